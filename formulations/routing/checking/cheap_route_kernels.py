"""All routes below a reduced cost, each set of customers once, in whole numbers, compiled: the checker's own list."""

import numpy as np

from ...kernels import kernel
from ...stop_kernel import asked
from .walk_kernels import NETWORK
from .walk_networks import BITS, DONE, FULL, STOPPED, Network

_NAMED = (Network,)
"""The named tuple that these types name."""

SLOTS = 1 << 18
"""Places of a table in which sets are looked up, a power of two."""


@kernel(_nrt=False, no_cpython_wrapper=True)
def _same(one, k, other, m):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Whether two rows have the same bits."""
    same = True
    for w in range(one.shape[1]):
        same = same and one[k, w] == other[m, w]
    return same


@kernel(
    f"Tuple((i8, i8, i8[:, ::1], i8[::1]))(i8[::1], {NETWORK}, i8[:, :, :, ::1], i8[::1], i8[::1], i8[:, ::1], i8[::1], i8[:, ::1], "
    "i8[::1], i8[::1], i8, i8, i8, i8)"
)
def cheap_routes(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, network, rest, paid, worth, inside, fines, among, gains, keys, limit, room, most, work
):
    """The sets of customers of all routes that visit nobody twice, keep their levels, and have reduced costs below ``limit``.

    A reduced cost is what the moves cost, ``paid`` (moves,), less the ``worth`` (nodes,) of visits, plus ``fines`` (rows,) for each second
    visit to the members of a row, ``inside`` (nodes, words), less ``gains`` (loads,) once for each set of which a member is visited,
    ``among`` (nodes, words). Of one set all of that is the same but what its moves cost: of two ways to one customer over the same others
    the one that costs no more and has no higher level stands for both. ``rest``, from ``completions``, is at most what is left to pay;
    sums of ``keys`` (nodes,) tell sets apart, nearly always. ``room`` is the most labels of as many visits each, ``most`` the most sets,
    ``work`` the most moves and comparisons. Returns whether it was done, stopped or had no room, the number of sets, their bits, of shape
    (most, words), and the least that the moves of a route through each cost.
    """
    first, moves, start, lower, upper, above, grid = network[:7]
    nodes, levels, rows, loads = len(first) - 1, len(start), inside.shape[1], among.shape[1]
    words = (nodes + BITS - 1) // BITS
    base, shift, mixed = grid[0], grid[1], above.max() >= 0
    slots, tables = SLOTS - 1, np.full(SLOTS, -1, np.int32)
    node, key = np.empty((2, room), np.int32), np.empty((2, room), np.int64)
    label = np.empty((2, room, 2 + levels), np.int64)  # what the moves cost, the reduced cost, levels
    seen, half, hit = np.empty((2, room, words), np.int64), np.empty((2, room, rows), np.int64), np.empty((2, room, loads), np.int64)
    link = np.empty(room, np.int32)
    sets, least, known = np.empty((most, words), np.int64), np.empty(most, np.int64), np.empty(most, np.int64)
    chain, ended = np.empty(most, np.int32), np.full(SLOTS, -1, np.int32)
    new = np.zeros(2 + levels, np.int64)
    # What is never written takes no memory.
    node[0, 0], key[0, 0], label[0, 0], seen[0, 0], half[0, 0], hit[0, 0] = 0, 0, 0, 0, 0, 0
    for r in range(levels):
        label[0, 0, 2 + r] = start[r]
    count, number, looked, now = 1, 0, 0, 0
    while count > 0:
        then, more = 1 - now, 0
        tables[:] = -1
        for one in range(count):
            if asked(flag):
                return STOPPED, 0, sets, least
            if looked > work:
                return FULL, 0, sets, least
            tail = node[now, one]
            looked += first[tail + 1] - first[tail]
            for m in range(first[tail], first[tail + 1]):
                head = moves[m, 0]
                if (head == 0 and tail == 0) or seen[now, one, head // BITS] >> (head % BITS) & 1:
                    continue
                fits = True
                for r in range(levels):
                    new[2 + r] = max(label[now, one, 2 + r] + moves[m, 3 + r], lower[head, r])
                    fits = fits and new[2 + r] <= upper[head, r]
                for r in range(levels if mixed else 0):
                    if above[r] >= 0 and new[2 + above[r]] > new[2 + r]:
                        new[2 + r] = new[2 + above[r]]
                        fits = fits and new[2 + r] <= upper[head, r]
                if not fits:
                    continue
                new[0], new[1] = label[now, one, 0] + paid[m], label[now, one, 1] + paid[m]
                if head == 0:
                    if new[1] >= limit:
                        continue
                    at = key[now, one] & slots
                    k = ended[at]
                    while k >= 0 and not (known[k] == key[now, one] and _same(sets, k, seen[now], one)):
                        k = chain[k]
                    if k < 0:
                        if number == most:
                            return FULL, 0, sets, least
                        k = number
                        number += 1
                        known[k], least[k], chain[k], ended[at] = key[now, one], new[0], ended[at], k
                        for w in range(words):
                            sets[k, w] = seen[now, one, w]
                    least[k] = min(least[k], new[0])
                    continue
                new[1] -= worth[head]
                cell = (new[2] - base) >> shift
                after = rest[0, head, cell, 2]
                back = after > 0 and seen[now, one, after // BITS] >> (after % BITS) & 1
                beyond = rest[0, head, cell, 1 if back else 0]
                for w in range(rows):
                    due, q = half[now, one, w] & inside[head, w], BITS * w
                    while due != 0:
                        if due & 1:
                            new[1] += fines[q]
                        due >>= 1
                        q += 1
                for w in range(loads):
                    due, q = among[head, w] & ~hit[now, one, w], BITS * w
                    while due != 0:
                        if due & 1:
                            new[1] -= gains[q]
                        due >>= 1
                        q += 1
                if new[1] + beyond >= limit:
                    continue
                mine = key[now, one] + keys[head]
                at = (mine ^ (head * 0x9E3779B97F4A7)) & slots
                k, place, stays = tables[at], -1, True
                while k >= 0 and stays:
                    looked += 1
                    if node[then, k] == head and key[then, k] == mine:
                        better, worse = new[0] <= label[then, k, 0], label[then, k, 0] <= new[0]
                        for r in range(2, 2 + levels):
                            better = better and new[r] <= label[then, k, r]
                            worse = worse and label[then, k, r] <= new[r]
                        if better or worse:
                            for w in range(words):
                                bits = seen[now, one, w] | (1 << (head % BITS) if w == head // BITS else 0)
                                better, worse = better and bits == seen[then, k, w], worse and bits == seen[then, k, w]
                        stays = not worse
                        if better:
                            place = k
                    k = link[k]
                if not stays:
                    continue
                if place < 0:
                    if more == room:
                        return FULL, 0, sets, least
                    place = more
                    more += 1
                    node[then, place], key[then, place], link[place], tables[at] = head, mine, tables[at], place
                    for w in range(words):
                        seen[then, place, w] = seen[now, one, w]
                    seen[then, place, head // BITS] |= 1 << (head % BITS)
                    for w in range(rows):
                        half[then, place, w] = half[now, one, w] ^ inside[head, w]
                    for w in range(loads):
                        hit[then, place, w] = hit[now, one, w] | among[head, w]
                for r in range(2 + levels):
                    label[then, place, r] = new[r]
        now, count = then, more
    return DONE, number, sets, least
