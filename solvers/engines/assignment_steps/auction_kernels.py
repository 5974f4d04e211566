"""Bertsekas' auction in whole numbers, compiled. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

NONE = 1 << 61
"""Cost of a forbidden pair; prices stay below half of it."""

KEPT = 24
"""Columns that a row of a dense matrix remembers, the cheapest when it last looked at all."""

KEPT_SPARSE = 8
"""Pairs that a row of a sparse matrix remembers."""

MANY_PAIRS = 12
"""Pairs of a row, in the mean, from which on remembering is worth it."""


@kernel()
def dense_phase(flag, cost, price, owner, column, epsilon, span, most, kept, kept_cost, limit, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Rows without a column bid until none is left, the one that was outbid last first.

    A row looks at the columns that it remembers. Prices only rise, so these are the cheapest as long as its two best are no dearer than
    ``limit``, the least that any other cost when it last looked at all of them.

    Parameters
    ----------
    flag : array
        Of a ``Stop``.
    cost : array of shape (rows, columns), whole
    price, owner : arrays of shape (columns,)
    column : array of shape (rows,)
        -1 for none.
    epsilon : int
        By which a bid goes beyond the second best.
    span : int
        By how much a row that has one column alone bids.
    most : int
        Bids, all phases together.
    kept, kept_cost : arrays of shape (rows, KEPT)
    limit : array of shape (rows,)
        -1 where the row never looked.
    counts : array of shape (2,)
        Bids, and looks at a whole row.

    Returns
    -------
    int
        0; 1 where it was stopped, 2 where prices grow beyond all bounds, 3 where ``most`` bids were not enough.
    """
    rows, columns = cost.shape
    many = kept.shape[1]
    stack = np.empty(rows, np.int64)
    top = 0
    for i in range(rows - 1, -1, -1):
        if column[i] < 0:
            stack[top] = i
            top += 1
    while top > 0:
        if asked(flag):
            return 1
        top -= 1
        i = stack[top]
        best, first, second = -1, NONE, NONE
        if limit[i] >= 0:
            for k in range(many):
                value = kept_cost[i, k] + price[kept[i, k]]
                if value < second:
                    if value < first:
                        best, first, second = kept[i, k], value, first
                    else:
                        second = value
        if limit[i] < 0 or second > limit[i]:
            counts[1] += 1
            size, worst = 0, NONE
            values = kept_cost[i]
            for j in range(columns):
                value = cost[i, j] + price[j]
                if value < worst:
                    at = size if size < many else many - 1
                    if size < many:
                        size += 1
                    while at > 0 and values[at - 1] > value:
                        values[at] = values[at - 1]
                        kept[i, at] = kept[i, at - 1]
                        at -= 1
                    values[at] = value
                    kept[i, at] = j
                    if size == many:
                        worst = values[many - 1]
            limit[i] = worst
            best, first = kept[i, 0], values[0]
            second = values[1] if size > 1 else NONE
            for k in range(size):
                values[k] = cost[i, kept[i, k]]
            for k in range(size, many):
                values[k] = NONE
                kept[i, k] = 0
        counts[0] += 1
        price[best] += (second - first if second < NONE else span) + epsilon
        if price[best] > NONE // 2:
            return 2
        if counts[0] > most:
            return 3
        before = owner[best]
        owner[best] = i
        column[i] = best
        if before >= 0:
            column[before] = -1
            stack[top] = before
            top += 1
    return 0


@kernel()
def remembering_phase(flag, indptr, columns, cost, price, owner, column, epsilon, span, most, kept, kept_cost, limit, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``dense_phase`` for the pairs of a CSR matrix, of which a row remembers as many as ``kept`` has columns."""
    rows = len(indptr) - 1
    many = kept.shape[1]
    stack = np.empty(rows, np.int64)
    top = 0
    for i in range(rows - 1, -1, -1):
        if column[i] < 0:
            stack[top] = i
            top += 1
    while top > 0:
        if asked(flag):
            return 1
        top -= 1
        i = stack[top]
        best, first, second = -1, NONE, NONE
        if limit[i] >= 0:
            for k in range(many):
                value = kept_cost[i, k] + price[kept[i, k]]
                if value < second:
                    if value < first:
                        best, first, second = kept[i, k], value, first
                    else:
                        second = value
        if limit[i] < 0 or second > limit[i]:
            counts[1] += 1
            size, worst = 0, NONE
            values = kept_cost[i]
            for k in range(indptr[i], indptr[i + 1]):
                j = columns[k]
                value = cost[k] + price[j]
                if value < worst:
                    at = size if size < many else many - 1
                    if size < many:
                        size += 1
                    while at > 0 and values[at - 1] > value:
                        values[at] = values[at - 1]
                        kept[i, at] = kept[i, at - 1]
                        at -= 1
                    values[at] = value
                    kept[i, at] = k
                    if size == many:
                        worst = values[many - 1]
            limit[i] = worst
            first = values[0]
            second = values[1] if size > 1 else NONE
            for k in range(size):
                values[k] = cost[kept[i, k]]
                kept[i, k] = columns[kept[i, k]]
            for k in range(size, many):
                values[k] = NONE
                kept[i, k] = 0
            best = kept[i, 0]
        counts[0] += 1
        price[best] += (second - first if second < NONE else span) + epsilon
        if price[best] > NONE // 2:
            return 2
        if counts[0] > most:
            return 3
        before = owner[best]
        owner[best] = i
        column[i] = best
        if before >= 0:
            column[before] = -1
            stack[top] = before
            top += 1
    return 0


@kernel()
def sparse_phase(flag, indptr, columns, cost, price, owner, column, epsilon, span, most, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``dense_phase`` for the pairs of a CSR matrix, each row looking at all of its own."""
    rows = len(indptr) - 1
    stack = np.empty(rows, np.int64)
    top = 0
    for i in range(rows - 1, -1, -1):
        if column[i] < 0:
            stack[top] = i
            top += 1
    while top > 0:
        if asked(flag):
            return 1
        top -= 1
        i = stack[top]
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
        column[i] = best
        if before >= 0:
            column[before] = -1
            stack[top] = before
            top += 1
    return 0
