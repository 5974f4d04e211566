"""Compiled loop of the primal-dual hybrid gradient method. Imports numba: import it inside functions only."""

from __future__ import annotations

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .layout import LAYOUT, Layout
from .restarts_kernels import to_simplex
from .sums_kernels import multiply

_NAMED = (Layout,)
"""The named tuple that these types name."""


@kernel(f"({LAYOUT}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8, i8, i8)")
def move_shares(graph, lengths, prices, shares, new_shares, first_shares, ahead, part, begin, end):  # type: ignore[no-untyped-def]
    """The shares' side of a step, for the robots from ``begin`` to ``end``; ``ahead`` is the reflected plain step.

    Shares go back onto the simplex by Newton's method on what to take from all of them, from those that were positive before. All in one
    loop, without branches on values: so it takes half the time.
    """
    order, starts, targets, weights, firsts = graph.order, graph.starts, graph.targets, graph.weights, graph.first
    for robot in range(begin, end):
        first, last, total, count, threshold = firsts[robot], firsts[robot + 1], 0.0, 0.0, 0.0
        for k in range(first, last):
            action, worth = order[k], 0.0
            for e in range(starts[action], starts[action + 1]):
                worth += weights[e] * prices[targets[e]]
            moved, used = shares[action] + lengths[action] * worth, new_shares[action] > 0.0
            total += moved if used else 0.0
            count += 1.0 if used else 0.0
            new_shares[action] = moved
        for _ in range(last - first + 2):
            if count == 0.0:
                break
            threshold, total_before, before = (total - 1.0) / count, total, count
            total, count = 0.0, 0.0
            for k in range(first, last):
                value = new_shares[order[k]]
                total += value if value > threshold else 0.0
                count += 1.0 if value > threshold else 0.0
            if count == before and total == total_before:
                break
        for k in range(first, last):
            action = order[k]
            new = max(0.0, new_shares[action] - threshold)
            twice = 2.0 * new - shares[action]
            new_shares[action], ahead[action] = new, twice
            shares[action] = part * twice + (1.0 - part) * first_shares[action]


@kernel("(f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8)")
def move_prices(lengths, cover, prices, new_prices, first_prices, level, part):  # type: ignore[no-untyped-def]
    """The prices' side of a step, from the ``cover`` by the reflected shares."""
    for j in range(len(prices)):
        new_prices[j] = prices[j] - lengths[j] * cover[j]
    level[0] = to_simplex(new_prices, lengths, 0, float(len(prices)), level[0])
    for j in range(len(prices)):
        prices[j] = part * (2.0 * new_prices[j] - prices[j]) + (1.0 - part) * first_prices[j]


@kernel(f"i8(i8[::1], {LAYOUT}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], i8, i8)")
def steps(  # type: ignore[no-untyped-def]
    flag, graph, share_steps, price_steps, shares, prices, new_shares, new_prices, first_shares, first_prices, level, ahead, cover, since,
    count,
):  # fmt: skip
    """``count`` steps, fewer where the ``flag`` of a ``Stop`` is set, after ``since`` from the point that they are anchored to.

    ``new_shares`` and ``new_prices``, which are feasible, are what a step of the primal-dual hybrid gradient method makes of ``shares`` and
    ``prices``; these go as far again, and then part of the way to ``first_shares`` and ``first_prices`` (reflection, Halpern's iteration).
    Prices sum to their number; ``level`` of shape (1,) is that of the last price step. Returns the steps made.
    """
    for step in range(since, since + count):
        if asked(flag):
            return step - since
        part = (step + 1.0) / (step + 2.0)
        move_shares(graph, share_steps, prices, shares, new_shares, first_shares, ahead, part, 0, len(graph.first) - 1)
        multiply(graph.viewer_starts, graph.viewing, graph.viewer_weights, ahead, cover, 0, len(cover))
        move_prices(price_steps, cover, prices, new_prices, first_prices, level, part)
    return count
