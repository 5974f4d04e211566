"""Small problems of robots and tasks, and their optima by plain enumeration that knows nothing of waybound but the data."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from waybound.formulations.auctions.balanced_partition import BalancedPartition
from waybound.formulations.auctions.task_allocation import TaskAllocation
from waybound.instances.auctions.robot_tasks import RobotTasks

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


def path_value(instance: RobotTasks, objective: str, paths: Any) -> float:
    """The objective, leg by leg."""
    ways, lengths = [], []
    for robot, path in enumerate(paths):
        way, row = 0.0, robot
        for task in path:
            way += float(instance.distances[row, task])
            row = instance.num_robots + task
            ways.append(way)
        lengths.append(way)
    return {"mini-sum": sum(lengths), "mini-max": max(lengths), "mini-ave": sum(ways) / len(ways)}[objective]


def best_paths_value(instance: RobotTasks, objective: str) -> float:
    return min(path_value(instance, objective, paths) for paths in all_paths(instance.num_robots, instance.num_tasks))


def part_cost(instance: RobotTasks, part: list[int], edges: str) -> float:
    """The cost of a part; of its spanning trees all are looked at (by Kruskal's rule)."""
    cost = float(sum(instance.weights[t] for t in part))  # type: ignore[index]
    pairs = sorted((float(instance.between[a, b]), a, b) for a, b in itertools.combinations(part, 2))
    if edges == "clique":
        return cost + sum(distance for distance, _, _ in pairs)
    tree = {t: t for t in part}
    for distance, a, b in pairs if edges == "mst" else ():
        if tree[a] != tree[b]:
            cost += distance
            old = tree[a]
            tree = {t: tree[b] if own == old else own for t, own in tree.items()}
    return cost


def best_partition_value(problem: BalancedPartition) -> float:
    n, m = problem.num_robots, problem.num_tasks
    found = []
    for owners in itertools.product(range(n), repeat=m):
        costs = [part_cost(problem.instance, [t for t in range(m) if owners[t] == r], problem.edges) for r in range(n)]
        found.append(max(costs) - (min(costs) if problem.objective == "min-difference" else 0.0))
    return min(found)
