import numpy as np
import pytest
import risky_cases as cases

import waybound as wb
from waybound.formulations.risk.risky_path import RiskyPath
from waybound.formulations.stop import NEVER, Stopped
from waybound.heuristics.heuristic import Context
from waybound.heuristics.risk import two_stage
from waybound.instances.risk.elements import LocaleRisk
from waybound.solvers.linear_programs import LinearPrograms


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


@pytest.mark.parametrize(("start", "answer"), [(0.1, (0,)), (0.0, None)])
def test_cut_short_it_has_the_start_alone_where_that_is_an_answer(monkeypatch, start, answer):
    def stopped(*_):
        raise Stopped

    monkeypatch.setattr(two_stage, "least_risky_paths", stopped)
    graph = cases.graph([(0, 1), (1, 2)], [LocaleRisk([start, 0.1, 0.1])], rewards=[0, 1, 1])
    context = Context(np.random.default_rng(1), 1.0, None, lambda path: None, NEVER, LinearPrograms())
    assert two_stage.run(RiskyPath(graph), context).answer == answer
