import itertools
import math

import numpy as np
import pytest
from coded import coded
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound import RoutingProblem, Sites, Travel, UsageError, VehicleType
from waybound.formulations.routing.routes import Routes
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.routing.tour_steps import giant_tour as module
from waybound.heuristics.routing.tour_steps.giant_tour import Costs, giant_tour, guaranteed, in_rows, moving_costs
from waybound.instances.routing.travel import EXPLICIT


def of(travel: Travel, service: float = 0.0, **vehicle: float) -> RoutingProblem:
    sites = Sites.of(range(len(travel)), service=np.r_[0.0, np.full(len(travel) - 1, service)])
    return RoutingProblem(sites, travel, (VehicleType(**vehicle),))


def costs_of(travel: Travel, **given: float) -> Costs:
    return moving_costs(of(travel, **given), NEVER)


def plane(seed: int, n: int, convention: str = "exact") -> Travel:
    return Travel("euclidean", np.random.default_rng(seed).integers(0, 15, (n, 2)), convention=convention)


def test_routes_cost_the_sum_of_their_moves() -> None:
    problem = of(plane(1, 4), fixed_cost=10.0, unit_cost=2.0)
    costs = moving_costs(problem, NEVER)
    value = problem.evaluate(Routes.of([[1, 3], [2]])).values[0]
    moves = [(0, 1), (1, 3), (3, 0), (0, 2), (2, 0)]
    assert math.fsum(costs.moves[i, j] for i, j in moves) == pytest.approx(value)


def test_durations_hold_half_of_each_service() -> None:
    travel = Travel(EXPLICIT, matrix=np.ones((3, 3)), duration_matrix=np.array([[0.0, 2, 4], [2, 0, 6], [4, 6, 0]]))
    costs = moving_costs(of(travel, service=3.0), NEVER, busy=True)
    assert costs is not None and costs.moves.tolist() == [[0, 3.5, 5.5], [3.5, 0, 9], [5.5, 9, 0]]
    distances = moving_costs(of(travel, unit_cost=7.0, fixed_cost=4.0), NEVER, distance=True)
    assert distances is not None and distances.moves[0].tolist() == [0, 1, 1]


@pytest.mark.parametrize(
    ("travel", "known"),
    [
        (plane(1, 4), True), (plane(1, 4, "round"), False), (plane(1, 4, "trunc1"), False), (plane(1, 4, "ceil"), False),
        (Travel("CEIL_2D", plane(1, 4).coordinates), True), (Travel("EUC_2D", plane(1, 4).coordinates), False),
        (Travel("GEO", plane(1, 4).coordinates, convention="exact"), False), (Travel(EXPLICIT, matrix=np.ones((4, 4))), False),
    ],
)  # fmt: skip
def test_what_is_metric_by_nature(travel: Travel, known: bool) -> None:
    assert costs_of(travel).known == known


def test_one_way_moves_are_told_from_symmetric_ones() -> None:
    costs = costs_of(Travel(EXPLICIT, matrix=np.array([[0.0, 1, 2], [3, 0, 4], [2, 4, 0]])))
    assert not costs.symmetric and costs.both_ways[0, 1] == 2.0
    found = giant_tour(costs, "christofides", True, NEVER)
    assert found.ratio is None and "not symmetric" in found.message
    assert found.length == 1 + 4 + 2  # the shorter of both directions


@settings(max_examples=draws(80), deadline=None)
@given(st.integers(0, 10**6), st.integers(2, 7), st.sampled_from(["exact", "round", "trunc1"]), st.booleans())
def test_a_tour_is_within_its_ratio(seed: int, n: int, convention: str, improved: bool) -> None:
    travel = plane(seed, n, convention)
    d = travel.distances
    tours = [(0, *p, 0) for p in itertools.permutations(range(1, n))]
    costs = costs_of(travel)
    shortest = min(sum(d[i, j] for i, j in itertools.pairwise(t)) for t in tours)
    for method, ratio in (("christofides", 1.5), ("double-tree", 2.0)):
        found = giant_tour(costs, method, improved, NEVER)
        assert sorted(found.order) == list(range(1, n))
        assert found.ratio == ratio
        assert found.proved <= ratio * shortest + 1e-9
        assert (found.length <= found.proved + 1e-9) or not found.metric
        assert found.metric == bool((d[:, :, None] + d[None] >= d[:, None, :] - 1e-9).all())


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1e149])
@pytest.mark.filterwarnings("error")
def test_a_tour_does_not_depend_on_the_unit_of_distance(size: float) -> None:
    corners = np.array([[0, 1, 2, 1], [1, 0, 1, 2], [2, 1, 0, 1], [1, 2, 1, 0]]) * size
    found = giant_tour(costs_of(Travel(EXPLICIT, matrix=corners)), "christofides", True, NEVER)
    assert found.length == 4 * size and found.ratio == 1.5


def test_with_too_many_to_match_the_tree_is_doubled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_MATCHED", 2)
    found = giant_tour(costs_of(plane(3, 30)), "christofides", True, NEVER)
    assert found.ratio == 2.0 and "double tree" in found.message and "Rosenkrantz" in found.source


def test_with_too_many_to_look_at_nothing_is_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_CLOSED", 10)
    assert giant_tour(costs_of(plane(3, 30)), "christofides", True, NEVER).ratio == 1.5
    found = giant_tour(costs_of(plane(3, 30, "round")), "christofides", True, NEVER)
    assert found.ratio is None and "30 sites are too many" in found.message


def test_the_nearest_neighbour_has_no_ratio() -> None:
    assert giant_tour(costs_of(plane(3, 9)), "nearest-neighbour", True, NEVER).ratio is None


def test_asked_to_stop_nothing_is_proved_and_nobody_left_out() -> None:
    for method in module.TOURS:
        found = giant_tour(costs_of(plane(3, 30)), method, True, Stop(0.0))
        assert found.ratio is None and sorted(found.order) == list(range(1, 30))


def test_a_tour_that_there_is_not_is_refused() -> None:
    with pytest.raises(UsageError, check=coded("unknown-name")):
        giant_tour(costs_of(plane(3, 4)), "best", True, NEVER)


def test_rows_are_moves_out_on_and_back() -> None:
    costs = np.arange(16.0).reshape(4, 4)
    assert in_rows(costs, np.array([2, 1, 3])).tolist() == [[2, 1, 3], [9, 7, 0], [8, 4, 12]]


def test_a_guarantee_is_widened_or_withheld_by_what_a_theorem_allows() -> None:
    metric = giant_tour(costs_of(plane(3, 9)), "christofides", False, NEVER)
    stated = lambda tour, value, plain=True: guaranteed(tour, value, 10.0, 2.0, 0.5, "words", (), "source", plain)  # noqa: E731
    allowed = 20.0 + metric.proved / 2
    assert stated(metric, allowed).ratio == 2.75
    assert stated(metric, 1.01 * allowed) is None
    rounded = giant_tour(costs_of(plane(3, 30, "round")), "christofides", False, NEVER)
    allowed = 20.0 + rounded.proved / 2
    assert not rounded.metric
    assert stated(rounded, allowed).ratio == 2.75
    assert stated(rounded, 1.1 * allowed).ratio == pytest.approx(2.75 * 1.1)
    assert stated(rounded, 1.1 * allowed, False) is None
    assert stated(giant_tour(costs_of(plane(3, 9)), "nearest-neighbour", False, NEVER), 1.0) is None
