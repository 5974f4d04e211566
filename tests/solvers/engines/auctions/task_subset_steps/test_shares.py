"""The dynamic program over sets of tasks against the enumeration of all paths."""

from __future__ import annotations

import numpy as np
import pytest
from draws import draws
from task_problems import OBJECTIVES, best_paths_value, drawn, line

from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.engines.auctions.task_subset_steps.shares import MOST_TASKS, best_paths


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_it_finds_the_best_of_all_paths(objective):
    rng = np.random.default_rng(13)
    for k in range(draws(60)):
        team = drawn(rng, tasks=5, matrix=k % 2 == 1)
        problem = TaskAllocation(team, objective)
        paths, value = best_paths(problem, NEVER)
        verdict = problem.evaluate(paths)
        assert verdict.feasible
        assert verdict.values[0] == pytest.approx(value, rel=1e-13)
        assert value == pytest.approx(best_paths_value(team, objective), rel=1e-13)


@pytest.mark.parametrize(
    ("robots", "tasks", "best"),
    [([0, 10], [4, 6, 1, 9], (7, 4)), ([2, 5], [0, 3, 4], (4, 2)), ([1, 6], [0, 3, 10], (8, 4)), ([0], [10, 0, 10, 0], (10, 10))],
)
def test_optima_by_hand(robots, tasks, best):
    assert tuple(best_paths(line(robots, tasks, o), NEVER)[1] for o in ("mini-sum", "mini-max")) == best


def test_cut_short_it_has_no_answer():
    many = line([0, 1], np.arange(MOST_TASKS))
    assert best_paths(many, Stop(0.0)) is None
