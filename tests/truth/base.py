"""The result of brute force on a tiny problem, and numbers in whole units."""

import functools
import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

Values = tuple[Fraction, ...]

PARTS = 10**9
"""One over what an answer may exceed a limit by, as a share of it, and still count for ``lenient``."""


ROUNDING = Fraction(1, 10**12)
"""Part of their size by which values of equal decimals may differ."""


@dataclass
class Truth:
    """``best`` and ``lenient`` are None where there is no answer; ``samples`` are answers that keep every limit, an optimal one first.

    ``continuous`` tells whether answers are vectors, so that solvers end near an optimum and not at one; ``parts`` is what of a vector
    may be outside, as one over a share.
    """

    senses: tuple[str, ...]
    best: Values | None = None
    lenient: Values | None = None
    samples: list[Any] = field(default_factory=list)
    continuous: bool = False
    unbounded: bool = False
    parts: int = PARTS
    size: Fraction = Fraction(0)
    """The largest value, of either sign, that any answer has: values that are equal but for rounding differ by less than 1e-12 of it."""
    mixed: bool = False
    """True where terms of both signs are added up to a value."""

    def better(self, a: Values, b: Values | None) -> bool:
        """Compare at the first level that differs, by more than decimals are off as doubles (9.9 + 16.1 and 26) before the last one."""
        levels = [] if b is None else list(zip(self.senses, a, b, strict=False))
        for number, (sense, one, other) in enumerate(levels, start=1):
            if one == other:
                continue
            if number == len(levels) or abs(one - other) > ROUNDING * max(abs(one), abs(other), self.size if number == 1 else 0):
                return (one < other) == (sense == "min")
        return b is None

    def meet(self, values: Values, strict: bool, answer: Any) -> None:
        """One answer that keeps the limits exactly (``strict``) or nearly."""
        self.size = max(self.size, abs(values[0]))
        alike, ahead = self.best is self.lenient, self.better(values, self.lenient)
        if ahead:
            self.lenient = values
        if strict and (ahead if alike else self.better(values, self.best)):
            self.best = values
            self.samples.insert(0, answer)
        elif strict and len(self.samples) < 40:
            self.samples.append(answer)

    def value(self, answer: Any) -> Values | None:
        """Exact value of an answer; None where it breaks a limit by more than doubles can."""
        raise NotImplementedError


def scale_of(*arrays: Any) -> int:
    """The least power of two of which all finite numbers, times it, are whole."""
    flat = [float(v) for a in arrays for v in np.asarray(a, dtype=np.float64).ravel().tolist()]
    return max((v.as_integer_ratio()[1] for v in flat if math.isfinite(v)), default=1)


@functools.lru_cache(maxsize=4096)  # the same few limits are asked for on every route
def whole(value: float, scale: int) -> int | None:
    """The value in whole units of one over ``scale``; None for infinity."""
    return None if math.isinf(value) else int(Fraction(value) * scale)


def ints(values: Any, scale: int) -> Any:
    """The values as nested lists of whole units; None for infinity."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    return [ints(v, scale) for v in values] if isinstance(values, list) else whole(values, scale)
