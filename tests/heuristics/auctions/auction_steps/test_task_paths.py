"""Answers out of arrays, what is left where an auction was cut short, and rules by name."""

import numpy as np
import pytest
from task_problems import drawn, line

from waybound import RobotTasks, TaskAllocation, UsageError
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.auctions.auction_steps.task_paths import arrays_of, completed, keeps_triangles, paths_of, rule_of
from waybound.heuristics.heuristic import HEURISTICS, Context
from waybound.solvers.linear_programs import LinearPrograms


def test_the_first_stops_of_each_row_are_its_path():
    assert paths_of(np.array([[2, 0, -1], [-1, -1, -1], [1, -1, -1]]), np.array([2, 0, 1])) == ((2, 0), (), (1,))


def test_what_nobody_got_the_first_robot_does_last():
    assert completed(line([0, 1], [1, 2, 3]), ((2,), ())) == ((2, 0, 1), ())


def test_arrays_are_copies():
    problem = line([0], [1, 2])
    starts, _ = arrays_of(problem)
    starts[0, 0] = 9
    assert problem.instance.starts[0, 0] == 1


def test_the_rule_is_by_default_that_of_the_objective():
    assert [rule_of(line([0], [1], f"mini-{rule}"), None) for rule in ("sum", "max", "ave")] == ["sum", "max", "ave"]
    assert rule_of(line([0], [1]), "ave") == "ave"
    with pytest.raises(UsageError, match="bids must be sum, max, ave"):
        rule_of(line([0], [1]), "mini-sum")


@pytest.mark.parametrize("heuristic", ["consensus-bundle", "parallel-auction", "sequential-single-item"])
def test_cut_short_every_task_is_done_all_the_same(heuristic):
    problem = TaskAllocation(drawn(np.random.default_rng(4), tasks=8))
    context = Context(np.random.default_rng(1), 0.0, None, lambda answer: None, Stop(), LinearPrograms())
    found = HEURISTICS[heuristic].run(problem, context)
    assert found.limit == "time" and found.guarantee is None and "cut short" in found.message
    assert problem.evaluate(found.answer).feasible


SQUARE = [[0.0, 1.0, 2.0], [1.0, 0.0, 1.0], [2.0, 1.0, 0.0]]


def test_rules_of_the_plane_need_no_look_and_matrices_do():
    assert keeps_triangles(RobotTasks.of_positions([0], [1, 2], "chebyshev"), Stop(0.0)) == ("distances are chebyshev ones of the plane",)
    assert keeps_triangles(RobotTasks.of_distances([[1, 0, 1]], SQUARE), NEVER) is not None
    assert keeps_triangles(RobotTasks.of_distances([[1, 0, 1]], SQUARE), Stop(0.0)) is None


@pytest.mark.parametrize(
    ("starts", "between"),
    [
        ([1, 0, 1], [[0, 1, 2], [1, 0, 1], [2.1, 1, 0]]),  # one way is longer
        ([1, 0, 1], [[0, 1, 2.1], [1, 0, 1], [2.1, 1, 0]]),  # by a third task it is shorter
        ([3, 1, 1], SQUARE),  # from the robot by a task
        ([0.2, 0.2, 3], SQUARE),  # between tasks by where the robot stands
    ],
)
def test_what_breaks_it_is_found(starts, between):
    assert keeps_triangles(RobotTasks.of_distances([starts], between), NEVER) is None


@pytest.mark.parametrize("scale", [1e-100, 1.0, 1e100])
def test_the_rounding_of_shortest_paths_is_let_pass_in_any_units(scale):
    rng = np.random.default_rng(1)
    made = rng.random((8, 8)) * scale
    made = np.minimum(made, made.T)
    np.fill_diagonal(made, 0)
    for k in range(8):
        made = np.minimum(made, made[:, [k]] + made[k])
    assert keeps_triangles(RobotTasks.of_distances(made[:2, 2:], made[2:, 2:]), NEVER) is not None
    made[2, 3] = made[3, 2] = made[2, 3] * (1 + 1e-6) + 20 * scale
    assert keeps_triangles(RobotTasks.of_distances(made[:2, 2:], made[2:, 2:]), NEVER) is None
