"""Compiled loop of predictive regret matching. Imports numba: import it inside functions only."""

from __future__ import annotations

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .layout import LAYOUT, Layout
from .sums_kernels import multiply

_NAMED = (Layout,)
"""The named tuple that these types name."""


@kernel(f"({LAYOUT}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8, i8, i8)")
def answer(graph, prices, shares, worth, regrets, mean_shares, part, begin, end):  # type: ignore[no-untyped-def]
    """The robots from ``begin`` to ``end`` answer the prices; ``part`` is the weight of the step in the mean."""
    order, starts, targets, weights, firsts = graph.order, graph.starts, graph.targets, graph.weights, graph.first
    for robot in range(begin, end):
        first, last = firsts[robot], firsts[robot + 1]
        value = 0.0
        for k in range(first, last):
            action = order[k]
            total = 0.0
            for e in range(starts[action], starts[action + 1]):
                total += weights[e] * prices[targets[e]]
            worth[action] = total
            value += total * shares[action]
        scale = 0.0
        for k in range(first, last):
            action = order[k]
            ahead = worth[action] - value
            regrets[action] = max(0.0, regrets[action] + ahead)
            scale += max(0.0, regrets[action] + ahead)
        for k in range(first, last):
            action = order[k]
            if scale > 0.0:
                shares[action] = max(0.0, regrets[action] + worth[action] - value) / scale
            mean_shares[action] += part * (shares[action] - mean_shares[action])


@kernel("(f8[::1], f8[::1], f8[::1], f8[::1], f8)")
def charge(cover, prices, grudges, mean_prices, part):  # type: ignore[no-untyped-def]
    """The targets answer the coverage."""
    value, scale = 0.0, 0.0
    for target in range(len(cover)):
        value += cover[target] * prices[target]
    for target in range(len(cover)):
        ahead = value - cover[target]
        grudges[target] = max(0.0, grudges[target] + ahead)
        scale += max(0.0, grudges[target] + ahead)
    for target in range(len(cover)):
        if scale > 0.0:
            prices[target] = max(0.0, grudges[target] + value - cover[target]) / scale
        mean_prices[target] += part * (prices[target] - mean_prices[target])


@kernel(f"i8(i8[::1], {LAYOUT}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], i8, i8)")
def play(  # type: ignore[no-untyped-def]
    flag, graph, shares, prices, regrets, grudges, mean_shares, mean_prices, worth, cover, first_step, count
):  # fmt: skip
    """``count`` steps of the game, fewer where the ``flag`` of a ``Stop`` is set; all arrays change in place. Returns the steps made.

    Robots answer the targets' prices, then the targets answer the robots' shares (alternation). Either side keeps the positive
    part of its regrets, and plays in proportion to them as they would be if the last payoff came again. The means weigh step t with t^2.
    """
    for step in range(first_step, first_step + count):
        if asked(flag):
            return step - first_step
        # 6 t^2 / (t (t + 1) (2 t + 1)): weight of step t in the mean of squares up to it.
        part = 6.0 * step / ((step + 1.0) * (2.0 * step + 1.0))
        answer(graph, prices, shares, worth, regrets, mean_shares, part, 0, len(graph.first) - 1)
        multiply(graph.viewer_starts, graph.viewing, graph.viewer_weights, shares, cover, 0, len(cover))
        charge(cover, prices, grudges, mean_prices, part)
    return count
