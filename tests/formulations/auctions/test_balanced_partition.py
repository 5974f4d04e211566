import numpy as np
import pytest
from task_problems import drawn, parts
from truth.auctions import PartTruth

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.instances.errors import InputError, UsageError

LINE = [0, 1, 2, 6, 7]


@pytest.mark.parametrize("edges", ["mst", "clique", "none"])
def test_costs_are_those_of_plain_sums(edges):
    rng = np.random.default_rng(2)
    for _ in range(20):
        problem = wb.BalancedPartition(drawn(rng, tasks=6), "min-max", edges)
        part = np.nonzero(rng.random(problem.num_tasks) < 0.6)[0].tolist()
        assert problem.costs((tuple(part),)) == pytest.approx([float(PartTruth(problem).cost(part))], abs=1e-14)


def test_balance_is_not_a_small_load():
    tree, even = ((0, 1, 2), (3, 4)), ((1, 2, 4), (0, 3))
    assert parts(LINE).costs(tree) == [2, 1] and parts(LINE).costs(even) == [6, 6]
    assert (parts(LINE).evaluate(tree).values, parts(LINE).evaluate(even).values) == ((2,), (6,))
    spread = parts(LINE, objective="min-difference")
    assert (spread.evaluate(tree).values, spread.evaluate(even).values) == ((1,), (0,))
    assert parts(LINE, edges="clique").costs(tree) == [4, 1]


def test_an_empty_part_costs_nothing_and_weights_may_be_negative():
    problem = parts([0, 1, 5], 3, weights=[-4, 1, 1])
    assert problem.costs(((0, 1), (2,), ())) == [-2, 1, 0]
    assert problem.evaluate(((0, 1), (2,), ())).quantities == {"largest_part": 1, "smallest_part": -2, "all_parts": -1}


def test_a_frame_has_a_row_a_task():
    frame = parts(LINE, weights=[1, 0, 0, 0, 2]).answer_to_frame(((0, 1, 2), (3, 4)))
    assert frame["robot"].tolist() == ["1", "1", "1", "2", "2"] and frame["weight"].tolist() == [1, 0, 0, 0, 2]
    assert frame["part_cost"].tolist() == [3, 3, 3, 3, 3]


def test_distances_that_depend_on_the_direction_are_refused_where_they_count():
    team = wb.RobotTasks.of_distances([[1, 2]], [[0, 3], [4, 0]])
    with pytest.raises(InputError, match="must not depend on the direction; found they do between 1 and 2"):
        wb.BalancedPartition(team)
    assert wb.BalancedPartition(team, edges="none").costs(((0, 1),)) == [0]


def test_settings_are_those_of_the_problem():
    team = wb.RobotTasks.of_positions([0], [1, 2], problem="balanced-partition")
    made = problem_from_instance(team, objective="min-difference", edges="clique")
    assert made.features() == {"objective:min-difference", "edges:clique"}
    with pytest.raises(UsageError, match="edges must be one of mst, clique, none"):
        problem_from_instance(team, edges="tour")
    assert parts(LINE).digest() != parts(LINE, edges="clique").digest()
