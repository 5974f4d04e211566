"""Greedy filling of a knapsack by gain per cost, from many starting sets, compiled."""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked
from ....solvers.bounds.sata.gain_kernels import OVER_ITEMS, gain, take
from .loops_kernels import sift


@inner
def fill(flag, costs, left, heap, keys, size, best, picks, count, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Add the element of largest gain per cost that still fits, until none does or the ``flag`` is set.

    ``keys`` on the heap are upper bounds of these rates.

    Returns the gain of all and the number of picks; ``heap``, ``keys``, ``best`` and ``picks`` are changed in place.
    """
    total = 0.0
    evaluated = np.full(len(costs), -1)
    while size > 0 and not asked(flag):
        e = heap[0]
        if costs[e] <= left:
            if evaluated[e] != count:
                keys[0] = gain(e, best, layout, indptr, indices, weights, matrix, single) / costs[e]
                evaluated[e] = count
                sift(keys, heap, size, 0)
                continue
            if keys[0] <= 0.0:  # nothing gains any more, least of all what was chosen at the start
                break
            total += keys[0] * costs[e]
            take(e, best, layout, indptr, indices, weights, matrix, single)
            picks[count] = e
            count += 1
            left -= costs[e]
        size -= 1
        keys[0], heap[0] = keys[size], heap[size]
        sift(keys, heap, size, 0)
    return total, count


@kernel(f"(i8[::1], i8[::1], i8, i8, f8, f8[::1], f8[::1], f8, {OVER_ITEMS})")
def fill_after(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, begun, lo, hi, most_value, free_best, costs, budget, layout, indptr, indices, weights, matrix, single
):
    """The best filling that starts with ``begun`` and one element of ``lo`` to ``hi`` (with ``begun`` alone where ``lo`` is negative).

    ``free_best`` is the set of all elements without cost. Returns ``(value, picks)``; no picks where none beats ``most_value``.
    """
    n = len(costs)
    best, left, value = np.empty(len(free_best)), budget, 0.0
    for j in range(len(best)):
        best[j] = free_best[j]
        value += best[j]
    picks = np.empty(n, np.int64)
    winner = np.empty(0, np.int64)
    for k in range(len(begun)):
        value += gain(begun[k], best, layout, indptr, indices, weights, matrix, single)
        take(begun[k], best, layout, indptr, indices, weights, matrix, single)
        left -= costs[begun[k]]
        picks[k] = begun[k]
    if left < 0.0:
        return most_value, winner
    # Rates over what has begun are upper bounds for all that starts with it.
    first_heap, first_keys, size = np.empty(n, np.int32), np.empty(n), 0
    for e in range(n):
        if asked(flag):
            return most_value, winner
        if 0.0 < costs[e] <= left:
            first_heap[size] = e
            first_keys[size] = gain(e, best, layout, indptr, indices, weights, matrix, single) / costs[e]
            size += 1
    for at in range(size // 2 - 1, -1, -1):
        sift(first_keys, first_heap, size, at)
    heap, keys, trial = np.empty(n, np.int32), np.empty(n), np.empty(len(best))
    for e in range(lo, hi):
        if asked(flag):
            break
        if e >= 0 and not 0.0 < costs[e] <= left:
            continue
        for j in range(len(best)):
            trial[j] = best[j]
        for at in range(size):
            heap[at], keys[at] = first_heap[at], first_keys[at]
        count, reached, rest = len(begun), value, left
        if e >= 0:
            reached += gain(e, trial, layout, indptr, indices, weights, matrix, single)
            take(e, trial, layout, indptr, indices, weights, matrix, single)
            picks[count] = e
            count += 1
            rest -= costs[e]
        more, count = fill(flag, costs, rest, heap, keys, size, trial, picks, count, layout, indptr, indices, weights, matrix, single)
        if reached + more > most_value:
            most_value = reached + more
            winner = np.empty(count, np.int64)
            for k in range(count):
                winner[k] = picks[k]
    return most_value, winner
