"""A small routing problem, and engines of any behaviour."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult

XY = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)


@pytest.fixture
def square() -> RoutingProblem:
    """SQUARE-4 with capacity 2 of unit demands: optimum 24."""
    sites = Sites.of(range(5), demand=[0, 1, 1, 1, 1], coordinates=XY)
    return RoutingProblem(sites, Travel("euclidean", coordinates=XY), (VehicleType(count=2, capacity=2),), name="square")


@pytest.fixture
def engine_that(registered: Any) -> Callable[[Callable[..., RawResult]], str]:
    """Registers an engine with the given behaviour for one test."""
    names: list[str] = []

    def make(behaviour: Callable[..., RawResult]) -> str:
        class Fake(Engine):
            name = f"fake-{len(names)}"
            package = "numpy"
            modules = ("numpy",)
            summary = "a fake"
            family = "routing"
            features = frozenset({"capacity", "limited-fleet", "objective:total-cost", "objective:priorities"})

            def run(self, problem: Any, options: Options, control: Control) -> RawResult:
                return behaviour(problem, options, control)

        registered(BACKENDS, Fake.name, Fake)
        names.append(Fake.name)
        return Fake.name

    return make
