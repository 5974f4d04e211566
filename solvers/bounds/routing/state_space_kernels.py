"""Walks without i-j-i by levels, compiled: their least costs, and which sites the best of them visit."""

from __future__ import annotations

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

_CELLS = "Tuple((f8[:, :, ::1], i4[:, :, ::1], f8[:, :, ::1]))"


@kernel(f"{_CELLS}(i8[::1], i8[::1], i8[::1], f8[::1], i8[::1], f8[::1], i8[::1], i8[::1], i8[::1], f8[::1], i8)")
def walk_costs(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, tails, cost, weight, first_cost, first_weight, lower, upper, heavy, steps
):
    """Least costs of coming to each node at each level or below it, and the node before: the best, and the best over any other node.

    Parameters
    ----------
    flag : array
        Of a ``Stop``; where it is set, costs are left infinite.
    starts, tails, cost, weight : arrays
        Moves into node ``j`` are those from ``starts[j]`` up to ``starts[j + 1]``; weights are at least 1.
    first_cost, first_weight : arrays of shape (nodes,)
        Moves out of the depot, node 0.
    lower, upper : arrays of shape (nodes,)
        Levels that each node can have.
    heavy : array of shape (nodes,)
        What each visit adds to the weight of a walk.
    steps : int

    Returns
    -------
    arrays of shape (nodes, steps, 2)
        Costs, nodes before, and weights of these walks.
    """
    nodes = len(lower)
    value = np.full((nodes, steps, 2), math.inf)
    before, load = np.full((nodes, steps, 2), -1, np.int32), np.zeros((nodes, steps, 2))
    for b in range(steps):
        if asked(flag):
            return value, before, load
        for j in range(1, nodes):
            if b < lower[j] or b > upper[j]:
                continue
            v0, v1, p0, p1 = math.inf, math.inf, np.int32(-1), np.int32(-1)
            h0, h1 = 0.0, 0.0
            if b > lower[j]:
                v0, v1, p0, p1 = value[j, b - 1, 0], value[j, b - 1, 1], before[j, b - 1, 0], before[j, b - 1, 1]
                h0, h1 = load[j, b - 1, 0], load[j, b - 1, 1]
            if first_weight[j] <= b and first_cost[j] < math.inf and p0 != 0 and p1 != 0:
                if first_cost[j] < v0:
                    v0, v1, p0, p1 = first_cost[j], v0, np.int32(0), p0
                    h0, h1 = heavy[j], h0
                elif first_cost[j] < v1:
                    v1, p1, h1 = first_cost[j], np.int32(0), heavy[j]
            for k in range(starts[j], starts[j + 1]):
                i = tails[k]
                at = b - weight[k]
                if at < lower[i]:
                    continue
                if at > upper[i]:
                    at = upper[i]
                v, x = cost[k] + value[i, at, 0], 0
                if v >= v1:
                    continue
                if before[i, at, 0] == j:
                    v, x = cost[k] + value[i, at, 1], 1
                    if v >= v1:
                        continue
                h = load[i, at, x] + heavy[j]
                if i == p0:
                    if v < v0:
                        v0, h0 = v, h
                elif v < v0:
                    v0, v1, p0, p1, h0, h1 = v, v0, np.int32(i), p0, h, h0
                else:
                    v1, p1, h1 = v, np.int32(i), h
            value[j, b, 0], value[j, b, 1], before[j, b, 0], before[j, b, 1] = v0, v1, p0, p1
            load[j, b, 0], load[j, b, 1] = h0, h1
    return value, before, load


@kernel("i8(i4[:, :, ::1], i8[::1], i8[::1], i8[::1], i8[::1], i8, i8, i8, f8, f8[::1])")
def add_visits(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    before, starts, tails, weight, upper, node, level, other, times, visits
):
    """Add ``times`` to ``visits`` for each node on the best walk to ``node``, or the best by another way (``other`` 1).

    Returns how many there are.
    """
    count = 0
    while node > 0:
        visits[node] += times
        count += 1
        previous = before[node, level, other]
        if previous <= 0 or count > 100_000:
            break
        for k in range(starts[node], starts[node + 1]):
            if tails[k] == previous:
                level = min(level - weight[k], upper[previous])
                break
        other = 1 if before[previous, level, 0] == node else 0
        node = previous
    return count


@kernel(
    "void(f8[:, :, ::1], i4[:, :, ::1], f8[:, :, ::1], f8[:, :, ::1], i4[:, :, ::1], f8[:, :, ::1], i8[::1], i8[::1], f8[::1], i8[::1],"
    "f8[::1], i8[:, ::1])"
)
def best_through(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    ahead, before, load, back, after, rest, lower, upper, heavy, tops, least, how
):
    """The least cost, by weight, of a walk through each node, and the levels (in, out) and ways (in, out) it takes.

    Parameters
    ----------
    ahead, before, load : arrays of shape (nodes, steps, 2)
        Of ways to a node from the start (``walk_costs``).
    back, after, rest : arrays of shape (nodes, steps, 2)
        Of ways from the end, on levels counted from there.
    lower, upper : arrays of shape (nodes,)
    heavy : array of shape (nodes,)
    tops : array of int
        Sums of both levels that are tried.
    least : array of shape (nodes,)
        Receives cost over weight.
    how : int array of shape (nodes, 4)
        Receives levels and ways.
    """
    for j in range(1, len(lower)):
        least[j] = math.inf
        for top in tops:
            for b in range(lower[j], min(upper[j], top) + 1):
                for x in range(2):
                    for y in range(2):
                        v = ahead[j, b, x] + back[j, top - b, y]
                        if v == math.inf or (before[j, b, x] == after[j, top - b, y] and before[j, b, x] != 0):
                            continue
                        v /= load[j, b, x] + rest[j, top - b, y] - heavy[j]
                        if v < least[j]:
                            least[j] = v
                            how[j, 0], how[j, 1], how[j, 2], how[j, 3] = b, top - b, x, y
