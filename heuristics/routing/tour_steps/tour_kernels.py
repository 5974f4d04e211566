"""Tours through all nodes of a complete graph, compiled. Imports numba: import it inside functions only."""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked

LEAST = 1e-12
"""Part of the edges removed by which a move has to shorten a tour: less may be rounding, and go round in circles."""

LONGEST = 3
"""Nodes of the longest path that Or-opt moves."""


@kernel("(i8[::1], f8[:, ::1])")
def close(flag, matrix):  # type: ignore[no-untyped-def]
    """Turn lengths into those of shortest paths, in place (Floyd 1962; Warshall 1962). False where it was asked to stop."""
    n = len(matrix)
    for k in range(n):
        if asked(flag):
            return False
        through = matrix[k]
        for i in range(n):
            row, first = matrix[i], matrix[i, k]
            for j in range(n):
                row[j] = min(row[j], first + through[j])
    return True


@kernel("(i8[::1], f8[:, ::1])")
def spanning_tree(flag, costs):  # type: ignore[no-untyped-def]
    """Parent of each node in a minimum spanning tree, the root 0 its own (Prim 1957); empty where it was asked to stop."""
    n = len(costs)
    parent = np.zeros(n, np.int64)
    least, left = np.empty(n), np.empty(max(0, n - 1), np.int64)
    for k in range(n):
        least[k] = costs[0, k]
    for k in range(1, n):
        left[k - 1] = k
    for count in range(n - 1, 0, -1):
        if asked(flag):
            return parent[:0]
        chosen = 0
        for k in range(1, count):
            if least[left[k]] < least[left[chosen]]:
                chosen = k
        node = left[chosen]
        left[chosen] = left[count - 1]
        for k in range(count - 1):
            other = left[k]
            if costs[node, other] < least[other]:
                least[other], parent[other] = costs[node, other], node
    return parent


@kernel("(i8[::1], i8[::1], i8)")
def shortcut(tails, heads, n):  # type: ignore[no-untyped-def]
    """The nodes of a connected graph of even degrees in the order in which a Euler tour from node 0 first meets them (Hierholzer 1873)."""
    m = len(tails)
    start = np.zeros(n + 1, np.int64)
    for k in range(m):
        start[tails[k] + 1] += 1
        start[heads[k] + 1] += 1
    fill, at, edge = np.empty(n, np.int64), np.empty(n, np.int64), np.empty(2 * m, np.int64)
    for node in range(n):
        start[node + 1] += start[node]
        fill[node] = at[node] = start[node]
    for k in range(m):
        for node in (tails[k], heads[k]):
            edge[fill[node]] = k
            fill[node] += 1
    used, met = np.zeros(m, np.bool_), np.zeros(n, np.bool_)
    path, depth = np.zeros(m + 1, np.int64), 1
    order, count = np.empty(n, np.int64), 0
    while depth > 0:
        node = path[depth - 1]
        while at[node] < start[node + 1] and used[edge[at[node]]]:
            at[node] += 1
        if at[node] < start[node + 1]:
            k = edge[at[node]]
            used[k] = True
            path[depth] = heads[k] if tails[k] == node else tails[k]
            depth += 1
        else:
            depth -= 1
            if not met[node]:
                met[node] = True
                order[count] = node
                count += 1
    return order


@kernel("(i8[::1], f8[:, ::1])")
def nearest_neighbour(flag, costs):  # type: ignore[no-untyped-def]
    """A tour from node 0, each time to the nearest node that is left; where it was asked to stop, the others in their order."""
    n = len(costs)
    order, left = np.zeros(n, np.int64), np.empty(max(0, n - 1), np.int64)
    for k in range(1, n):
        left[k - 1] = k
    node = 0
    for k in range(1, n):
        count, chosen = n - k, 0
        if not asked(flag):
            for i in range(1, count):
                a, b = left[i], left[chosen]
                if costs[node, a] < costs[node, b] or (costs[node, a] == costs[node, b] and a < b):
                    chosen = i
        node = order[k] = left[chosen]
        left[chosen] = left[count - 1]
    return order


