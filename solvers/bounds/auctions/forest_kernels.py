"""Prim's smallest forest of tasks rooted at robots, compiled. Imports numba: import it inside functions only."""

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked


@kernel("Tuple((f8, i8[::1], i8[::1]))(i8[::1], f8[:, ::1], f8[:, ::1], f8[::1], f8[::1])")
def rooted_forest(flag, starts, edges, task_price, robot_price):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Weight of the smallest forest that joins each task to a robot under prices, and how many edges each task and each robot has in it.

    ``edges`` is symmetric; the weight is NaN where the flag of a ``Stop`` was set.
    """
    robots, n = starts.shape
    near = np.full(n, math.inf)
    joined = np.zeros(n, np.int64)  # a task, or -1 - robot
    for r in range(robots):
        for t in range(n):
            cost = starts[r, t] + robot_price[r] + task_price[t]
            if cost < near[t]:
                near[t] = cost
                joined[t] = -1 - r
    left = np.ones(n, np.bool_)
    of_tasks, of_robots = np.zeros(n, np.int64), np.zeros(robots, np.int64)
    total = 0.0
    for _ in range(n):
        if asked(flag):
            return math.nan, of_tasks, of_robots
        best, node = math.inf, -1
        for t in range(n):
            if left[t] and near[t] < best:
                best, node = near[t], t
        left[node] = False
        total += best
        of_tasks[node] += 1
        if joined[node] < 0:
            of_robots[-1 - joined[node]] += 1
        else:
            of_tasks[joined[node]] += 1
        for t in range(n):
            if left[t]:
                cost = edges[node, t] + task_price[node] + task_price[t]
                if cost < near[t]:
                    near[t] = cost
                    joined[t] = node
    return total, of_tasks, of_robots
