import itertools

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.routing.travel import EXPLICIT
from waybound.reports.ratios.judged_runs import run_heuristic


def salesman(travel: Travel, **fleet: float) -> RoutingProblem:
    return RoutingProblem(Sites.of(range(len(travel)), demand=1.0), travel, (VehicleType(**fleet),))


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 8), st.booleans())
def test_the_tour_is_at_most_half_as_long_again_as_the_shortest(seed: int, n: int, improve: bool) -> None:
    travel = Travel("manhattan", np.random.default_rng(seed).integers(0, 9, (n, 2)))
    d = travel.distances
    shortest = min(sum(d[i, j] for i, j in itertools.pairwise((0, *p, 0))) for p in itertools.permutations(range(1, n)))
    problem = salesman(travel, count=1)
    found = run_heuristic(problem, "christofides", {"improve": improve}, seed)
    assert found.guarantee is not None and found.guarantee.ratio == 1.5
    assert shortest - 1e-9 <= problem.evaluate(found.answer).values[0] <= 1.5 * shortest + 1e-9


def test_octo_is_solved() -> None:
    xy = [(0, 0), (2, 7), (5, 3), (8, 8), (-4, 6), (-7, 1), (-3, -5), (4, -6), (9, -2)]
    problem = salesman(Travel("euclidean", xy), count=1)
    assert problem.evaluate(run_heuristic(problem, "christofides", {}, 1).answer).values[0] == pytest.approx(56.606765)


def test_distances_that_are_not_metric_are_measured() -> None:
    matrix = np.array([[0, 1, 9, 1], [1, 0, 1, 9], [9, 1, 0, 1], [1, 9, 1, 0]], dtype=float)
    found = run_heuristic(salesman(Travel(EXPLICIT, matrix=matrix)), "christofides", {}, 1)
    assert found.guarantee is not None and found.guarantee.ratio == 1.5  # the tour of length 4 uses short moves alone
    assert found.guarantee.assumptions[1] == "moves longer than shortest paths stay within what the theorem allows"


def test_a_load_beyond_one_vehicle_is_refused() -> None:
    travel = Travel("euclidean", np.eye(4)[:, :2])
    assert HEURISTICS["christofides"].missing(salesman(travel, capacity=2.0)) == {"capacity"}
    assert not HEURISTICS["christofides"].missing(salesman(travel, capacity=3.0))


def test_cut_short_it_is_a_tour_all_the_same() -> None:
    problem = salesman(Travel("EUC_2D", np.random.default_rng(1).integers(0, 1000, (300, 2))), count=1)
    found = HEURISTICS["christofides"].run(problem, context(0.0))
    assert problem.evaluate(found.answer).feasible and found.guarantee is None and found.limit == "time"
