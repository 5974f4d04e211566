"""Problems whose good answer is planted among decoys that greed prefers."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.reports.ratios.judging import run_heuristic
from waybound.reports.ratios.optimum import optimum
from waybound.reports.ratios.studies.sata.families import planted


def test_planted_answers_beat_greedy():
    for family, name in ((planted.planted_covers("cardinality"), "greedy"), (planted.planted_assignments(), "sequential-greedy")):
        ratios = []
        for k in range(60):
            case = family.case(k, 1)
            found = case.problem.evaluate(run_heuristic(case.problem, name, {}, 1).answer).values[0]
            ratios.append(case.solved().value / found)
        assert np.mean(ratios) > 1.03
        assert max(ratios) > 1.15


@pytest.mark.parametrize("constraint", ["cardinality", "partition", "knapsack"])
def test_the_planted_sets_cover_everything_and_are_allowed(constraint):
    for seed in range(20):
        problem = planted.planted_cover(np.random.default_rng(seed), 4, "planted", constraint)
        everything = problem.value(range(problem.num_elements))
        assert problem.num_elements == 8
        assert optimum(problem).value == pytest.approx(everything)


def test_each_robot_alone_can_keep_what_is_its_own():
    for seed in range(20):
        problem = planted.planted_assignment(np.random.default_rng(seed), 3, "planted")
        g = problem.graph
        own = problem.value(range(0, g.num_actions, 2))
        assert g.num_robots == 3 and not len(g.unseen_targets)
        assert optimum(problem).value >= own - 1e-9
