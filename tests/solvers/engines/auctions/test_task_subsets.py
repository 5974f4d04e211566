"""The engine of best paths through ``solve``: a verified optimum, the sizes that it takes, and limits."""

from __future__ import annotations

import numpy as np
import pytest
from task_problems import drawn, line

import waybound as wb
from waybound.solvers.engines.auctions.task_subset_steps.shares import MOST_TASKS


def test_its_optimum_is_claimed_and_where_bounds_meet_it_verified():
    star = wb.solve(line([0, 10], [4, 6, 1, 9], "mini-max"), bound_time=60.0)
    assert (star.solver, star.status, star.objective) == ("task-subsets", "optimal", 4.0)
    proved = wb.solve(line([0, 10], [1, 9]), bound_time=60.0)
    assert (proved.objective, proved.bound_kind) == (2.0, "verified")


def test_other_solvers_agree():
    problem = wb.TaskAllocation(drawn(np.random.default_rng(1), tasks=4), "mini-ave")
    best = wb.solve(problem, "task-subsets", bound_time=0).objective
    for solver in ("highs", "cpsat", "pulp"):
        found = wb.solve(problem, solver, bound_time=0, time_limit=20)
        assert (found.status, found.objective) == ("optimal", pytest.approx(best, rel=1e-6))


def test_too_many_tasks_are_refused_with_who_can_take_them():
    with pytest.raises(wb.UnsupportedError, match=f"it does not handle more than {MOST_TASKS} tasks; can take it: .*highs"):
        wb.solve(line([0], np.arange(MOST_TASKS + 1)), "task-subsets")


def test_without_time_there_is_no_answer():
    assert wb.solve(line([0, 1], np.arange(MOST_TASKS)), "task-subsets", time_limit=1e-6, bound_time=0).status in ("unknown", "optimal")
