"""Prices of a known assignment by shortest paths, compiled. Imports numba: import it inside functions only."""

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked


@kernel(
    "(i8[::1], i8[::1], read(i4[::1]), read(f8[::1]), i8[::1], f8[::1], i8)",
    "(i8[::1], i8[::1], read(i4[::1]), i8[::1], i8[::1], i8[::1], i8)",
)
def lower_labels(flag, indptr, columns, cost, column, price, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Lower the price of each row's column until no other column is better for the row, in sweeps up and down (Bellman 1958).

    ``price`` begins from above and is changed in place, by at most ``most`` sweeps; returns whether nothing is left to lower.
    """
    rows = len(column)
    for sweep in range(most):
        changed = False
        for turn in range(rows):
            if turn & 127 == 0 and asked(flag):
                return False
            i = turn if sweep % 2 == 0 else rows - 1 - turn
            own = column[i]
            first = indptr[i]
            least, paid = cost[first] + price[columns[first]], cost[first]
            for k in range(first, indptr[i + 1]):
                j = columns[k]
                if j == own:
                    paid = cost[k]
                least = min(least, cost[k] + price[j])
            if least - paid < price[own]:
                price[own] = least - paid
                changed = True
        if not changed:
            return True
    return False


@kernel("(i8[::1], i8[::1], read(i4[::1]), read(f8[::1]), i8[::1], f8[::1], i8)")
def raise_labels(flag, indptr, columns, cost, column, price, most):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Raise prices from 0 until no row has a column better than its own: the least such prices; arguments as of ``lower_labels``."""
    rows = len(column)
    for sweep in range(most):
        changed = False
        for turn in range(rows):
            if turn & 127 == 0 and asked(flag):
                return False
            i = turn if sweep % 2 == 0 else rows - 1 - turn
            own = column[i]
            paid = price[own]
            for k in range(indptr[i], indptr[i + 1]):
                if columns[k] == own:
                    paid = cost[k] + price[own]
            for k in range(indptr[i], indptr[i + 1]):
                j = columns[k]
                if j != own and cost[k] + price[j] < paid:
                    price[j] = paid - cost[k]
                    changed = True
        if not changed:
            return True
    return False
