"""Bertsekas' auction in whole numbers, compiled. Imports numba: import it inside functions only."""

import numpy as np

from .....formulations.kernels import inner, kernel
from .....formulations.stop_kernel import asked

NONE = 1 << 61
"""Cost of a forbidden pair; prices stay below half of it."""

LINE = 4
"""Pairs that a row remembers together: with their limit they are one line of a processor's memory."""

LINES, LINES_SPARSE = 6, 3
"""Lines of a row, its cheapest pairs first when it last looked at all of them: with all pairs allowed, and of a sparse matrix."""

MANY_PAIRS = 12
"""Mean number of pairs of a row from which on remembering is worth it."""

_COLUMN = (1 << 32) - 1


BLOCK = 64
"""Costs of a row that are compared together with what it remembers: as many as a processor takes in some strides."""

ENOUGH = LINE
"""Pairs at 0 that a row is content to remember."""

ROUNDING = 2.0**-50
"""Relative rounding error of a few multiplications and additions, at most."""


@kernel("(i8[::1], i8[::1], read(i4[::1]), i8[::1], read(f8[::1]), f8, i8, i8, f8, i8[::1], i8[::1], i8, i8, i8, i8[:, :, ::1], i8[::1])")
def remembering_phase(flag, indptr, columns, cost, real, scale, least, many, slack, price, owner, epsilon, span, most, memory, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Rows without a column bid in turn until none is left; a row that is outbid takes the turn of the one that outbids it.

    A row looks at the pairs that it remembers, line by line. Prices only rise, so its two best are known as soon as they are no dearer than
    the limit of a line: the least cost of any pair behind it when the row last looked at all of them. Taking turns, rather than having an
    outbid row bid at once, lets a processor read one row while it decides another.

    Columns and whole costs of the CSR matrix are empty where all pairs are allowed; then ``real`` holds their costs as they are, shape
    (rows * columns,). ``scale``, ``least`` and ``many`` are those of ``auction.Steps``, and counted costs differ by at most ``slack`` from
    ``scale * many`` times the cost less ``least``. A bid exceeds the second best by ``epsilon``, that of a row with one column by ``span``;
    ``most`` limits the bids of all phases, and ``counts`` are bids and looks at a whole row. ``memory`` is that of ``auction.remembered``;
    a line is its limit (-1 where the row never looked), costs, and columns, two a word.

    Returns 0; 1 where it was stopped, 2 where prices grow beyond all bounds, 3 where ``most`` bids were not enough.
    """
    lines = memory.shape[1]
    waiting, left = _bidders(owner, len(indptr) - 1)
    values, pairs = np.empty(LINE * lines + 1, np.int64), np.empty(LINE * lines + 1, np.int64)
    shift = float(least) * float(many)
    near = np.empty(len(price) if len(real) > 0 else 0, np.float64)
    for j in range(len(near)):
        near[j] = price[j] - shift
    turn, guess, floor = 0, NONE, NONE
    while left > 0:
        if asked(flag):
            return 1
        i = waiting[turn]
        best, first, second = np.int64(-1), NONE, NONE
        known = False
        if memory[i, 0, 0] >= 0:
            for line in range(lines):
                for k in range(LINE):
                    column = memory[i, line, 1 + LINE + k // 2] >> 32 * (k % 2) & _COLUMN
                    value = memory[i, line, 1 + k] + price[column]
                    if value < second:
                        if value < first:
                            best, first, second = column, value, first
                        else:
                            second = value
                if second <= memory[i, line, 0]:
                    known = True
                    break
        if not known:
            counts[1] += 1
            if len(real) > 0:
                floor = _look_at_all(real[indptr[i] : indptr[i + 1]], scale, least, many, slack, near, price, guess, values, pairs)
                guess = floor + floor // 2
            else:
                _look(columns, cost, price, indptr[i], indptr[i + 1], values, pairs)
            best, first, second = pairs[0], values[0], values[1]
            for line in range(lines):
                memory[i, line, 0] = min(values[LINE * (line + 1)], floor)
                for k in range(LINE):
                    at = LINE * line + k
                    column, paid = np.int64(0), NONE
                    if values[at] < NONE:
                        column, paid = pairs[at], values[at] - price[pairs[at]]
                    memory[i, line, 1 + k] = paid
                    if k % 2 == 0:
                        memory[i, line, 1 + LINE + k // 2] = column
                    else:
                        memory[i, line, 1 + LINE + k // 2] |= column << 32
        counts[0] += 1
        price[best] += (second - first if second < NONE else span) + epsilon
        if price[best] > NONE // 2:
            return 2
        if counts[0] > most:
            return 3
        if len(near) > 0:
            near[best] = price[best] - shift
        before = owner[best]
        owner[best] = i
        if before >= 0:
            waiting[turn] = before
            turn += 1
        else:
            left -= 1
            waiting[turn] = waiting[left]
        if turn >= left:
            turn = 0
    return 0


@inner
def _look(columns, cost, price, begin, end, values, pairs):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Columns of the cheapest pairs from ``begin`` to ``end`` at present prices, in ascending order; ``NONE`` where there are no more."""
    size, many = 0, len(values)
    worst = NONE
    for k in range(begin, end):
        value = cost[k] + price[columns[k]]
        if value < worst:
            at = min(size, many - 1)
            size = min(size + 1, many)
            while at > 0 and values[at - 1] > value:
                values[at], pairs[at] = values[at - 1], pairs[at - 1]
                at -= 1
            values[at], pairs[at] = value, columns[k]
            if size == many:
                worst = values[many - 1]
    values[size:] = NONE


@inner
def _look_at_all(costs, scale, least, many, slack, near, price, guess, values, pairs):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``_look`` at the costs of all columns, of which there are more than are kept; only those near enough are counted in whole numbers.

    Where those kept are no dearer than ``guess``, no other can be cheaper; else it looks again with a larger guess. It ends early once none
    can be cheaper: neither costs nor prices are below 0.
    """
    last, unit = len(values) - 1, scale * many
    for attempt in range(3):
        size, worst, limit = 0, NONE, guess + guess * ROUNDING + slack
        for begin in range(0, len(costs), BLOCK):
            some, own = costs[begin : begin + BLOCK], near[begin : begin + BLOCK]
            hits = 0
            for k in range(len(some)):
                hits += some[k] * unit + own[k] < limit
            if hits == 0:
                continue
            for k in range(len(some)):
                if some[k] * unit + own[k] < limit:
                    value = (round(some[k] * scale) - least) * many + price[begin + k]
                    if value < worst:
                        at = min(size, last)
                        size = min(size + 1, last + 1)
                        while at > 0 and values[at - 1] > value:
                            values[at], pairs[at] = values[at - 1], pairs[at - 1]
                            at -= 1
                        values[at], pairs[at] = value, begin + k
                        if size > last:
                            worst = values[last]
                            limit = min(limit, worst + worst * ROUNDING + slack)
            if size >= ENOUGH and values[ENOUGH - 1] == 0:
                values[ENOUGH:] = NONE
                return np.int64(0)
        if worst <= guess:
            return worst
        guess = min(2 * (guess + many), NONE) if attempt == 0 else NONE
    return NONE


@kernel("(i8[::1], i8[::1], read(i4[::1]), i8[::1], i8[::1], i8[::1], i8, i8, i8, i8[::1])")
def sparse_phase(flag, indptr, columns, cost, price, owner, epsilon, span, most, counts):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """``remembering_phase`` where each row looks at all of its pairs, and the row that was outbid last bids first."""
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


@inner
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
