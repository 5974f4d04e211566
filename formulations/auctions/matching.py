"""Largest matchings of bipartite graphs, and the vertex covers that prove them largest."""

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import Flags as Marks

Indices = NDArray[np.integer]

MANY_PAIRS = 50_000
"""Pairs from which on a compiled loop is worth loading."""

LOOKS = 8
"""Pairs that the search for paths may look at, for each pair that there is."""


def largest_matching(indptr: Indices, columns: Indices, num_columns: int) -> NDArray[np.int64]:
    """Column of each row in a largest matching, -1 for none; ``indptr`` and ``columns`` are the allowed pairs as a CSR matrix.

    Of many pairs by augmenting paths found depth first, as long as these are short; else by Hopcroft and Karp (1973).
    """
    rows = len(indptr) - 1
    if len(columns) == rows * num_columns:
        return np.where(np.arange(rows) < num_columns, np.arange(rows), -1)
    if len(columns) >= MANY_PAIRS:
        from .matching_kernels import matched

        columns_of_rows, largest = matched(indptr, columns, num_columns, LOOKS * len(columns))
        if largest:
            return np.asarray(columns_of_rows)
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import maximum_bipartite_matching

    graph = csr_matrix((np.ones(len(columns), np.int8), columns, indptr), shape=(rows, num_columns))
    return np.asarray(maximum_bipartite_matching(graph, perm_type="column"), dtype=np.int64)


def surplus_rows(indptr: Indices, columns: Indices, num_columns: int, matched: NDArray[np.int64]) -> tuple[Marks, Marks]:
    """Rows that alternating paths from unmatched rows lead to, and the columns on these paths (Dulmage and Mendelsohn 1958).

    ``matched`` is a largest matching as of ``largest_matching``. The other rows and these columns cover every pair, and are as many as the
    matching has pairs (König 1931). Every largest matching matches each of them.
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
