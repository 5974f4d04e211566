"""Costs of parts of a partition, and partitions of the least spread, compiled. Imports numba: import it inside functions only."""

import math

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked

NONE, CLIQUE, TREE = 0, 1, 2
"""Distances that a part costs: none, all pairs, a minimum spanning tree."""


@kernel("f8(f8[::1], f8[:, ::1], i8[::1], i8)")
def part_cost(weights, between, part, edges):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The cost of one part."""
    n, total = len(part), 0.0
    for k in range(n):
        total += weights[part[k]]
    if edges == CLIQUE:
        for a in range(n):
            for b in range(a):
                total += between[part[a], part[b]]
    elif edges == TREE and n > 1:
        near, left = np.empty(n), np.ones(n, np.bool_)
        node = 0
        for k in range(n):
            near[k] = math.inf
        for _ in range(n - 1):
            left[node] = False
            best, after = math.inf, -1
            for k in range(n):
                if left[k]:
                    near[k] = min(near[k], between[part[node], part[k]])
                    if near[k] < best:
                        best, after = near[k], k
            total += best
            node = after
    return total


@kernel("f8[::1](i8[::1], f8[::1], f8[:, ::1], i8)")
def costs_of_sets(flag, weights, between, edges):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The cost of every set as a part, shape (2^tasks,); meaningless where it was asked to stop."""
    n = len(weights)
    found = np.zeros(1 << n)
    part = np.empty(n, np.int64)
    for members in range(1, 1 << n):
        if asked(flag):
            break
        count = 0
        for t in range(n):
            if (members >> t) & 1:
                part[count] = t
                count += 1
        found[members] = part_cost(weights, between, part[:count], edges)
    return found


@kernel("Tuple((f8, i8[::1], b1))(i8[::1], f8[::1], i8)")
def least_spread(flag, cost, parts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The partition with the least difference of largest and smallest cost: difference, set of each part, whether the search was complete.

    Each part in turn takes the lowest free task, and any of the others; the spread of the parts so far only grows. ``cost`` has shape
    (2^tasks,), and some parts may be empty.
    """
    every = len(cost) - 1
    best, shares = math.inf, np.zeros(parts, np.int64)
    rest, others, low = np.zeros(parts + 1, np.int64), np.zeros(parts + 1, np.int64), np.zeros(parts + 1, np.int64)
    least, most = np.full(parts + 1, math.inf), np.full(parts + 1, -math.inf)
    own = np.zeros(parts, np.int64)
    begun = np.zeros(parts + 1, np.bool_)
    depth, looks = 0, 0
    rest[0] = every
    while depth >= 0:
        looks += 1
        if looks % 1024 == 0 and asked(flag):
            return best, shares, False
        if not begun[depth]:
            if rest[depth] == 0 or depth == parts:  # the parts that are left are empty
                smallest = min(least[depth], 0.0) if depth < parts else least[depth]
                largest = max(most[depth], 0.0) if depth < parts else most[depth]
                if rest[depth] == 0 and largest - smallest < best:
                    best = largest - smallest
                    shares[:] = 0
                    for p in range(depth):
                        shares[p] = own[p]
                depth -= 1
                continue
            begun[depth] = True
            low[depth] = rest[depth] & -rest[depth]
            others[depth] = rest[depth] ^ low[depth]
        elif others[depth] < 0:
            begun[depth] = False
            depth -= 1
            continue
        above = rest[depth] ^ low[depth]
        part = low[depth] | others[depth]
        others[depth] = (others[depth] - 1) & above if others[depth] > 0 else -1
        if depth == parts - 1 and part != rest[depth]:
            others[depth] = -1  # the last part takes all
            continue
        smallest, largest = min(least[depth], cost[part]), max(most[depth], cost[part])
        if largest - smallest < best:
            own[depth] = part
            rest[depth + 1], least[depth + 1], most[depth + 1] = rest[depth] ^ part, smallest, largest
            begun[depth + 1] = False
            depth += 1
    return best, shares, True
