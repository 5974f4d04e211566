"""The least reduced cost of a walk from the depot and back, compiled: the checker's own labels."""

from __future__ import annotations

import math

import numpy as np

from ...kernels import kernel
from ...stop_kernel import asked

DONE, STOPPED, FULL = 0, 1, 2


@kernel(
    "Tuple((i8, f8))(i8[::1], f8[:, ::1], f8[:, :, ::1], f8[:, :, ::1], f8[::1], f8[:, ::1], f8[:, ::1], f8[:, ::1], u8[:, ::1], i8, i8)"
)
def least_walk(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, cost, weight, way, start, lower, upper, beyond, memory, room, work
):
    """Least cost of all walks that keep their levels and do not come back to a customer whom they remember.

    Labels are extended stage by stage, a visit a stage, so that each walk of as many visits as there are customers is looked at. One gives
    way to another at its node that costs no more, has no higher level, and remembers nobody whom it does not remember, or can reach.

    Parameters
    ----------
    flag : array
        Of a ``Stop``.
    cost : array of shape (nodes, nodes)
        Node 0 is the depot. Infinite where there is no move.
    weight, way : arrays of shape (resources, nodes, nodes)
        What a move adds to each level, and the least that any moves add from node to node; infinite where there are none.
    start : array of shape (resources,)
    lower, upper : arrays of shape (resources, nodes)
        A level is raised to ``lower``, and is ``upper`` at most.
    beyond : array of shape (resources, nodes)
        A customer is out of reach where the level would be above it.
    memory : uint64 array of shape (nodes, words)
        Those who are still remembered at each node, one bit a customer.
    room, work : int
        Labels and comparisons at most.

    Returns
    -------
    (int, float)
        Whether it was done, stopped, or had no room; the least cost, infinite if there is no such walk.
    """
    nodes, words, resources = len(cost), memory.shape[1], len(start)
    # What is never written takes no memory.
    node, behind, dropped = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.bool_)
    value, level, seen = np.empty(room), np.empty((room, resources)), np.empty((room, words), np.uint64)
    front = np.empty(nodes, np.int32)  # labels of a node in order of their values
    for j in range(nodes):
        front[j] = -1
    here, bits = np.empty(resources), np.empty(words, np.uint64)
    one, least = np.uint64(1), math.inf
    begin, count, looked = -1, 0, 0
    for _ in range(nodes - 1):
        end = count
        for label in range(begin, end):
            if label >= 0 and dropped[label]:
                continue
            tail = node[label] if label >= 0 else 0
            for head in range(1, nodes):
                if cost[tail, head] == math.inf:
                    continue
                if label >= 0 and (seen[label, (head - 1) // 64] >> np.uint64((head - 1) % 64)) & one:
                    continue
                kept = True
                for r in range(resources):
                    before = level[label, r] if label >= 0 else start[r]
                    here[r] = max(lower[r, head], before + weight[r, tail, head])
                    kept = kept and here[r] <= upper[r, head]
                if not kept:
                    continue
                price = cost[tail, head] + (value[label] if label >= 0 else 0.0)
                for w in range(words):
                    bits[w] = seen[label, w] & memory[head, w] if label >= 0 else np.uint64(0)
                for other in range(1, nodes):
                    away = other == head
                    for r in range(resources):
                        away = away or here[r] + way[r, head, other] > beyond[r, other]
                    if away:
                        bits[(other - 1) // 64] |= one << np.uint64((other - 1) % 64)

                looked += nodes
                if looked > work:
                    return FULL, -math.inf
                if asked(flag):
                    return STOPPED, -math.inf
                previous, k = -1, front[head]
                while kept and k >= 0 and value[k] <= price:
                    better = True
                    for r in range(resources):
                        better = better and level[k, r] <= here[r]
                    for w in range(words):
                        better = better and seen[k, w] & ~bits[w] == 0
                    kept = not better
                    previous, k = k, behind[k]
                    looked += 1
                if not kept:
                    continue
                if count == room:
                    return FULL, -math.inf
                new = count
                count += 1
                node[new], value[new], behind[new], dropped[new] = head, price, k, False
                for r in range(resources):
                    level[new, r] = here[r]
                for w in range(words):
                    seen[new, w] = bits[w]
                if previous < 0:
                    front[head] = new
                else:
                    behind[previous] = new
                previous = new
                while k >= 0:
                    worse = k <= label or k >= end  # one that waits for its turn has fewer visits, and may be extended further
                    for r in range(resources):
                        worse = worse and here[r] <= level[k, r]
                    for w in range(words):
                        worse = worse and bits[w] & ~seen[k, w] == 0
                    if worse:
                        dropped[k] = True
                        behind[previous] = behind[k]
                    else:
                        previous = k
                    k = behind[k]
                    looked += 1

                back = cost[head, 0] < math.inf
                for r in range(resources):
                    back = back and here[r] + weight[r, head, 0] <= upper[r, 0]
                if back:
                    least = min(least, price + cost[head, 0])
        begin = end
        if begin == count:
            break
    return DONE, least
