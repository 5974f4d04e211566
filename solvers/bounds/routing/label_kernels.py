"""Routes of the least reduced cost by labels from both ends, compiled, in whole numbers. Imports numba: import it inside functions only.

A label is one row: its reduced cost, its levels, the customers it remembers, these and those out of its reach (bits over the list of its
node), and the subset-row cuts for which it is halfway to a further unit (bits, ``WORD`` a word). Labels of a node stand in buckets of their
first level, cheapest first.

Source: Sadykov, Uchoa, Pessoa (2021) for buckets and the halfway point; Baldacci, Mingozzi, Roberti (2011) for memories; Jepsen, Petersen,
Spoorendonk, Pisinger (2008) for dominance with cuts; Pecin, Contardo, Desaulniers, Uchoa (2017) for cuts with memories of arcs.
"""

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked
from .route_levels import DONE, EXACT, FORGETFUL, FULL, NONE, SINGLE, STOPPED

CLOSE = 5
"""Places of a node that are looked at where memories count in part, its own among them."""


@kernel(_nrt=False, no_cpython_wrapper=True)  # counting references would take most of its time
def replaces(rows, one, other, levels, fines, how):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Whether a label that costs no more than another one can stand for it."""
    for r in range(1, levels + 1):
        if rows[one, r] > rows[other, r]:
            return False
    if how >= FORGETFUL:
        return True
    if rows[one, levels + 1] & ~rows[other, levels + 2] & (-1 if how == EXACT else (1 << CLOSE) - 1):
        return False
    spare = rows[other, 0] - rows[one, 0]
    for w in range(len(fines)):
        owed, byte = rows[one, levels + 3 + w] & ~rows[other, levels + 3 + w], 0
        while owed:
            spare -= fines[w, byte, owed & 255]
            if spare < 0:
                return False
            owed >>= 8
            byte += 1
    return True


@kernel(_nrt=False, no_cpython_wrapper=True)
def remembered(seen, i, j, members, position):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Customers remembered at node i that node j remembers too, as bits over the list of j."""
    kept, p, one = 0, 0, 1
    while seen:
        if seen & 1:
            q = position[j, members[i, p]]
            if q >= 0:
                kept |= one << q
        seen >>= 1
        p += 1
    return kept


