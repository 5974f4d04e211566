"""Matchings of the most pairs in a bipartite graph, and what proves that there are no larger ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.integer]
Marks = NDArray[np.bool_]

MANY_PAIRS = 50_000
"""Pairs from which on a compiled loop is worth loading."""

LOOKS = 8
"""Times that paths may look at each pair, in the mean."""


def largest_matching(indptr: Indices, columns: Indices, num_columns: int) -> NDArray[np.int64]:
    """A matching of the most pairs: of many by paths that are found depth first, where these are short, else that of Hopcroft and Karp
    (1973).

    Parameters
    ----------
    indptr, columns : arrays
        Allowed pairs as a CSR matrix, one row a robot.
    num_columns : int

    Returns
    -------
    array of shape (rows,)
        Column of each row, -1 for none.
    """
    rows = len(indptr) - 1
    if len(columns) == rows * num_columns:
        return np.where(np.arange(rows) < num_columns, np.arange(rows), -1)
    if len(columns) >= MANY_PAIRS:
        from .matching_kernels import matched

        found, largest = matched(indptr, columns, num_columns, LOOKS * len(columns))
        if largest:
            return np.asarray(found)
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import maximum_bipartite_matching

    graph = csr_matrix((np.ones(len(columns), np.int8), columns, indptr), shape=(rows, num_columns))
    return np.asarray(maximum_bipartite_matching(graph, perm_type="column"), dtype=np.int64)


def surplus_rows(indptr: Indices, columns: Indices, num_columns: int, matched: NDArray[np.int64]) -> tuple[Marks, Marks]:
    """Rows that alternating paths lead to from rows without a column, and the columns on them (Dulmage and Mendelsohn 1958).

    Parameters
    ----------
    indptr, columns, num_columns
        See ``largest_matching``.
    matched : array of shape (rows,)
        A matching of the most pairs.

    Returns
    -------
    (array of shape (rows,), array of shape (columns,))
        The other rows and these columns meet every pair, and are as many as the matching has pairs (König 1931). Each of these columns
        is matched in every largest matching, each of the other rows too.
    """
    rows = len(indptr) - 1
    holder = np.full(num_columns, -1, dtype=np.int64)
    held = matched >= 0
    holder[matched[held]] = np.nonzero(held)[0]
    seen_rows, seen_columns = ~held, np.zeros(num_columns, dtype=bool)
    front = np.nonzero(~held)[0]
    while len(front):
        counts = (indptr[front + 1] - indptr[front]).astype(np.int64)
        before = np.cumsum(counts) - counts
        places = np.repeat(indptr[front] - before, counts) + np.arange(int(counts.sum()))
        reached = np.unique(columns[places])
        reached = reached[~seen_columns[reached]]
        seen_columns[reached] = True
        front = holder[reached]
        front = front[front >= 0]
        front = front[~seen_rows[front]]
        seen_rows[front] = True
    assert rows == len(seen_rows)
    return seen_rows, seen_columns
