"""The transpose of a sparse matrix, compiled. Imports numba: import it inside functions only."""

import numpy as np

from .kernels import kernel
from .stop_kernel import asked


@kernel("(i8[::1], i8, read(i4[::1]), read(i4[::1]), read(f8[::1]))")
def transpose(flag, columns, indptr, indices, values):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """A matrix by columns: where each starts, the rows of its entries, ascending, and their values, if any; unfinished if asked to stop."""
    starts = np.zeros(columns + 1, np.int64)
    for p in range(len(indices)):
        starts[indices[p] + 1] += 1
    at = np.empty(columns, np.int64)
    for j in range(columns):
        at[j] = starts[j]
        starts[j + 1] += starts[j]
    rows, given = np.empty(len(indices), np.int32), np.empty(len(values))
    for i in range(len(indptr) - 1):
        if asked(flag):
            break
        for p in range(indptr[i], indptr[i + 1]):
            j = indices[p]
            rows[at[j]] = i
            if len(values) > 0:
                given[at[j]] = values[p]
            at[j] += 1
    return starts, rows, given
