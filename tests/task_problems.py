"""Small problems of robots and tasks, and their optima by enumeration."""

import itertools
from typing import Any

import numpy as np
from truth.auctions import PartTruth, TaskTruth

from waybound import BalancedPartition, RobotTasks, TaskAllocation

OBJECTIVES = ("mini-sum", "mini-max", "mini-ave")


def line(robots: Any, tasks: Any, objective: str = "mini-sum") -> TaskAllocation:
    return TaskAllocation(RobotTasks.of_positions(robots, tasks), objective)


def parts(tasks: Any, robots: int = 2, objective: str = "min-max", edges: str = "mst", **given: Any) -> BalancedPartition:
    return BalancedPartition(RobotTasks.of_positions(np.zeros((robots, 2)), tasks, **given), objective, edges)


def drawn(rng: np.random.Generator, robots: int = 3, tasks: int = 5, *, matrix: bool = False) -> RobotTasks:
    """Up to so many robots and tasks; with ``matrix`` any distances, which may keep no triangle inequality."""
    n, m = int(rng.integers(1, robots + 1)), int(rng.integers(1, tasks + 1))
    weights = rng.normal(0.3, 0.5, m)
    if matrix:
        return RobotTasks.of_distances(rng.random((n, m)), rng.random((m, m)), weights=weights)
    return RobotTasks.of_positions(rng.random((n, 2)), rng.random((m, 2)), weights=weights)


def all_paths(robots: int, tasks: int) -> Any:
    """Every way to do all tasks."""
    for order in itertools.permutations(range(tasks)):
        for cuts in itertools.combinations_with_replacement(range(tasks + 1), robots - 1):
            ends = (0, *cuts, tasks)
            yield tuple(order[a:b] for a, b in itertools.pairwise(ends))


def best_paths_value(instance: RobotTasks, objective: str) -> float:
    return float(TaskTruth(TaskAllocation(instance, objective)).best[0])


def best_partition_value(problem: BalancedPartition) -> float:
    return float(PartTruth(problem).best[0])
