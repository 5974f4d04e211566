"""Routes of the least reduced cost by labels, compiled, for the linear program of column generation."""

from __future__ import annotations

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

DONE, STOPPED, FULL = 0, 1, 2


@kernel(
    "Tuple((i8, f8, f8[::1], i4[::1], i4[::1], i4[::1]))"
    "(i8[::1], f8[:, ::1], f8[:, :, ::1], f8[:, :, ::1], f8[::1], f8[:, ::1], f8[:, ::1], u8[:, ::1], b1, i8, f8)"
)
def cheapest_routes(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, cost, weight, way, start, lower, upper, memory, careful, room, below
):
    """Routes of the least reduced cost over all that keep their levels and come back to a customer only where he was forgotten.

    Labels, ``room`` of them at most, are extended in the order of their first level, and kept at each node in the order of their costs.
    ``cost`` is reduced, infinite where there is no move; node 0 is the depot. ``weight`` and ``way``, shape (resources, nodes, nodes), are
    what a move and the shortest way add to each level; ``lower`` and ``upper`` have shape (resources, nodes). ``memory``, shape (nodes,
    words), holds the customers that are remembered at each node, one bit each. Unless ``careful``, a label gives way to one that remembers
    more: only some routes are found, and sooner.

    Returns whether it was done, stopped or full; the least reduced cost; reduced costs and last labels of the routes ``below`` a reduced
    cost; of all labels their customers, and the labels before them, -1 for none.

    Source: Feillet, Dejax, Gendreau, Gueguen (2004), with customers out of reach; Baldacci, Mingozzi, Roberti (2011) for memories.
    """
    n, words, kinds = len(cost), memory.shape[1], len(start)
    # What is never written takes no memory.
    at, parent, after = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.int32)
    heap, found, gone = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.bool_)
    value, totals, level, seen = np.empty(room), np.empty(room), np.empty((room + 1, kinds)), np.empty((room + 1, words), np.uint64)
    first = np.empty(n, np.int32)
    for j in range(n):
        first[j] = -1
    one = np.uint64(1)
    waiting = count = number = 0  # what is looked at stands in row ``count``
    least, label = math.inf, -1
    while True:
        tail = 0 if label < 0 else at[label]
        for head in range(1, n):
            if cost[tail, head] == math.inf or (label >= 0 and gone[label]):
                continue
            word, bit = (head - 1) >> 6, one << np.uint64((head - 1) & 63)
            if label >= 0 and seen[label, word] & bit:
                continue
            fits = True
            for r in range(kinds):
                before = start[r] if label < 0 else level[label, r]
                level[count, r] = max(lower[r, head], before + weight[r, tail, head])
                if level[count, r] > upper[r, head]:
                    fits = False
                    break
            if not fits:
                continue
            v = cost[tail, head] + (0.0 if label < 0 else value[label])
            for w in range(words):
                seen[count, w] = np.uint64(0) if label < 0 else seen[label, w] & memory[head, w]
            seen[count, word] |= bit
            for other in range(1, n):
                for r in range(kinds):
                    if level[count, r] + way[r, head, other] > upper[r, other]:
                        seen[count, (other - 1) >> 6] |= one << np.uint64((other - 1) & 63)
                        break
            if asked(flag):
                return STOPPED, -math.inf, totals[:0], found[:0], at[:0], parent[:0]
            previous, k, kept = -1, first[head], True
            while k >= 0 and value[k] <= v:
                if _replaces(k, count, level, seen, careful):
                    kept = False
                    break
                previous = k
                k = after[k]
            if not kept:
                continue
            if count == room:
                return FULL, -math.inf, totals[:0], found[:0], at[:0], parent[:0]
            new = count
            count += 1
            at[new], parent[new], value[new], after[new], gone[new] = head, label, v, k, False
            if previous < 0:
                first[head] = new
            else:
                after[previous] = new
            previous = new
            while k >= 0:
                if _replaces(new, k, level, seen, careful):
                    gone[k] = True
                    after[previous] = after[k]
                else:
                    previous = k
                k = after[k]
            home = cost[head, 0] < math.inf
            for r in range(kinds):
                if home and level[new, r] + weight[r, head, 0] > upper[r, 0]:
                    home = False
            if home:
                total = v + cost[head, 0]
                least = min(least, total)
                if total < below:
                    found[number], totals[number] = new, total
                    number += 1
            p = waiting
            heap[p] = new
            waiting += 1
            while p > 0 and level[heap[(p - 1) >> 1], 0] > level[heap[p], 0]:
                q = (p - 1) >> 1
                heap[q], heap[p] = heap[p], heap[q]
                p = q
        if waiting == 0:
            break
        label = heap[0]
        waiting -= 1
        heap[0] = heap[waiting]
        p = 0
        while 2 * p + 1 < waiting:
            q = 2 * p + 1
            if q + 1 < waiting and level[heap[q + 1], 0] < level[heap[q], 0]:
                q += 1
            if level[heap[p], 0] <= level[heap[q], 0]:
                break
            heap[q], heap[p] = heap[p], heap[q]
            p = q
    return DONE, least, totals[:number], found[:number], at[:count], parent[:count]


@kernel(_nrt=False, no_cpython_wrapper=True)  # counting references would take most of its time
def _replaces(one, other, level, seen, careful):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Whether a label has no higher level than another one, and (``careful``) remembers nobody whom that does not remember."""
    for r in range(level.shape[1]):
        if level[one, r] > level[other, r]:
            return False
    if careful:
        for w in range(seen.shape[1]):
            if seen[one, w] & ~seen[other, w]:
                return False
    return True
