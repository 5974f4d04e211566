"""The least reduced cost of a walk from the depot and back, in whole numbers, compiled: the checker's own labels."""

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from ...kernels import kernel
from ...stop_kernel import asked
from .walk_networks import BITS, DONE, FAR, FULL, STOPPED, Network

CHUNK = 64
"""Kept labels that are sorted together."""

ROUNDS = 20
"""Passes over the moves within a cell; what does not settle by then bounds nothing."""

_NAMED = (Network,)
"""The named tuple that these types name."""

NETWORK = (
    "named(Network, i8[::1], i8[:, ::1], i8[::1], i8[:, ::1], i8[:, ::1], i8[::1], i8[::1], i4[:, ::1], i4[:, ::1], i8[:, :, ::1], "
    "i4[:, ::1], i4[:, ::1], i8[:, ::1], i8[:, ::1])"
)


@intrinsic  # type: ignore[untyped-decorator]
def lowest(typing: Any, word: Any) -> Any:
    """Position of the lowest bit that is set."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], ir.Constant(ir.IntType(1), 1))

    return types.int64(types.int64), code


@kernel(f"i8[:, :, :, ::1](i8[::1], {NETWORK}, i8)")
def completions(flag, network, layers):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """At most what any walk costs from a node on, at a level within a cell or above; FAR where none comes back.

    Of all levels only the first counts, and of all that is remembered only whether a walk goes back at once: the best and the second
    way on, over different nodes, are enough for that (Christofides, Mingozzi, Toth 1981). Entry [0] of the result is for all walks, [1],
    with two ``layers``, for those that make a needed move from there on. Nothing is bounded where the flag is set meanwhile.
    """
    first, moves, lower, upper, place = network.first, network.moves, network.lower, network.upper, network.place
    base, shift, cells = network.grid[0], network.grid[1], network.grid[2]
    nodes = len(first) - 1
    rest = np.full((layers, nodes, cells, 3), FAR)
    new = np.empty((layers, 3), np.int64)
    for c in range(cells - 1, -1, -1):
        if asked(flag):
            break
        begin = base + (c << shift)
        settled = False
        for _ in range(ROUNDS):
            within, changed = False, False
            for i in range(1, nodes):
                level = max(begin, lower[i, 0])
                if level > upper[i, 0] or (level - base) >> shift != c:
                    continue
                for layer in range(layers):
                    new[layer, 0], new[layer, 1], new[layer, 2] = FAR, FAR, -1
                for m in range(first[i], first[i + 1]):
                    head = moves[m, 0]
                    arrival = max(level + moves[m, 3], lower[head, 0])
                    if arrival > upper[head, 0]:
                        continue
                    to = (arrival - base) >> shift
                    within = within or (to == c and head > 0)
                    for layer in range(layers):
                        wanted = layer & (1 - moves[m, 1])
                        if head == 0:
                            total = FAR if wanted else 0
                        else:
                            back = rest[wanted, head, to, 2] == i and place[head, i] >= 0
                            total = rest[wanted, head, to, 1 if back else 0]
                        if total == FAR:
                            continue
                        total = max(total + moves[m, 2], -FAR)
                        if total < new[layer, 0]:
                            new[layer, 0], new[layer, 1], new[layer, 2] = total, new[layer, 0], head
                        elif total < new[layer, 1]:
                            new[layer, 1] = total
                for layer in range(layers):
                    for k in range(3):
                        changed = changed or (k < 2 and new[layer, k] != rest[layer, i, c, k])
                        rest[layer, i, c, k] = new[layer, k]
            settled = not (within and changed)
            if settled:
                break
        if not settled:
            for layer in range(layers):
                for i in range(1, nodes):
                    rest[layer, i, c, 0] = rest[layer, i, c, 1] = -FAR
    return rest


@kernel(f"UniTuple(i8, 4)(i8[::1], {NETWORK}, i8[:, :, :, ::1], i8, b1, b1, i8[:, :, ::1], i8, i8)")
def least_walk(flag, network, rest, least, wanted, careful, seen, room, work):  # type: ignore[no-untyped-def] # pragma: no cover
    """Least cost of the walks that cost less than ``least``, keep their levels, and come back to nobody whom they remember.

    Labels are gone through as their first level grows. One gives way to another that was gone through at its node before, costs no more,
    has no higher level, remembers nobody whom it does not remember or cannot reach, and has made a needed move if it has; for each row
    that the other one alone has half of, the other one costs as much less as that row's price. Those whose cost and ``rest``, from
    ``completions``, are ``least`` or more are dropped.

    With ``wanted`` a walk makes a needed move. Unless ``careful``, labels give way whatever is remembered, in whichever rows, and by their
    first level alone: then the cost of a walk is found, and may not be the least. ``seen``, of shape (layers, nodes, cells), takes the
    least cost of coming to a node in each cell, before what is paid there, of all labels that can be part of a walk below ``least``:
    layer 0 of all, layer 1 of those that have made a needed move. Then no walk that is found lowers ``least``; an empty one takes nothing.
    ``room`` and ``work`` are the most labels at a time, and the most moves and comparisons. Returns whether it was done, stopped or had no
    room, the least cost (FAR without a walk), the visits of that walk, and the moves and comparisons.
    """
    first, moves, start, lower, upper, above, grid, listed, place, reach, rows_at, row_place, turned, prices = network
    nodes, levels, rows = len(first) - 1, len(start), turned.shape[1]
    words = (listed.shape[1] + BITS - 1) // BITS
    known = 1 + levels  # a label: its cost, its levels, whom it remembers behind the bit of a needed move, its rows
    halves = known + words
    width = halves + rows
    base, shift, cells = grid[0], grid[1], grid[2]
    # What is never written takes no memory.
    label, node = np.empty((room, width), np.int64), np.empty(room, np.int32)
    visits, link = np.empty(room, np.int32), np.empty(room, np.int64)  # the next one of a cell, or of those that are free
    queue = np.full(cells, -1)
    chunks = room // CHUNK + nodes
    kept, count, older = np.empty((chunks, CHUNK, width), np.int64), np.zeros(chunks, np.int64), np.empty(chunks, np.int64)
    newest = np.full(nodes, -1)  # the chunks of a node, each in order of costs
    new = np.zeros(width, np.int64)
    free, used, filled, looked = -1, 1, 0, 0
    found, length, mixed = FAR, 0, above.max() >= 0

    label[0, 0], node[0], visits[0], link[0], queue[0] = 0, 0, 0, -1, 0
    for r in range(levels):
        label[0, 1 + r] = start[r]
    for w in range(known, width):
        label[0, w] = 0
    label[0, known] = 1 if wanted else 0
    for cell in range(cells):
        while queue[cell] >= 0:
            if asked(flag):
                return STOPPED, -FAR, 0, looked
            if looked > work:
                return FULL, -FAR, 0, looked
            one = queue[cell]
            queue[cell] = link[one]
            tail, cost = node[one], label[one, 0]
            if tail > 0:
                stays = cost + rest[label[one, known] & 1, tail, cell, 0] < least
                if stays:
                    for w in range(width):
                        new[w] = label[one, w]
                    stays, more = _stays(kept, count, older, newest[tail], new, levels, words, prices[tail], careful)
                    looked += more
                if not stays:
                    link[one], free = free, one
                    continue
                k = newest[tail]
                if k < 0 or count[k] == CHUNK:
                    if filled == chunks:
                        return FULL, -FAR, 0, looked
                    older[filled], newest[tail], k = k, filled, filled
                    filled += 1
                at = count[k]
                while at > 0 and kept[k, at - 1, 0] > cost:
                    for w in range(width):
                        kept[k, at, w] = kept[k, at - 1, w]
                    at -= 1
                for w in range(width):
                    kept[k, at, w] = new[w]
                count[k] += 1

            looked += first[tail + 1] - first[tail]
            for m in range(first[tail], first[tail + 1]):
                head, total = moves[m, 0], cost + moves[m, 2]
                still = label[one, known] & (1 - moves[m, 1]) & 1
                level = max(label[one, 1] + moves[m, 3], lower[head, 0])
                if level > upper[head, 0]:
                    continue
                to = (level - base) >> shift
                if head == 0:
                    if still or total >= least:
                        continue
                else:
                    beyond = rest[still, head, to, 1 if rest[still, head, to, 2] == tail and place[head, tail] >= 0 else 0]
                    if total + beyond >= least:
                        continue
                p = place[tail, head]
                if p >= 0 and label[one, known + p // BITS] >> (p % BITS) & 1:
                    continue
                new[1] = level
                inside = True
                for r in range(1, levels):
                    new[1 + r] = max(label[one, 1 + r] + moves[m, 3 + r], lower[head, r])
                    inside = inside and new[1 + r] <= upper[head, r]
                if mixed:
                    for r in range(levels):
                        if above[r] >= 0 and new[1 + above[r]] > new[1 + r]:
                            new[1 + r] = new[1 + above[r]]
                            inside = inside and new[1 + r] <= upper[head, r]
                    to = (new[1] - base) >> shift
                if not inside:
                    continue
                if head == 0:
                    if len(seen) == 0:
                        least, found, length = total, total, visits[one]
                    continue
                for layer in range(len(seen)):
                    if layer == 0 or still == 0:
                        seen[layer, head, to] = min(seen[layer, head, to], total)

                for w in range(known, width):
                    new[w] = 0
                for w in range(rows):
                    left = label[one, halves + w]
                    while left != 0:
                        q = row_place[head, rows_at[tail, BITS * w + lowest(left)]]
                        left &= left - 1
                        if q >= 0:
                            new[halves + q // BITS] |= 1 << (q % BITS)
                for w in range(rows):
                    left = new[halves + w] & turned[head, w]
                    new[halves + w] ^= turned[head, w]
                    while left != 0:
                        total += prices[head, BITS * w + lowest(left)]
                        left &= left - 1
                if rows and total + beyond >= least:
                    continue
                new[0] = total
                for w in range(words):
                    left = label[one, known + w]
                    if w == 0:
                        left &= ~1
                    while left != 0:
                        q = place[head, listed[tail, BITS * w + lowest(left)]]
                        left &= left - 1
                        if q >= 0:
                            new[known + q // BITS] |= 1 << (q % BITS)
                new[known] |= still
                for p in range(1, listed.shape[1]):
                    if listed[head, p] < 0:
                        break
                    for r in range(levels):
                        if new[1 + r] > reach[head, p, r]:
                            new[known + p // BITS] |= 1 << (p % BITS)
                stays, more = _stays(kept, count, older, newest[head], new, levels, words, prices[head], careful)
                looked += more
                if not stays:
                    continue
                at = free
                if at >= 0:
                    free = link[at]
                elif used < room:
                    at = used
                    used += 1
                else:
                    return FULL, -FAR, 0, looked
                for w in range(width):
                    label[at, w] = new[w]
                node[at], visits[at], link[at], queue[to] = head, visits[one] + 1, queue[to], at
            link[one], free = free, one
    return DONE, found, length, looked


@kernel(_nrt=False, no_cpython_wrapper=True)  # counting references would take most of its time
def _stays(kept, count, older, k, new, levels, words, prices, careful):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Whether a label gives way to none of those kept at its node, from chunk ``k`` on; and how many were looked at."""
    looked, known = 0, 1 + levels
    while k >= 0:
        looked += 1
        for e in range(count[k]):
            spare = new[0] - kept[k, e, 0]
            if spare < 0:
                break
            looked += 1
            if kept[k, e, known] & (-1 if careful else 1) & ~new[known] != 0:
                continue
            worse = False
            for r in range(1, known if careful else 2):
                worse = worse or kept[k, e, r] > new[r]
            if worse:
                continue
            if not careful:
                return False, looked
            for w in range(known + 1, known + words):
                worse = worse or kept[k, e, w] & ~new[w] != 0
            if worse:
                continue
            for w in range(known + words, len(new)):
                left = kept[k, e, w] & ~new[w]
                while left != 0 and spare >= 0:
                    spare -= prices[BITS * (w - known - words) + lowest(left)]
                    left &= left - 1
            if spare >= 0:
                return False, looked
        k = older[k]
    return True, looked
