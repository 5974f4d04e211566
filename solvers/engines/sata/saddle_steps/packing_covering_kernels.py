"""Compiled loops of the primal-dual method for packing and covering rows. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .restarts_kernels import to_simplex
from .sums_kernels import multiply


@kernel("(i4[::1], i4[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8, i8, i8)")
def move_variables(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    column_starts, rows, column_entries, short, prices, x, next_x, x_anchor, reflected, kept, begin, end
):  # fmt: skip
    """The side of the variables from ``begin`` to ``end`` in a step; ``reflected`` is the plain step, gone twice."""
    for v in range(begin, end):
        worth = 0.0
        for k in range(column_starts[v], column_starts[v + 1]):
            worth += column_entries[k] * prices[rows[k]]
        next_x[v] = max(0.0, x[v] - short[v] * worth)
        reflected[v] = 2.0 * next_x[v] - x[v]
        x[v] = kept * reflected[v] + (1.0 - kept) * x_anchor[v]


@kernel("(i8, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8)")
def move_prices(packing, long, load, prices, next_prices, price_anchor, level, kept):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """The prices' side of a step, from the ``load`` of each row by the reflected variables."""
    for r in range(len(prices)):
        next_prices[r] = max(0.0, prices[r] + long[r] * (load[r] - 1.0)) if r < packing else prices[r] + long[r] * load[r]
    level[0] = to_simplex(next_prices, long, packing, 1.0, level[0])
    for r in range(len(prices)):
        prices[r] = kept * (2.0 * next_prices[r] - prices[r]) + (1.0 - kept) * price_anchor[r]


@kernel(
    "i8(i8[::1], i4[::1], i4[::1], f8[::1], i4[::1], i4[::1], f8[::1], i8, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], "
    "f8[::1], f8[::1], f8[::1], f8[::1], i8, i8)"
)
def steps(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, columns, entries, column_starts, rows, column_entries, packing, short, long, x, prices, next_x, next_prices, x_anchor,
    price_anchor, level, reflected, load, done, count,
):  # fmt: skip
    """``count`` reflected Halpern steps, fewer where the ``flag`` of a ``Stop`` is set; returns the steps made since ``done`` of them.

    The matrix, by rows and by columns, has the ``packing`` rows first and the covering rows with their signs turned. ``short`` and
    ``long`` are the lengths of steps of variables and of prices. ``x``, ``prices`` (those of covering rows sum to 1) and ``level`` of shape
    (1,) change in place; ``next_x`` and ``next_prices`` become the plain step from the last point, nonnegative and the better answer.
    """
    for step in range(done, done + count):
        if asked(flag):
            return step - done
        kept = (step + 1.0) / (step + 2.0)
        move_variables(column_starts, rows, column_entries, short, prices, x, next_x, x_anchor, reflected, kept, 0, len(x))
        multiply(starts, columns, entries, reflected, load, 0, len(load))
        move_prices(packing, long, load, prices, next_prices, price_anchor, level, kept)
    return count


@kernel("f8(i4[::1], i4[::1], f8[::1], i4[::1], i4[::1], i8, f8[::1])")
def scale_down(starts, columns, entries, column_starts, rows, packing, x):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Divide each entry of ``x`` by the most overfull packing row that it stands in, and then all by the fullest row, in place; returns the
    least coverage then.

    A row full to f > 1 loses the factor f at least in all of its entries, so that it is kept.
    """
    full = np.ones(packing)
    for r in range(packing):
        load = 0.0
        for k in range(starts[r], starts[r + 1]):
            load += entries[k] * x[columns[k]]
        full[r] = max(1.0, load)
    for v in range(len(x)):
        most = 1.0
        for k in range(column_starts[v], column_starts[v + 1]):
            if rows[k] < packing:
                most = max(most, full[rows[k]])
        x[v] /= most
    least, fullest = np.inf, 0.0
    for r in range(len(starts) - 1):
        load = 0.0
        for k in range(starts[r], starts[r + 1]):
            load += abs(entries[k]) * x[columns[k]]
        if r < packing:
            fullest = max(fullest, load)
        else:
            least = min(least, load)
    if fullest == 0.0:
        return 0.0
    for v in range(len(x)):
        x[v] /= fullest
    return least / fullest


@kernel("f8(i4[::1], i4[::1], i4[::1], i4[::1], f8[::1], i8, f8[::1])")
def pay_for_all(starts, columns, column_starts, rows, column_entries, packing, prices):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Lower ``prices``, in place, so that no variable covers for more than it packs; returns the bound that they prove, or infinity.

    The rate of a variable is what it covers over what it packs, at these prices. Each covering row is divided by the largest rate above 1
    of its variables, then each packing row multiplied by the largest rate of its variables: both keep all rates at 1 or below.
    """
    rate = np.empty(len(column_starts) - 1)
    for turn in range(2):
        for v in range(len(rate)):
            packed, covered = 0.0, 0.0
            for k in range(column_starts[v], column_starts[v + 1]):
                if rows[k] < packing:
                    packed += column_entries[k] * prices[rows[k]]
                else:
                    covered -= column_entries[k] * prices[rows[k]]
            rate[v] = covered / packed if packed > 0.0 else (np.inf if covered > 0.0 else 0.0)
        for r in range(len(starts) - 1):
            most = 0.0
            for k in range(starts[r], starts[r + 1]):
                most = max(most, rate[columns[k]])
            if turn == 0 and r >= packing:
                prices[r] /= max(1.0, most)
            elif turn == 1 and r < packing:
                prices[r] *= min(1.0, most)
    paid, asked_for = 0.0, 0.0
    for r in range(len(prices)):
        if r < packing:
            paid += prices[r]
        else:
            asked_for += prices[r]
    return paid / asked_for if asked_for > 0.0 else np.inf
