import math
from statistics import NormalDist

import pytest
from uncertain_graphs import all_paths

from waybound.reports.ratios.judged_runs import judge, run_heuristic
from waybound.reports.studies.risk.families import uncertain_graphs as families
from waybound.reports.studies.study import STUDIES, StudySetting


@pytest.mark.parametrize("risk", [0.5, 0.05])
@pytest.mark.parametrize("family", [families.graphs, families.gambles, families.long_ways], ids=lambda family: family.__name__)
def test_optima_are_those_of_all_paths(family, risk):
    for k in range(3):
        case = family(risk).case(k, seed=5)
        best = min(case.problem.value(*moments) for moments in all_paths(case.problem.graph).values())
        assert case.solved().value == pytest.approx(best)


@pytest.mark.parametrize("risk", [0.5, 0.05, 1e-6])
def test_non_dominated_paths_have_the_optimum_of_all_paths(risk):
    for k in range(3):
        problem = families.graphs(risk, whole=True).case(k, seed=6).problem
        assert families.from_non_dominated(problem).solved().value == pytest.approx(families.enumerated(problem).solved().value)


def test_roadmaps_repeat_and_are_small():
    first, again = (families.roadmaps(0.05).case(2, seed=3) for _ in range(2))
    assert first.problem.digest() == again.problem.digest() and first.solved() == again.solved()
    assert first.problem.graph.num_vertices == families.VERTICES


def test_gambles_cost_the_least_mean_any_ratio_below_one_half_and_nothing_at_it():
    """Three stages of variance 100: 3 + z sqrt(300) against 3.03."""
    even, below = (families.gambles(risk).case(5, seed=1) for risk in (0.5, 0.05))
    runs = [judge(case.problem, case.solved(), run_heuristic(case.problem, "least-mean", {}, 1)) for case in (even, below)]
    assert runs[0].ratio == pytest.approx(1.0) and runs[0].stated == 1.0
    assert runs[1].ratio == pytest.approx((3.0 + NormalDist().inv_cdf(0.95) * math.sqrt(300.0)) / 3.03) and runs[1].stated is None


def test_nothing_is_stated_below_one_half():
    report = STUDIES["uncertain-paths"](StudySetting(7, seed=4))
    assert report.num_faults == 0
    assert {row["heuristic"] for row in report.rows} == {"least mean", "rags"}
    assert all(row["stated_min"] is None for row in report.rows)
    assert max(row["max_ratio"] for row in report.rows) > 1.5
