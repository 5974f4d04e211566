"""Evidence ``shortest-ways``: nobody reaches a task sooner than the shortest way from any robot allows.

Whoever does task t went at least D_t, the length of a shortest walk from some robot to it. So the longest path, and all paths together, are
at least max D_t long, and the mean way is at least the mean of all D_t. Besides, the ways of all tasks together are the sum of all legs,
each times the number of tasks from it on. Of n robots at most n have a leg that counts k times, for each k, and the leg to t is at least
e_t, the shortest from anywhere. So the sum is at least e_(1) + ... + e_(n) + 2 (e_(n+1) + ... + e_(2n)) + 3 ..., the largest e first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS

Floats = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("shortest-ways")
def check_shortest_ways(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound from the shortest ways to all tasks, rounded downwards; it reads no evidence data.

    Source: docs/formulations/task-allocation.md#evidence.
    """
    if problem.family != "task-allocation":
        raise InputError("shortest ways to tasks are evidence for task-allocation problems", found=problem.problem)
    instance = problem.instance
    distances, robots, tasks = np.asarray(instance.distances), instance.num_robots, instance.num_tasks
    ways = _shortest_ways(distances[:robots].min(axis=0), distances[robots:])
    shrunk = 1.0 - 8.0 * _EPS * (tasks + 2)  # sums of at most so many numbers that are not negative
    if problem.objective != "mini-ave":
        return float(float(ways.max()) * shrunk)
    own = distances.copy()
    own[np.arange(robots, robots + tasks), np.arange(tasks)] = math.inf
    legs = np.sort(own.min(axis=0))[::-1]
    times = np.arange(tasks) // robots + 1
    return float(max(math.fsum(ways.tolist()), math.fsum((legs * times).tolist())) / tasks * shrunk)


def _shortest_ways(first: Floats, between: Floats) -> Floats:
    """Lengths of shortest walks to all tasks, ``first`` being the lengths of their first legs (Dijkstra 1959)."""
    lengths, open_tasks = first.copy(), np.ones(len(first), dtype=bool)
    for _ in range(len(first)):
        node = int(np.where(open_tasks, lengths, math.inf).argmin())
        open_tasks[node] = False
        lengths = np.minimum(lengths, lengths[node] + between[node])
    return lengths
