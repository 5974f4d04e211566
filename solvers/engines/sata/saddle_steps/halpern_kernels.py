"""Compiled loop of the primal-dual hybrid gradient method. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import inner, kernel
from .....formulations.stop_kernel import asked
from .layout import LAYOUT, Layout

_NAMED = (Layout,)
"""The named tuple that these types name."""

MOST_NEWTON = 60
"""Far more than it takes: sums of cut linear functions are convex, and Newton's method meets each breakpoint once."""


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


@inner
def _level(values, lengths, level, total):  # type: ignore[no-untyped-def]
    """The level at which the positive parts of ``values + level * lengths`` sum to ``total``, by Newton's method from ``level``."""
    for _ in range(MOST_NEWTON):
        reached, slope = 0.0, 0.0
        for j in range(len(values)):
            value = values[j] + level * lengths[j]
            if value > 0.0:
                reached += value
                slope += lengths[j]
        if slope == 0.0:  # all are cut: to the right of the first breakpoint
            least, slope = np.inf, 0.0
            for j in range(len(values)):
                least = min(least, -values[j] / lengths[j])
                slope += lengths[j]
            level = least + total / slope
            continue
        level += (total - reached) / slope
        if abs(total - reached) <= 1e-13 * total:
            break
    return level


@kernel(f"(i8[::1], {LAYOUT}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8, i8, i8)")
def steps(  # type: ignore[no-untyped-def]
    flag, graph, share_steps, price_steps, shares, prices, first_shares, first_prices, new_shares, new_prices, level, since, count
):  # fmt: skip
    """``count`` steps, fewer where the ``flag`` of a ``Stop`` is set, after ``since`` from the point that they are anchored to.

    ``new_shares`` and ``new_prices``, which are feasible, are what a step of the primal-dual hybrid gradient method makes of ``shares`` and
    ``prices``; these go as far again, and then part of the way to ``first_shares`` and ``first_prices`` (reflection, Halpern's iteration).
    Prices sum to their number. Returns the steps made, the level of the last price step, and how far the last step went, squared, each
    side in parts of its step sizes (of ``share_steps`` for robots, of ``price_steps`` for targets).
    """
    cover, far = np.empty(len(prices)), 0.0
    for step in range(since, since + count):
        if asked(flag):
            return step - since, level, far
        part, far = (step + 1.0) / (step + 2.0), 0.0
        cover[:] = 0.0
        for robot in range(len(graph.first) - 1):
            first, last = graph.first[robot], graph.first[robot + 1]
            for k in range(first, last):
                action, worth = graph.order[k], 0.0
                for e in range(graph.starts[action], graph.starts[action + 1]):
                    worth += graph.weights[e] * prices[graph.targets[e]]
                new_shares[action] = shares[action] + share_steps[robot] * worth
            _onto_simplex(graph.order, first, last, new_shares)
            moved = 0.0
            for k in range(first, last):
                action = graph.order[k]
                change = new_shares[action] - shares[action]
                moved += change * change
                ahead = new_shares[action] + change
                shares[action] = part * ahead + (1.0 - part) * first_shares[action]
                if ahead != 0.0:
                    for e in range(graph.starts[action], graph.starts[action + 1]):
                        cover[graph.targets[e]] += graph.weights[e] * ahead
            far += moved / share_steps[robot]
        for j in range(len(prices)):
            new_prices[j] = prices[j] - price_steps[j] * cover[j]
        level = _level(new_prices, price_steps, level, float(len(prices)))
        for j in range(len(prices)):
            new = max(0.0, new_prices[j] + level * price_steps[j])
            change = new - prices[j]
            far += change * change / price_steps[j]
            new_prices[j] = new
            prices[j] = part * (new + change) + (1.0 - part) * first_prices[j]
    return count, level, far
