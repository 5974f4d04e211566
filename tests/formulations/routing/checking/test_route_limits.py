import math

import numpy as np
import pytest
from coded import coded
from draws import draws
from hypothesis import given, settings
from oracles import routing, small_problems
from truth.routing import routes

from waybound import Energy, InputError, RoutingProblem
from waybound.formulations.routing.checking.route_limits import (
    LARGEST_RATE,
    allowed,
    clocks,
    limits_of,
    named_customers,
    servable_sets,
    summable,
    within_reach,
)

LINE = np.array([(0, 0), (1, 0), (2, 0), (5, 0)], dtype=float)


def servable(problem: RoutingProblem, kind: int = 0, most: int = 9) -> set[frozenset[int]]:
    """Sets of sites that may be all of one route, without detours."""
    customers = problem.customers
    masks = servable_sets(limits_of(problem, problem.fleet[kind]), np.arange(1, len(customers) + 1), np.zeros(0, dtype=np.int64), most)
    return {frozenset(int(c) for k, c in enumerate(customers) if mask >> k & 1) for mask in masks}


@settings(max_examples=draws(80), deadline=None)
@given(problem=small_problems(most=3, hetero=True))
def test_every_route_that_can_be_driven_is_found_possible(problem: RoutingProblem) -> None:
    customers = problem.customers.tolist()
    for kind, vehicle in enumerate(problem.fleet):
        limits, possible = limits_of(problem, vehicle), servable(problem, kind)
        near = dict(zip(customers, within_reach(limits).tolist(), strict=True))
        for visits in routes(problem, vehicle):
            assert frozenset(visits) in possible
            assert all(near[site] for site in visits)


def test_without_detours_what_is_found_possible_can_be_driven() -> None:
    problem = routing(xy=LINE, sites={"demand": [0, 2, 2, 3], "due": [math.inf, 1, 9, 9]}, capacity=5, max_distance=10)
    driven = {frozenset(visits) for visits in routes(problem, problem.fleet[0])}
    assert servable(problem) == driven == {frozenset(s) for s in ([1], [2], [3], [1, 2], [1, 3], [2, 3])}
    assert servable(problem, most=1) == {frozenset(s) for s in ([1], [2], [3])}


@pytest.mark.parametrize(
    ("vehicle", "reachable"),
    [
        ({}, [True, True, True]),
        ({"capacity": 2}, [True, True, False]),
        ({"max_distance": 4}, [True, True, False]),
        ({"max_duration": 5}, [True, True, False]),  # 1 at each site and two ways
        ({"max_duration": 4}, [True, False, False]),
        ({"energy": Energy(8, 2, "travel")}, [True, True, False]),
        ({"energy": Energy(8, 2, "elapsed")}, [True, False, False]),
        ({"energy": Energy(8, 2, "elapsed-fixed-start")}, [False, False, False]),  # everybody opens at 3
        ({"energy": Energy(12, 2, "elapsed-fixed-start")}, [True, True, False]),
        ({"energy": Energy(9.9, 2, "windows")}, [False, False, False]),  # 2 max(1, 3) + 2 (1 + 1)
        ({"energy": Energy(12, 2, "windows")}, [True, True, False]),
    ],
)
def test_every_limit_bounds_how_far_a_vehicle_gets(vehicle: dict[str, object], reachable: list[bool]) -> None:
    sites = {"demand": [0, 1, 2, 3], "service": [0, 1, 1, 1], "ready": [0, 3, 3, 3]}
    problem = routing(xy=LINE, sites=sites, **vehicle)
    assert within_reach(limits_of(problem, problem.fleet[0])).tolist() == reachable


def test_a_limit_that_is_met_exactly_is_kept_and_one_missed_by_more_than_rounding_is_not() -> None:
    for limit, reachable in ((4.0, True), (4.0 - 1e-12, True), (3.999, False)):
        problem = routing(xy=LINE[:3], max_distance=limit)
        assert within_reach(limits_of(problem, problem.fleet[0]))[1] == reachable
    assert allowed(10.0) >= 10.0 and allowed(10.0, 1e6) >= allowed(10.0) and allowed(10.0, 0.0, 2.0) >= 12.0


def test_clocks_go_over_detours_where_these_are_shorter_and_open() -> None:
    """From the depot to 2 it is 9, over 1 it is 2 + 3; closed at 4, site 1 is still passed on the way at 2, but not if it opens at 6."""
    matrix = np.array([[0, 2, 9], [7, 0, 3], [1, 8, 0]], dtype=float)
    for ready, begin in ((0, 5), (3, 6), (8, 9)):
        problem = routing(matrix=matrix, sites={"ready": [0, ready, 0], "due": [math.inf, ready + 2, math.inf]})
        reached, home = clocks(limits_of(problem, problem.fleet[0]))
        assert reached.tolist() == [max(2, ready), begin]
        assert home.tolist() == [4, 1]  # from 1 by way of 2


def test_a_window_that_is_missed_is_never_reached() -> None:
    problem = routing(xy=LINE, sites={"due": [math.inf, 9, 1.5, 9]})
    reached, _ = clocks(limits_of(problem, problem.fleet[0]))
    assert reached.tolist() == [1, math.inf, 5]


def test_detours_over_unnamed_sites_are_free() -> None:
    """Named are 1 and 3; the direct move takes 9, by way of 2 it is 2. Either alone is 9 from one end, and the other is no detour."""
    matrix = np.full((4, 4), 9.0)
    matrix[[0, 1, 2, 3], [1, 2, 3, 0]] = 1.0
    problem = routing(matrix=matrix, max_distance=5)
    limits, named = limits_of(problem, problem.fleet[0]), np.array([1, 3])
    assert servable_sets(limits, named, np.zeros(0, dtype=np.int64), 2) == set()
    assert servable_sets(limits, named, np.array([2]), 2) == {0b11}


def test_rates_beyond_what_can_be_added_up_prove_nothing() -> None:
    assert summable(routing(xy=LINE))
    assert summable(routing(xy=LINE, energy=Energy(1.0, LARGEST_RATE, "travel")))
    assert not summable(routing(xy=LINE, energy=Energy(1.0, 2 * LARGEST_RATE, "travel")))


def test_named_sites_are_customers_by_their_ids() -> None:
    problem = routing(xy=LINE, sites={"depot": [False, True, False, False]}, start=1, end=1)
    assert named_customers(problem, ["3", "0"]) == [3, 1]
    for wrong in ("0", [], ["9"], [0], None, {"0": 1}):
        with pytest.raises(InputError, check=coded("unknown-name")):
            named_customers(problem, wrong)
    for wrong in (["1"], ["0", "0"]):
        with pytest.raises(InputError, match="a depot, or a site twice"):
            named_customers(problem, wrong)
