import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import example, given, settings, strategies as st
from small_routing import context
from truth.routing import best_values

from waybound import Reward, RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.reports.ratios.judged_runs import run_heuristic


def tours(seed: int, n: int, windows: bool, fleet: int, *, ends: bool = False) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    depots = 1 + ends
    size = n + depots
    ready = rng.integers(0, 30, size) * windows * (np.arange(size) >= depots)
    due = np.where(rng.random(size) < 0.6 * windows, ready + rng.integers(5, 60, size), math.inf)
    sites = Sites.of(
        range(size), depot=np.arange(size) < depots, reward=rng.integers(0, 9, size), required=np.zeros(size, dtype=bool), ready=ready,
        due=due, service=rng.integers(0, 3, size),
    )  # fmt: skip
    limits = {"max_duration": float(rng.integers(20, 80))} if seed % 2 else {"max_distance": float(rng.integers(20, 80))}
    vehicle = VehicleType(count=fleet, end=depots - 1, **limits)
    return RoutingProblem(sites, Travel("euclidean", rng.integers(0, 20, (size, 2))), (vehicle,), Reward())


@pytest.mark.slow
@settings(max_examples=draws(120), deadline=None)
@example(555, 1, True, 1, True)  # which must set out before the first site opens, and waits there for longer than it may be under way
@given(st.integers(0, 10**6), st.integers(1, 6), st.booleans(), st.integers(1, 3), st.booleans())
def test_answers_keep_all_limits_and_are_no_better_than_the_optimum(seed: int, n: int, windows: bool, fleet: int, ends: bool) -> None:
    problem = tours(seed, n, windows, fleet, ends=ends)
    best = best_values(problem)
    values = {}
    for by in ("reward", "density", None):
        found = run_heuristic(problem, "greedy-orienteering", {"by": by}, seed)
        judged = problem.evaluate(found.answer)
        assert judged.feasible, judged.violations
        values[by] = judged.values[0]
        assert found.guarantee is None and best is not None and judged.values[0] <= best[0] + 1e-9
    assert values[None] == max(values.values())
    single = [
        problem.evaluate(run_heuristic(replace(problem, fleet=problem.fleet), "greedy-orienteering", {"by": "reward"}, 1).answer).values[0]
    ]
    assert single[0] == values["reward"]


def test_density_prefers_what_lies_near() -> None:
    travel = Travel("euclidean", np.array([(0, 0), (10, 0), (-1, 0), (-2, 0), (-3, 0)], dtype=float))
    sites = Sites.of(range(5), reward=[0, 5, 4, 4, 4], required=False)
    problem = RoutingProblem(sites, travel, (VehicleType(count=1, max_distance=20.0),), Reward())
    reward = lambda by: problem.evaluate(run_heuristic(problem, "greedy-orienteering", {"by": by}, 1).answer).values[0]  # noqa: E731
    assert (reward("reward"), reward("density"), reward(None)) == (5.0, 12.0, 12.0)


def test_whoever_must_be_visited_comes_first() -> None:
    travel = Travel("euclidean", np.array([(0, 0), (10, 0), (-10, 0)], dtype=float))
    sites = Sites.of(range(3), reward=[0, 9, 0], required=[False, False, True])
    problem = RoutingProblem(sites, travel, (VehicleType(count=1, max_distance=20.0),), Reward())
    assert problem.evaluate(run_heuristic(problem, "greedy-orienteering", {}, 1).answer).feasible


def test_cut_short_fewer_are_visited() -> None:
    problem = tours(1, 60, False, 2)
    found = HEURISTICS["greedy-orienteering"].run(problem, context(0.0))
    assert problem.evaluate(found.answer).feasible and found.limit == "time"
