"""Two stages: exact for the last reward, and within what it states for all."""

from __future__ import annotations

import numpy as np
import pytest
import risky_cases as cases

import waybound as wb


@pytest.mark.parametrize("seed", range(4))
def test_where_the_last_reward_alone_counts_it_is_exact(seed):
    rng = np.random.default_rng(seed)
    problem = cases.random_map(rng, rewards=rng.integers(0, 4, 9) + np.eye(9)[8], discount=0.0)
    solution = wb.solve(problem, heuristic="two-stage", bound_time=0)
    assert solution.objective == pytest.approx(cases.best(problem)) and solution.certificate.guarantee.ratio == 1.0


@pytest.mark.parametrize("seed", range(4))
def test_where_all_count_it_keeps_what_it_states(seed):
    rng = np.random.default_rng(seed)
    problem = cases.random_map(rng, rewards=rng.integers(0, 4, 9) + np.eye(9)[8])
    solution = wb.solve(problem, heuristic="two-stage", bound_time=0)
    assert cases.best(problem) <= solution.objective * solution.certificate.guarantee.ratio * (1 + 1e-9)


@pytest.mark.parametrize("given", [{"muddy": True}, {"discount": 0.5}])
def test_no_guarantee_without_its_assumptions(given):
    problem = cases.random_map(np.random.default_rng(0), rewards=np.ones(9), **given)
    assert wb.solve(problem, heuristic="two-stage", bound_time=0).certificate.guarantee is None


def test_goals_are_kept_to():
    problem = cases.two_ways(goals=(1, 2), objective="reward-per-risk")
    solution = wb.solve(problem, heuristic="two-stage", bound_time=0)
    assert solution.answer == (0, 2) and solution.certificate.guarantee is None
