"""Projection that the primal-dual methods share. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import inner

MOST_NEWTON = 100
"""Far more than it takes: sums of cut linear functions are convex, and Newton's method meets each breakpoint once."""


@inner
def to_simplex(values, lengths, first, total, level):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Cut ``values`` from ``first`` on to nonnegative ones that sum to ``total``, raised by ``level * lengths``; returns that level.

    Newton's method from the level of the step before.
    """
    for _ in range(MOST_NEWTON):
        reached, slope = 0.0, 0.0
        for j in range(first, len(values)):
            raised = values[j] + level * lengths[j]
            if raised > 0.0:
                reached += raised
                slope += lengths[j]
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
