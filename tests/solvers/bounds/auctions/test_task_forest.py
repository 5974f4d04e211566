import math

import numpy as np
import pytest
from task_problems import best_paths_value, drawn, line, parts

from waybound import RobotTasks, TaskAllocation
from waybound.formulations.evidence import CHECKERS
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.linear_programs import LinearPrograms

method, check = BOUNDS["task-forest"], CHECKERS["task-forest"]


@pytest.mark.parametrize("objective", ["mini-sum", "mini-max"])
def test_what_it_finds_is_proved_and_no_worse_than_the_forest(objective):
    rng = np.random.default_rng(12)
    gaps = []
    for k in range(12):
        team = drawn(rng, tasks=5, matrix=k % 2 == 1)
        problem = TaskAllocation(team, objective)
        found = method.compute(problem, NEVER, LinearPrograms())
        proved = check(problem, found.data)
        assert proved == pytest.approx(found.value, rel=1e-9)
        alone = check(problem, {"tasks": [0.0] * team.num_tasks, "robots": [0.0] * team.num_robots})
        best = best_paths_value(team, objective)
        assert alone <= proved * (1 + 1e-12) and proved <= best
        gaps.append(proved / best)
    assert objective == "mini-max" or np.mean(gaps) > 0.9


def test_a_star_is_proved_to_the_optimum():
    star = line([0], [1, -1, 2])
    assert check(star, method.compute(star, NEVER, LinearPrograms()).data) == pytest.approx(4.0, rel=1e-3)


def test_units_do_not_matter_and_nothing_costs_nothing():
    team = drawn(np.random.default_rng(3), tasks=5)
    one, tiny = (
        check(p, method.compute(p, NEVER, LinearPrograms()).data)
        for p in (TaskAllocation(RobotTasks.of_distances(team.starts * s, team.between * s)) for s in (1.0, 2.0**-500))
    )
    assert tiny == pytest.approx(one * 2.0**-500, rel=1e-9)
    assert method.compute(line([0], [0, 0]), NEVER, LinearPrograms()).value == 0.0


def test_cut_short_it_proves_what_it_has():
    stop = Stop(0.0)
    found = method.compute(line([0], [1, -1, 2]), stop, LinearPrograms())
    assert math.isfinite(check(line([0], [1, -1, 2]), found.data))


def test_it_says_for_what_it_proves_nothing():
    assert method.missing(line([0], [1], "mini-ave")) == {"objective:mini-ave"}
    assert method.missing(parts([0, 1])) == {"balanced-partition problems"}
    assert not method.missing(line([0], [1], "mini-max"))
