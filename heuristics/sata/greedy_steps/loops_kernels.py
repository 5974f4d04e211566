"""Greedy loops over coverage and facility location, compiled.

All of them pick the largest gain, the smallest index among equal ones, until each group has as many elements as it has room for (a
cardinality limit is one group), ``most`` are picked, the gain is below ``eps``, or the ``flag`` of a ``Stop`` is set: then the picks so far
are a prefix of the whole. They return ``(picks, gains, evaluations)``. A function comes as the arrays of its ``ItemWeights``, and a set as
``best``, which is raised in place.
"""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked
from ....instances.sata.set_functions import AT_ITEM
from ....solvers.bounds.sata.gain_kernels import OVER_ITEMS, gain, take


@kernel(f"(i8[::1], b1[::1], i4[::1], i8[::1], i8, f8, f8[::1], {OVER_ITEMS})")
def plain(flag, free, groups, room, most, eps, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Every gain afresh in every round."""
    n, count, evaluations = len(groups), 0, 0
    picks, gains = np.empty(most, np.int64), np.empty(most)
    while count < most:
        chosen, most_gain = -1, -1.0
        for e in range(n):
            if asked(flag):
                return picks[:count], gains[:count], evaluations
            if free[e] and room[groups[e]] > 0:
                found = gain(e, best, layout, indptr, indices, weights, matrix, single)
                evaluations += 1
                if found > most_gain:
                    chosen, most_gain = e, found
        if chosen < 0 or most_gain < eps:
            break
        take(chosen, best, layout, indptr, indices, weights, matrix, single)
        picks[count], gains[count] = chosen, most_gain
        count += 1
        free[chosen] = False
        room[groups[chosen]] -= 1
    return picks[:count], gains[:count], evaluations


@inner
def sift(keys, heap, size, at):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Let the entry at ``at`` sink to its place in a heap with the largest key on top, the smallest index among equal ones."""
    key, e = keys[at], heap[at]
    while True:
        child = 2 * at + 1
        if child >= size:
            break
        if child + 1 < size:
            other = child + 1
            if keys[other] > keys[child] or (keys[other] == keys[child] and heap[other] < heap[child]):
                child = other
        if keys[child] > key or (keys[child] == key and heap[child] < e):
            keys[at], heap[at] = keys[child], heap[child]
            at = child
        else:
            break
    keys[at], heap[at] = key, e


@kernel(f"(i8[::1], b1[::1], i4[::1], i8[::1], i8, f8, f8[::1], {OVER_ITEMS})")
def lazy(flag, free, groups, room, most, eps, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Gains of earlier rounds, which can only have fallen since, on a heap; only what comes up is evaluated again."""
    n, count, size = len(groups), 0, 0
    heap, keys = np.empty(n, np.int32), np.empty(n)
    evaluated = np.zeros(n, np.int64)  # the round in which an element was evaluated last
    picks, gains = np.empty(most, np.int64), np.empty(most)
    for e in range(n):
        if asked(flag):
            return picks[:0], gains[:0], size
        if free[e] and room[groups[e]] > 0:
            keys[size] = gain(e, best, layout, indptr, indices, weights, matrix, single)
            heap[size] = e
            size += 1
    evaluations = size
    for at in range(size // 2 - 1, -1, -1):
        sift(keys, heap, size, at)
    while count < most and size > 0 and not asked(flag):
        e = heap[0]
        full = room[groups[e]] == 0
        if not full and evaluated[e] != count:
            keys[0] = gain(e, best, layout, indptr, indices, weights, matrix, single)
            evaluations += 1
            evaluated[e] = count
            sift(keys, heap, size, 0)
            continue
        if not full:
            if keys[0] < eps:
                break
            take(e, best, layout, indptr, indices, weights, matrix, single)
            picks[count], gains[count] = e, keys[0]
            count += 1
            room[groups[e]] -= 1
        size -= 1
        keys[0], heap[0] = keys[size], heap[size]
        sift(keys, heap, size, 0)
    return picks[:count], gains[:count], evaluations


BLOCK = 256
EPSILON = float(np.finfo(np.float64).eps)


@kernel(
    "(i8[::1], b1[::1], i4[::1], i8[::1], i8, f8, f8[::1], i8[::1], i4[::1], f8[::1], i8, "
    "i8, read(i4[::1]), read(i4[::1]), read(f8[::1]), read(f8[:, ::1]), read(f4[:, ::1]))"
)
def incremental(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag,
    free,
    groups,
    room,
    most,
    eps,
    best,
    item_starts,
    item_elements,
    item_weights,
    changes,
    layout,
    indptr,
    indices,
    weights,
    matrix,
    single,
):
    """Gains kept up to date through the transposed CSR: when an item's weight rises, the gains of its elements fall.

    Differences that are taken one after another drift by roundings, one for each of at most ``changes`` changes of a gain; elements that
    close to the largest are evaluated afresh, so that the picks are those of ``plain`` to the bit. The largest gain of a block of elements
    is kept as an upper bound.
    """
    n, count, evaluations = len(groups), 0, 0
    blocks = (n + BLOCK - 1) // BLOCK
    near, highest = np.full(n, -np.inf), np.full(blocks, -np.inf)
    picks, gains = np.empty(most, np.int64), np.empty(most)
    for e in range(n):
        if asked(flag):
            return picks[:0], gains[:0], evaluations
        if free[e]:
            near[e] = gain(e, best, layout, indptr, indices, weights, matrix, single)
            evaluations += 1
            highest[e // BLOCK] = max(highest[e // BLOCK], near[e])
    top = 0.0
    for b in range(blocks):
        top = max(top, highest[b])
    slack = 4.0 * EPSILON * (changes + 2.0) * top
    while count < most and not asked(flag):
        top = -np.inf
        for b in range(blocks):
            if highest[b] > top:
                most_near = -np.inf
                for e in range(b * BLOCK, min(n, (b + 1) * BLOCK)):
                    if near[e] > most_near:
                        if room[groups[e]] > 0:
                            most_near = near[e]
                        else:
                            near[e] = -np.inf
                highest[b] = most_near
                top = max(top, most_near)
        chosen, most_gain = -1, -1.0
        for b in range(blocks):
            if asked(flag):
                return picks[:count], gains[:count], evaluations
            if highest[b] >= top - slack and highest[b] > -np.inf:
                for e in range(b * BLOCK, min(n, (b + 1) * BLOCK)):
                    if near[e] >= top - slack and room[groups[e]] > 0:
                        found = gain(e, best, layout, indptr, indices, weights, matrix, single)
                        evaluations += 1
                        if found > most_gain:
                            chosen, most_gain = e, found
        if chosen < 0 or most_gain < eps:
            break
        for p in range(indptr[chosen], indptr[chosen + 1]):
            if asked(flag):
                break
            j = indices[p]
            old, w = best[j], weights[j] if layout == AT_ITEM else weights[p]
            if w > old:
                best[j] = w
                for q in range(item_starts[j], item_starts[j + 1]):
                    if layout == AT_ITEM:
                        near[item_elements[q]] -= w
                    elif item_weights[q] > old:
                        near[item_elements[q]] -= min(item_weights[q], w) - old
        picks[count], gains[count] = chosen, most_gain
        count += 1
        near[chosen] = -np.inf
        room[groups[chosen]] -= 1
    return picks[:count], gains[:count], evaluations


@kernel(f"(i8[::1], i8[::1], i8[::1], i8[::1], i8[::1], f8[::1], {OVER_ITEMS})")
def in_order(flag, order, starts, members, room, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """One group after the other picks its best elements, as many as it has room for."""
    most = 0
    for g in order:
        most += min(room[g], starts[g + 1] - starts[g])
    picks, gains = np.empty(most, np.int64), np.empty(most)
    count, evaluations = 0, 0
    for g in order:
        left = np.empty(starts[g + 1] - starts[g], np.int64)
        for k in range(len(left)):
            left[k] = members[starts[g] + k]
        for _ in range(min(room[g], len(left))):
            at, most_gain = -1, -1.0
            for k in range(len(left)):
                if asked(flag):
                    return picks[:count], gains[:count], evaluations
                if left[k] >= 0:
                    found = gain(left[k], best, layout, indptr, indices, weights, matrix, single)
                    evaluations += 1
                    if found > most_gain:
                        at, most_gain = k, found
            take(left[at], best, layout, indptr, indices, weights, matrix, single)
            picks[count], gains[count] = left[at], most_gain
            count += 1
            left[at] = -1
    return picks, gains, evaluations
