"""The checker of shortest ways: what it derives holds for every answer, whatever the evidence, in any units."""

from __future__ import annotations

import numpy as np
import pytest
from task_problems import OBJECTIVES, best_paths_value, drawn, line, parts

from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.formulations.evidence import CHECKERS
from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.instances.errors import InputError

check = CHECKERS["shortest-ways"]


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("scale", [2.0**-60, 1.0, 2.0**60])
def test_it_passes_no_optimum(objective, scale):
    rng = np.random.default_rng(6)
    for k in range(40):
        team = drawn(rng, tasks=4, matrix=k % 2 == 1)
        problem = TaskAllocation(RobotTasks.of_distances(team.starts * scale, team.between * scale), objective)
        assert 0.0 <= check(problem, {}) <= best_paths_value(team, objective) * scale


def test_it_is_the_farthest_task_or_the_mean_way():
    assert check(line([0], [3, -4], "mini-max"), {}) == pytest.approx(4.0, rel=1e-12)
    assert check(line([0, 10], [1, 9], "mini-ave"), {}) == pytest.approx(1.0, rel=1e-12)
    crowd = line([0], [5, 5.5, 6, 6.5], "mini-ave")  # legs of 5, 0.5, 0.5, 0.5 count 1, 2, 3, 4 times at the least; ways are longer
    assert check(crowd, {}) == pytest.approx(23 / 4, rel=1e-12)


def test_a_detour_may_be_shorter_than_the_direct_way():
    detour = TaskAllocation(RobotTasks.of_distances([[1, 9]], [[0, 1], [1, 0]]), "mini-max")
    assert check(detour, {}) == pytest.approx(2.0, rel=1e-12)


def test_other_families_are_refused():
    with pytest.raises(InputError, match="evidence for task-allocation problems"):
        check(parts([0, 1]), {})
