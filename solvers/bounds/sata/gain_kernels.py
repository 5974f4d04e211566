"""Marginal gains of coverage and facility location, compiled.

A function is handed over as the ``arrays`` of its ``ItemWeights``: ``(layout, indptr, indices, weights, matrix, single)``, the last two
for matrices of doubles and of single numbers. A set S is ``best``, the largest weight that one of its elements gives to each item, so that
f(S) = sum(best). Sums are in float64 whatever the matrix holds, and in one order of additions, so that two loops that ask for the same gain
get the same number to the bit. Loops over elements take a ``Stop.flag`` first.
"""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked
from ....instances.sata.set_functions import AT_ITEM, IN_MATRIX

OVER_ITEMS = "i8, read(i4[::1]), read(i4[::1]), read(f8[::1]), read(f8[:, ::1]), read(f4[:, ::1])"
"""Declared types of a function's arrays."""


@inner
def _gain_of_row(matrix, e, best):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    # Four sums at once, because one would wait for its own last addition.
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    items = matrix.shape[1]
    full = items - items % 4
    for j in range(0, full, 4):
        a += max(matrix[e, j] - best[j], 0.0)
        b += max(matrix[e, j + 1] - best[j + 1], 0.0)
        c += max(matrix[e, j + 2] - best[j + 2], 0.0)
        d += max(matrix[e, j + 3] - best[j + 3], 0.0)
    for j in range(full, items):
        a += max(matrix[e, j] - best[j], 0.0)
    return (a + b) + (c + d)


@inner
def gain(e, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Gain of element ``e`` over the set that ``best`` stands for."""
    if layout == IN_MATRIX:
        return _gain_of_row(matrix, e, best) if len(matrix) > 0 else _gain_of_row(single, e, best)
    total = 0.0
    if layout == AT_ITEM:
        for p in range(indptr[e], indptr[e + 1]):
            total += weights[indices[p]] - best[indices[p]]
    else:
        for p in range(indptr[e], indptr[e + 1]):
            total += max(weights[p] - best[indices[p]], 0.0)
    return total


@kernel(f"(i8, f8[::1], {OVER_ITEMS})")
def take(e, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Add element ``e`` to the set: raises ``best`` in place."""
    if layout == IN_MATRIX:
        if len(matrix) > 0:
            for j in range(matrix.shape[1]):
                best[j] = max(best[j], matrix[e, j])
        else:
            for j in range(single.shape[1]):
                best[j] = max(best[j], single[e, j])
    else:
        for p in range(indptr[e], indptr[e + 1]):
            j = indices[p]
            best[j] = max(best[j], weights[j] if layout == AT_ITEM else weights[p])


@kernel(f"(i8[::1], i8[::1], f8[::1], {OVER_ITEMS})")
def gains_of(flag, elements, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Gain of each of ``elements``, shape (elements,); 0 where it was asked to stop before."""
    found = np.zeros(len(elements))
    for k in range(len(elements)):
        if asked(flag):
            break
        found[k] = gain(elements[k], best, layout, indptr, indices, weights, matrix, single)
    return found


@kernel(f"(i8[::1], f8[::1], f8, i4[::1], i8[::1], i8, f8, f8[::1], {OVER_ITEMS})")
def sweep(flag, costs, budget, groups, room, most, floor, best, layout, indptr, indices, weights, matrix, single):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """A set picked almost greedily: sweeps with a falling threshold on the gain per cost, each a tenth below the last.

    Every set proves a bound; one near greedy's proves a good one, and this needs no heap. The number of sweeps is fixed beforehand: a
    threshold among the smallest numbers falls no further.
    """
    n = len(groups)
    known = np.empty(n)  # an upper bound on the gain per cost of each element
    top = 0.0
    for e in range(n):
        known[e] = gain(e, best, layout, indptr, indices, weights, matrix, single) / costs[e]
        if costs[e] > budget or room[groups[e]] == 0:
            known[e] = -1.0
        top = max(top, known[e])
        if asked(flag):
            return np.empty(0, np.int64)
    picks = np.empty(most, np.int64)
    count, threshold = 0, 0.9 * top
    for _ in range(int(np.ceil(np.log(floor) / np.log(0.9))) - 1):
        if count == most:
            break
        for e in range(n):
            if asked(flag):
                return picks[:count]
            if known[e] < threshold:
                continue
            if costs[e] > budget or room[groups[e]] == 0:
                known[e] = -1.0
                continue
            known[e] = gain(e, best, layout, indptr, indices, weights, matrix, single) / costs[e]
            if known[e] >= threshold:
                take(e, best, layout, indptr, indices, weights, matrix, single)
                picks[count] = e
                count += 1
                known[e] = -1.0
                budget -= costs[e]
                room[groups[e]] -= 1
                if count == most:
                    break
        threshold *= 0.9
    return picks[:count]
