"""What the tests of this floor share."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.reading import read_instance
from waybound.instances.routing.instance import RoutingInstance

SITE_ARRAYS = ("depot", "demand", "ready", "due", "service", "reward", "required")


NAMES = ("robot_names", "action_names", "target_names", "element_names", "variable_names")


def _differences(a: Any, b: Any) -> list[str]:
    if a.kind != b.kind:
        return ["kind"]
    if isinstance(a, RoutingInstance):
        return _routing_differences(a, b)
    found = [key for key in ("name", "problem", "problems", "notes", *NAMES) if getattr(a, key, None) != getattr(b, key, None)]
    for key in ("action_positions", "target_positions"):
        here, there = getattr(a, key, None), getattr(b, key, None)
        if (here is None) != (there is None) or (here is not None and here.tobytes() != there.tobytes()):
            found.append(key)
    return found + ["data"] * (a.digest() != b.digest())


def _routing_differences(a: RoutingInstance, b: RoutingInstance) -> list[str]:
    found = [key for key in ("name", "problem", "problems", "fleet", "min_vehicles", "objective") if getattr(a, key) != getattr(b, key)]
    found += [key for key in SITE_ARRAYS if not np.array_equal(getattr(a.sites, key), getattr(b.sites, key))]
    if a.sites.ids != b.sites.ids:
        found.append("ids")
    here, there = (np.empty(0) if i.sites.coordinates is None else i.sites.coordinates for i in (a, b))
    if not np.array_equal(here, there):
        found.append("coordinates")
    if (a.travel.metric, a.travel.convention) != (b.travel.metric, b.travel.convention):
        found.append("metric or convention")
    every = np.arange(len(a.sites))
    step = max(1, len(every) // 50)
    pick = every[::step], every[None, :].T
    if not np.array_equal(a.travel.distance(*pick), b.travel.distance(*pick)):
        found.append("distances")
    if not np.array_equal(a.travel.duration(*pick), b.travel.duration(*pick)):
        found.append("durations")
    return found


@pytest.fixture(scope="session")
def differences() -> Callable[[Any, Any], list[str]]:
    """Names of everything in which two instances differ, to the bit."""
    return _differences


@pytest.fixture
def read_text_as(tmp_path: Path) -> Callable[..., Any]:
    """Reads a text as a file of the given name."""

    def read(text: str, name: str = "file.txt", **options: Any) -> Any:
        path = tmp_path / name
        path.write_text(textwrap.dedent(text), encoding="utf-8", newline="")
        return read_instance(path, **options)

    return read


@pytest.fixture
def refusal(read_text_as: Callable[..., Any]) -> Callable[..., InputError]:
    """The error that a text is refused with; checks that it names file and is one line."""

    def refuse(text: str, name: str = "file.txt", **options: Any) -> InputError:
        with pytest.raises(InputError) as caught:
            read_text_as(text, name, **options)
        assert name in str(caught.value)
        assert "\n" not in str(caught.value)
        assert caught.value.exit_code == 2
        return caught.value

    return refuse
