"""Exact partitions against the enumeration of all of them, and what a limit leaves."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from draws import draws
from task_problems import best_partition_value, drawn, parts

import waybound as wb
from waybound.formulations.auctions.balanced_partition import BalancedPartition
from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.auctions.part_subsets import MOST_TASKS, PartSubsets

KINDS = list(itertools.product(("min-max", "min-difference"), ("mst", "clique", "none")))


@pytest.mark.parametrize(("objective", "edges"), KINDS)
def test_it_finds_the_best_of_all_partitions(objective, edges):
    rng = np.random.default_rng(14)
    for _ in range(draws(40)):
        problem = BalancedPartition(drawn(rng, robots=4, tasks=5), objective, edges)
        found = PartSubsets().run(problem, Options(), Control())
        verdict = problem.evaluate(found.answer)
        assert verdict.feasible and found.status == "optimal"
        assert verdict.values[0] == pytest.approx(found.objective, abs=1e-12)
        assert found.objective == pytest.approx(best_partition_value(problem), abs=1e-12)


def test_the_two_objectives_have_different_optima():
    line = [0, 1, 2, 6, 7]
    best = {(o, e): wb.solve(parts(line, objective=o, edges=e), bound_time=0).objective for o, e in KINDS if e != "none"}
    assert best == {("min-max", "mst"): 2, ("min-max", "clique"): 4, ("min-difference", "mst"): 0, ("min-difference", "clique"): 3}


def test_weights_alone_are_halved():
    """8, 7, 6, 5, 4: two parts of 15."""
    problem = parts([0] * 5, weights=[8, 7, 6, 5, 4], edges="none", objective="min-difference")
    assert wb.solve(problem, bound_time=0).objective == 0.0


def test_sixteen_tasks_are_not_many():
    rng = np.random.default_rng(15)
    for objective in ("min-max", "min-difference"):
        problem = parts(rng.random((MOST_TASKS, 2)), 4, objective, weights=rng.random(MOST_TASKS))
        assert PartSubsets().run(problem, Options(time_limit=20.0), Control()).status == "optimal"
    with pytest.raises(wb.UnsupportedError, match=f"more than {MOST_TASKS} tasks"):
        wb.solve(parts(np.zeros(MOST_TASKS + 1)), "part-subsets")


def test_a_limit_leaves_an_answer_or_none():
    rng = np.random.default_rng(16)
    problem = parts(rng.random((MOST_TASKS, 2)), 5, "min-difference", weights=rng.random(MOST_TASKS))
    found = PartSubsets().run(problem, Options(time_limit=0.0), Control())
    assert found.limit == "time" and found.status in ("feasible", "unknown")


@pytest.mark.parametrize(
    ("weights", "objective", "status"),
    [
        ((0.1, 0.2, 0.3, 0.4), "min-difference", "feasible"), ((1.0, 2.0, 3.0, 4.0), "min-difference", "optimal"),
        ((0.1, 0.2, 0.3, 0.4), "min-max", "optimal"),
    ],
)  # fmt: skip
def test_a_least_spread_that_rounding_may_hide_is_not_claimed(weights, objective, status):
    between = 1e12 * (1.0 - np.eye(4))
    problem = BalancedPartition(RobotTasks.of_distances(np.zeros((4, 4)), between, weights=weights), objective, "clique")
    found = PartSubsets().run(problem, Options(), Control())
    assert found.status == status and found.objective == problem.evaluate(found.answer).values[0]
