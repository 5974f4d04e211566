"""Lifting a bound to the next value that an objective can take at all."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LIFT_TOLERANCE = 1e-6
"""Share of a grain by which a bound may exceed a multiple and still be rounded up to that multiple only."""

_GRAINS = (1.0, 0.1, 0.01, 0.001)
_SAMPLE = 1000
"""Coefficients looked at before all of them are sorted: most data without a grain show it there."""


def grain(coefficients: ArrayLike, terms: int) -> float | None:
    """The coarsest of 1, 0.1, 0.01, 0.001 of which every coefficient is a multiple, None if there is none.

    Parameters
    ----------
    coefficients : array of finite numbers
    terms : int
        How many of them an objective sums up at most. Each may be off by a float's error, and all of them together must stay
        below half of ``LIFT_TOLERANCE``.
    """
    given = np.asarray(coefficients, dtype=np.float64).ravel()
    allowed = min(1e-9, 0.5 * LIFT_TOLERANCE / max(1, terms))
    return _grain(np.unique(given), allowed) if len(given) <= _SAMPLE or _grain(given[:_SAMPLE], allowed) else None


def _grain(values: NDArray[np.float64], allowed: float) -> float | None:
    if not np.isfinite(values).all():
        return None
    for size, scale in zip(_GRAINS, (1.0, 10.0, 100.0, 1000.0), strict=True):
        scaled = values * scale
        if (np.abs(scaled - np.round(scaled)) <= allowed).all():
            return size
    return None


def is_decimal(values: ArrayLike) -> bool:
    """Whether all values are, as closely as doubles can be, multiples of 0.001: then so are their sums, up to rounding."""
    scaled = 1000.0 * np.asarray(values, dtype=np.float64)
    return bool((np.abs(scaled - np.round(scaled)) <= 4.0 * np.finfo(np.float64).eps * np.abs(scaled)).all())


def lift(bound: float, sense: str, size: float | None) -> float:
    """``bound`` moved to the next multiple of ``size``: up for ``min``, down for ``max``.

    An objective that is a sum of multiples of ``size`` is one itself, so no value lies in between. Bounds beyond 2**50
    grains stay as they are: there a double no longer tells neighbouring multiples apart.
    """
    if size is None or not math.isfinite(bound) or abs(bound) / size > 2.0**50:
        return bound
    scale = round(1.0 / size)  # division by an integer gives the double nearest to the decimal; multiplication does not
    if sense == "max":
        return min(bound, math.floor(bound * scale + LIFT_TOLERANCE) / scale)
    return max(bound, math.ceil(bound * scale - LIFT_TOLERANCE) / scale)


def value_grain(function: Any) -> float | None:
    """Of what every value of a coverage or facility-location function is a multiple; None for full matrices and users' functions."""
    if function.name == "coverage":
        return grain(function.item_weights, function.num_items)
    return None if function.name == "user" or hasattr(function, "matrix") else grain(function.weights, function.num_items)
