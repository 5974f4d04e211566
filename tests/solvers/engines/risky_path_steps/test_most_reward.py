"""Most reward per risk against enumeration."""

from __future__ import annotations

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.stop import NEVER
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.risky_path_steps.most_reward import most_reward


@pytest.mark.parametrize("discount", [1.0, 0.7, 0.0])
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("goals", [(), (8,)])
def test_the_best_of_all_paths_is_found(seed, discount, goals):
    rng = np.random.default_rng(seed)
    given = {"rewards": rng.integers(0, 4, 9) + np.eye(9)[8], "discount": discount, "objective": "reward-per-risk"}
    problem = cases.random_map(rng, muddy=True, **given)
    if goals:
        from dataclasses import replace

        from waybound.formulations.risk.risky_path import RiskyPath

        problem = RiskyPath(replace(problem.graph, goals=goals))
    result = most_reward(problem, NEVER, Options(), Control())
    assert result.status == "optimal" and result.limit == "none"
    assert problem.evaluate(result.answer).values[0] == pytest.approx(cases.best(problem)) == pytest.approx(result.bound)


def test_a_limit_leaves_the_best_so_far_and_a_bound():
    problem = cases.random_map(np.random.default_rng(1), rewards=1.0 - np.eye(9)[0])
    result = most_reward(problem, NEVER, Options(iterations=3), Control())
    assert (result.status, result.limit) == ("feasible", "iterations")
    assert result.objective <= cases.best(problem) <= result.bound * (1 + 1e-9)


def test_a_start_is_never_made_worse():
    problem = cases.two_ways()
    assert most_reward(problem, NEVER, Options(iterations=1, start=(0, 2, 3)), Control()).answer == (0, 2, 3)
