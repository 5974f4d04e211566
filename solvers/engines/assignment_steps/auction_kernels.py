"""Bertsekas' auction in whole numbers, compiled. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

NONE = 1 << 61
"""Cost of a forbidden pair; prices stay below half of it."""

KEPT = 24
"""Pairs that a row remembers where there are all, the cheapest when it last looked at all of its own."""

KEPT_SPARSE = 11
"""Pairs that a row of a sparse matrix remembers."""

MANY_PAIRS = 12
"""Pairs of a row, in the mean, from which on remembering is worth it."""


@kernel()
def remembering_phase(flag, indptr, columns, cost, price, owner, epsilon, span, most, memory, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Rows without a column bid until none is left, the one that was outbid last first.

    A row looks at the columns that it remembers. Prices only rise, so these are the cheapest as long as its two best are no dearer than
    its limit, the least that any other cost when it last looked at all of them.

    Parameters
    ----------
    flag : array
        Of a ``Stop``.
    indptr, columns, cost : arrays
        Pairs as a CSR matrix, whole costs.
    price, owner : arrays of shape (columns,)
        -1 for no owner.
    epsilon : int
        By which a bid goes beyond the second best.
    span : int
        By how much a row that has one column alone bids.
    most : int
        Bids, all phases together.
    memory : array of shape (rows, 2 KEPT + 2)
        Of each row the limit, -1 where it never looked, then costs and columns of the pairs that it remembers.
    counts : array of shape (2,)
        Bids, and looks at a whole row.

    Returns
    -------
    int
        0; 1 where it was stopped, 2 where prices grow beyond all bounds, 3 where ``most`` bids were not enough.
    """
    many = memory.shape[1] // 2 - 1
    stack, top = _bidders(owner, len(indptr) - 1)
    while top > 0:
        if asked(flag):
            return 1
        i = stack[top - 1]
        best, first, second = -1, NONE, NONE
        if memory[i, 0] >= 0:
            for k in range(1, many + 1):
                value = memory[i, k] + price[memory[i, many + k]]
                if value < second:
                    if value < first:
                        best, first, second = memory[i, many + k], value, first
                    else:
                        second = value
        if memory[i, 0] < 0 or second > memory[i, 0]:
            counts[1] += 1
            size, worst = 0, NONE
            for k in range(indptr[i], indptr[i + 1]):
                value = cost[k] + price[columns[k]]
                if value < worst:
                    at = size + 1 if size < many else many
                    if size < many:
                        size += 1
                    while at > 1 and memory[i, at - 1] > value:
                        memory[i, at] = memory[i, at - 1]
                        memory[i, many + at] = memory[i, many + at - 1]
                        at -= 1
                    memory[i, at] = value
                    memory[i, many + at] = k
                    if size == many:
                        worst = memory[i, many]
            memory[i, 0] = worst
            first = memory[i, 1]
            second = memory[i, 2] if size > 1 else NONE
            for k in range(1, many + 1):
                pair = memory[i, many + k] if k <= size else 0
                memory[i, k] = cost[pair] if k <= size else NONE
                memory[i, many + k] = columns[pair]
            best = memory[i, many + 1]
        counts[0] += 1
        price[best] += (second - first if second < NONE else span) + epsilon
        if price[best] > NONE // 2:
            return 2
        if counts[0] > most:
            return 3
        before = owner[best]
        owner[best] = i
        if before >= 0:
            stack[top - 1] = before
        else:
            top -= 1
    return 0


@kernel()
def sparse_phase(flag, indptr, columns, cost, price, owner, epsilon, span, most, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``remembering_phase`` with each row looking at all of its own pairs."""
    stack, top = _bidders(owner, len(indptr) - 1)
    while top > 0:
        if asked(flag):
            return 1
        i = stack[top - 1]
        best, first, second = -1, NONE, NONE
        for k in range(indptr[i], indptr[i + 1]):
            value = cost[k] + price[columns[k]]
            if value < second:
                if value < first:
                    best, first, second = columns[k], value, first
                else:
                    second = value
        counts[0] += 1
        price[best] += (second - first if second < NONE else span) + epsilon
        if price[best] > NONE // 2:
            return 2
        if counts[0] > most:
            return 3
        before = owner[best]
        owner[best] = i
        if before >= 0:
            stack[top - 1] = before
        else:
            top -= 1
    return 0


@kernel()
def _bidders(owner, rows):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Rows that own no column, the first one on top, and how many they are."""
    owning = np.zeros(rows, np.bool_)
    for j in range(len(owner)):
        if owner[j] >= 0:
            owning[owner[j]] = True
    stack = np.empty(rows, np.int64)
    top = 0
    for i in range(rows - 1, -1, -1):
        if not owning[i]:
            stack[top] = i
            top += 1
    return stack, top
