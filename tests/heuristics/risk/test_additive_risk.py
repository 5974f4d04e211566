import itertools

import numpy as np
import pytest
import risky_cases as cases

import waybound as wb
from waybound.formulations.risk.risky_path import RiskyPath
from waybound.instances.risk.elements import LocaleRisk


def test_the_least_sum_of_all_paths():
    for seed in range(3):
        problem = cases.random_map(np.random.default_rng(seed), muddy=True)
        risk = problem.graph.elements[0].risk
        solution = wb.solve(problem, heuristic="additive-risk", bound_time=0)
        least = min(sum(risk[list(path[1:])]) for path in cases.all_paths(problem) if path[-1] == 8)
        assert sum(risk[list(solution.answer[1:])]) == pytest.approx(least) and solution.certificate.guarantee is None
        assert solution.objective >= cases.best(problem) - 1e-12


def test_normalised_elements_weigh_the_same():
    elements = [LocaleRisk([0, 0.001, 0, 0], "small"), LocaleRisk([0, 0, 0.5, 0], "large")]
    problem = RiskyPath(cases.graph([(0, 1), (0, 2), (1, 3), (2, 3)], elements, goals=(3,)))
    assert wb.solve(problem, heuristic="additive-risk").answer == (0, 1, 3)
    halves = wb.solve(problem, heuristic="additive-risk", normalised=True)
    assert halves.statistics["sum"] == pytest.approx(0.5)


def test_equal_sums_take_the_fewest_moves_and_no_way_is_told():
    free = [LocaleRisk(np.zeros(4))]
    problem = RiskyPath(cases.graph([*itertools.pairwise(range(4)), (0, 3)], free, goals=(3,)))
    assert wb.solve(problem, heuristic="additive-risk").answer == (0, 3)
    apart = RiskyPath(cases.graph([(0, 1)], free, states=4, goals=(3,)))
    assert wb.solve(apart, heuristic="additive-risk").status == "infeasible"
