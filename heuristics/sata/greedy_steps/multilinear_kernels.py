r"""The multilinear extension of coverage and facility location in closed form, and the loops that climb and round on it, compiled.

Elements are drawn independently with probabilities x, and F(x) is the expected value of f. For an item whose elements, by falling
weight, give it w_1 >= w_2 >= ... with probabilities x_1, x_2, ..., with P_i = prod_{h<i} (1 - x_h) and T_i = w_i+1 x_i+1 + (1 - x_i+1)
T_i+1 (what the elements after i are expected to give)::

    F_j(x) = sum_i w_i x_i P_i,        dF_j/dx_i = P_i (w_i - T_i)

Coverage: equal weights make dF_j/dx_i = w_j prod_{h != i} (1 - x_h), the product formula, which is kept as one product an item.
Probabilities are counts out of ``steps``: what is summed up and moved is exact, and a full element is recognised as such.

``data`` is ``(state, position, item_starts, item_elements, item_weights, layout, indptr, indices, weights)``: the CSR of the function, its
transpose with the elements of an item by falling weight, the place of each entry in it, and the state, which is kept up to date: for
coverage prod (1 - x_h) of each item, else dF_j/dx_i of each entry of the transpose.
"""

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked
from ....instances.sata.set_functions import AT_ITEM
from .loops_kernels import sift

_DATA = "Tuple((f8[::1], i8[::1], i8[::1], i4[::1], f8[::1], i8, read(i4[::1]), read(i4[::1]), read(f8[::1])))"


@kernel(f"(i8, i8[::1], i8, {_DATA})")
def slope(e, count, steps, data):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """dF/dx_e; for coverage only while element ``e`` is not full."""
    state, position, _, _, _, layout, indptr, indices, weights = data
    total = 0.0
    if layout == AT_ITEM:
        for p in range(indptr[e], indptr[e + 1]):
            total += weights[indices[p]] * state[indices[p]]
        return total * steps / (steps - count[e])
    for p in range(indptr[e], indptr[e + 1]):
        total += state[position[p]]
    return total


@kernel(f"(i8, i8, i8[::1], i8, {_DATA})")
def move(e, to, count, steps, data):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Set x_e to ``to`` steps, and bring the items of ``e`` up to date."""
    state, _, item_starts, item_elements, item_weights, layout, indptr, indices, _ = data
    if layout == AT_ITEM:
        factor = (steps - to) / (steps - count[e])
        for p in range(indptr[e], indptr[e + 1]):
            state[indices[p]] *= factor
        count[e] = to
        return
    count[e] = to
    for p in range(indptr[e], indptr[e + 1]):
        j = indices[p]
        first, last = item_starts[j], item_starts[j + 1]
        rest = 0.0
        for q in range(last - 1, first - 1, -1):
            x = count[item_elements[q]] / steps
            state[q] = item_weights[q] - rest
            rest = item_weights[q] * x + (1.0 - x) * rest
        before = 1.0
        for q in range(first, last):
            state[q] *= before
            before *= 1.0 - count[item_elements[q]] / steps


@kernel(f"(i8[::1], i8[::1], i8, {_DATA})")
def value(flag, count, steps, data):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """F(x); a part of it where it was asked to stop."""
    state, _, item_starts, item_elements, item_weights, layout, _, _, weights = data
    total = 0.0
    if layout == AT_ITEM:
        for j in range(len(weights)):
            total += weights[j] * (1.0 - state[j])
        return total
    for j in range(len(item_starts) - 1):
        if asked(flag):
            break
        before = 1.0
        for q in range(item_starts[j], item_starts[j + 1]):
            x = count[item_elements[q]] / steps
            total += item_weights[q] * x * before
            before *= 1.0 - x
    return total


@kernel(f"(i8[::1], i8, f8[::1], i4[::1], i8[::1], i8, i8[::1], i8, {_DATA})")
def climb(flag, rounds, bounds, groups, room, most, count, steps, data):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``rounds`` steps of the continuous greedy, as far as the ``flag`` lets it.

    Each adds 1 / steps to every element of a base, picked one by one by the slope.

    Slopes never rise, so old ones (``bounds``) are upper bounds, and a heap finds the largest with few evaluations.
    """
    n, evaluations = len(groups), 0
    heap, keys = np.empty(n, np.int32), np.empty(n)
    moved_at = np.empty(n, np.int64)  # how many elements of the base had been moved when the slope was evaluated
    for _ in range(rounds):
        left, size, moved = room.copy(), 0, 0
        for e in range(n):
            moved_at[e] = -1
            if left[groups[e]] > 0:
                heap[size], keys[size] = e, bounds[e]
                size += 1
        for at in range(size // 2 - 1, -1, -1):
            sift(keys, heap, size, at)
        while moved < most and size > 0 and not asked(flag):
            e = heap[0]
            if left[groups[e]] > 0:
                if moved_at[e] != moved:
                    keys[0] = min(keys[0], slope(e, count, steps, data))
                    bounds[e] = keys[0]
                    moved_at[e] = moved
                    evaluations += 1
                    sift(keys, heap, size, 0)
                    continue
                move(e, count[e] + 1, count, steps, data)
                left[groups[e]] -= 1
                moved += 1
            size -= 1
            heap[0], keys[0] = heap[size], keys[size]
            sift(keys, heap, size, 0)
    return evaluations


@kernel(f"(i8[::1], i8[::1], i8[::1], i8[::1], i8, {_DATA})")
def pipage(flag, starts, members, count, steps, data):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Make every count 0 or ``steps``: within a group, two broken ones trade until one is whole, uphill.

    Along x_a + t, x_b - t the extension is convex (submodularity), so F rises, or stays, on the side of the larger slope.
    """
    trades = 0
    for g in range(len(starts) - 1):
        open_ = -1
        for k in range(starts[g], starts[g + 1]):
            e = members[k]
            if asked(flag):
                return trades
            if count[e] == 0 or count[e] == steps:
                continue
            if open_ < 0:
                open_ = e
                continue
            a, b = open_, e
            if slope(b, count, steps, data) > slope(a, count, steps, data):
                a, b = b, a
            much = min(steps - count[a], count[b])
            # The one that falls goes first: a full element would leave no product to take the other out of.
            move(b, count[b] - much, count, steps, data)
            move(a, count[a] + much, count, steps, data)
            trades += 1
            open_ = a if 0 < count[a] < steps else b if 0 < count[b] < steps else -1
    return trades
