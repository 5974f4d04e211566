import itertools

import numpy as np
import pytest
from task_problems import best_partition_value, drawn, parts

import waybound as wb
from waybound.formulations.auctions.balanced_partition import BalancedPartition
from waybound.formulations.stop import Stop
from waybound.heuristics.auctions.distributed_sampling import single_moves
from waybound.reports.ratios.judged_runs import run_heuristic

DSA = "distributed-sampling"
KINDS = list(itertools.product(("min-max", "min-difference"), ("mst", "clique", "none")))


@pytest.mark.parametrize(("objective", "edges"), KINDS)
def test_it_ends_with_a_partition_no_worse_than_it_began_with(objective, edges):
    rng = np.random.default_rng(1)
    for _ in range(12):
        problem = BalancedPartition(drawn(rng, robots=4, tasks=6), objective, edges)
        for initial in ("nearest", "first"):
            begin = run_heuristic(problem, DSA, {"initial": initial, "most_moves": 0}, 1)
            found = run_heuristic(problem, DSA, {"initial": initial}, 1)
            assert found.statistics["ended"] in ("balanced", "local")
            before, after = (problem.evaluate(answer).values[0] for answer in (begin.answer, found.answer))
            assert best_partition_value(problem) - 1e-9 <= after
            if objective == "min-max" or problem.num_robots == 2:
                assert after <= before + 1e-9


def test_it_begins_with_the_nearest_robot_or_with_a_start():
    problem = wb.BalancedPartition(wb.RobotTasks.of_positions([0, 10], [1, 2, 9]), edges="none")
    assert run_heuristic(problem, DSA, {}, 1).answer == ((0, 1), (2,))
    assert run_heuristic(problem, DSA, {"initial": "first"}, 1).answer == ((0, 1, 2), ())
    assert wb.solve(problem, heuristic=DSA, start=((), (0, 1, 2)), bound_time=0).answer == ((), (0, 1, 2))


ALL_IN_ONE = ((0, 1, 2, 3, 4), ())


def test_additive_weights_are_balanced_in_two_moves():
    problem = parts([0] * 5, weights=[8, 7, 6, 5, 4], edges="none")
    found = single_moves(problem, ALL_IN_ONE, 100)
    assert (found.moves, problem.costs(found.parts), found.ended) == (((0, 0, 1), (1, 0, 1)), [15, 15], "balanced")


def test_cliques_on_a_line():
    problem = parts([0, 1, 2, 6, 7], edges="clique")
    found = single_moves(problem, ALL_IN_ONE, 100, guarded=False)
    assert (found.moves, found.parts, problem.costs(found.parts)) == (((4, 0, 1), (0, 0, 1)), ((1, 2, 3), (0, 4)), [10, 7])
    signed = single_moves(problem, ALL_IN_ONE, 100, signed=True, guarded=False)
    assert signed.ended == "cycle"
    assert {signed.parts} <= {((1, 2), (0, 3, 4)), ((1, 2, 4), (0, 3))}


def test_trees_on_a_line_are_balanced_and_three_times_as_dear():
    problem = parts([0, 1, 2, 6, 7])
    found = single_moves(problem, ALL_IN_ONE, 100, guarded=False)
    assert (found.moves, found.parts, problem.costs(found.parts)) == (((0, 0, 1), (3, 0, 1)), ((1, 2, 4), (0, 3)), [6, 6])
    assert problem.costs(single_moves(problem, ALL_IN_ONE, 100).parts) == [1, 2]  # guarded: no part larger than before


def test_the_pair_test_alone_runs_in_circles_and_a_guarded_descent_does_not():
    places, weights = [(7, 3), (3, 5), (9, 1), (2, 3), (2, 5), (0, 2), (0, 9), (0, 0)], [-9, -4, -3, -8, -2, -7, -2, -7]
    problem = parts(places, 3, edges="clique", metric="chebyshev", weights=weights)
    start = ((0, 1, 2, 5, 7), (), (3, 4, 6))
    assert problem.costs(start) == [24, 0, 0]
    found = single_moves(problem, start, 100, guarded=False)
    assert found.moves == ((2, 0, 1), (0, 0, 1), (4, 2, 1), (0, 1, 0), (4, 1, 2)) and found.ended == "cycle"
    assert single_moves(problem, start, 100).ended == "local"


def test_guarded_descents_end_and_the_costs_come_down():
    rng = np.random.default_rng(1)
    for k in range(40):
        problem = BalancedPartition(drawn(rng, robots=4, tasks=8), "min-max", ("mst", "clique", "none")[k % 3])
        owners = rng.integers(0, problem.num_robots, problem.num_tasks)
        start = tuple(tuple(np.nonzero(owners == r)[0].tolist()) for r in range(problem.num_robots))
        found = single_moves(problem, start, 1000)
        assert found.ended in ("balanced", "local")
        assert problem.evaluate(found.parts).feasible
        before, after = (sorted(problem.costs(p), reverse=True) for p in (start, found.parts))
        assert after <= [cost + 1e-9 for cost in before]


def test_a_limit_cuts_it_short():
    problem = parts([0] * 5, weights=[8, 7, 6, 5, 4], edges="none")
    assert single_moves(problem, ALL_IN_ONE, 1).ended == "moves"
    assert single_moves(problem, ALL_IN_ONE, 9, Stop(0.0)).ended == "time"
