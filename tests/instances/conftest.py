"""What the tests of this floor share."""

import textwrap
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from waybound import InputError, RoutingInstance, Travel
from waybound.instances.reading import read_instance

SITE_ARRAYS = ("depot", "demand", "ready", "due", "service", "reward", "required", "penalty", "pickup", "further_demand", "further_pickup")


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
    found = [key for key in ("name", "problem", "problems", "min_vehicles", "objective") if getattr(a, key) != getattr(b, key)]
    found += [key for key in SITE_ARRAYS if not np.array_equal(getattr(a.sites, key), getattr(b.sites, key))]
    found += [key for key in ("windows", "skills", "shipments", "groups") if getattr(a.sites, key) != getattr(b.sites, key)]
    if a.sites.ids != b.sites.ids:
        found.append("ids")
    if not np.array_equal(*(np.empty(0) if i.sites.coordinates is None else i.sites.coordinates for i in (a, b))):
        found.append("coordinates")
    if [replace(v, travel=None) for v in a.fleet] != [replace(v, travel=None) for v in b.fleet]:
        return [*found, "fleet"]
    for here, there in ((a.travel, b.travel), *((v.travel, w.travel) for v, w in zip(a.fleet, b.fleet, strict=True))):
        if here is None or there is None:
            found += ["travel"] * (here is not there)
        else:
            found += _travel_differences(here, there)
    return found


def _travel_differences(a: Travel, b: Travel) -> list[str]:
    every = np.arange(len(a))
    step = max(1, len(every) // 50)
    pick = every[::step], every[None, :].T
    found = ["metric or convention"] * ((a.metric, a.convention) != (b.metric, b.convention))
    found += ["distances"] * (not np.array_equal(a.distance(*pick), b.distance(*pick)))
    return found + ["durations"] * (not np.array_equal(a.duration(*pick), b.duration(*pick)))


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