@kernel(
    "Tuple((i8, i8))(i8[::1], i4[::1], i4[::1], i8[::1], i8[:, ::1], i8[:, ::1], i1[::1], i8[:, ::1], i8[:, :, ::1], i8[:, ::1], "
    "i8[:, ::1], i8[::1], i4[:, ::1], i1[:, ::1], i8[:, :, ::1], i8[:, ::1], i4[::1], i4[::1], i4[::1], b1[::1], i4[::1], i4[::1], "
    "i4[:, ::1], i8[:, ::1], i8, i8)",
    _nrt=False,
)
def grow(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, arcs, heads, cost, weight, keep, place, toggle, fines, lower, upper, above, members, position, latest,
    rows, node, parent, after, gone, queue, waiting, chains, cheapest, halfway, how,
):  # fmt: skip
    """Extend the label of the depot, node 0, in row 0, in the order of the first level, by labels of at most ``halfway``.

    Arcs of node i are ``arcs[i]`` to ``arcs[i + 1]``: their ``heads``, reduced ``cost``, ``weight`` (arcs, levels), the cuts whose memory
    they ``keep`` (arcs, words), and the ``place`` of their head among those that node i remembers, -1 for none. ``toggle`` (nodes, words)
    has the cuts that a node belongs to, ``fines`` (words, 7, 256) what the bits of each byte cost together; a level is never below the one
    that ``above`` (levels,) names, -1 for none. ``members`` (nodes, places)
    are the customers that a node remembers, itself first, ``position`` (nodes, nodes) where they stand, and ``latest`` (nodes, places,
    levels) the levels above which they are out of reach. Returns whether it was done, stopped or full, and the number of labels.
    """
    nodes, levels, words = len(chains), lower.shape[1], len(fines)
    buckets, places, room, one = chains.shape[1], members.shape[1], len(node), 1
    mixed = False
    for r in range(levels):
        mixed = mixed or above[r] >= 0
    for i in range(nodes):
        for b in range(buckets):
            chains[i, b], cheapest[i, b] = -1, NONE
    for b in range(len(queue)):
        queue[b] = -1
    begin, count = rows[0, 1], 1
    step = (halfway - begin) // len(queue) + 1
    node[0], parent[0], gone[0], waiting[0] = 0, -1, False, -1
    queue[0] = 0
    for now in range(len(queue)):
        while queue[now] >= 0:
            label = queue[now]
            queue[now] = waiting[label]
            if gone[label]:
                continue
            if asked(flag):
                return STOPPED, count
            i, value = node[label], rows[label, 0]
            if i > 0 and how != SINGLE:
                own = (rows[label, 1] - lower[i, 0]) // ((upper[i, 0] - lower[i, 0]) // buckets + 1)
                for b in range(own - 1, -1, -1):
                    if cheapest[i, b] > value:
                        continue
                    k = chains[i, b]
                    while k >= 0 and rows[k, 0] <= value:
                        if replaces(rows, k, label, levels, fines, how):
                            gone[label] = True
                            break
                        k = after[k]
                    if gone[label]:
                        break
                if gone[label]:
                    continue
            seen = rows[label, levels + 1]
            for a in range(arcs[i], arcs[i + 1]):
                j = heads[a]
                if j == 0 or (place[a] >= 0 and seen >> place[a] & 1):
                    continue
                fits = True
                for r in range(levels):
                    level = max(rows[label, 1 + r] + weight[a, r], lower[j, r])
                    rows[count, 1 + r] = level
                    fits = fits and level <= upper[j, r]
                for r in range(levels if mixed else 0):
                    if above[r] >= 0 and rows[count, 1 + above[r]] > rows[count, 1 + r]:
                        rows[count, 1 + r] = rows[count, 1 + above[r]]
                        fits = fits and rows[count, 1 + r] <= upper[j, r]
                if not fits or rows[count, 1] > halfway:
                    continue
                v = value + cost[a]
                for w in range(words):
                    owed = rows[label, levels + 3 + w] & keep[a, w]
                    due, byte = owed & toggle[j, w], 0
                    rows[count, levels + 3 + w] = owed ^ toggle[j, w]
                    while due:
                        v += fines[w, byte, due & 255]
                        due >>= 8
                        byte += 1
                rows[count, 0] = v
                mine = one | remembered(seen, i, j, members, position)
                rows[count, levels + 1] = mine
                for p in range(1, places):
                    for r in range(levels):
                        if rows[count, 1 + r] > latest[j, p, r]:
                            mine |= one << p
                            break
                rows[count, levels + 2] = mine
                b = (rows[count, 1] - lower[j, 0]) // ((upper[j, 0] - lower[j, 0]) // buckets + 1)
                previous, k, kept = -1, chains[j, b], True
                while k >= 0 and rows[k, 0] <= v:
                    if how == SINGLE or replaces(rows, k, count, levels, fines, how):
                        kept = False
                        break
                    previous = k
                    k = after[k]
                if not kept:
                    continue
                if count == room - 1:
                    return FULL, count
                new = count
                count += 1
                node[new], parent[new], after[new], gone[new] = j, label, k, False
                if previous < 0:
                    chains[j, b], cheapest[j, b] = new, v
                else:
                    after[previous] = new
                previous = new
                while k >= 0:
                    if how == SINGLE or replaces(rows, new, k, levels, fines, how):
                        gone[k] = True
                        after[previous] = after[k]
                    else:
                        previous = k
                    k = after[k]
                at = (rows[new, 1] - begin) // step
                waiting[new] = queue[at]
                queue[at] = new
    return DONE, count


