"""The least cost of a walk without i-j-i whose levels are whole numbers, compiled: the checker's own dynamic program."""

import math

import numpy as np

from ...kernels import kernel
from ...stop_kernel import asked


@kernel("f8(i8[::1], i8[::1], i8[::1], f8[::1], i8[::1], f8[::1], i8[::1], f8[::1], i8[::1], i8[::1], i8[::1])")
def least_walk(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, tails, cost, weight, first_cost, first_weight, last_cost, last_weight, lower, upper
):
    """Least cost of a walk from the depot over at least one customer and back; infinite if there is none, NaN where it was stopped.

    ``best[j, b]`` is the least cost of arriving at ``j`` at a level of at most ``b``, over the predecessor ``before[j, b]``, and
    ``second[j, b]`` the least over any other predecessor. Moves between customers into node ``j`` are those from ``starts[j]`` up to
    ``starts[j + 1]``, with whole weights of at least 1; those out of the depot and into it have shape (nodes,), infinite where there is
    none. A level is raised to ``lower``, and is ``upper`` at most; entry 0 is for the return. ``flag`` is that of a ``Stop``.
    """
    nodes, steps = len(lower), 1
    for j in range(1, nodes):
        steps = max(steps, upper[j] + 1)
    best, second = np.full((nodes, steps), math.inf), np.full((nodes, steps), math.inf)
    before = np.full((nodes, steps), -1, np.int32)
    least = math.inf
    for b in range(steps):
        if asked(flag):
            return math.nan
        for j in range(1, nodes):
            if b < lower[j] or b > upper[j]:
                continue
            one, two, who = math.inf, math.inf, np.int32(-1)
            if b > lower[j]:
                one, two, who = best[j, b - 1], second[j, b - 1], before[j, b - 1]
            if first_weight[j] <= b and first_cost[j] < one:
                one, two, who = first_cost[j], one if who != 0 else two, np.int32(0)
            elif first_weight[j] <= b and who != 0 and first_cost[j] < two:
                two = first_cost[j]
            for k in range(starts[j], starts[j + 1]):
                i = tails[k]
                at = b - weight[k]
                if at < lower[i]:
                    continue
                at = min(at, upper[i])
                value = cost[k] + (best[i, at] if before[i, at] != j else second[i, at])
                if i == who:
                    one = min(one, value)
                elif value < one:
                    one, two, who = value, one, np.int32(i)
                elif value < two:
                    two = value
            best[j, b], second[j, b], before[j, b] = one, two, who
            if b + last_weight[j] <= upper[0]:
                least = min(least, one + last_cost[j])
    return least
