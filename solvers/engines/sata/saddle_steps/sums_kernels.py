"""Sums over a graph or a sparse matrix, of which threads take rows each. Imports numba: import it inside functions only."""

from __future__ import annotations

from .....formulations.kernels import kernel
from .layout import LAYOUT, Layout

_NAMED = (Layout,)
"""The named tuple that these types name."""


@kernel(f"({LAYOUT}, f8[::1], f8[::1], i8, i8)")
def worths(graph, prices, worth, begin, end):  # type: ignore[no-untyped-def]
    """What each action from ``begin`` to ``end`` earns at ``prices`` of the targets."""
    starts, targets, weights = graph.starts, graph.targets, graph.weights
    for action in range(begin, end):
        total = 0.0
        for e in range(starts[action], starts[action + 1]):
            total += weights[e] * prices[targets[e]]
        worth[action] = total


@kernel(f"({LAYOUT}, f8[::1], f8[::1], i8, i8)")
def covers(graph, shares, cover, begin, end):  # type: ignore[no-untyped-def]
    """What each target from ``begin`` to ``end`` gets from ``shares`` of the actions, of either sign."""
    starts, actions, weights = graph.viewer_starts, graph.viewing, graph.viewer_weights
    for target in range(begin, end):
        total = 0.0
        for e in range(starts[target], starts[target + 1]):
            total += weights[e] * shares[actions[e]]
        cover[target] = total


@kernel("(i4[::1], i4[::1], f8[::1], f8[::1], f8[::1], i8, i8)")
def multiply(starts, columns, values, vector, product, begin, end):  # type: ignore[no-untyped-def]
    """The matrix times ``vector``, into ``product``, for the rows from ``begin`` to ``end``."""
    for row in range(begin, end):
        total = 0.0
        for e in range(starts[row], starts[row + 1]):
            total += values[e] * vector[columns[e]]
        product[row] = total
