"""Bids of robots for tasks, and the auctions in which one task is awarded after the other, compiled.

Imports numba: import it inside functions only.
"""

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked
from ....solvers.engines.auctions.task_subset_steps.subset_kernels import costs_to_go, path_through

SUM, LARGEST, WAYS = 0, 1, 2
"""A bid counts the length added to the path, the whole path with the task, or what is added to the ways of all its tasks."""


@kernel("Tuple((f8, i8))(f8[::1], f8[:, ::1], i8[::1], i8, i8, b1)")
def insertion(start, between, path, count, task, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Cost of the cheapest insertion of a task into the first ``count`` stops of a path, and its place; the first of equal ones."""
    best, place = math.inf, 0
    way = 0.0  # until the stop before the place
    for k in range(count + 1):
        into = start[task] if k == 0 else between[path[k - 1], task]
        detour = 0.0
        if k < count:
            direct = start[path[k]] if k == 0 else between[path[k - 1], path[k]]
            detour = into + between[task, path[k]] - direct
            added = way + into + detour * (count - k) if waiting else detour
        else:
            added = way + into if waiting else into
        if added < best:
            best, place = added, k
        if k < count:
            way += start[path[k]] if k == 0 else between[path[k - 1], path[k]]
    return best, place


@kernel("Tuple((f8[::1], i8[::1]))(i8[::1], f8[::1], f8[:, ::1], i8[::1], b1)")
def insertions(flag, start, between, path, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``insertion`` for all tasks at once; infinite for those of the path, and where it was asked to stop."""
    n = len(start)
    added, place = np.full(n, math.inf), np.zeros(n, np.int64)
    inside = np.zeros(n, np.bool_)
    for task in path:
        inside[task] = True
    for task in range(n):
        if asked(flag):
            break
        if not inside[task]:
            added[task], place[task] = insertion(start, between, path, len(path), task, waiting)
    return added, place


@kernel("f8(f8[::1], f8[:, ::1], i8[::1], i8, b1)")
def cost_of(start, between, path, count, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Length of a path over its first ``count`` tasks; if ``waiting``, the sum over these tasks of the length of the path up to each."""
    total = 0.0
    for k in range(count):
        leg = start[path[k]] if k == 0 else between[path[k - 1], path[k]]
        total += leg * (count - k) if waiting else leg
    return total


@kernel("Tuple((f8, i8[::1]))(i8[::1], f8[::1], f8[:, ::1], i8[::1], b1)")
def cheapest_order(flag, start, between, tasks, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The best path through a few tasks, and its cost."""
    n = len(tasks)
    own, first = np.empty((n, n)), np.empty(n)
    for a in range(n):
        first[a] = start[tasks[a]]
        for b in range(n):
            own[a, b] = between[tasks[a], tasks[b]]
    order = path_through(first, own, costs_to_go(flag, own, waiting), (1 << n) - 1, waiting)
    cost = cost_of(first, own, order, n, waiting)
    for a in range(n):
        order[a] = tasks[order[a]]
    return cost, order


@kernel("Tuple((i8[:, ::1], i8[::1], i8))(i8[::1], f8[:, ::1], f8[:, ::1], i8, i8)")
def sequential(flag, starts, between, rule, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Round after round the lowest bid of all robots for all open tasks is awarded; of equal bids to the lower robot, then the lower task.

    Up to ``most`` tasks of a robot its bids are by its best path through them; beyond, by the cheapest insertion. Returns paths of shape
    (robots, tasks), the stops of each, and how many tasks were awarded before it was asked to stop.
    """
    robots, n = starts.shape
    waiting = rule == WAYS
    path, count, cost = np.full((robots, n), -1), np.zeros(robots, np.int64), np.zeros(robots)
    bid = np.empty((robots, n))
    left = np.ones(n, np.bool_)
    changed = -1  # whose bids are to be made anew; all of them at first
    for awarded in range(n):
        for r in range(robots):
            if changed >= 0 and r != changed:
                continue
            bundle = np.empty(count[r] + 1, np.int64)
            for k in range(count[r]):
                bundle[k] = path[r, k]
            for t in range(n):
                if not left[t]:
                    continue
                if asked(flag):
                    return path, count, awarded
                if count[r] < most:
                    bundle[count[r]] = t
                    added = cheapest_order(flag, starts[r], between, bundle, waiting)[0] - cost[r]
                else:
                    added = insertion(starts[r], between, path[r], count[r], t, waiting)[0]
                bid[r, t] = cost[r] + added if rule == LARGEST else added
        lowest, winner, task = math.inf, -1, -1
        for r in range(robots):
            for t in range(n):
                if left[t] and bid[r, t] < lowest:
                    lowest, winner, task = bid[r, t], r, t
        if asked(flag):
            return path, count, awarded
        if count[winner] < most:
            bundle = np.empty(count[winner] + 1, np.int64)
            for k in range(count[winner]):
                bundle[k] = path[winner, k]
            bundle[count[winner]] = task
            order = cheapest_order(flag, starts[winner], between, bundle, waiting)[1]
            for k in range(len(order)):
                path[winner, k] = order[k]
        else:
            place = insertion(starts[winner], between, path[winner], count[winner], task, waiting)[1]
            for k in range(count[winner], place, -1):
                path[winner, k] = path[winner, k - 1]
            path[winner, place] = task
        count[winner] += 1
        left[task] = False
        cost[winner] = cost_of(starts[winner], between, path[winner], count[winner], waiting)
        changed = winner
    return path, count, n


@kernel("Tuple((i8[:, ::1], i8[::1]))(f8[:, ::1], f8[:, ::1], i8[::1])")
def appended(starts, between, order):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Each task of a given order to the robot whose path is the shortest with it at its end; the lower robot of equal ones."""
    robots, n = starts.shape
    path, count, cost = np.full((robots, n), -1), np.zeros(robots, np.int64), np.zeros(robots)
    for task in order:
        lowest, winner = math.inf, -1
        for r in range(robots):
            leg = starts[r, task] if count[r] == 0 else between[path[r, count[r] - 1], task]
            if cost[r] + leg < lowest:
                lowest, winner = cost[r] + leg, r
        path[winner, count[winner]] = task
        count[winner] += 1
        cost[winner] = lowest
    return path, count
