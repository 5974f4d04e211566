import numpy as np
import pytest
from task_problems import line

import waybound as wb
from waybound.formulations.stop import NEVER
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.solvers.engines.auctions.task_subsets import best_paths

FIXED = "fixed-order-auction"


def test_the_example_of_two_robots():
    problem = line([0, 10], [4, 6, 1, 9])
    found = run_heuristic(problem, FIXED, {}, 1)
    assert found.answer == ((0, 2), (1, 3))  # plans 4, 1 and 6, 9
    assert (problem.value(found.answer), best_paths(problem, NEVER)[1]) == (14, 7)
    longest = line([0, 10], [4, 6, 1, 9], "mini-max")
    assert (longest.value(found.answer), best_paths(longest, NEVER)[1]) == (7, 4)
    assert found.guarantee is None


@pytest.mark.parametrize("tasks", [1, 2, 4, 8])
def test_a_zigzag_is_as_many_times_the_optimum_as_there_are_tasks(tasks):
    problem = line([0], [10.0 * (k % 2 == 0) for k in range(tasks)])
    found = run_heuristic(problem, FIXED, {}, 1)
    assert problem.value(found.answer) == 10.0 * tasks == tasks * best_paths(problem, NEVER)[1]
    assert found.guarantee.ratio == tasks


def test_no_constant_ratio_holds_for_two_robots_either():
    worst = []
    for pairs in (1, 2, 4, 7):  # both robots zigzag, far from each other
        ends = [place for _ in range(pairs) for place in (10.0, 1000.0 - 10.0, 0.0, 1000.0)]
        problem = line([0.0, 1000.0], ends[:14])
        found = run_heuristic(problem, FIXED, {}, 1)
        worst.append(problem.value(found.answer) / best_paths(problem, NEVER)[1])
        assert found.guarantee is None
    assert worst == sorted(worst) and worst[-1] >= 7.0


def test_one_robot_stays_within_its_number_of_tasks():
    rng = np.random.default_rng(1)
    for _ in range(60):
        problem = line(rng.random(1), rng.random(int(rng.integers(1, 7))))
        found = run_heuristic(problem, FIXED, {"order": rng.permutation(problem.num_tasks).tolist()}, 1)
        assert problem.value(found.answer) <= found.guarantee.ratio * best_paths(problem, NEVER)[1] * (1 + 1e-12)
    assert run_heuristic(line([0], [1, 2], "mini-ave"), FIXED, {}, 1).guarantee is None


def test_orders_are_numbers_or_names():
    named = wb.TaskAllocation(wb.RobotTasks.of_positions([0], [1, 2, 3], task_names=("a", "b", "c")))
    for order in ("c, a, b", ["c", "a", "b"], [2, 0, 1]):
        assert run_heuristic(named, FIXED, {"order": order}, 1).answer == ((2, 0, 1),)
    for wrong in ("a,b", [0, 0, 1], 5, ["a", "b", "z"]):
        with pytest.raises(wb.UsageError):
            run_heuristic(named, FIXED, {"order": wrong}, 1)
