"""Scales that turn data into whole numbers, each rounded to its safe side."""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ....instances.number_arrays import Flags, Floats as Floats, Integers as Integers

UNLIMITED = int(np.iinfo(np.int64).max)
"""Stands for infinity; each engine puts its own largest value there."""

FINE = 1_000_000
"""Scale of data that three decimals cannot hold."""

_ROUNDING = 4 * float(np.finfo(np.float64).eps)
_SMALL, _WIDE, _BASE = -10, 40, 20
"""Binary exponents: data below 2**-10, above 2**40, or above 2**20 and to be rounded become just less than 2**20; so do binary fractions,
which that makes exact."""


@dataclass(frozen=True, eq=False)
class Strips:
    """Numbers too many to be held at once: ``strips`` computes them anew, a strip after the other, as often as they are asked for.

    Where they are too many even for that, ``few`` stand for them: none of all is larger, and the few are whole only where all are.
    """

    strips: Callable[[], Iterable[Floats]]
    few: tuple[float, ...] | None = None

    def finite(self) -> Iterator[Floats]:
        """The numbers that are neither infinite nor NaN, a strip after the other."""
        for strip in self.strips() if self.few is None else (np.array(self.few),):
            known = np.isfinite(strip)
            yield strip if known.all() else strip[known]

    @cached_property
    def largest(self) -> float:
        """The largest absolute value of a finite one; 0 where there are none."""
        return max((float(np.abs(strip).max(initial=0.0)) for strip in self.finite()), default=0.0)


@dataclass(frozen=True)
class Scale:
    """One unit of the data is ``factor`` integers; ``exact`` if nothing was rounded."""

    factor: float
    exact: bool

    def nearest(self, values: ArrayLike) -> Integers:
        """Integers for costs."""
        return _integers(np.rint(np.asarray(values, dtype=np.float64) * self.factor))

    def up(self, values: ArrayLike) -> Integers:
        """Integers for consumption, and for earliest times."""
        scaled = self._scaled(values)
        return _integers(np.ceil(scaled if self.exact else scaled - _ROUNDING * np.abs(scaled)))

    def down(self, values: ArrayLike) -> Integers:
        """Integers for limits; infinite ones become ``UNLIMITED``."""
        scaled = self._scaled(values)
        return _integers(np.floor(scaled if self.exact else scaled + _ROUNDING * np.abs(scaled)))

    def _scaled(self, values: ArrayLike) -> Floats:
        scaled = np.asarray(values, dtype=np.float64) * self.factor
        return np.where(whole(scaled), np.rint(scaled), scaled) if self.exact else scaled


def scale_of(*values: ArrayLike | Strips, fine: int = FINE, room: float = math.inf) -> Scale:
    """The smallest of 1, 10, 100, 1000 that makes all finite ``values`` integers, but for the rounding of floats.

    ``fine`` where none does, or where only that leaves them within ``room``. Each times a power of two, where the largest value is very
    small or very large.
    """
    parts = [v if isinstance(v, Strips) else _whole_strip(v) for v in values]
    largest = max((part.largest for part in parts), default=0.0)
    if largest == 0.0:
        return Scale(1, True)
    exponent = math.frexp(largest)[1]
    other = math.ldexp(1.0, min(1000, _BASE - exponent))
    rounded = Scale(plain((1.0 if _SMALL <= exponent <= _BASE else other) * fine), False)
    for unit in (1.0, other) if _SMALL <= exponent <= _WIDE else (other,):
        for factor in (1, 10, 100, 1000):
            if all(whole(strip * unit * factor).all() for part in parts for strip in part.finite()):  # most data fail in the first
                return rounded if rounded.factor * largest <= room < unit * factor * largest else Scale(plain(unit * factor), True)
    return rounded


def _whole_strip(values: ArrayLike) -> Strips:
    held = np.asarray(values, dtype=np.float64)
    return Strips(lambda: (held,))


def plain(factor: float) -> float:
    """A whole number as an integer, for people to read."""
    return int(factor) if factor == int(factor) else factor


def whole(values: Floats) -> Flags:
    """Which values are integers but for the rounding of floats."""
    with np.errstate(invalid="ignore"):  # infinity less infinity
        return np.asarray(np.abs(values - np.rint(values)) <= _ROUNDING * np.abs(values))


def _integers(values: Floats) -> Integers:
    """Whole floats as integers; what int64 cannot hold becomes ``UNLIMITED``, with a wide margin for further sums."""
    values = np.asarray(values, dtype=np.float64)
    high = values >= 2.0**62
    integers = np.where(high, 0.0, np.maximum(values, -(2.0**62))).astype(np.int64)
    integers[high] = UNLIMITED
    return integers
