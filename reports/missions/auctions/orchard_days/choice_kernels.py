"""Which idle robot fetches which bin, compiled. Imports numba: import it inside functions only.

Costs are whole steps, one row a robot, one column a bin, both in ascending order of their numbers; plans give a column a row, -1 for none.
"""

import numpy as np

from .....formulations.kernels import kernel

FAR = np.int64(1) << 60


@kernel("(i8[:, ::1], i8[:, ::1])")
def serial(first, second):  # type: ignore[no-untyped-def]
    """Each robot in turn takes the bin, of those left, that is least by ``first``, then by ``second``."""
    robots, bins = first.shape
    plan, taken = np.full(robots, -1), np.zeros(bins, np.bool_)
    for i in range(robots):
        best = -1
        for j in range(bins):
            if taken[j]:
                continue
            if best < 0 or first[i, j] < first[i, best] or (first[i, j] == first[i, best] and second[i, j] < second[i, best]):
                best = j
        if best >= 0:
            plan[i], taken[best] = best, True
    return plan


@kernel("(i8[:, ::1],)")
def deferred(costs):  # type: ignore[no-untyped-def]
    """The outcome of the deferred conflict auction: the cheapest pair of a free robot and a free bin, again and again."""
    robots, bins = costs.shape
    plan, taken = np.full(robots, -1), np.zeros(bins, np.bool_)
    for _ in range(min(robots, bins)):
        at, to, least = -1, -1, FAR
        for i in range(robots):
            if plan[i] >= 0:
                continue
            for j in range(bins):
                if not taken[j] and costs[i, j] < least:
                    at, to, least = i, j, costs[i, j]
        plan[at], taken[to] = to, True
    return plan


@kernel("(i8[:, ::1],)")
def immediate(costs):  # type: ignore[no-untyped-def]
    """The conflict auction in which a winner is final: those without a bin bid for their cheapest of those left."""
    robots, bins = costs.shape
    plan, taken = np.full(robots, -1), np.zeros(bins, np.bool_)
    wins = np.full(bins, -1)
    for _ in range(min(robots, bins)):
        wins[:] = -1
        for i in range(robots):
            if plan[i] >= 0:
                continue
            best = -1
            for j in range(bins):
                if not taken[j] and (best < 0 or costs[i, j] < costs[i, best]):
                    best = j
            if best >= 0 and (wins[best] < 0 or costs[i, best] < costs[wins[best], best]):
                wins[best] = i
        for j in range(bins):
            if wins[j] >= 0:
                plan[wins[j]], taken[j] = j, True
    return plan


@kernel("(i8[:, ::1],)")
def assignment(costs):  # type: ignore[no-untyped-def]
    """An assignment of as many pairs as there can be of the least sum, by shortest augmenting paths (Jonker and Volgenant 1987)."""
    robots, bins = costs.shape
    n, m = min(robots, bins), max(robots, bins)  # each of the fewer gets one of the others
    turned = robots > bins
    if turned:
        other = np.empty((n, m), np.int64)
        for i in range(n):
            for j in range(m):
                other[i, j] = costs[j, i]
        costs = other
    u, v = np.zeros(n + 1, np.int64), np.zeros(m + 1, np.int64)
    row, way = np.zeros(m + 1, np.int64), np.zeros(m + 1, np.int64)  # rows and columns count from 1 here; 0 is none
    least, done = np.empty(m + 1, np.int64), np.empty(m + 1, np.bool_)
    for i in range(1, n + 1):
        row[0], at = i, 0
        least[:] = FAR
        done[:] = False
        while row[at] != 0:
            done[at] = True
            here, step, to = row[at], FAR, 0
            for j in range(1, m + 1):
                if done[j]:
                    continue
                reduced = costs[here - 1, j - 1] - u[here] - v[j]
                if reduced < least[j]:
                    least[j], way[j] = reduced, at
                if least[j] < step:
                    step, to = least[j], j
            for j in range(m + 1):
                if done[j]:
                    u[row[j]] += step
                    v[j] -= step
                else:
                    least[j] -= step
            at = to
        while at != 0:
            row[at] = row[way[at]]
            at = way[at]
    plan = np.full(robots, -1)
    for j in range(1, m + 1):
        if row[j] > 0:
            i, to = (j, row[j]) if turned else (row[j], j)
            plan[i - 1] = to - 1
    return plan


@kernel("(i8[:, ::1], i8[::1])")
def beaten(costs, plan):  # type: ignore[no-untyped-def]
    """Whether another plan of as many pairs costs less; sums of least entries, a bound, decide most of the time."""
    robots, bins = costs.shape
    total, rows, columns = 0, 0, 0
    for i in range(robots):
        if plan[i] >= 0:
            total += costs[i, plan[i]]
        least = costs[i, 0]
        for j in range(bins):
            least = min(least, costs[i, j])
        rows += least
    if robots <= bins and total == rows:
        return False
    for j in range(bins):
        least = costs[0, j]
        for i in range(robots):
            least = min(least, costs[i, j])
        columns += least
    if robots >= bins and total == columns:
        return False
    best, least = assignment(costs), np.int64(0)
    for i in range(robots):
        if best[i] >= 0:
            least += costs[i, best[i]]
    return total > least
