"""Prices of a known assignment by shortest paths, compiled. Imports numba: import it inside functions only."""

from __future__ import annotations

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked


@kernel()
def lower_labels(flag, indptr, columns, cost, column, price, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Lower the price of each row's column until no other column is better for the row, in sweeps up and down (Bellman 1958).

    Parameters
    ----------
    flag : array
        Of a ``Stop``.
    indptr, columns, cost : arrays
        Pairs as a CSR matrix; costs are whole.
    column : array of shape (rows,)
    price : array of shape (columns,), whole
        From above; changed in place.
    most : int
        Sweeps.

    Returns
    -------
    bool
        Whether nothing is left to lower.
    """
    rows = len(column)
    for sweep in range(most):
        changed = False
        for turn in range(rows):
            if turn & 127 == 0 and asked(flag):
                return False
            i = turn if sweep % 2 == 0 else rows - 1 - turn
            own = column[i]
            least, paid = price[own], price[own]
            for k in range(indptr[i], indptr[i + 1]):
                j = columns[k]
                if j == own:
                    paid = cost[k]
            for k in range(indptr[i], indptr[i + 1]):
                least = min(least, cost[k] + price[columns[k]] - paid)
            if least < price[own]:
                price[own] = least
                changed = True
        if not changed:
            return True
    return False