@kernel("(i8[::1], i8[::1], f8[:, ::1], i8[:, ::1])")
def improve(flag, tour, costs, near):  # type: ignore[no-untyped-def]
    """2-opt and Or-opt (Croes 1958; Or 1976) between near nodes, in place, until neither shortens the tour; returns the moves made.

    Or-opt looks for a place next to nodes that are nearer than what taking the path out saves. Nodes without a change around them since
    they were last looked at are passed over at first (Bentley 1992).
    """
    n = len(tour)
    place = np.empty(n, np.int64)
    for k in range(n):
        place[tour[k]] = k
    if n < 5:
        return 0
    waiting, queued = np.empty(n, np.int64), np.empty(n, np.bool_)
    for k in range(n):
        waiting[k], queued[k] = tour[k], True
    first, count, moves, known = 0, n, 0, -1
    touched = np.empty(8, np.int64)
    while not asked(flag):
        if count == 0:
            if moves == known:
                break
            known = moves  # those passed over may have a place to go by now: once more for all
            first, count = 0, n
            for k in range(n):
                waiting[k], queued[k] = tour[k], True
        node = waiting[first]
        first = (first + 1) % n
        count -= 1
        queued[node] = False
        changed = _shorten(tour, place, costs, near, node, touched)
        if changed > 0:
            moves += 1
        for k in range(changed):
            if not queued[touched[k]]:
                queued[touched[k]] = True
                waiting[(first + count) % n] = touched[k]
                count += 1
    return moves


@inner
def _shorten(tour, place, costs, near, a, touched):  # type: ignore[no-untyped-def]
    """Make the first move at ``a`` that shortens the tour; returns how many nodes it ``touched``."""
    n = len(tour)
    for forward in (True, False):
        step = 1 if forward else n - 1
        b = tour[(place[a] + step) % n]
        for k in range(near.shape[1]):
            c = near[a, k]
            if costs[a, c] >= costs[a, b]:
                break
            d = tour[(place[c] + step) % n]
            removed = costs[a, b] + costs[c, d]
            if removed - costs[a, c] - costs[b, d] > LEAST * removed:
                x, y = (b, c) if forward else (c, b)
                _turn(tour, place, x, y)
                touched[0], touched[1], touched[2], touched[3] = a, b, c, d
                return 4
        # The path from a on, away from p, goes between c and one of its neighbours d, a next to c.
        p = tour[(place[a] + n - step) % n]
        for length in range(1, min(LONGEST, n - 3) + 1):
            e = tour[(place[a] + (length - 1) * step) % n]
            q = tour[(place[a] + length * step) % n]
            gone = costs[p, a] + costs[e, q]
            for k in range(near.shape[1]):
                c = near[a, k]
                if gone - costs[p, q] - costs[a, c] <= 0.0:
                    break
                if (place[c] - place[a] if forward else place[a] - place[c]) % n < length:
                    continue
                for d in (tour[(place[c] + 1) % n], tour[(place[c] + n - 1) % n]):
                    if (place[d] - place[a] if forward else place[a] - place[d]) % n < length:
                        continue
                    removed = gone + costs[c, d]
                    if removed - costs[p, q] - costs[a, c] - costs[e, d] > LEAST * removed:
                        _move(tour, place, p, a, e, q, c, d)
                        touched[0], touched[1], touched[2], touched[3], touched[4], touched[5] = p, a, e, q, c, d
                        return 6
    return 0


@inner
def _turn(tour, place, x, y):  # type: ignore[no-untyped-def]
    """Turn the path from ``x`` on to ``y`` round; or all other nodes, where they are fewer, which makes the same tour."""
    n = len(tour)
    i, j = place[x], place[y]
    inside = (j - i) % n + 1
    if 2 * inside > n:
        i, j = (j + 1) % n, (i + n - 1) % n
        inside = n - inside
    for _ in range(inside // 2):
        tour[i], tour[j] = tour[j], tour[i]
        place[tour[i]], place[tour[j]] = i, j
        i, j = (i + 1) % n, (j + n - 1) % n


@inner
def _move(tour, place, p, a, e, q, c, d):  # type: ignore[no-untyped-def]
    """Take the path ``a..e`` out from between ``p`` and ``q``, and put it between ``c`` and ``d``, ``a`` next to ``c``."""
    n = len(tour)
    forward = tour[(place[p] + 1) % n] == a and tour[(place[e] + 1) % n] == q
    if not forward:
        p, a, e, q = q, e, a, p
    straight = forward == (tour[(place[c] + 1) % n] == d)
    if tour[(place[c] + 1) % n] != d:
        c = d
    # p a..e q..c becomes p c..q e..a, then p q..c e..a. Each turn may leave the tour mirrored.
    _turn(tour, place, a, c)
    x, y = (c, q) if tour[(place[p] + 1) % n] == c else (q, c)
    _turn(tour, place, x, y)
    if straight and a != e:
        x, y = (e, a) if tour[(place[c] + 1) % n] == e else (a, e)
        _turn(tour, place, x, y)
