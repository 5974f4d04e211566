import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context
from truth.routing import best_values

from waybound import LongestRoute, Makespan, RoutingProblem, Sites, Travel, UsageError, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.routing.travel import EXPLICIT
from waybound.reports.ratios.judged_runs import run_heuristic

SQUARE = [(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)]
OCTO = [(0, 0), (2, 7), (5, 3), (8, 8), (-4, 6), (-7, 1), (-3, -5), (4, -6), (9, -2)]


def shared(points: list[tuple[float, float]], vehicles: int) -> RoutingProblem:
    xy = np.array(points, dtype=float)
    return RoutingProblem(Sites.of(range(len(xy))), Travel("euclidean", coordinates=xy), (VehicleType(count=vehicles),), LongestRoute())


@pytest.mark.parametrize(
    ("points", "vehicles", "cut", "stated"),
    [(SQUARE, 2, 12.0, 14.0), (SQUARE, 3, 12.0, 12.6667), (OCTO, 2, 36.381253, 39.617091), (OCTO, 3, 28.524688, 33.953866)],
)
def test_no_worse_than_the_published_cuts_of_a_shortest_tour(
    points: list[tuple[float, float]], vehicles: int, cut: float, stated: float
) -> None:
    problem = shared(points, vehicles)
    found = run_heuristic(problem, "tour-splitting", {}, 1)
    assert problem.evaluate(found.answer).values[0] <= cut + 1e-6
    tour = found.statistics["tour"]
    farthest = float(problem.travel.distances[0].max())
    assert (tour - 2 * farthest) / vehicles + 2 * farthest == pytest.approx(stated, abs=1e-4)
    assert found.guarantee is not None and found.guarantee.ratio == pytest.approx(2.5 - 1 / vehicles)


@pytest.mark.slow
@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.integers(1, 4), st.booleans(), st.sampled_from(["exact", "round"]))
def test_its_ratio_holds(seed: int, n: int, vehicles: int, timed: bool, convention: str) -> None:
    rng = np.random.default_rng(seed)
    travel = Travel("euclidean", coordinates=rng.integers(0, 12, (n + 1, 2)), convention=convention)
    service = np.r_[0, rng.integers(0, 9, n)].astype(float) if timed else 0.0
    problem = RoutingProblem(
        Sites.of(range(n + 1), service=service), travel, (VehicleType(count=vehicles),), Makespan() if timed else LongestRoute()
    )
    best = best_values(problem)
    for options in ({}, {"improve": False}, {"tour": "double-tree"}):
        found = run_heuristic(problem, "tour-splitting", options, seed)
        judged = problem.evaluate(found.answer)
        assert judged.feasible and found.guarantee is not None
        assert best[0] * (1 - 1e-9) <= judged.values[0] <= found.guarantee.ratio * best[0] * (1 + 1e-9)


def test_moves_far_from_metric_widen_the_ratio_by_what_they_cost() -> None:
    matrix = np.array([[0, 1, 1, 9], [1, 0, 1, 1], [1, 1, 0, 1], [9, 1, 1, 0]], dtype=float)
    problem = RoutingProblem(Sites.of(range(4)), Travel(EXPLICIT, matrix=matrix), (VehicleType(count=3),), LongestRoute())
    found = run_heuristic(problem, "tour-splitting", {}, 1)
    judged, best = problem.evaluate(found.answer), best_values(problem)
    assert judged.values[0] <= found.guarantee.ratio * best[0] + 1e-9
    assert "shortest paths" in found.guarantee.assumptions[1]


def test_cut_short_everybody_is_visited_and_nothing_is_stated() -> None:
    found = HEURISTICS["tour-splitting"].run(shared(OCTO, 3), context(0.0))
    assert sorted(site for route in found.answer for site in route.visits) == list(range(1, 9))
    assert found.limit == "time" and found.guarantee is None


def test_a_tour_that_there_is_not_is_refused() -> None:
    with pytest.raises(UsageError, match="christofides, double-tree, nearest-neighbour"):
        run_heuristic(shared(SQUARE, 2), "tour-splitting", {"tour": "shortest"}, 1)
