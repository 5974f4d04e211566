"""A whole day in the orchard as one compiled loop. Imports numba: import it inside functions only."""

import numpy as np

from .....formulations.kernels import inner, kernel
from .....formulations.stop_kernel import asked
from .choice_kernels import assignment, beaten, deferred, immediate, serial

OUT, FETCH, WAIT, HAUL, BACK = range(1, 6)


@kernel(
    "(i8[::1], Tuple((i8[:, ::1], i8[:, ::1], i8[:, ::1], i8)), Tuple((i8[::1], i8[:, ::1], i8[::1])), "
    "UniTuple(i8, 2), UniTuple(i8, 3), i8, UniTuple(i8[::1], 3))"
)
def day(flag, grid, start, sizes, rules, limit, times):  # type: ignore[no-untyped-def]
    """Play until all bins are home, ``limit`` steps have passed or ``flag`` is set: the world of ``instances/auctions/worlds/orchard.py``.

    ``grid`` is ``distance, empty, full`` of shape (cells, cells) and the repository's cell; ``start`` is ``cells, orders`` of groups and
    ``fruit`` of cells; ``sizes`` are ``robots, fill``. ``rules`` are ``choice`` (0 greedy, 1 auction, 2 immediate auction, 3 assignment),
    ``delivery`` (0 baseline, 1 proposed) and ``added`` (1: travel and filling are added up in a cost, 0: the larger counts). ``times`` are
    ``stood, full, returned`` of bins, all -1, and are written.

    Returns steps, group steps without a bin, auctions of several robots, and those of them that an assignment beats.
    """
    distance, empty, loaded, home = grid
    begin, orders, fruit = start
    robots, fill = sizes
    choice, delivery, added = rules
    stood, full, returned = times
    groups, bins = len(begin), len(stood)
    group_cell, group_bin, since = np.empty(groups, np.int64), np.empty(groups, np.int64), np.zeros(groups, np.int64)
    for g in range(groups):
        group_cell[g], group_bin[g] = begin[g], g
    group_at, coming, reserve = np.full(len(fruit), -1), np.zeros(len(fruit), np.bool_), np.full(len(fruit), -1)
    cell_of, free, left = np.full(bins, -1), np.zeros(bins, np.bool_), np.full(bins, -1)  # left: steps until full
    state, place, until = np.zeros(robots, np.int64), np.full(robots, home), np.zeros(robots, np.int64)
    brings, target = np.full(robots, -1), np.full(robots, -1)
    idle, offered, told = np.empty(robots, np.int64), np.empty(bins, np.int64), np.zeros(4, np.int64)
    for g in range(groups):
        group_at[begin[g]], cell_of[g], stood[g], free[g], left[g] = g, begin[g], 0, True, fill
    made, t, out = groups, 0, 0
    while t < limit and out < bins and not asked(flag):
        # robots decide
        n, m = 0, 0
        for r in range(robots):
            if state[r] == 0:
                idle[n] = r
                n += 1
        for b in range(bins):
            if free[b]:
                offered[m] = b
                m += 1
        if n > 0:
            costs, ready, near = np.empty((n, m), np.int64), np.empty((n, m), np.int64), np.empty((n, m), np.int64)
            for i in range(n):
                at = place[idle[i]]
                for j in range(m):
                    b = offered[j]
                    travel, ready[i, j], near[i, j] = empty[at, cell_of[b]], left[b], distance[at, cell_of[b]]
                    costs[i, j] = travel + left[b] if added == 1 else max(travel, left[b])
            if choice == 0:
                plan = serial(ready, near)
            elif choice == 3:
                plan = assignment(costs)
            else:
                plan = deferred(costs) if choice == 1 else immediate(costs)
                if n > 1 and m > 0:
                    told[2] += 1
                    told[3] += beaten(costs, plan)
            for k in range(n):
                r = idle[k]
                b = offered[plan[k]] if plan[k] >= 0 else -1
                to = -1
                if place[r] == home:
                    to = _delivery(delivery, b, home, cell_of, group_cell, group_bin, since, group_at, fruit, coming, reserve, empty)
                target[r] = b
                if b >= 0:
                    free[b] = False
                if to >= 0:
                    coming[to], brings[r], cell_of[made] = True, made, to
                    made += 1
                    state[r], until[r], place[r] = OUT, t + empty[home, to], to
                elif b >= 0:
                    state[r], until[r], place[r] = FETCH, t + empty[place[r], cell_of[b]], cell_of[b]
                elif place[r] != home:
                    state[r], until[r], place[r] = BACK, t + empty[place[r], home], home
        for moment in range(2):  # legs of no length end before groups work, the others after it
            if moment == 1:
                _work(t, fill, group_cell, group_bin, since, group_at, reserve, fruit, orders, distance, left, full, told)
                t += 1
            for r in range(robots):
                if state[r] == 0 or until[r] > t:
                    continue
                if state[r] == OUT:
                    b, c = brings[r], place[r]
                    stood[b], free[b], coming[c], brings[r] = t, True, False, -1
                    g = group_at[c]
                    if group_bin[g] < 0:
                        group_bin[g], left[b] = b, fill
                    else:
                        reserve[c], left[b] = b, left[group_bin[g]] + fill
                    b = target[r]
                    if b < 0:
                        state[r] = 0
                        continue
                    state[r], until[r], place[r] = FETCH, t + empty[c, cell_of[b]], cell_of[b]
                if state[r] == FETCH and until[r] <= t:
                    state[r] = WAIT
                if state[r] == WAIT and full[target[r]] >= 0:
                    state[r], until[r], place[r] = HAUL, t + loaded[place[r], home], home
                elif state[r] >= HAUL:
                    if state[r] == HAUL:
                        returned[target[r]] = t
                        out += 1
                    state[r] = 0
    told[0] = t
    return told


