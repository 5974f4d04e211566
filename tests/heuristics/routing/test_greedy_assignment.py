import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context

from waybound import Makespan, Reward, Route, Routes, RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.reports.ratios.judged_runs import run_heuristic

SQUARE = Travel("euclidean", np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float))
GAP = Travel("manhattan", np.array([(5, 5), (0, 7), (1, 6), (2, 10), (0, 2), (1, 8)], dtype=float))


def robots(travel: Travel, count: int, limit: float) -> RoutingProblem:
    return RoutingProblem(Sites.of(range(len(travel))), travel, (VehicleType(count=count, max_duration=limit),), Makespan())


@pytest.mark.parametrize(
    ("travel", "count", "limit", "routes", "left"),
    [
        (SQUARE, 2, 14.0, [[1, 2], [4, 3]], 0), (SQUARE, 1, 14.0, [[1, 2, 3]], 1), (SQUARE, 1, 18.0, [[1, 2, 3, 4]], 0),
        (GAP, 2, 26.0, [[2, 5, 3], [1, 4]], 0), (GAP, 1, 28.0, [[2, 1, 5, 3]], 1),
    ],
)  # fmt: skip
def test_reference_instances(travel: Travel, count: int, limit: float, routes: list[list[int]], left: int) -> None:
    found = run_heuristic(robots(travel, count, limit), "greedy-assignment", {}, 1)
    assert found.answer == Routes.of(routes).canonical()
    assert found.statistics["left"] == left and found.guarantee is None
    assert bool(left) == ("left that no vehicle" in found.message)


def test_three_robots_on_the_square() -> None:
    problem = robots(SQUARE, 3, 14.0)
    found = run_heuristic(problem, "greedy-assignment", {}, 1)
    lengths = sorted(problem.evaluate(Routes((route,))).quantities["distance"] for route in found.answer)
    assert lengths == [6.0, 8.0, 12.0]


@settings(max_examples=draws(100), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 9), st.booleans(), st.sampled_from(["greedy-assignment", "pure-greedy"]))
def test_what_it_serves_it_serves_within_all_limits(seed: int, n: int, windows: bool, name: str) -> None:
    rng = np.random.default_rng(seed)
    ready = rng.integers(0, 30, n + 2) * windows
    due = np.where(rng.random(n + 2) < 0.5 * windows, ready + rng.integers(0, 30, n + 2), math.inf)
    sites = Sites.of(
        range(n + 2), depot=np.arange(n + 2) < 2, demand=rng.integers(0, 5, n + 2), ready=ready, due=due, service=rng.integers(0, 4, n + 2),
        reward=rng.integers(0, 9, n + 2), required=np.zeros(n + 2, dtype=bool),
    )  # fmt: skip
    fleet = tuple(
        VehicleType(count=int(rng.integers(1, 3)), capacity=float(rng.integers(3, 15)), start=k, end=int(rng.integers(2)),
                    max_duration=float(rng.integers(20, 90)), max_distance=float(rng.integers(20, 90)), name=f"type {k}")
        for k in range(2)
    )  # fmt: skip
    problem = RoutingProblem(sites, Travel("euclidean", rng.integers(0, 20, (n + 2, 2))), fleet, Reward())
    found = run_heuristic(problem, name, {}, seed)
    judged = problem.evaluate(found.answer)
    assert judged.feasible, judged.violations
    assert found.statistics["left"] == n - sum(len(route) for route in found.answer)


def test_pure_greedy_weighs_reward_against_distance() -> None:
    travel = Travel("euclidean", np.array([(0, 0), (10, 0), (-1, 0)], dtype=float))
    sites = Sites.of(range(3), reward=[0, 5, 4], required=False)
    problem = RoutingProblem(sites, travel, (VehicleType(count=1, max_duration=20.0),), Reward())
    run = lambda weight: run_heuristic(problem, "pure-greedy", {"distance_weight": weight}, 1).answer  # noqa: E731
    assert run(0.0) == Routes((Route((1,)),))
    assert run(0.5) == Routes((Route((2,)),))


def test_cut_short_fewer_are_served() -> None:
    problem = robots(Travel("euclidean", np.random.default_rng(1).uniform(0, 9, (50, 2))), 3, math.inf)
    optional = replace(problem, sites=replace(problem.sites, required=np.zeros(50, dtype=bool)))
    found = HEURISTICS["greedy-assignment"].run(optional, context(0.0))
    assert optional.evaluate(found.answer).feasible and found.limit == "time"
