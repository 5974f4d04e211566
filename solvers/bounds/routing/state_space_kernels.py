"""Walks without i-j-i by levels, compiled: their least costs, and the sites that the best of them visit.

Cells stand for a node at a level: those of node ``j`` from ``base[j]`` on, one for each level from ``lower[j]`` to ``upper[j]``.
"""

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

_CELLS = "Tuple((f8[:, ::1], i4[:, ::1], f8[:, ::1]))"
_GRID = "i8[::1], i8[::1], i8[::1]"
_MOVES = "i8[::1], i8[::1], i8[::1]"


@kernel(f"{_CELLS}(i8[::1], {_MOVES}, f8[::1], f8[::1], i8[::1], {_GRID}, f8[::1])")
def walk_costs(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, tails, weight, cost, first_cost, first_weight, base, lower, upper, heavy
):
    """Least costs of coming to each node at each level or below it, nodes before, and weights, each of shape (cells, 2).

    Column 0 holds the best walk, column 1 the best over any other node before. Costs stay infinite where ``flag`` is set. Moves into node
    ``j`` are those from ``starts[j]`` up to ``starts[j + 1]``, out of nodes with cells; weights are at least 1. ``first_cost`` and
    ``first_weight``, shape (nodes,), are those of moves out of the depot, node 0; ``heavy``, shape (nodes,), what each visit adds to the
    weight of a walk.
    """
    nodes, cells = len(lower), base[-1]
    value = np.full((cells, 2), math.inf)
    before, load = np.full((cells, 2), -1, np.int32), np.zeros((cells, 2))
    most = np.int64(0)
    for j in range(1, nodes):
        most = max(most, upper[j])
    for b in range(most + 1):
        if asked(flag):
            return value, before, load
        for j in range(1, nodes):
            if b < lower[j] or b > upper[j]:
                continue
            cell = base[j] + b - lower[j]
            v0, v1, p0, p1 = math.inf, math.inf, np.int32(-1), np.int32(-1)
            h0, h1 = 0.0, 0.0
            if b > lower[j]:
                v0, v1, p0, p1 = value[cell - 1, 0], value[cell - 1, 1], before[cell - 1, 0], before[cell - 1, 1]
                h0, h1 = load[cell - 1, 0], load[cell - 1, 1]
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
                at = base[i] + min(at, upper[i]) - lower[i]
                v, x = cost[k] + value[at, 0], 0
                if v >= v1:
                    continue
                if before[at, 0] == j:
                    v, x = cost[k] + value[at, 1], 1
                    if v >= v1:
                        continue
                h = load[at, x] + heavy[j]
                if i == p0:
                    if v < v0:
                        v0, h0 = v, h
                elif v < v0:
                    v0, v1, p0, p1, h0, h1 = v, v0, np.int32(i), p0, h, h0
                else:
                    v1, p1, h1 = v, np.int32(i), h
            value[cell, 0], value[cell, 1], before[cell, 0], before[cell, 1] = v0, v1, p0, p1
            load[cell, 0], load[cell, 1] = h0, h1
    return value, before, load


@kernel(f"i8(i4[:, ::1], {_MOVES}, {_GRID}, i8, i8, i8, i8[::1])")
def walk_to(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    before, starts, tails, weight, base, lower, upper, node, level, other, walk
):
    """The best walk to ``node`` at ``level``, or the best by another way (``other`` 1), from its end on; returns its length."""
    count = 0
    while node > 0 and count < len(walk):
        walk[count] = node
        count += 1
        previous = before[base[node] + level - lower[node], other]
        if previous <= 0:
            break
        for k in range(starts[node], starts[node + 1]):
            if tails[k] == previous:
                level = min(level - weight[k], upper[previous])
                break
        other = 1 if before[base[previous] + level - lower[previous], 0] == node else 0
        node = previous
    return count


@kernel(
    f"void(f8[:, ::1], i4[:, ::1], f8[:, ::1], {_GRID}, f8[:, ::1], i4[:, ::1], f8[:, ::1], {_GRID}, f8[::1], i8[::1], f8[::1], i8[:, ::1])"
)
def best_through(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    ahead, before, load, base, lower, upper, back, after, rest, back_base, back_lower, back_upper, heavy, tops, least, how
):
    """The least cost, by weight, of a walk through each node, and the levels (in, out) and ways (in, out) it takes.

    ``ahead, before, load`` are those of ways from the start (``walk_costs``), ``back, after, rest`` those of ways from the end, on levels
    counted from there; ``tops`` sums of both levels that are tried. ``least`` receives cost over weight, ``how``, shape (nodes, 4), levels
    and ways.
    """
    for j in range(1, len(lower)):
        least[j] = math.inf
        for top in tops:
            for b in range(max(lower[j], top - back_upper[j]), min(upper[j], top - back_lower[j]) + 1):
                one, two = base[j] + b - lower[j], back_base[j] + top - b - back_lower[j]
                for x in range(2):
                    for y in range(2):
                        v = ahead[one, x] + back[two, y]
                        if v == math.inf or (before[one, x] == after[two, y] and before[one, x] != 0):
                            continue
                        v /= load[one, x] + rest[two, y] - heavy[j]
                        if v < least[j]:
                            least[j] = v
                            how[j, 0], how[j, 1], how[j, 2], how[j, 3] = b, top - b, x, y


@kernel(f"f8(i4[:, ::1], {_MOVES}, {_GRID}, i4[:, ::1], {_MOVES}, {_GRID}, f8[::1], i8[:, ::1], f8[::1], i8[::1], f8[::1])")
def share_out(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    before, starts, tails, weight, base, lower, upper, after, back_starts, back_heads, back_weight, back_base, back_lower, back_upper,
    least, how, heavy, walk, visits
):  # fmt: skip
    """Add to ``visits`` those of the best walks through all nodes, each by the node's share of its weight; returns the sum of the shares.

    The moves and grid are those of both directions (``walk_costs``), ``least`` and ``how`` from ``best_through``; ``walk`` is room for one.
    """
    walks = 0.0
    for i in range(1, len(lower)):
        if least[i] == math.inf:
            continue
        # The way in ends at the node, and so does the way out, whose first entry makes room for its last one.
        count = walk_to(before, starts, tails, weight, base, lower, upper, i, how[i, 0], how[i, 2], walk)
        out = walk[count:]
        more = walk_to(after, back_starts, back_heads, back_weight, back_base, back_lower, back_upper, i, how[i, 1], how[i, 3], out)
        out[0] = out[more - 1]
        count += more - 1
        total = 0.0
        for k in range(count):
            total += heavy[walk[k]]
        walks += heavy[i] / total
        for k in range(count):
            visits[walk[k]] += heavy[i] / total
    return walks