@inner
def _delivery(proposed, b, home, cell_of, group_cell, group_bin, since, group_at, fruit, coming, reserve, empty):  # type: ignore[no-untyped-def]
    """The cell to which a robot that will fetch bin ``b`` (-1: none) brings a new one; -1 for none."""
    if b >= 0 and not proposed:
        return -1
    near = home
    if b >= 0:
        near = cell_of[b]
        g = group_at[near]
        if g >= 0 and not coming[near] and reserve[near] < 0 and (group_bin[g] < 0 or fruit[near] > 1):
            return near
    best, key = -1, 0
    for g in range(len(group_cell)):
        c = group_cell[g]
        if c < 0 or group_bin[g] >= 0 or coming[c]:
            continue
        k = empty[near, c] if proposed else since[g]
        if best < 0 or k < key or (k == key and proposed and since[g] < since[group_at[best]]):
            best, key = c, k
    return best


@inner
def _work(t, fill, group_cell, group_bin, since, group_at, reserve, fruit, orders, distance, left, full, told):  # type: ignore[no-untyped-def]
    """Let groups work for a step."""
    for g in range(len(group_cell)):
        c, b = group_cell[g], group_bin[g]
        if c < 0:
            continue
        if b < 0:
            told[1] += 1
            continue
        left[b] -= 1
        if reserve[c] >= 0:
            left[reserve[c]] -= 1
        if left[b] > 0:
            continue
        full[b], group_bin[g], since[g] = t + 1, -1, t + 1
        fruit[c] -= 1
        if fruit[c] > 0:
            if reserve[c] >= 0:
                group_bin[g], reserve[c] = reserve[c], -1
            continue
        to = -1
        if orders.shape[1] > 0:
            for k in range(orders.shape[1]):
                if orders[g, k] >= 0 and fruit[orders[g, k]] > 0 and group_at[orders[g, k]] < 0:
                    to = orders[g, k]
                    break
        else:
            for k in range(len(fruit)):
                if fruit[k] > 0 and group_at[k] < 0 and (to < 0 or distance[c, k] < distance[c, to]):
                    to = k
        group_at[c], group_cell[g] = -1, to
        if to >= 0:
            group_at[to] = g
