"""Cheapest paths through every set of tasks, and the best way to share all tasks among robots, compiled.

A set is a whole number whose bit t says whether task t is in it. Imports numba: import it inside functions only.
"""

import math

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked


@kernel("f8[:, ::1](i8[::1], f8[:, ::1], b1)")
def costs_to_go(flag, between, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Least cost of doing every set of tasks, starting from each task outside it, shape (2^tasks, tasks); meaningless if stopped.

    With ``waiting`` a leg counts once for each task still to be done (the sum of all tasks' ways), else once.
    """
    n = len(between)
    found = np.zeros((1 << n, n))
    for members in range(1, 1 << n):
        if asked(flag):
            break
        count = 0
        for j in range(n):
            count += (members >> j) & 1
        times = float(count) if waiting else 1.0
        for i in range(n):
            best = math.inf
            if not (members >> i) & 1:
                for j in range(n):
                    if (members >> j) & 1:
                        best = min(best, times * between[i, j] + found[members ^ (1 << j), j])
            found[members, i] = best
    return found


@kernel("f8[:, ::1](i8[::1], f8[:, ::1], f8[:, ::1], b1)")
def costs_of_robots(flag, starts, to_go, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Least cost of every set for each robot, shape (robots, 2^tasks); the empty set costs nothing."""
    robots, n = starts.shape
    found = np.zeros((robots, 1 << n))
    for members in range(1, 1 << n):
        if asked(flag):
            break
        count = 0
        for j in range(n):
            count += (members >> j) & 1
        times = float(count) if waiting else 1.0
        for r in range(robots):
            best = math.inf
            for j in range(n):
                if (members >> j) & 1:
                    best = min(best, times * starts[r, j] + to_go[members ^ (1 << j), j])
            found[r, members] = best
    return found


@kernel("Tuple((f8, i8[::1]))(i8[::1], f8[:, ::1], b1)")
def best_shares(flag, cost, largest):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The best way to share all elements among parts: its value, infinite where it was asked to stop, and the set of each part.

    ``cost`` is that of every set in each part, shape (parts, 2^elements); with ``largest`` the largest cost counts, else the sum.
    """
    parts, sets = cost.shape
    best = np.empty((parts, sets))
    own = np.zeros((parts, sets), np.int64)
    for members in range(sets):
        best[0, members] = cost[0, members]
        own[0, members] = members
    every = sets - 1
    for p in range(1, parts):
        for members in range(every if p == parts - 1 else 0, sets):
            if asked(flag):
                return math.inf, np.zeros(parts, np.int64)
            least, chosen = math.inf, 0
            part = members
            while True:
                before, here = best[p - 1, members ^ part], cost[p, part]
                both = max(before, here) if largest else before + here
                if both < least:
                    least, chosen = both, part
                if part == 0:
                    break
                part = (part - 1) & members
            best[p, members] = least
            own[p, members] = chosen
    shares = np.zeros(parts, np.int64)
    left = every
    for p in range(parts - 1, -1, -1):
        shares[p] = own[p, left]
        left ^= shares[p]
    return best[parts - 1, every], shares


@kernel("i8[::1](f8[::1], f8[:, ::1], f8[:, ::1], i8, b1)")
def path_through(start, between, to_go, members, waiting):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The cheapest path of a robot through a set, the lower task where two cost the same."""
    n = len(start)
    count = 0
    for j in range(n):
        count += (members >> j) & 1
    path = np.empty(count, np.int64)
    at = -1
    for k in range(count):
        times = float(count - k) if waiting else 1.0
        best, chosen = math.inf, -1
        for j in range(n):
            if (members >> j) & 1:
                leg = start[j] if at < 0 else between[at, j]
                cost = times * leg + to_go[members ^ (1 << j), j]
                if cost < best:
                    best, chosen = cost, j
        path[k] = chosen
        members ^= 1 << chosen
        at = chosen
    return path
