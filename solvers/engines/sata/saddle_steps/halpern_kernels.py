"""Compiled loop of the primal-dual hybrid gradient method. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import inner, kernel
from .....formulations.stop_kernel import asked
from .layout import LAYOUT, Layout
from .restarts_kernels import to_simplex

_NAMED = (Layout,)
"""The named tuple that these types name."""


@inner
def _onto_simplex(order, first, last, values):  # type: ignore[no-untyped-def]
    """Move the values of a robot's actions to the nearest ones that are not negative and sum to 1."""
    total, count, threshold = 0.0, last - first, 0.0
    for k in range(first, last):
        total += values[order[k]]
    for _ in range(last - first):
        threshold, before = (total - 1.0) / count, count
        total, count = 0.0, 0
        for k in range(first, last):
            if values[order[k]] > threshold:
                total += values[order[k]]
                count += 1
        if count == before or count == 0:
            break
    for k in range(first, last):
        values[order[k]] = max(0.0, values[order[k]] - threshold)


@kernel(f"i8(i8[::1], {LAYOUT}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], i8, i8)")
def steps(  # type: ignore[no-untyped-def]
    flag, graph, share_steps, price_steps, shares, prices, new_shares, new_prices, first_shares, first_prices, level, since, count
):  # fmt: skip
    """``count`` steps, fewer where the ``flag`` of a ``Stop`` is set, after ``since`` from the point that they are anchored to.

    ``new_shares`` and ``new_prices``, which are feasible, are what a step of the primal-dual hybrid gradient method makes of ``shares`` and
    ``prices``; these go as far again, and then part of the way to ``first_shares`` and ``first_prices`` (reflection, Halpern's iteration).
    Prices sum to their number; ``level`` of shape (1,) is that of the last price step. Returns the steps made.
    """
    cover = np.empty(len(prices))
    for step in range(since, since + count):
        if asked(flag):
            return step - since
        part = (step + 1.0) / (step + 2.0)
        cover[:] = 0.0
        for robot in range(len(graph.first) - 1):
            first, last = graph.first[robot], graph.first[robot + 1]
            for k in range(first, last):
                action, worth = graph.order[k], 0.0
                for e in range(graph.starts[action], graph.starts[action + 1]):
                    worth += graph.weights[e] * prices[graph.targets[e]]
                new_shares[action] = shares[action] + share_steps[action] * worth
            _onto_simplex(graph.order, first, last, new_shares)
            for k in range(first, last):
                action = graph.order[k]
                ahead = 2.0 * new_shares[action] - shares[action]
                shares[action] = part * ahead + (1.0 - part) * first_shares[action]
                if ahead != 0.0:
                    for e in range(graph.starts[action], graph.starts[action + 1]):
                        cover[graph.targets[e]] += graph.weights[e] * ahead
        for j in range(len(prices)):
            new_prices[j] = prices[j] - price_steps[j] * cover[j]
        level[0] = to_simplex(new_prices, price_steps, 0, float(len(prices)), level[0])
        for j in range(len(prices)):
            prices[j] = part * (2.0 * new_prices[j] - prices[j]) + (1.0 - part) * first_prices[j]
    return count
