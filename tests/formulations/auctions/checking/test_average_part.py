"""The checker of average parts: it passes no optimum, in any units, with weights of any sign."""

from __future__ import annotations

import numpy as np
import pytest
from task_problems import best_partition_value, drawn, line, parts

from waybound.formulations.auctions.balanced_partition import BalancedPartition
from waybound.formulations.evidence import CHECKERS
from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.instances.errors import InputError

check = CHECKERS["average-part"]


@pytest.mark.parametrize("edges", ["mst", "clique", "none"])
@pytest.mark.parametrize("scale", [2.0**-60, 1.0, 2.0**60])
def test_it_passes_no_optimum(edges, scale):
    rng = np.random.default_rng(7)
    for _ in range(25):
        team = drawn(rng, tasks=5)
        scaled = RobotTasks.of_distances(team.starts * scale, team.between * scale, weights=team.weights * scale)
        for objective in ("min-max", "min-difference"):
            best = best_partition_value(BalancedPartition(team, objective, edges)) * scale
            assert check(BalancedPartition(scaled, objective, edges), {}) <= best


def test_it_is_the_mean_of_what_all_parts_must_cost():
    assert check(parts([0, 1, 2, 6, 7]), {}) == pytest.approx(1.5, rel=1e-12)  # the tree of 7 without its edge of 4
    assert check(parts([0, 1, 2, 6, 7], edges="clique"), {}) == pytest.approx(2.5, rel=1e-12)  # four pairs: 1, 1, 1 and 2
    assert check(parts([0, 0], weights=[8, 1], edges="none"), {}) == pytest.approx(8.0, rel=1e-12)  # the heaviest alone
    assert check(parts([0, 0], weights=[8, 1], objective="min-difference"), {}) == 0.0


def test_other_families_are_refused():
    with pytest.raises(InputError, match="evidence for balanced-partition problems"):
        check(line([0], [1]), {})
