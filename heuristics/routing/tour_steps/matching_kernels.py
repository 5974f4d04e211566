"""Minimum-weight perfect matching of a complete graph, compiled. Imports numba: import it inside functions only.

Blossom method with prices (Edmonds 1965), in O(n^3) with the least slack of each surface (Gabow 1976; Galil 1986). Vertices are
``0..n-1``, blossoms have the numbers from ``n`` on, and a *surface* is a vertex or blossom within no other one. ``end[x, y]`` is the
vertex of ``x`` at which its edge of least slack to ``y`` ends: all vertices of a blossom change their prices alike, so that this edge stays
the same one.
"""

import numpy as np
from numpy.typing import NDArray

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked

NONE, OUTER, INNER = -1, 0, 1
FAR = 1 << 62

PRICE, MATE, TOP, LABEL, NEAR, PARENT, MEMBER, SEEN, LENGTH, QUEUE, SPAN, SURFACE, OWN, OTHER = range(14)
"""Rows of ``table``: numbers of each vertex and blossom, what waits in the queue and how far it is, and a stack of edges in three rows."""


def minimum_weight_perfect_matching(flag: NDArray[np.int64], weights: NDArray[np.int64]) -> NDArray[np.int64]:
    """Partner of each vertex (-1 for some where ``flag`` asked to stop) for symmetric weights of an even number of vertices, up to 2^57."""
    n = len(weights)
    size = n + n // 2 + 2
    doubled = 2 * weights  # then all prices of outer vertices stay of one parity
    table = np.full((14, size), -1)
    table[SEEN] = 0
    table[PRICE, n:] = 0
    table[PRICE, :n] = np.where(np.eye(n, dtype=np.bool_), FAR, doubled).min(axis=1, initial=FAR)
    table[[TOP, MEMBER], :n] = np.arange(n)
    end = np.full((size, size), -1)
    end[:n, :n] = np.arange(n)[:, None]
    inside, cycle = np.full((size - n, n), -1), np.zeros((size - n, n), np.int64)  # child of each vertex, and children in their order
    raise_prices(doubled, table[PRICE], table[MATE])
    while augmented(flag, (doubled, table, end, inside, cycle)):
        pass
    return table[MATE, :n]


@kernel("(i8[:, ::1], i8[::1], i8[::1])")
def raise_prices(doubled, price, mate):  # type: ignore[no-untyped-def]
    """Raise the price of each vertex as high as those of the others allow, and match it where the nearest is free."""
    n = len(doubled)
    for u in range(n):
        if mate[u] >= 0:
            continue
        least, best = FAR, -1
        for v in range(n):
            if v != u:
                slack = 2 * doubled[u, v] - price[v]
                if slack < least or (slack == least and mate[best] >= 0 and mate[v] < 0):
                    least, best = slack, v
        price[u] = least
        if best >= 0 and mate[best] < 0:
            mate[u], mate[best] = best, u


