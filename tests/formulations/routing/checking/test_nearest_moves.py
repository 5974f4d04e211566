"""Least moves at each site: as many ends at depots as the loads need routes, and two sites beside each customer."""

from __future__ import annotations

import numpy as np
import pytest
from small_routing import plane

from waybound.formulations.routing.checking.nearest_moves import check_nearest_moves
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel


def by_hand(problem: RoutingProblem, routes: int) -> float:
    """One depot, one type of vehicle, at cost 1 of a unit of distance."""
    d, n = problem.travel.distances, len(problem.sites)
    paid = 0.0
    for i in range(1, n):
        pairs = [(a, b) for a in range(n) for b in range(n) if i not in (a, b) and (a != b or a == 0)]
        paid += min(d[a, i] + d[i, b] for a, b in pairs) / 2
    return paid + (sum(sorted(d[0, 1:])[:routes]) + sum(sorted(d[1:, 0])[:routes])) / 2


@pytest.mark.parametrize("seed", range(5))
def test_the_same_by_hand(seed: int) -> None:
    problem = plane(seed, 9, 15.0)
    routes = int(np.ceil(problem.sites.demand.sum() / 15.0))
    assert check_nearest_moves(problem, {}) == pytest.approx(by_hand(problem, routes), rel=1e-9)
    matrix = problem.travel.distances
    explicit = RoutingProblem(problem.sites, Travel(EXPLICIT, matrix=matrix), problem.fleet)
    assert check_nearest_moves(explicit, {}) == pytest.approx(by_hand(problem, routes), rel=1e-9), "off a matrix"


def test_one_customer_and_two() -> None:
    for customers, least in ((1, 10.0), (2, 12.0)):
        xy = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]])[: customers + 1]
        problem = RoutingProblem(Sites.of(range(customers + 1)), Travel("euclidean", xy), (VehicleType(),))
        assert 0.0 < check_nearest_moves(problem, {}) <= least + np.hypot(3.0, 6.0) - 5.0
