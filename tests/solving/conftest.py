"""A small routing problem, and engines of any behaviour."""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.programs.program import INTEGERS
from waybound.solvers.backend import BACKENDS, Engine, RawResult
from waybound.solvers.program_backend import ProgramBackend

XY = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)


@pytest.fixture
def square() -> RoutingProblem:
    """SQUARE-4 with capacity 2 of unit demands: optimum 24."""
    sites = Sites.of(range(5), demand=[0, 1, 1, 1, 1], coordinates=XY)
    return RoutingProblem(sites, Travel("euclidean", coordinates=XY), (VehicleType(count=2, capacity=2),), name="square")


@pytest.fixture
def says(registered: Any) -> Callable[..., str]:
    """``says(WORD, name, ...)`` registers for one test who says the same whatever is asked, or what a function makes of it: an engine where
    a ``family`` is named, else a solver of programs."""

    def make(said: RawResult | Callable[..., RawResult], name: str = "liar", **what: Any) -> str:
        kind, method = (Engine, "run") if "family" in what else (ProgramBackend, "search")
        body = {
            "name": name, "package": "numpy", "modules": ("numpy",), "summary": "a fake", "programs": (INTEGERS,), **what,
            method: lambda self, *given: said(*given) if callable(said) else said,
        }  # fmt: skip
        registered(BACKENDS, name, type("Says", (kind,), body))
        return name

    return make


@pytest.fixture
def engine_that(says: Callable[..., str]) -> Callable[[Callable[..., RawResult]], str]:
    """Registers an engine with the given behaviour for one test."""
    numbers = itertools.count()
    features = frozenset({"capacity", "limited-fleet", "objective:total-cost", "objective:priorities"})
    return lambda behaviour: says(behaviour, f"fake-{next(numbers)}", family="routing", features=features)
