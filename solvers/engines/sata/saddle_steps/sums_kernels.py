"""A sparse matrix times a vector, of which threads take rows each. Imports numba: import it inside functions only."""

from __future__ import annotations

from .....formulations.kernels import kernel

_READ = "read(i4[::1]), read(i4[::1]), read(f8[::1])"
"""The matrix: the graph's arrays cannot be written to."""


@kernel(f"({_READ}, f8[::1], f8[::1], i8, i8)")
def multiply(starts, columns, values, vector, product, begin, end):  # type: ignore[no-untyped-def]
    """The rows from ``begin`` to ``end`` of the matrix (CSR), times ``vector``, are written into ``product``."""
    for row in range(begin, end):
        total = 0.0
        for e in range(starts[row], starts[row + 1]):
            total += values[e] * vector[columns[e]]
        product[row] = total
