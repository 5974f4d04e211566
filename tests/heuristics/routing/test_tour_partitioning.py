import math

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context
from truth.routing import best_values

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.heuristics.routing.tour_partitioning import pieces_of
from waybound.instances.routing.travel import EXPLICIT
from waybound.reports.ratios.judged_runs import run_heuristic


def loaded(demand: list[float], capacity: float, travel: Travel | None = None, **fleet: float) -> RoutingProblem:
    n = len(demand) + 1
    made = travel or Travel("euclidean", np.random.default_rng(n).integers(0, 30, (n, 2)))
    return RoutingProblem(Sites.of(range(n), demand=[0, *demand]), made, (VehicleType(capacity=capacity, **fleet),))


@pytest.mark.parametrize(
    ("demand", "capacity", "ratio", "source"),
    [
        ([1] * 9, 3, 2.5 - 1.5 / 3, "Haimovich"), ([0.3] * 9, 0.9, 2.5 - 1.5 / 3, "Haimovich"),
        ([0.2] * 9, 0.6, 2.5 - 1.5 / 3, "Haimovich"), ([7] * 9, 10, 1.0, "Haimovich"),
        ([2, 4, 6, 2], 8, 3.5 - 3 / 4, "Altinkemer and Gavish (1987)"),  # in units of 2
        ([1, 2, 3, 1], 5, 3.5 - 3 / 10, "Altinkemer and Gavish (1987)"), ([1.5, 2, 3], 4, 3.5, "Altinkemer and Gavish (1987)"),
        ([1, 2, 3, 1], 7, 1.5, "Christofides"), ([1, 2, 3], math.inf, 1.5, "Christofides"), ([0, 0, 0], 1, 1.5, "Christofides"),
    ],
)  # fmt: skip
def test_the_ratio_is_that_of_the_literature(demand: list[float], capacity: float, ratio: float, source: str) -> None:
    found = run_heuristic(loaded(demand, capacity), "tour-partitioning", {}, 1)
    assert found.guarantee.ratio == pytest.approx(ratio) and source in found.guarantee.source
    assert found.guarantee.assumptions[:2] == ("distances are symmetric", "the triangle inequality holds")


def test_customers_above_half_a_vehicle_go_alone() -> None:
    pieces = pieces_of(loaded([5, 6, 2, 10], 10))
    assert pieces.alone.tolist() == [False, True, False, True]
    assert (pieces.segment, pieces.times, pieces.share) == (5.0, 2.0, 0.8)
    found = run_heuristic(loaded([5, 6, 2, 10], 10), "tour-partitioning", {}, 1)
    assert {(2,), (4,)} <= {route.visits for route in found.answer}


@settings(max_examples=draws(80), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6), st.sampled_from([1, 9, 0.7]), st.sampled_from(["exact", "round", "trunc1"]))
def test_its_ratio_holds(seed: int, n: int, unit: float, convention: str) -> None:
    rng = np.random.default_rng(seed)
    demand = np.full(n, 1.0) if unit == 1 else unit * rng.integers(0, 10, n)
    capacity = max(float(demand.max()), float(rng.uniform(0, demand.sum() * 1.2)), 1.0)
    travel = Travel("euclidean", rng.integers(0, 12, (n + 1, 2)), convention=convention)
    problem = loaded(demand.tolist(), capacity, travel, fixed_cost=float(rng.choice([0.0, 4.0])), unit_cost=float(rng.choice([1.0, 3.0])))
    best = best_values(problem)
    for options in ({}, {"improve": False}, {"tour": "double-tree"}):
        found = run_heuristic(problem, "tour-partitioning", options, seed)
        judged = problem.evaluate(found.answer)
        assert judged.feasible and found.guarantee is not None
        assert best[0] * (1 - 1e-9) <= judged.values[0] <= found.guarantee.ratio * best[0] * (1 + 1e-9) + 1e-12


def test_one_way_distances_have_no_guarantee() -> None:
    travel = Travel(EXPLICIT, matrix=np.random.default_rng(1).uniform(1, 9, (6, 6)))
    found = run_heuristic(loaded([1, 1, 1, 1, 1], 2, travel), "tour-partitioning", {}, 1)
    assert found.guarantee is None and "not symmetric" in found.message


def test_customers_without_demand_are_on_one_route_where_a_vehicle_carries_nothing() -> None:
    found = run_heuristic(loaded([0, 1, 0, 2], 0.5), "tour-partitioning", {}, 1)
    assert sorted(sorted(route.visits) for route in found.answer) == [[1, 3], [2], [4]] and found.guarantee is None


def test_a_fleet_too_small_is_said_and_has_no_guarantee() -> None:
    found = run_heuristic(loaded([4, 4, 4, 4], 10, count=1), "tour-partitioning", {}, 1)
    assert found.guarantee is None and "fleet of 1" in found.message


def test_a_way_within_the_fleet_is_taken_before_a_cheaper_one() -> None:
    problem = loaded([1] * 7, 4, count=2)
    found = run_heuristic(problem, "tour-partitioning", {}, 1)
    assert problem.evaluate(found.answer).feasible and len(found.answer) == 2


def test_cut_short_it_fills_vehicles_in_turn() -> None:
    problem = loaded([1] * 40, 6)
    found = HEURISTICS["tour-partitioning"].run(problem, context(0.0))
    assert problem.evaluate(found.answer).feasible and found.guarantee is None and found.limit == "time"


def test_what_it_cannot_cut_it_refuses() -> None:
    heuristic = HEURISTICS["tour-partitioning"]
    sites = Sites.of(range(3), depot=[True, False, True])
    travel = Travel("euclidean", [[0, 0], [1, 0], [2, 0]])
    assert "open-routes" in heuristic.missing(RoutingProblem(sites, travel, (VehicleType(start=0, end=2),)))
    assert "time-windows" in heuristic.missing(RoutingProblem(Sites.of(range(3), due=[9, 5, 5]), travel, (VehicleType(),)))