@kernel("(i8[::1], UniTuple(i8[:, ::1], 5))")
def augmented(flag, state):  # type: ignore[no-untyped-def]
    """Grow trees of alternating paths from all free surfaces until two of them meet; False without any, or where it was asked to stop."""
    doubled, table, end, _, _ = state
    price, mate, top, label = table[PRICE], table[MATE], table[TOP], table[LABEL]
    near, parent, queue, span = table[NEAR], table[PARENT], table[QUEUE], table[SPAN]
    n, size = len(doubled), len(top)
    span[0] = span[1] = 0
    for x in range(size):
        label[x], near[x] = NONE, -1
    for x in range(size):
        if top[x] == x and mate[x] < 0:
            parent[x] = -1
            label[x] = OUTER
            _push(state, n, x)
    if span[1] == 0:
        return False
    while True:
        while span[0] < span[1]:
            if asked(flag):
                return False
            u = queue[span[0]]
            span[0] += 1
            for v in range(n):
                if top[u] != top[v]:
                    if _slack(state, u, v) == 0:
                        if _met(state, n, u, v):
                            return True
                    else:
                        _note(state, u, top[v])
        if asked(flag):
            return False
        span[0] = span[1] = 0
        step = FAR
        for x in range(size):
            if top[x] != x:
                continue
            if x >= n and label[x] == INNER:
                step = min(step, price[x] // 2)
            if near[x] >= 0 and label[x] != INNER:
                slack = _slack(state, near[x], x)
                step = min(step, slack if label[x] == NONE else slack // 2)
        for u in range(n):
            if label[top[u]] == OUTER:
                price[u] += step
            elif label[top[u]] == INNER:
                price[u] -= step
        for b in range(n, size):
            if top[b] == b:
                if label[b] == OUTER:
                    price[b] += 2 * step
                elif label[b] == INNER:
                    price[b] -= 2 * step
        for x in range(size):
            tight = top[x] == x and near[x] >= 0 and top[near[x]] != x and label[x] != INNER and _slack(state, near[x], x) == 0
            if tight and _met(state, n, near[x], end[x, near[x]]):
                return True
        for b in range(n, size):
            if top[b] == b and label[b] == INNER and price[b] == 0:
                _open(state, n, b)


@inner
def _slack(state, x, y):  # type: ignore[no-untyped-def]
    """Slack of the edge of least slack between ``x`` and ``y``."""
    doubled, table, end, _, _ = state
    price, u, v = table[PRICE], end[x, y], end[y, x]
    return 2 * doubled[u, v] - price[u] - price[v]


@inner
def _note(state, u, x):  # type: ignore[no-untyped-def]
    near = state[1][NEAR]
    if near[x] < 0 or _slack(state, u, x) < _slack(state, near[x], x):
        near[x] = u


@inner
def _look(state, n, x):  # type: ignore[no-untyped-def]
    """The outer vertex nearest to surface ``x``, from scratch."""
    table = state[1]
    top, label, near = table[TOP], table[LABEL], table[NEAR]
    near[x] = -1
    for u in range(n):
        if top[u] != x and label[top[u]] == OUTER:
            _note(state, u, x)


@inner
def _push(state, n, x):  # type: ignore[no-untyped-def]
    _, table, _, inside, _ = state
    queue, span = table[QUEUE], table[SPAN]
    if x < n:
        queue[span[1]] = x
        span[1] += 1
    else:
        for v in range(n):
            if inside[x - n, v] >= 0:
                queue[span[1]] = v
                span[1] += 1


@inner
def _met(state, n, u, v):  # type: ignore[no-untyped-def]
    """Outer vertex ``u`` has a tight edge to ``v``: the tree grows, contracts, or meets another one (True)."""
    table = state[1]
    mate, top, label, near, parent, seen = table[MATE], table[TOP], table[LABEL], table[NEAR], table[PARENT], table[SEEN]
    x, y = top[u], top[v]
    if label[y] == NONE:
        parent[y] = u
        label[y] = INNER
        z = top[mate[y]]
        near[y] = near[z] = -1
        label[z] = OUTER
        _push(state, n, z)
    elif label[y] == OUTER:
        stamp = 1
        for z in range(len(seen)):
            stamp = max(stamp, seen[z] + 1)
        base, a, b = -1, x, y
        while a >= 0 or b >= 0:
            if a >= 0:
                if seen[a] == stamp:
                    base = a
                    break
                seen[a] = stamp
                a = top[parent[top[mate[a]]]] if mate[a] >= 0 else -1
            a, b = b, a
        if base < 0:
            for _ in range(2):
                _flip(state, n, x, u, v)
                x, u, v = y, v, u
            return True
        _contract(state, n, x, base, y)
    return False


@inner
def _reverse(row, first, last):  # type: ignore[no-untyped-def]
    """Turn ``row[first:last]`` round in place."""
    last -= 1
    while first < last:
        row[first], row[last] = row[last], row[first]
        first += 1
        last -= 1


@inner
def _turn(state, n, b, child):  # type: ignore[no-untyped-def]
    """Place of ``child`` in the cycle of ``b``, in the direction that makes it an even number."""
    _, table, _, _, cycle = state
    k, at = table[LENGTH, b], 0
    while cycle[b - n, at] != child:
        at += 1
    if at % 2 == 1:
        _reverse(cycle[b - n], 1, k)
        at = k - at
    return at


@inner
def _flip(state, n, x, u, v):  # type: ignore[no-untyped-def]
    """Match surface ``x`` along the edge from its vertex ``u`` to ``v``, and all that follows on the way to the root."""
    _, table, end, _, _ = state
    mate, top, parent = table[MATE], table[TOP], table[PARENT]
    outer = True
    while True:
        old = mate[x]
        _match(state, n, x, u, v)
        if not outer:
            x, u, v = top[v], v, u
        elif old < 0:
            return
        else:
            x = top[old]
            v = parent[x]
            u = end[x, v]
        outer = not outer


@inner
def _match(state, n, x, u, v):  # type: ignore[no-untyped-def]
    """Match ``x`` along the edge from its vertex ``u`` to ``v``, with all blossoms within it."""
    _, table, end, inside, cycle = state
    mate, surface, own, other, depth = table[MATE], table[SURFACE], table[OWN], table[OTHER], 1
    surface[0], own[0], other[0] = x, u, v
    while depth > 0:
        depth -= 1
        x, u, v = surface[depth], own[depth], other[depth]
        mate[x] = v
        if x < n:
            continue
        child = inside[x - n, u]
        at, row = _turn(state, n, x, child), cycle[x - n]
        for i in range(at):
            a, b = row[i], row[i ^ 1]
            surface[depth], own[depth], other[depth] = a, end[a, b], end[b, a]
            depth += 1
        surface[depth], own[depth], other[depth] = child, u, v
        depth += 1
        k = table[LENGTH, x]
        for first, last in ((0, at), (at, k), (0, k)):  # three turns rotate
            _reverse(row, first, last)


@inner
def _contract(state, n, x, base, y):  # type: ignore[no-untyped-def]
    """A blossom of the cycle through ``base``, ``x`` and ``y``."""
    _, table, end, inside, cycle = state
    price, mate, top, label, parent, member = table[PRICE], table[MATE], table[TOP], table[LABEL], table[PARENT], table[MEMBER]
    size, b = len(top), n
    while top[b] >= 0:
        b += 1
    row = cycle[b - n]
    row[0] = base
    k = 1
    for _ in range(2):
        _reverse(row, 1, k)
        while x != base:
            row[k] = x
            row[k + 1] = inner = top[mate[x]]
            k += 2
            _push(state, n, inner)
            x = top[parent[inner]]
        x = y
    table[LENGTH, b], member[b], mate[b] = k, member[base], mate[base]
    price[b], label[b], top[b] = 0, OUTER, b
    for i in range(k):
        child = row[i]
        top[child] = b
        if child < n:
            inside[b - n, child] = child
        else:
            for v in range(n):
                if inside[child - n, v] >= 0:
                    inside[b - n, v] = child
                    top[v] = b
    for other in range(size):
        if top[other] < 0 or top[member[other]] == b:
            continue
        best, least = -1, FAR
        for i in range(k):
            slack = _slack(state, row[i], other)
            if slack < least:
                best, least = row[i], slack
        end[b, other], end[other, b] = end[best, other], end[other, best]
    _look(state, n, b)


@inner
def _open(state, n, b):  # type: ignore[no-untyped-def]
    """Inner blossom ``b`` has no price left: its children are surfaces again, those between its two tree edges part of the tree."""
    _, table, end, inside, cycle = state
    top, label, near, parent = table[TOP], table[LABEL], table[NEAR], table[PARENT]
    k = table[LENGTH, b]
    entry = inside[b - n, end[b, parent[b]]]
    at, row = _turn(state, n, b, entry), cycle[b - n]
    for i in range(k):
        top[row[i]] = row[i]
    for v in range(n):
        if inside[b - n, v] >= 0:
            top[v] = inside[b - n, v]
            inside[b - n, v] = -1
    top[b] = -1
    label[b] = NONE
    for i in range(k):
        label[row[i]] = NONE
        near[row[i]] = -1
    for i in range(0, at, 2):
        inner, outer = row[i], row[i + 1]
        parent[inner] = end[outer, inner]
        label[inner] = INNER
        label[outer] = OUTER
        _push(state, n, outer)
    label[entry] = INNER
    parent[entry] = parent[b]
    for i in range(k):
        if label[row[i]] != INNER:
            _look(state, n, row[i])
