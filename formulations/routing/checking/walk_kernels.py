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

    Labels are extended stage by stage, a visit a stage, so that each walk of as many visits as there are customers is looked at. One
    gives way to another at its node that costs no more, has no higher level, and remembers nobody whom it does not remember, or can
    reach.

    ``cost`` has shape (nodes, nodes), node 0 being the depot, ``weight`` and ``way`` (the least that any moves add from node to node)
    shape (resources, nodes, nodes), all infinite where there is no move; ``lower``, ``upper`` and ``beyond`` (a customer is out of reach
    above it) shape (resources, nodes); ``memory`` of shape (nodes, words) has one bit a customer for those still remembered at a node;
    ``room`` and ``work`` are the most labels and comparisons; ``flag`` is that of a ``Stop``. Returns whether it was done, stopped, or
    had no room.
    """
    nodes, words, resources = len(cost), memory.shape[1], len(start)
    # What is never written takes no memory.
    node, behind, dropped = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(room, np.bool_)
    value, level, seen = np.empty(room), np.empty((room + 1, resources)), np.empty((room + 1, words), np.uint64)
    front = np.empty(nodes, np.int32)  # labels of a node in order of their values
    for j in range(nodes):
        front[j] = -1
    one, least = np.uint64(1), math.inf
    begin, count, looked = -1, 0, 0  # what is looked at stands in row ``count``
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
                    level[count, r] = max(lower[r, head], before + weight[r, tail, head])
                    kept = kept and level[count, r] <= upper[r, head]
                if not kept:
                    continue
                price = cost[tail, head] + (value[label] if label >= 0 else 0.0)
                for w in range(words):
                    seen[count, w] = seen[label, w] & memory[head, w] if label >= 0 else np.uint64(0)
                for other in range(1, nodes):
                    away = other == head
                    for r in range(resources):
                        away = away or level[count, r] + way[r, head, other] > beyond[r, other]
                    if away:
                        seen[count, (other - 1) // 64] |= one << np.uint64((other - 1) % 64)

                looked += nodes
                if looked > work:
                    return FULL, -math.inf
                if asked(flag):
                    return STOPPED, -math.inf
                previous, k = -1, front[head]
                while kept and k >= 0 and value[k] <= price:
                    kept = not _no_worse(k, count, level, seen)
                    previous, k = k, behind[k]
                    looked += 1
                if not kept:
                    continue
                if count == room:
                    return FULL, -math.inf
                new = count
                count += 1
                node[new], value[new], behind[new], dropped[new] = head, price, k, False
                if previous < 0:
                    front[head] = new
                else:
                    behind[previous] = new
                previous = new
                while k >= 0:
                    # One that waits for its turn has fewer visits, and may be extended further.
                    if (k <= label or k >= end) and _no_worse(new, k, level, seen):
                        dropped[k] = True
                        behind[previous] = behind[k]
                    else:
                        previous = k
                    k = behind[k]
                    looked += 1

                back = cost[head, 0] < math.inf
                for r in range(resources):
                    back = back and level[new, r] + weight[r, head, 0] <= upper[r, 0]
                if back:
                    least = min(least, price + cost[head, 0])
        begin = end
        if begin == count:
            break
    return DONE, least


@kernel(_nrt=False, no_cpython_wrapper=True)  # counting references would take most of its time
def _no_worse(one, other, level, seen):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Whether a label has no higher level than another one, and remembers nobody whom that does not remember."""
    for r in range(level.shape[1]):
        if level[one, r] > level[other, r]:
            return False
    for w in range(seen.shape[1]):  # noqa: SIM110 - numba compiles no generators
        if seen[one, w] & ~seen[other, w] != 0:
            return False
    return True
