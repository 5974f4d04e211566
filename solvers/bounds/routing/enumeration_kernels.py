"""All routes below a reduced cost, compiled, by labels that grow a visit at a time. Imports numba: import it inside functions only."""

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked
from .route_levels import DONE, FULL, STOPPED, WORD

SLOTS = 1 << 18
"""Places of a table in which sets are looked up, a power of two."""


@kernel(_nrt=False, no_cpython_wrapper=True)
def completed(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    base, below, level, j, seen, members, others, after, chains, cheapest, lower, upper
):
    """Whether some label from the other end completes one that comes to node j, for less than ``below`` together; ``level`` (levels,) is
    the most that it may have, ``seen`` (words,) who was visited."""
    levels, buckets = len(level), chains.shape[1]
    if level[0] < lower[j, 0]:
        return False
    last = min(buckets - 1, (level[0] - lower[j, 0]) // ((upper[j, 0] - lower[j, 0]) // buckets + 1))
    mine, ready, one = 0, False, 1
    for b in range(last + 1):
        if base + cheapest[j, b] >= below:
            continue
        if not ready:
            for p in range(members.shape[1]):
                who = members[j, p]
                if who >= 0 and seen[who // WORD] >> (who % WORD) & 1:
                    mine |= one << p
            ready = True
        k = chains[j, b]
        while k >= 0 and base + others[k, 0] < below:
            if others[k, levels + 1] & mine == 0:
                fits = True
                for r in range(levels):
                    fits = fits and others[k, 1 + r] <= level[r]
                if fits:
                    return True
            k = after[k]
    return False


@kernel(
    "Tuple((i8, i8))(i8[::1], i4[::1], i4[::1], i8[::1], i8[:, ::1], i8[::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], "
    "i8[:, ::1], i8[::1], i4[:, ::1], i8[:, ::1], i4[::1], i4[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[::1], i8[::1], i8[::1], i8, "
    "i4[::1], i4[::1], i4[::1], i8[::1])"
)
def all_below(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, arcs, heads, paid, weight, worth, rows_of, fines, loads_of, gains, lower, upper, above, members,
    others, after, chains, cheapest, back_lower, back_upper, top, start, keys, below, node, parent, ended, total,
):  # fmt: skip
    """Routes that visit nobody twice, of reduced costs ``below`` a number, of each set of customers the one whose moves cost least.

    Arcs, levels and labels from the other end are as for ``grow``. Moves cost ``paid`` (arcs,), visits are ``worth`` (nodes,), each second
    visit to the members of a row, ``rows_of`` (nodes, words), costs its share of ``fines`` (words, WORD), the first to those of a load,
    ``loads_of``, gains that of ``gains``. Sums of ``keys`` (nodes,) tell sets apart. ``node`` and ``parent`` receive the labels, ``ended``
    the last label of each route, and ``total`` what its moves cost, as many as there is room for. Returns whether it was done, stopped or
    full, and the number of routes.
    """
    nodes, levels, rows, loads, room = len(chains), lower.shape[1], rows_of.shape[1], loads_of.shape[1], len(node)
    words, one = (nodes + WORD - 1) // WORD, 1
    slots, places, known, link = SLOTS - 1, np.full(SLOTS, -1, np.int32), np.full(SLOTS, -1, np.int32), np.empty(room, np.int32)
    next_route = np.full(len(ended), -1, np.int32)
    key, moves, cost = np.empty(room, np.int64), np.empty(room, np.int64), np.empty(room, np.int64)
    level, seen = np.empty((room, levels), np.int64), np.empty((room, words), np.int64)
    half, hit = np.empty((room, rows), np.int64), np.empty((room, loads), np.int64)
    left, new = np.zeros(levels, np.int64), np.zeros(levels, np.int64)
    for r in range(levels):
        level[0, r] = start[r]
    node[0], parent[0] = 0, -1
    key[0], moves[0], cost[0], seen[0], half[0], hit[0] = 0, 0, 0, 0, 0, 0
    count, number, begin = 1, 0, 0
    while begin < count:
        end = count  # all labels from here on have a visit more
        for label in range(begin, end):
            if asked(flag):
                return STOPPED, number
            i = node[label]
            for a in range(arcs[i], arcs[i + 1]):
                j = heads[a]
                if (j == 0 and i == 0) or seen[label, j // WORD] >> (j % WORD) & 1:
                    continue
                fits = True
                for r in range(levels):
                    new[r] = max(level[label, r] + weight[a, r], lower[j, r])
                    left[r] = top[r] - level[label, r] - weight[a, r]
                    fits = fits and new[r] <= upper[j, r]
                for r in range(levels):
                    if above[r] >= 0 and new[above[r]] > new[r]:
                        new[r] = new[above[r]]
                        fits = fits and new[r] <= upper[j, r]
                if not fits:
                    continue
                value = cost[label] + paid[a] - worth[j]
                if j == 0:
                    if value >= below:
                        continue
                    k = known[key[label] & slots]
                    while k >= 0 and key[ended[k]] != key[label]:
                        k = next_route[k]
                    if k < 0:
                        if number == len(ended):
                            return FULL, number
                        k, number = number, number + 1
                        next_route[k], known[key[label] & slots] = known[key[label] & slots], k
                        ended[k], total[k] = label, moves[label] + paid[a]
                    elif moves[label] + paid[a] < total[k]:
                        ended[k], total[k] = label, moves[label] + paid[a]
                    continue
                for w in range(loads):
                    due, q = loads_of[j, w] & ~hit[label, w], 0
                    while due:
                        if due & 1:
                            value -= gains[w, q]
                        due >>= 1
                        q += 1
                if not completed(
                    value, below, left, j, seen[label], members, others, after, chains, cheapest, back_lower, back_upper
                ):  # fmt: skip
                    continue
                for w in range(rows):
                    due, q = half[label, w] & rows_of[j, w], 0
                    while due:
                        if due & 1:
                            value += fines[w, q]
                        due >>= 1
                        q += 1
                mine, spent, place = key[label] ^ keys[j], moves[label] + paid[a], -1
                at = (mine + j * 40503) & slots
                k, stays = places[at], True
                while k >= end and stays:
                    if node[k] == j and key[k] == mine:
                        better, worse = spent <= moves[k], moves[k] <= spent
                        for r in range(levels):
                            better, worse = better and new[r] <= level[k, r], worse and level[k, r] <= new[r]
                        stays = not worse
                        if better:
                            place = k
                    k = link[k]
                if not stays:
                    continue
                if place < 0:
                    if count == room:
                        return FULL, number
                    place, count = count, count + 1
                    link[place], places[at] = places[at], place
                    node[place], key[place] = j, mine
                    for w in range(words):
                        seen[place, w] = seen[label, w]
                    seen[place, j // WORD] |= one << (j % WORD)
                    for w in range(rows):
                        half[place, w] = half[label, w] ^ rows_of[j, w]
                    for w in range(loads):
                        hit[place, w] = hit[label, w] | loads_of[j, w]
                parent[place], moves[place], cost[place] = label, spent, value
                for r in range(levels):
                    level[place, r] = new[r]
        begin = end
    return DONE, number
