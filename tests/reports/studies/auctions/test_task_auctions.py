import numpy as np
import pytest
from task_problems import best_paths_value

from waybound.formulations.stop import NEVER
from waybound.heuristics.auctions.auction_steps.task_paths import keeps_triangles
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.reports.studies.auctions import task_auctions as families


@pytest.mark.parametrize("family", [*families.random_families(), *families.random_families(1)], ids=lambda family: family.name)
def test_random_cases_are_metric_and_their_optima_hold(family):
    for k in range(3):
        case = family.case(k, 1)
        assert keeps_triangles(case.problem.instance, NEVER) is not None
        assert case.optimum.value == pytest.approx(best_paths_value(case.problem.instance, "mini-sum"), rel=1e-12)


def test_optima_of_other_objectives_hold_too():
    for objective in ("mini-max", "mini-ave"):
        case = families.placed([0, 10], [4, 6, 1], "both", objective)
        assert case.optimum.value == pytest.approx(best_paths_value(case.problem.instance, objective))


def test_traps_do_what_they_are_made_for():
    ratios = {}
    for k in range(families.TRAPS.size):
        case = families.TRAPS.case(k, 1)
        found = run_heuristic(case.problem, "parallel-auction", {}, 1)
        ratios[case.problem.name] = case.problem.value(found.answer) / case.optimum.value
    assert ratios["around-4"] > 3.8
    assert families.greedy_line().optimum.value == 4.0
    zigzag = families.zigzag(5)
    assert zigzag.problem.value((tuple(range(5)),)) == 5 * zigzag.optimum.value == 50
    assert np.isfinite(zigzag.optimum.value)
