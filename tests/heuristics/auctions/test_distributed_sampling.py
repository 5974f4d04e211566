"""Distributed sampling as a heuristic: initial partitions, starts, and that it never leaves the largest part larger."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from task_problems import best_partition_value, drawn, parts

import waybound as wb
from waybound.formulations.auctions.balanced_partition import BalancedPartition
from waybound.reports.ratios.judging import run_heuristic

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


@pytest.mark.parametrize("options", [{"initial": "random"}, {"most_moves": -1}])
def test_other_options_are_refused(options):
    with pytest.raises(wb.UsageError):
        run_heuristic(parts([0, 1]), DSA, options, 1)