@kernel(_nrt=False, no_cpython_wrapper=True)
def meeting(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    label, a, bar, heads, cost, weight, keep, place, fines, members, position, rows, i, others, after, chains, cheapest, lower, upper, top
):
    """The cheapest label from the other end that completes one over arc a, and their cost together, if it is below ``bar``; else -1.

    ``lower`` and ``upper`` are the levels from the other end, which are those here taken from ``top``.
    """
    levels, buckets, words, j, found = len(top), chains.shape[1], len(fines), heads[a], -1
    seen = rows[label, levels + 1]
    if place[a] >= 0 and seen >> place[a] & 1:
        return bar, found
    base = rows[label, 0] + cost[a]
    most = top[0] - rows[label, 1] - weight[a, 0]
    if most < lower[j, 0]:
        return bar, found
    last = min(buckets - 1, (most - lower[j, 0]) // ((upper[j, 0] - lower[j, 0]) // buckets + 1))
    ready, mine = False, seen
    for b in range(last + 1):
        if base + cheapest[j, b] >= bar:
            continue
        if not ready:
            mine, ready = remembered(seen, i, j, members, position), True
        k = chains[j, b]
        while k >= 0 and base + others[k, 0] < bar:
            total = base + others[k, 0]
            fits = others[k, levels + 1] & mine == 0
            for r in range(levels):
                fits = fits and others[k, 1 + r] <= top[r] - rows[label, 1 + r] - weight[a, r]
            if fits:
                for w in range(words):
                    due, byte = rows[label, levels + 3 + w] & others[k, levels + 3 + w] & keep[a, w], 0
                    while due:
                        total += fines[w, byte, due & 255]
                        due >>= 8
                        byte += 1
                if total < bar:
                    bar, found = total, k
            k = after[k]
    return bar, found


@kernel(
    "Tuple((i8, i8))(i8[::1], i4[::1], i4[::1], i8[::1], i8[:, ::1], i8[:, ::1], i1[::1], i8[:, :, ::1], i4[:, ::1], i1[:, ::1], "
    "i8[:, ::1], i4[::1], b1[::1], i8, i8[:, ::1], i4[::1], i4[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[::1], i8, i4[:, ::1], "
    "i8[::1])",
    _nrt=False,
)
def join(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, arcs, heads, cost, weight, keep, place, fines, members, position, rows, node, gone, count,
    others, after, chains, cheapest, lower, upper, top, below, pairs, totals,
):  # fmt: skip
    """The least cost of labels from both ends put together, and for each from here the best one from there, if they cost less than
    ``below``: their rows in ``pairs``, their costs in ``totals``. Returns the least cost, and how many there are, -1 if stopped."""
    least, number = NONE, 0
    for label in range(count):
        if gone[label]:
            continue
        if asked(flag):
            return -NONE, -1
        i, best, partner = node[label], max(below, least), -1
        for a in range(arcs[i], arcs[i + 1]):
            if i == 0 and heads[a] == 0:
                continue
            bar, found = meeting(
                label, a, best, heads, cost, weight, keep, place, fines, members, position, rows, i, others, after, chains, cheapest, lower,
                upper, top,
            )  # fmt: skip
            if found >= 0:
                best, partner = bar, found
        if partner >= 0:
            least = min(least, best)
            if best < below:
                pairs[number, 0], pairs[number, 1], totals[number] = label, partner, best
                number += 1
    return least, number


@kernel(
    "i8(i8[::1], i4[::1], i4[::1], i8[::1], i8[:, ::1], i8[:, ::1], i1[::1], i8[:, :, ::1], i4[:, ::1], i1[:, ::1], i8[:, ::1], i4[::1], "
    "b1[::1], i8, i8[:, ::1], i4[::1], i4[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[::1], i8[::1])",
    _nrt=False,
)
def arc_costs(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, arcs, heads, cost, weight, keep, place, fines, members, position, rows, node, gone, count,
    others, after, chains, cheapest, lower, upper, top, least,
):  # fmt: skip
    """Lower ``least`` (arcs,) to the least cost of labels put together over each arc; returns whether it was done or stopped."""
    for label in range(count):
        if gone[label]:
            continue
        if asked(flag):
            return STOPPED
        i = node[label]
        for a in range(arcs[i], arcs[i + 1]):
            if i == 0 and heads[a] == 0:
                continue
            bar, found = meeting(
                label, a, least[a], heads, cost, weight, keep, place, fines, members, position, rows, i, others, after, chains, cheapest,
                lower, upper, top,
            )  # fmt: skip
            if found >= 0:
                least[a] = bar
    return DONE
