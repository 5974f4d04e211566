"""Least costs by coordinates are those of the matrices, at any size in little memory."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

from waybound.formulations.routing.checking.load_shares import check_load_shares, check_nearest_moves
from waybound.formulations.routing.checking.vehicle_moves import terms_of
from waybound.formulations.routing.checking.ways_by_metric import by_coordinates, least_moves_at, least_round_trips
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, METRICS, Travel

METRIC = [name for name in METRICS if name != "GEO"]


def spread(n: int, metric: str, convention: str = "exact", seed: int = 1) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    travel = Travel(metric, rng.uniform(-60, 60, (n + 1, 2)), convention=convention)
    return RoutingProblem(Sites.of(range(n + 1), demand=[0, *rng.integers(1, 10, n)]), travel, (VehicleType(capacity=50.0, unit_cost=2.0),))


@pytest.mark.parametrize("metric", METRIC)
def test_coordinates_say_what_the_matrix_says(metric: str) -> None:
    problem = spread(40, metric)
    matrix = replace(problem, travel=Travel(EXPLICIT, matrix=problem.travel.distances))
    terms, vehicle = terms_of(problem), problem.fleet[0]
    assert terms is not None and by_coordinates(problem) and not by_coordinates(matrix)
    size = float(problem.travel.distances.max())
    for one, other in zip(least_moves_at(problem, terms), least_moves_at(matrix, terms), strict=True):
        assert np.allclose(one, other, rtol=1e-6, atol=1e-6 * size) and (one <= other * (1 + 1e-12)).all()
    trips, shortfall = least_round_trips(problem, terms, vehicle)
    assert np.allclose(trips, least_round_trips(matrix, terms, vehicle)[0], rtol=1e-6)
    assert shortfall <= 1e-5 * size


def test_ways_lead_over_other_sites_where_that_is_nearer() -> None:
    matrix = np.array([[0.0, 1.0, 9.0], [1.0, 0.0, 1.0], [9.0, 1.0, 0.0]])
    problem = RoutingProblem(Sites.of(range(3)), Travel(EXPLICIT, matrix=matrix), (VehicleType(),))
    terms = terms_of(problem)
    assert terms is not None
    assert least_round_trips(problem, terms, problem.fleet[0])[0].tolist() == [2.0, 4.0]


def test_many_sites_take_no_matrix() -> None:
    problem = spread(20_000, "euclidean")
    tracemalloc.start()
    try:
        assert check_load_shares(problem, {}) > 0 and check_nearest_moves(problem, {}) > 0
        assert tracemalloc.get_traced_memory()[1] < 1e8, "all moves would take 3.2e9 bytes"
    finally:
        tracemalloc.stop()
