"""All distances between some sites, as far as there are memory and time for them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....formulations.stop import Stop
from ....instances.errors import UsageError
from ....instances.memory import fits, readable

Floats = NDArray[np.float64]

MOST_SITES = 10_000
"""Between which all distances are held."""

STRIP = 1 << 20
"""Distances that are computed before the time is looked at."""


def dense(
    between: Callable[[ArrayLike, ArrayLike], Floats], nodes: NDArray[np.int64], stop: Stop, what: str, *, savings: bool = False
) -> Floats | None:
    """``between(nodes[i], nodes[j])`` for all i and j; None where it was asked to stop.

    Parameters
    ----------
    savings : bool
        Whether that heuristic takes the problem too, to be named in the refusal.

    Raises
    ------
    UsageError
        If there are too many sites for ``what``, or no memory for them.
    """
    n = len(nodes)
    if n > MOST_SITES or not fits(24.0 * n * n):
        reason = f"needs {readable(24.0 * n * n)}" if n <= MOST_SITES else f"takes at most {MOST_SITES:,}"
        other = "; savings needs none of them" if savings else ""
        raise UsageError(f"{what} of {n:,} sites holds all distances between them and {reason}{other}")
    made, step = np.empty((n, n)), max(1, STRIP // n)
    for first in range(0, n, step):
        if stop.reached():
            return None
        made[first : first + step] = between(nodes[first : first + step, None], nodes[None, :])
    return made
