import numpy as np
import pytest
from draws import draws
from file_cases import check_refused
from task_problems import OBJECTIVES, drawn, line

import waybound as wb
from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.formulations.stop import NEVER
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.solvers.engines.auctions.task_subsets import best_paths

SSI = "sequential-single-item"


@pytest.mark.parametrize("paths", ["insertion", "optimal"])
def test_robots_that_are_drawn_away(paths):
    problem = line([2, 5], [0, 3, 4])
    found = run_heuristic(problem, SSI, {"paths": paths}, 1)
    assert (problem.value(found.answer), best_paths(problem, NEVER)[1]) == (6, 4)
    longest = line([1, 6], [0, 3, 10], "mini-max")
    found = run_heuristic(longest, SSI, {"paths": paths}, 1)
    assert (longest.value(found.answer), best_paths(longest, NEVER)[1]) == (10, 4)
    assert found.guarantee is None


@pytest.mark.parametrize("paths", ["insertion", "optimal"])
def test_five_targets_in_the_plane_stay_below_two(paths):
    rng = np.random.default_rng(1)
    worst = 1.0
    for _ in range(draws(400)):
        problem = TaskAllocation(wb.RobotTasks.of_positions(rng.random((2, 2)), rng.random((5, 2))))
        found = run_heuristic(problem, SSI, {"paths": paths}, 1)
        assert found.guarantee.ratio == 2.0
        worst = max(worst, problem.value(found.answer) / best_paths(problem, NEVER)[1])
    assert 1.05 < worst < 1.6


def test_nothing_is_guaranteed_without_the_triangle_inequality_or_for_other_bids():
    detour = TaskAllocation(wb.RobotTasks.of_distances([[1, 9]], [[0, 1], [1, 0]]))
    one_way = TaskAllocation(wb.RobotTasks.of_distances([[1, 2]], [[0, 1], [1.5, 0]]))
    for problem in (detour, one_way):
        assert run_heuristic(problem, SSI, {}, 1).guarantee is None
    assert run_heuristic(line([0], [1]), SSI, {"bids": "max"}, 1).guarantee is None
    metric = TaskAllocation(wb.RobotTasks.of_distances([[1, 2]], [[0, 1], [1, 0]]))
    held = ("distances between tasks are symmetric", "the triangle inequality holds")
    assert run_heuristic(metric, SSI, {}, 1).guarantee.assumptions == held


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_every_round_awards_one_task(objective):
    rng = np.random.default_rng(2)
    for k in range(20):
        problem = TaskAllocation(drawn(rng, robots=4, tasks=8, matrix=k % 2 == 1), objective)
        for options in ({}, {"paths": "optimal"}, {"bids": "ave"}):
            found = run_heuristic(problem, SSI, options, 1)
            assert problem.evaluate(found.answer).feasible
            assert found.statistics == {"rounds": problem.num_tasks, "bids": problem.num_tasks * problem.num_robots}


def test_best_paths_are_beyond_nine_tasks_continued_by_insertion():
    rng = np.random.default_rng(3)
    problem = TaskAllocation(wb.RobotTasks.of_positions(rng.random((1, 2)), rng.random((12, 2))))
    found = run_heuristic(problem, SSI, {"paths": "optimal"}, 1)
    assert problem.evaluate(found.answer).feasible
    assert problem.value(found.answer) <= 2 * best_paths(problem, NEVER)[1]


def test_other_bids_and_paths_are_refused():
    check_refused(wb.UsageError, "bids must be sum, max, ave, not 'least'", wb.solve, line([0], [1]), heuristic=SSI, bids="least")
    check_refused(wb.UsageError, "paths must be insertion or optimal", wb.solve, line([0], [1]), heuristic=SSI, paths="best")
