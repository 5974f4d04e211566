import itertools
import math
from dataclasses import replace

import hostile_instances
import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context
from truth.routing import RoutingTruth

from waybound import Routes, RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.reports.ratios.judged_runs import run_heuristic

CONTEXT = context()


def loaded(seed: int, n: int, **fleet: float) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    demand = np.r_[0, rng.integers(0, 10, n)]
    travel = Travel("euclidean", rng.integers(0, 30, (n + 1, 2)))
    capacity = float(max(demand.max(), rng.integers(1, demand.sum() + 2)))
    return RoutingProblem(Sites.of(range(n + 1), demand=demand), travel, (VehicleType(capacity=capacity, **fleet),))


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 40))
def test_it_costs_no_more_than_partitioning_the_same_tour(seed: int, n: int) -> None:
    problem = loaded(seed, n, fixed_cost=2.0)
    split, cut = (run_heuristic(problem, name, {}, seed) for name in ("split", "tour-partitioning"))
    value, other = (problem.evaluate(found.answer) for found in (split, cut))
    assert value.feasible and value.values[0] <= other.values[0] + 1e-9
    assert split.guarantee is not None and cut.guarantee is not None and split.guarantee.ratio == cut.guarantee.ratio


@pytest.mark.slow
@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_the_routes_of_an_optimum_in_a_row_are_split_into_an_optimum(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    problem = hostile_instances.routing(rng, hostile_instances.Units(), most=n, plain=True)
    truth = RoutingTruth(problem)
    if truth.best is None or truth.lenient is None or HEURISTICS["split"].missing(problem):
        return
    customers = problem.customers.tolist()
    values = []
    for order in itertools.islice(itertools.permutations(customers), 24):
        found = HEURISTICS["split"].run(problem, replace(CONTEXT, start=Routes.of([order])))
        judged = problem.evaluate(found.answer)
        if judged.feasible:
            values.append(judged.values[0])
    if len(customers) <= 4:  # all orders were tried
        most, least = float(truth.best[0]), float(truth.lenient[0])
        assert least - 1e-9 * abs(least) <= min(values) <= most + 1e-9 * abs(most)


def test_windows_and_limits_are_kept() -> None:
    xy = [(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)]
    sites = Sites.of(range(5), ready=[0, 0, 0, 10, 0], due=[math.inf, 20, 6, 12, 4])
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(count=4),))
    assert problem.evaluate(run_heuristic(problem, "split", {}, 1).answer).feasible
    limited = RoutingProblem(Sites.of(range(5)), Travel("euclidean", xy), (VehicleType(count=2, max_distance=12.0),))
    judged = limited.evaluate(run_heuristic(limited, "split", {}, 1).answer)
    assert judged.feasible and judged.values[0] == 24.0


@settings(max_examples=draws(60), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 8))
def test_with_windows_it_costs_no_more_than_insertion(seed: int, n: int) -> None:
    problem = hostile_instances.routing(np.random.default_rng(seed), hostile_instances.Units(), most=n, plain=True)
    split, inserted = (problem.evaluate(run_heuristic(problem, name, {}, seed).answer) for name in ("split", "insertion"))
    if inserted.feasible and "time-windows" in problem.features():
        assert split.feasible and split.values[0] <= inserted.values[0] * (1 + 1e-9)


def test_a_limited_fleet_is_part_of_the_search() -> None:
    xy = [(0, 0), (10, 0), (-10, 0), (0, 10)]
    free = RoutingProblem(Sites.of(range(4), demand=[0, 1, 1, 1]), Travel("euclidean", xy), (VehicleType(capacity=2, unit_cost=1.0),))
    asymmetric = replace(free, fleet=(VehicleType(capacity=2, count=2),))
    found = run_heuristic(asymmetric, "split", {}, 1)
    assert asymmetric.evaluate(found.answer).feasible and len(found.answer) == 2


def test_who_fits_on_no_route_has_one_alone() -> None:
    problem = RoutingProblem(Sites.of(range(3)), Travel("euclidean", [(0, 0), (5, 0), (50, 0)]), (VehicleType(max_distance=20.0),))
    assert run_heuristic(problem, "split", {}, 1).answer == Routes.of([[1], [2]])


def test_a_guarantee_needs_limits_that_cost_nothing() -> None:
    plain = loaded(3, 20)
    longest = 2.5 * float(plain.travel.distances[0].max())
    limited = replace(plain, fleet=(replace(plain.fleet[0], max_distance=longest),))
    found = run_heuristic(limited, "split", {}, 1)
    assert limited.evaluate(found.answer).feasible
    assert found.guarantee is None or found.guarantee.ratio == run_heuristic(plain, "split", {}, 1).guarantee.ratio  # type: ignore[union-attr]
    windows = RoutingProblem(
        Sites.of(range(3), ready=[0, 0, 30], due=[99, 5, 40]), Travel("euclidean", [(0, 0), (1, 0), (2, 0)]), (VehicleType(),)
    )
    assert run_heuristic(windows, "split", {}, 1).guarantee is not None  # one tour, as without the windows


@pytest.mark.parametrize("seconds", [0.0, 1e-9])
def test_cut_short_nobody_is_left_out(seconds: float) -> None:
    problem = loaded(1, 200)
    found = HEURISTICS["split"].run(problem, replace(CONTEXT, time_limit=seconds))
    assert problem.evaluate(found.answer).feasible and found.guarantee is None and found.limit == "time"
