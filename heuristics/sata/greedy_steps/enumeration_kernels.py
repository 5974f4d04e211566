"""Depth-first enumeration of all answers, with what cannot win cut off, compiled."""

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked
from ....solvers.bounds.sata.gain_kernels import OVER_ITEMS, gain, take


@kernel(f"(i8[::1], i8[::1], i8[::1], i8[::1], f8[::1], f8[::1], f8, f8[::1], b1, i8, {OVER_ITEMS})")
def best_set(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, slot_group, starts, members, rest, costs, budget, tail, optional, items, layout, indptr, indices, weights, matrix, single
):
    """The set of largest value: each slot holds an element of its group, ascending within a group.

    ``rest[t]`` bounds what the slots from t on can add; with ``optional`` (a knapsack: a slot an element) ``tail[k]`` bounds what the
    members from place k on can add. Returns ``(value, picks, sets looked at, whether it came to its end)``, of the sets those that are full
    (with ``optional`` all of them); with the ``flag`` set, the best of those.
    """
    slots = len(slot_group)
    best = np.zeros((slots + 1, items))
    place = np.full(slots + 1, -1)
    chosen, winner = np.empty(slots, np.int64), np.empty(0, np.int64)
    value, left = np.zeros(slots + 1), np.zeros(slots + 1)
    left[0] = budget
    most, looked, t = 0.0, 0, 0
    while t >= 0 and not asked(flag):
        if t == slots:
            t -= 1
            continue
        g = slot_group[t]
        # The first visit of a slot starts behind the one before it in the same group.
        if place[t] < 0:
            place[t] = place[t - 1] if t > 0 and slot_group[t - 1] == g else starts[g]
        k = place[t]
        if k >= starts[g + 1]:
            place[t] = -1
            t -= 1
            continue
        place[t] = k + 1
        e = members[k]
        if costs[e] > left[t]:
            continue
        reached = value[t] + gain(e, best[t], layout, indptr, indices, weights, matrix, single)
        looked += optional or t + 1 == slots
        chosen[t] = e
        if reached > most:
            most = reached
            winner = np.empty(t + 1, np.int64)
            for h in range(t + 1):
                winner[h] = chosen[h]
        if t + 1 == slots or reached + (tail[k + 1] if optional else rest[t + 1]) <= most:
            continue
        for j in range(items):
            best[t + 1, j] = best[t, j]
        take(e, best[t + 1], layout, indptr, indices, weights, matrix, single)
        value[t + 1], left[t + 1] = reached, left[t] - costs[e]
        t += 1
    return most, winner, looked, t < 0


@kernel("(i8[::1], i4[::1], i4[::1], read(i4[::1]), read(i4[::1]), read(f8[::1]), f8[:, ::1])")
def best_bottleneck(flag, starts, actions, indptr, indices, weights, rest):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """One action per robot such that the worst target is covered best; ``rest[i, j]`` bounds what robots from i on can give target j."""
    robots, targets = len(starts) - 1, rest.shape[1]
    covered = np.zeros((robots + 1, targets))
    place = np.full(robots + 1, -1)
    chosen, winner = np.full(robots, -1), np.full(robots, -1)
    most, looked, t = -1.0, 0, 0
    while t >= 0 and not asked(flag):
        if t == robots:
            looked += 1
            worst = np.inf
            for j in range(targets):
                worst = min(worst, covered[t, j])
            if worst > most:
                most = worst
                for i in range(robots):
                    winner[i] = chosen[i]
            t -= 1
            continue
        if place[t] < 0:
            place[t] = starts[t]
            if starts[t] == starts[t + 1]:  # a robot without actions
                place[t] += 1
                for j in range(targets):
                    covered[t + 1, j] = covered[t, j]
                t += 1
                continue
        if place[t] >= starts[t + 1]:
            place[t] = -1
            t -= 1
            continue
        a = actions[place[t]]
        place[t] += 1
        for j in range(targets):
            covered[t + 1, j] = covered[t, j]
        for p in range(indptr[a], indptr[a + 1]):
            covered[t + 1, indices[p]] += weights[p]
        hope = np.inf
        for j in range(targets):
            hope = min(hope, covered[t + 1, j] + rest[t + 1, j])
        if hope > most:
            chosen[t] = a
            t += 1
    return most, winner, looked, t < 0
