import numpy as np
import pytest
from coded import coded
from task_problems import OBJECTIVES, best_paths_value, drawn, line, parts

from waybound import InputError, RobotTasks, TaskAllocation
from waybound.formulations.evidence import CHECKERS

forest, ways = CHECKERS["task-forest"], CHECKERS["shortest-ways"]


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("scale", [2.0**-60, 1.0, 2.0**60])
def test_no_prices_pass_the_optimum(objective, scale):
    rng = np.random.default_rng(5)
    for k in range(25):
        team = drawn(rng, tasks=4, matrix=k % 2 == 1)
        best = best_paths_value(team, objective) * scale
        problem = TaskAllocation(RobotTasks.of_distances(team.starts * scale, team.between * scale), objective)
        for size in (0.0, 0.1, 0.5, 3.0, -1.0):
            data = {
                key: (scale * size * rng.random(count)).tolist() for key, count in (("tasks", team.num_tasks), ("robots", team.num_robots))
            }
            assert 0.0 <= forest(problem, data) <= best


def test_without_prices_it_is_the_smallest_forest_and_prices_may_prove_the_optimum():
    free = {"tasks": [0.0] * 3, "robots": [0.0]}
    star = line([0], [1, -1, 2])  # the forest takes 1 + 1 + 1, the best path 1 + 2 + 3
    assert forest(star, free) == pytest.approx(3.0, rel=1e-12)
    assert forest(star, {"tasks": [0.0] * 3, "robots": [1.0]}) == pytest.approx(4.0, rel=1e-12)
    assert forest(line([0, 10], [1, 9], "mini-max"), {"tasks": [0, 0], "robots": [0, 0]}) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({}, "lacks the list 'tasks'"),
        ({"tasks": [0.0], "robots": [0.0]}, "'tasks' has the wrong length; expected 2"),
        ({"tasks": [0.0, np.inf], "robots": [0.0]}, "finite"),
        ({"tasks": [0.0, "a"], "robots": [0.0]}, "numbers"),
    ],
)
def test_evidence_of_another_shape_is_refused(data, message):
    with pytest.raises(InputError, match=message):
        forest(line([0], [1, 2]), data)
    for check in (forest, ways):
        with pytest.raises(InputError, check=coded("foreign")):
            check(parts([0, 1]), data)


def test_prices_beyond_all_numbers_prove_nothing():
    assert forest(line([0], [1, 2]), {"tasks": [1e308, 1e308], "robots": [1e308]}) == 0.0


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("scale", [2.0**-60, 1.0, 2.0**60])
def test_it_passes_no_optimum(objective, scale):
    rng = np.random.default_rng(6)
    for k in range(40):
        team = drawn(rng, tasks=4, matrix=k % 2 == 1)
        problem = TaskAllocation(RobotTasks.of_distances(team.starts * scale, team.between * scale), objective)
        assert 0.0 <= ways(problem, {}) <= best_paths_value(team, objective) * scale


def test_it_is_the_farthest_task_or_the_mean_way():
    assert ways(line([0], [3, -4], "mini-max"), {}) == pytest.approx(4.0, rel=1e-12)
    assert ways(line([0, 10], [1, 9], "mini-ave"), {}) == pytest.approx(1.0, rel=1e-12)
    crowd = line([0], [5, 5.5, 6, 6.5], "mini-ave")  # legs of 5, 0.5, 0.5, 0.5 count 1, 2, 3, 4 times at the least; ways are longer
    assert ways(crowd, {}) == pytest.approx(23 / 4, rel=1e-12)


def test_a_detour_may_be_shorter_than_the_direct_way():
    detour = TaskAllocation(RobotTasks.of_distances([[1, 9]], [[0, 1], [1, 0]]), "mini-max")
    assert ways(detour, {}) == pytest.approx(2.0, rel=1e-12)
