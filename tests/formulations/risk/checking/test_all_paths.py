"""All paths that could earn more per risk."""

from __future__ import annotations

import math

import numpy as np
import pytest
import risky_cases as cases

from waybound.formulations.evidence import CHECKERS
from waybound.formulations.risk.checking import all_paths as module
from waybound.formulations.risk.risky_path import RiskyPath
from waybound.instances.errors import InputError
from waybound.instances.risk.elements import LocaleRisk

check = CHECKERS["all-paths"]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("discount", [1.0, 0.5, 0.0])
def test_the_optimum_is_proved_and_any_target_proves_something_true(seed, discount):
    rng = np.random.default_rng(seed)
    problem = cases.random_map(rng, muddy=True, rewards=rng.integers(0, 4, 9) + np.eye(9)[8], discount=discount)
    best = cases.best(problem)
    assert check(problem, {"target": None}) == pytest.approx(best) == check(problem, {"target": best})
    assert check(problem, {"target": best / 2}) == pytest.approx(best)
    assert check(problem, {"target": 2 * best}) == pytest.approx(2 * best)


def test_ends_are_goals_where_there_are_any():
    problem = cases.two_ways(goals=(1,), objective="reward-per-risk")
    assert check(problem, {"target": None}) == pytest.approx(10.0)


@pytest.mark.parametrize("discount", [0.0, 1e-10])
@pytest.mark.parametrize("small", [1e-9, 5e-7])
def test_small_rewards_count_beside_large_ones(small, discount):
    arcs = [(0, 1), (1, 2), (2, 3)]
    rewards = np.array([0.0, 1e17, 0.0, small])
    problem = RiskyPath(
        cases.graph(arcs, [LocaleRisk(np.full(4, 0.1))], goals=(3,), rewards=rewards, discount=discount, objective="reward-per-risk")
    )
    (value,) = problem.evaluate((0, 1, 2, 3)).values
    assert value <= check(problem, {"target": 0.0}) <= value * (1.0 + 1e-12)
    assert value <= check(problem, {"target": value / 2}) <= value * (1.0 + 1e-12)


def test_too_many_paths_and_least_risks_prove_nothing(monkeypatch):
    assert check(cases.ring(), {"target": None}) == -math.inf
    monkeypatch.setattr(module, "MOST_PATHS", 2)
    assert check(cases.two_ways(), {"target": None}) == math.inf


@pytest.mark.parametrize("target", ["a", True, float("nan")])
def test_what_is_malformed_is_refused(target):
    with pytest.raises(InputError, match="target must be a number"):
        check(cases.two_ways(), {"target": target})
