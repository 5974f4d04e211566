"""Lifting a bound to the next value that an objective can take at all."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...instances.number_arrays import Floats as Floats

LIFT_TOLERANCE = 1e-6
"""Share of a grain by which a bound may exceed a multiple and still be rounded up to that multiple only."""

_EPS = float(np.finfo(np.float64).eps)
_CLOSE = 4.0 * _EPS
"""A number is a multiple of a grain if it is one as closely as doubles can be: a decimal is off by half a unit in its last place."""

_MOST = 1e9
"""Multiples beyond this are not looked for: no bound is that close."""

_SAMPLE = 1000
"""Coefficients looked at before all of them are sorted: most data without a grain show it there."""


@dataclass(frozen=True)
class Grain:
    """``units / parts``: what all coefficients are whole multiples of. For decimals both are whole, so that multiples are decimals too."""

    units: float
    parts: float = 1.0

    @property
    def size(self) -> float:
        return self.units / self.parts

    def multiple(self, count: float) -> float:
        return count * self.units / self.parts


def grain(coefficients: ArrayLike) -> Grain | None:
    """The largest number of which every coefficient is a whole multiple; None if none is found, or all are 0.

    Only ratios between ``coefficients`` matter, and a number that is not 0 is never taken for the multiple 0.
    """
    given = np.abs(np.asarray(coefficients, dtype=np.float64).ravel())
    if len(given) > _SAMPLE and _grain(given[:_SAMPLE]) is None and (given[:_SAMPLE] > 0).any():
        return None
    return _grain(given)


def _grain(values: Floats) -> Grain | None:
    if not np.isfinite(values).all():
        return None
    values = np.unique(values[values > 0])
    if not len(values) or values[0] < 1e-290:  # none, or too close to where doubles end
        return None
    for parts in (1.0, 10.0, 100.0, 1000.0):
        whole = np.rint(values * parts) if values[-1] < 1e15 else np.zeros(1)
        if (whole > 0).all() and (np.abs(values * parts - whole) <= _CLOSE * whole).all():
            return Grain(float(np.gcd.reduce(whole.astype(np.int64))), parts)
    size = _common_divisor(values)
    if size is None:
        return None
    whole = np.rint(values / size)
    size = math.fsum(values) / math.fsum(whole)  # the best estimate of all
    return Grain(size) if (np.abs(values / size - whole) <= _CLOSE * whole).all() else None


def _common_divisor(values: Floats) -> float | None:
    """Euclid's algorithm on ascending positive numbers; a remainder within rounding counts as none. The result is only a guess."""
    largest, left = float(values[-1]), values
    while True:
        divisor = float(left[0])
        if largest > _MOST * divisor:
            return None
        rest = np.abs(left - np.rint(left / divisor) * divisor)
        noise = 8.0 * _EPS * largest * (largest / divisor)  # a rest is a sum of as many of the numbers, each off by its rounding
        rest = rest[rest > 1e-7 * divisor + min(noise, 0.01 * divisor)]
        if not len(rest):
            return divisor
        left = np.append(np.unique(rest), divisor)  # ascending: a rest is at most half the divisor


def is_decimal(values: ArrayLike) -> bool:
    """Whether all values are, as closely as doubles can be, multiples of 0.001: then so are their sums, up to rounding."""
    scaled = 1000.0 * np.asarray(values, dtype=np.float64)
    return bool((np.abs(scaled - np.round(scaled)) <= _CLOSE * np.abs(scaled)).all())


def lift(bound: float, sense: str, size: Grain | None) -> float:
    """``bound`` moved to the next multiple of ``size``: up for ``min``, down for ``max``.

    An objective that is a sum of multiples of ``size`` is one itself, up to the rounding of its coefficients, so no value lies in
    between. Bounds of so many grains that this rounding counts stay as they are.
    """
    if size is None or not math.isfinite(bound) or abs(bound) * 8 * _EPS > LIFT_TOLERANCE * size.size:
        return bound
    count = bound * size.parts / size.units
    if sense == "max":
        return min(bound, size.multiple(math.floor(count + LIFT_TOLERANCE)))
    return max(bound, size.multiple(math.ceil(count - LIFT_TOLERANCE)))
