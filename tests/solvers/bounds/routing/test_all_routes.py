"""Small fleets of several types are proved by all routes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from programs import program
from small_routing import small
from truth.routing import best_values

import waybound as wb
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.all_routes import all_routes_bound


@pytest.mark.slow
def test_a_fleet_of_several_types_and_optional_sites_are_proved_optimal() -> None:
    for feature in ("heterogeneous-fleet", "prizes"):
        problem = next(p for p in (small(feature, seed, "exact") for seed in range(9)) if best_values(p) is not None)
        evidence, best = all_routes_bound(problem, Stop(10.0)), best_values(problem)
        assert evidence is not None and best is not None
        assert verified_bound(problem, evidence) == pytest.approx(best[0])
        found = wb.solve(problem, "highs", bound_time=10.0)
        assert (found.status, found.bound_kind) == ("optimal", "verified")


def test_it_applies_to_few_customers() -> None:
    missing = BOUNDS["all-routes"].missing
    assert missing(small("capacity", 0, "exact")) == frozenset()
    assert missing(wb.generate("random", seed=1, customers=13)) == {"few customers"}
    assert missing(wb.generate("random", seed=1, customers=12)) == frozenset()
    assert missing(ArrayProblem(program([1.0], [[1.0]], 0, 1))) == {"arrays problems"}


def test_a_problem_without_answers_is_told() -> None:
    sites = Sites.of("oabc", demand=[0, 2, 2, 2])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(2, 3.0),))
    found = all_routes_bound(problem, Stop(60.0))
    assert found is not None and found.value == math.inf
    assert all_routes_bound(problem, Stop(0.0)) is None
