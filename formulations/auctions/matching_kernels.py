"""Largest matchings, compiled. Imports numba: import it inside functions only."""

import numpy as np

from ..kernels import kernel


@kernel("(read(i4[::1]), read(i4[::1]), i8, i8)")
def matched(indptr, columns, num_columns, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """A matching, column of each row or -1, and whether it is known to be a largest one.

    Rows take free columns; then augmenting paths are sought from each row left over, depth first with a look ahead for a free column, until
    a round finds none (Pothen and Fan 1990). ``most`` limits how many pairs are looked at, which could be rows times pairs.
    """
    rows = len(indptr) - 1
    own, holder = np.full(rows, -1), np.full(num_columns, -1)
    for i in range(rows):
        for k in range(indptr[i], indptr[i + 1]):
            if holder[columns[k]] < 0:
                own[i], holder[columns[k]] = columns[k], i
                break
    ahead, seen = np.empty(rows, np.int64), np.full(rows, -1)
    for i in range(rows):
        ahead[i] = indptr[i]
    at, path = np.zeros(rows, np.int64), np.zeros(rows, np.int64)
    left, turn = np.empty(rows, np.int64), 0
    while True:
        found = waiting = 0
        for i in range(rows):
            if own[i] < 0:
                left[waiting] = i
                waiting += 1
        for k in range(waiting):
            start = left[k]
            if most < 0:
                return own, False
            depth, path[0], at[start], seen[start] = 0, start, indptr[start], turn
            while depth >= 0:
                i = path[depth]
                free = -1
                while ahead[i] < indptr[i + 1]:  # a column that was taken once stays so
                    if holder[columns[ahead[i]]] < 0:
                        free = columns[ahead[i]]
                        break
                    ahead[i] += 1
                if free >= 0:
                    for d in range(depth, -1, -1):
                        before = own[path[d]]
                        own[path[d]], holder[free] = free, path[d]
                        free = before
                    found += 1
                    break
                deeper = False
                while at[i] < indptr[i + 1]:
                    other = holder[columns[at[i]]]
                    at[i] += 1
                    most -= 1
                    if seen[other] != turn:
                        seen[other], at[other] = turn, indptr[other]
                        depth += 1
                        path[depth] = other
                        deeper = True
                        break
                if not deeper:
                    depth -= 1
        if found == 0:
            break
        turn += 1
    return own, True
