"""Evidence ``task-forest`` and ``shortest-ways`` of task allocations.

The legs of all paths, regardless of direction, are a forest that joins every task to exactly one robot. In it a task has at most two legs,
and a robot one. So for prices p_t, q_r >= 0 all paths together are at least as long as::

    min over forests that join each task to a robot of  sum (c_ij + p_i + p_j) + sum (c_rj + q_r + p_j)  -  2 sum p_t  -  sum q_r

c_ij being the shorter of the two directions. Without prices that is the minimum spanning forest rooted at the robots.

Whoever does task t went at least D_t, the length of a shortest walk from some robot to it. So the longest path, and all paths together, are
at least max D_t long, and the mean way is at least the mean of all D_t. Besides, the ways of all tasks together are the sum of all legs,
each times the number of tasks from it on. Of n robots at most n have a leg that counts k times, for each k, and the leg to t is at least
e_t, the shortest from anywhere. So the sum is at least e_(1) + ... + e_(n) + 2 (e_(n+1) + ... + e_(2n)) + 3 ..., the largest e first.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.number_arrays import Floats
from ...checking.evidence_numbers import numbers
from ...evidence import checker

_EPS = float(np.finfo(np.float64).eps)


@checker("task-forest", "task-allocation", "a forest of tasks is")
def check_task_forest(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound on the sum of all paths, or on the longest, that any prices prove; 0 for the mean way.

    ``data`` holds ``tasks`` and ``robots``, one price each; negative ones count as 0. The longest of n paths is at least an n-th of all
    together.

    Source: Lagoudakis et al. (2005) for the forest; Held and Karp (1971) for the prices; docs/formulations/task-allocation.md#evidence.
    """
    instance = problem.instance
    robots, tasks = instance.num_robots, instance.num_tasks
    p, q = np.maximum(numbers(data, "tasks", tasks), 0.0), np.maximum(numbers(data, "robots", robots), 0.0)
    if problem.objective == "mini-ave":
        return 0.0
    distances = np.asarray(instance.distances)
    size = float(distances.max()) + 2.0 * float(p.max()) + float(q.max())
    if not math.isfinite(64.0 * size * (tasks + robots)):
        return 0.0
    inner = np.minimum(distances[robots:], distances[robots:].T)
    root = (distances[:robots] + q[:, None]).min(axis=0) + p
    forest = smallest_forest(root, inner + p[:, None] + p)
    rounding = 32.0 * _EPS * (tasks + robots) * size
    whole = math.fsum([*forest, *(-2.0 * p), *(-q), -rounding])
    return max(0.0, whole / robots * (1.0 - 4.0 * _EPS) if problem.objective == "mini-max" else whole)


def smallest_forest(root: Floats, edges: Floats) -> list[float]:
    """Lengths of the edges by which Prim's algorithm (1957) joins all nodes to a root."""
    near, waiting, taken = root.copy(), np.ones(len(root), dtype=bool), []
    for _ in range(len(root)):
        node = int(np.where(waiting, near, math.inf).argmin())
        taken.append(float(near[node]))
        waiting[node] = False
        near = np.minimum(near, edges[node])
    return taken


@checker("shortest-ways", "task-allocation", "shortest ways to tasks are")
def check_shortest_ways(problem: Any, data: Mapping[str, Any]) -> float:
    """Lower bound from the shortest ways to all tasks, rounded downwards; it reads no evidence data.

    Source: docs/formulations/task-allocation.md#evidence.
    """
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
