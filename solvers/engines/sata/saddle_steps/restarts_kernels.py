"""Projection that the primal-dual methods share. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import inner

MOST_NEWTON = 100
"""Far more than it takes: sums of cut linear functions are convex, and Newton's method meets each breakpoint once."""


@inner
def _raised(values, lengths, first, level):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Sum of the values that are positive once raised, and of their lengths. Four sums at a time: one waits for itself."""
    a = b = c = d = slope_a = slope_b = slope_c = slope_d = 0.0
    for j in range(first, len(values) - 3, 4):
        one, two = values[j] + level * lengths[j], values[j + 1] + level * lengths[j + 1]
        three, four = values[j + 2] + level * lengths[j + 2], values[j + 3] + level * lengths[j + 3]
        a, slope_a = a + max(one, 0.0), slope_a + (lengths[j] if one > 0.0 else 0.0)
        b, slope_b = b + max(two, 0.0), slope_b + (lengths[j + 1] if two > 0.0 else 0.0)
        c, slope_c = c + max(three, 0.0), slope_c + (lengths[j + 2] if three > 0.0 else 0.0)
        d, slope_d = d + max(four, 0.0), slope_d + (lengths[j + 3] if four > 0.0 else 0.0)
    for j in range(len(values) - (len(values) - first) % 4, len(values)):
        one = values[j] + level * lengths[j]
        a, slope_a = a + max(one, 0.0), slope_a + (lengths[j] if one > 0.0 else 0.0)
    return (a + b) + (c + d), (slope_a + slope_b) + (slope_c + slope_d)


@inner
def to_simplex(values, lengths, first, total, level):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Cut ``values`` from ``first`` on to nonnegative ones that sum to ``total``, raised by ``level * lengths``; returns that level.

    Newton's method from the level of the step before.
    """
    for _ in range(MOST_NEWTON):
        reached, slope = _raised(values, lengths, first, level)
        if slope > 0.0:
            ahead = level + (total - reached) / slope
        else:  # all are cut: to the first one that reaches the sum alone, or beyond
            ahead = np.inf
            for j in range(first, len(values)):
                ahead = min(ahead, (total - values[j]) / lengths[j])
        if abs(total - reached) <= 1e-13 * total or ahead == level:
            break
        level = ahead
    for j in range(first, len(values)):
        values[j] = max(0.0, values[j] + level * lengths[j])
    return level
