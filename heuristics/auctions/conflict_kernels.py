"""Rounds of bids of robots for bins, compiled. Imports numba: import it inside functions only."""

import numpy as np

from ...formulations.kernels import kernel
from ...formulations.stop_kernel import asked


@kernel("(i8[::1], i8[::1], i8[::1], read(f8[::1]), i8, b1)")
def conflict_rounds(flag, indptr, bins, cost, num_bins, final):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Every robot without a bin bids for its cheapest one, the lowest cost wins, losers go on to their next one.

    ``indptr``, ``bins`` and ``cost`` are the pairs of each robot, cheapest first. With ``final`` a bin that is won is offered no more; else
    a cheaper later bid wins it. Returns the bin of each robot (-1 for none), rounds, bids, and whether it came to its end.
    """
    n = len(indptr) - 1
    place, holder, offered = np.empty(n, np.int64), np.full(num_bins, -1), np.full(num_bins, -1)
    for i in range(n):
        place[i] = indptr[i]
    taken = np.full(n, -1)
    active = np.ones(n, np.bool_)
    rounds, bids = 0, 0
    while True:
        any_bid = False
        for i in range(n):
            if not active[i]:
                continue
            if i & 127 == 0 and asked(flag):
                return taken, rounds, bids, False
            while final and place[i] < indptr[i + 1] and holder[bins[place[i]]] >= 0:
                place[i] += 1
            if place[i] == indptr[i + 1]:
                active[i] = False
                continue
            any_bid = True
            bids += 1
            j = bins[place[i]]
            best = offered[j]
            if best < 0 or cost[place[i]] < cost[place[best]]:
                offered[j] = i
        if not any_bid:
            return taken, rounds, bids, True
        rounds += 1
        for i in range(n):  # who is not the cheapest of this round goes on
            if active[i] and offered[bins[place[i]]] != i:
                place[i] += 1
        for j in range(num_bins):
            i, before = offered[j], holder[j]
            if i < 0:
                continue
            offered[j] = -1
            if before >= 0 and (cost[place[before]] < cost[place[i]] or (cost[place[before]] == cost[place[i]] and before < i)):
                place[i] += 1
                continue
            if before >= 0:
                taken[before], active[before] = -1, True
                place[before] += 1
            holder[j], taken[i], active[i] = i, j, False


@kernel("(i8[::1], i8[::1], i8[::1], read(f8[::1]), i8, i8[::1])")
def serial_choice(flag, indptr, bins, cost, num_bins, order):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """One robot after the other takes its cheapest free bin, the first of equal ones: bin of each robot or -1, and whether it came to its
    end."""
    taken = np.full(len(indptr) - 1, -1)
    free = np.ones(num_bins, np.bool_)
    for turn in range(len(order)):
        if asked(flag):
            return taken, False
        i = order[turn]
        best = -1
        for k in range(indptr[i], indptr[i + 1]):
            if free[bins[k]] and (best < 0 or cost[k] < cost[best]):
                best = k
        if best >= 0:
            taken[i] = bins[best]
            free[bins[best]] = False
    return taken, True


@kernel("(i8[::1], read(f8[:, ::1]), f8)")
def quadrangle_broken(flag, matrix, slack):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Whether some c_ij exceeds c_il + c_kl + c_kj by more than ``slack`` of it: 1, 0, or -1 where it was stopped."""
    n, m = matrix.shape
    for i in range(n):
        for k in range(n):
            if asked(flag):
                return -1
            most, least = -np.inf, np.inf
            for j in range(m):
                most = max(most, matrix[i, j] * (1.0 - slack) - matrix[k, j])
                least = min(least, matrix[i, j] + matrix[k, j])
            if most > least:
                return 1
    return 0
