"""Random draws whose stream depends on nothing but ``Generator.random``.

numpy may change the streams of its distributions between releases, and has done so. Doubles out of PCG64 are its most stable
stream, so everything is made from them, and an instance stays the same under every numpy.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..number_arrays import Floats as Floats

Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]


class Draw:
    """Draws from one generator.

    Parameters
    ----------
    rng : numpy.random.Generator
    """

    def __init__(self, rng: "np.random.Generator") -> None:
        self._rng = rng

    def uniform(self, low: float, high: float, size: int | tuple[int, ...]) -> Floats:
        """Random numbers, uniform on [low, high)."""
        return low + (high - low) * self._rng.random(size)

    def integers(self, low: int, high: int, size: int | tuple[int, ...]) -> Integers:
        """Whole numbers of [low, high], all equally likely."""
        return low + np.floor((high - low + 1) * self._rng.random(size)).astype(np.int64)

    def integer(self, low: int, high: int) -> int:
        """A random whole number, uniform on low, ..., high."""
        return int(self.integers(low, high, 1)[0])

    def normal(self, mean: float, deviation: float, size: int) -> Floats:
        """Normal numbers (Box and Muller 1958)."""
        u = self._rng.random((2, size))
        return np.asarray(mean + deviation * np.sqrt(-2.0 * np.log1p(-u[0])) * np.cos(2.0 * math.pi * u[1]))

    def triangular(self, low: float, mode: float, high: float) -> float:
        """A random number of the triangular distribution, by inversion."""
        u = float(self._rng.random())
        if u < (mode - low) / (high - low):
            return low + math.sqrt(u * (high - low) * (mode - low))
        return high - math.sqrt((1.0 - u) * (high - low) * (high - mode))

    def weighted(self, values: Sequence[int], weights: Sequence[float], size: int) -> Integers:
        """Entries of ``values``, each as likely as its weight says."""
        edges = np.cumsum(weights) / np.sum(weights)
        return np.asarray(values, dtype=np.int64)[np.searchsorted(edges[:-1], self._rng.random(size), side="right")]

    def permutation(self, size: int) -> Integers:
        """The numbers 0 to ``size`` - 1 in random order."""
        return np.argsort(self._rng.random(size), kind="stable")

    def chosen(self, count: int, of: int) -> Flags:
        """Flags that mark ``count`` random places out of ``of``."""
        marks = np.zeros(of, dtype=bool)
        marks[self.permutation(of)[:count]] = True
        return marks
