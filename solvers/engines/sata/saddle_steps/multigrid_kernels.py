"""Compiled loops of multigrid by aggregation, over symmetric CSR matrices. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel

STRONG = 0.5
"""Two rows are joined if their coupling has this share of the strongest that the first of them has."""

LARGEST = 4
"""Rows of an aggregate: two, and what finds all that it is strongly coupled to in aggregates already."""


@kernel("(i4[::1], i4[::1], f8[::1], i4[::1])")
def aggregate(starts, columns, values, group):  # type: ignore[no-untyped-def]
    """Join each row with the free one that it is coupled to most strongly; returns the number of groups."""
    size = np.zeros(len(group), np.int32)
    group[:] = -1
    count = 0
    for row in range(len(group)):
        if group[row] >= 0:
            continue
        free, nearest, coupling, strongest = -1, -1, 0.0, 0.0
        for e in range(starts[row], starts[row + 1]):
            column, value = columns[e], -values[e]
            if column == row:
                continue
            if value > strongest:
                nearest, strongest = column, value
            if group[column] < 0 and value > coupling:
                free, coupling = column, value
        if free >= 0 and coupling >= STRONG * strongest:
            group[row] = group[free] = count
            size[count] = 2
            count += 1
        elif nearest >= 0 and group[nearest] >= 0 and size[group[nearest]] < LARGEST:
            group[row] = group[nearest]
            size[group[row]] += 1
        else:
            group[row] = count
            size[count] = 1
            count += 1
    return count


@kernel("(i4[::1], i4[::1], f8[::1], i4[::1], i8)")
def coarsen(starts, columns, values, group, count):  # type: ignore[no-untyped-def]
    """The matrix of the groups, of which each entry is a sum over pairs of members: CSR arrays, the diagonal first in each row."""
    first = np.zeros(count + 1, np.int32)
    for row in range(len(group)):
        first[group[row] + 1] += 1
    for c in range(count):
        first[c + 1] += first[c]
    member, at = np.empty(len(group), np.int32), first.copy()
    for row in range(len(group)):
        member[at[group[row]]] = row
        at[group[row]] += 1
    new_starts, place = np.zeros(count + 1, np.int32), np.full(count, -1, np.int32)
    new_columns, new_values, k = np.empty(len(columns), np.int32), np.empty(len(columns)), 0
    for c in range(count):
        begin = k
        place[c] = k
        new_columns[k], new_values[k] = c, 0.0
        k += 1
        for q in range(first[c], first[c + 1]):
            for e in range(starts[member[q]], starts[member[q] + 1]):
                other = group[columns[e]]
                if place[other] < begin:
                    place[other] = k
                    new_columns[k], new_values[k] = other, values[e]
                    k += 1
                else:
                    new_values[place[other]] += values[e]
        new_starts[c + 1] = k
    return new_starts, new_columns[:k].copy(), new_values[:k].copy()


@kernel("(i4[::1], i4[::1], f8[::1], i4[::1], i4[::1], f4[::1])")
def sort_halves(starts, columns, values, middle, new_columns, new_values):  # type: ignore[no-untyped-def]
    """The entries of each row left of the diagonal, from ``middle`` on those right of it, and last the diagonal itself."""
    for row in range(len(middle)):
        left, right = starts[row], starts[row + 1] - 2
        for e in range(starts[row], starts[row + 1]):
            if columns[e] < row:
                new_columns[left], new_values[left] = columns[e], values[e]
                left += 1
            elif columns[e] > row:
                new_columns[right], new_values[right] = columns[e], values[e]
                right -= 1
            else:
                new_columns[starts[row + 1] - 1], new_values[starts[row + 1] - 1] = columns[e], values[e]
        middle[row] = left


@kernel("(i4[::1], i4[::1], i4[::1], f4[::1], f8[::1], f8[::1], f8[::1], i4[::1], f8[::1])")
def descend_a_level(starts, middle, columns, values, inverse, given, solution, group, coarse):  # type: ignore[no-untyped-def]
    """Gauss-Seidel forwards from zero, then what is left of ``given``, summed over each group."""
    for row in range(len(given)):
        total = given[row]
        for e in range(starts[row], middle[row]):
            total -= values[e] * solution[columns[e]]
        solution[row] = total * inverse[row]
    coarse[:] = 0.0
    for row in range(len(given)):
        total = 0.0
        for e in range(middle[row], starts[row + 1] - 1):
            total -= values[e] * solution[columns[e]]
        coarse[group[row]] += total


@kernel("(i4[::1], i4[::1], f4[::1], f8[::1], f8[::1], f8[::1], i4[::1], f8[::1])")
def ascend_a_level(starts, columns, values, inverse, given, solution, group, coarse):  # type: ignore[no-untyped-def]
    """Add what the groups found, then Gauss-Seidel backwards."""
    for row in range(len(given)):
        solution[row] += coarse[group[row]]
    for row in range(len(given) - 1, -1, -1):
        total = given[row]
        for e in range(starts[row], starts[row + 1] - 1):
            total -= values[e] * solution[columns[e]]
        solution[row] = total * inverse[row]


@kernel("(i4[::1], i4[::1], f4[::1], f8[::1], f8[::1], f8[::1])")
def times(starts, columns, values, inverse, vector, product):  # type: ignore[no-untyped-def]
    """The matrix times ``vector``, into ``product``."""
    for row in range(len(product)):
        total = vector[row] / inverse[row]
        for e in range(starts[row], starts[row + 1] - 1):
            total += values[e] * vector[columns[e]]
        product[row] = total
