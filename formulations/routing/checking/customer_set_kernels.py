"""Least walks through each set of a few customers, and least ways to divide a set among routes, compiled: the checker's own."""

import math

import numpy as np

from ...kernels import kernel
from ...stop_kernel import asked


@kernel("f8[:,::1](i8[::1], f8[:,:,::1], f8[:,:,::1], f8[::1], f8[:,::1], f8[:,::1], i8[::1])")
def set_values(flag, costs, weights, start, lower, upper, before):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Least of each cost of a route through exactly the customers of each set, a mask; inf without one, NaN where it was stopped.

    The least level of each resource at the last customer of a set, and each cost, are found by themselves over all orders that no level
    alone rules out (Held, Karp 1962). ``costs`` of shape (costs, nodes, nodes), node 0 being the depot, are infinite in the first of them
    where there is no move; ``weights`` have shape (resources, nodes, nodes), ``lower`` and ``upper`` (resources, nodes), where entry 0 is
    for the return; ``before`` is a mask of who must have been visited before each customer; ``flag`` is that of a ``Stop``.
    """
    n, many, kinds = len(before), len(start), len(costs)
    level = np.full((1 << n, n, many), math.inf)
    cost = np.full((1 << n, n, kinds), math.inf)
    values = np.full((kinds, 1 << n), math.inf)
    for members in range(1, 1 << n):
        if asked(flag):
            values[0, 0] = math.nan
            return values
        for j in range(n):
            rest = members & ~(1 << j)
            if rest == members or before[j] & ~rest:
                continue
            if rest == 0:
                if costs[0, 0, j + 1] == math.inf:
                    continue
                for r in range(many):
                    level[members, j, r] = start[r] + weights[r, 0, j + 1]
                for c in range(kinds):
                    cost[members, j, c] = costs[c, 0, j + 1]
            else:
                for i in range(n):
                    if not rest >> i & 1 or cost[rest, i, 0] == math.inf or costs[0, i + 1, j + 1] == math.inf:
                        continue
                    for r in range(many):
                        level[members, j, r] = min(level[members, j, r], level[rest, i, r] + weights[r, i + 1, j + 1])
                    for c in range(kinds):
                        cost[members, j, c] = min(cost[members, j, c], cost[rest, i, c] + costs[c, i + 1, j + 1])
            for r in range(many):
                level[members, j, r] = max(level[members, j, r], lower[r, j + 1])
                if level[members, j, r] > upper[r, j + 1]:
                    for c in range(kinds):
                        cost[members, j, c] = math.inf
            if cost[members, j, 0] == math.inf or costs[0, j + 1, 0] == math.inf:
                continue
            home = True
            for r in range(many):
                home = home and level[members, j, r] + weights[r, j + 1, 0] <= upper[r, 0]
            if home:
                for c in range(kinds):
                    values[c, members] = min(values[c, members], cost[members, j, c] + costs[c, j + 1, 0])
    return values


@kernel("f8[:,::1](i8[::1], f8[:,::1], i8[::1], f8[::1])")
def with_route(flag, best, sets, values):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``best``, or less with one more route through one of ``sets``; NaN first where it was stopped.

    ``best`` of shape (counts, 2^customers) is the least value of routes through each set of customers, by their number; the last counts
    for all larger ones.
    """
    joined = best.copy()
    last, full = len(best) - 1, best.shape[1] - 1
    for t in range(len(sets)):
        if asked(flag):
            joined[0, 0] = math.nan
            return joined
        mine, others = sets[t], full & ~sets[t]
        for k in range(last + 1):
            more = min(k + 1, last)
            rest = others
            while True:
                value = best[k, rest] + values[t]
                if value < joined[more, rest | mine]:
                    joined[more, rest | mine] = value
                if rest == 0:
                    break
                rest = (rest - 1) & others
    return joined
