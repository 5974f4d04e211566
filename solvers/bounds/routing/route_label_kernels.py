"""Routes of the least reduced cost by labels, compiled: what column generation adds to its linear program."""

from __future__ import annotations

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

DONE, STOPPED, FULL = 0, 1, 2


@kernel(
    "Tuple((i8, f8, f8[::1], i4[::1], i4[::1]))(i8[::1], f8[:, ::1], f8[:, :, ::1], f8[:, :, ::1], f8[::1], f8[:, ::1], f8[:, ::1], "
    "u8[:, ::1], b1, i8, i8, f8)"
)
def cheapest_routes(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, cost, weight, way, start, lower, upper, memory, careful, room, most, below
):
    """Routes of the least reduced cost over all that keep their levels and come back to a customer only where he was forgotten.

    Labels are extended in the order of their first level, and kept at each node in the order of their costs.

    Parameters
    ----------
    flag : array
        Of a ``Stop``.
    cost : array of shape (nodes, nodes)
        Reduced; node 0 is the depot. Infinite where there is no move.
    weight, way : arrays of shape (resources, nodes, nodes)
        What a move adds to each level, and what the shortest way adds; infinite where there is none.
    start : array of shape (resources,)
    lower, upper : arrays of shape (resources, nodes)
    memory : uint64 array of shape (nodes, words)
        The customers that are remembered at each node, one bit each.
    careful : bool
        Whether a label must also remember no more than one that gives way to it. Without it only some routes are found, and sooner.
    room, most : int
        Labels, and routes to return.
    below : float
        Only routes of a smaller reduced cost are returned.

    Returns
    -------
    (int, float, array, int32 array, int32 array)
        Whether it was done, stopped or full; the least reduced cost; of the routes returned their reduced costs and lengths, and their
        customers one after the other.

    Notes
    -----
    Source: Feillet, Dejax, Gendreau, Gueguen (2004), with customers out of reach; Baldacci, Mingozzi, Roberti (2011) for memories.
    """
    n, words, kinds = len(cost), memory.shape[1], len(start)
    size = min(room, 1024)  # of what follows, which grows
    at, parent, value = np.zeros(size, np.int32), np.zeros(size, np.int32), np.zeros(size)
    level, seen, gone = np.zeros((size, kinds)), np.zeros((size, words), np.uint64), np.zeros(size, np.bool_)
    heap, found, totals = np.zeros(size, np.int32), np.zeros(size, np.int32), np.zeros(size)
    after, first = np.zeros(size, np.int32), np.full(n, -1, np.int32)
    bits, now, one = np.zeros(words, np.uint64), np.zeros(kinds), np.uint64(1)
    waiting = count = number = 0
    least, label = math.inf, -1
    none, nobody = np.zeros(0), np.zeros(0, np.int32)
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
                now[r] = max(lower[r, head], before + weight[r, tail, head])
                if now[r] > upper[r, head]:
                    fits = False
                    break
            if not fits:
                continue
            v = cost[tail, head] + (0.0 if label < 0 else value[label])
            for w in range(words):
                bits[w] = np.uint64(0) if label < 0 else seen[label, w] & memory[head, w]
            bits[word] |= bit
            for other in range(1, n):
                for r in range(kinds):
                    if now[r] + way[r, head, other] > upper[r, other]:
                        bits[(other - 1) >> 6] |= one << np.uint64((other - 1) & 63)
                        break
            if asked(flag):
                return STOPPED, -math.inf, none, nobody, nobody
            previous, k, kept = -1, first[head], True
            while k >= 0 and value[k] <= v:
                good = True
                for r in range(kinds):
                    if level[k, r] > now[r]:
                        good = False
                        break
                if good and careful:
                    for w in range(words):
                        if seen[k, w] & ~bits[w]:
                            good = False
                            break
                if good:
                    kept = False
                    break
                previous = k
                k = after[k]
            if not kept:
                continue
            if count == room:
                return FULL, -math.inf, none, nobody, nobody
            if count == size:
                more = np.zeros(min(room, 2 * size) - size, np.int32)
                at, parent, after = np.append(at, more), np.append(parent, more), np.append(after, more)
                heap, found, gone = np.append(heap, more), np.append(found, more), np.append(gone, more > 0)
                value, totals = np.append(value, more * 1.0), np.append(totals, more * 1.0)
                level = np.concatenate((level, np.zeros((len(more), kinds))))
                seen = np.concatenate((seen, np.zeros((len(more), words), np.uint64)))
                size += len(more)
            new = count
            count += 1
            at[new], parent[new], value[new] = head, label, v
            level[new], seen[new], after[new] = now, bits, k
            if previous < 0:
                first[head] = new
            else:
                after[previous] = new
            previous = new
            while k >= 0:
                good = True
                for r in range(kinds):
                    if now[r] > level[k, r]:
                        good = False
                        break
                if good and careful:
                    for w in range(words):
                        if bits[w] & ~seen[k, w]:
                            good = False
                            break
                if good:
                    gone[k] = True
                    after[previous] = after[k]
                else:
                    previous = k
                k = after[k]
            home = cost[head, 0] < math.inf
            for r in range(kinds):
                if home and now[r] + weight[r, head, 0] > upper[r, 0]:
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
    order = np.argsort(totals[:number])[:most]
    lengths = np.zeros(len(order), np.int32)
    for k in range(len(order)):
        label = found[order[k]]
        while label >= 0:
            lengths[k] += 1
            label = parent[label]
    visits, end = np.zeros(lengths.sum(), np.int32), 0
    for k in range(len(order)):
        end += lengths[k]
        p, label = end - 1, found[order[k]]
        while label >= 0:
            visits[p] = at[label]
            p -= 1
            label = parent[label]
    return DONE, least, totals[order], lengths, visits
