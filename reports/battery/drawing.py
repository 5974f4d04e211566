"""Numbers that the battery's problems are made of.

Numbers that rows add up are whole, or whole numbers times powers of two: what is just feasible in fractions is so in doubles.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...formulations.problem import Problem
from ...instances.number_arrays import Floats as Floats

Generator = np.random.Generator
Draw = Callable[[Generator], Problem]

TINY, HUGE = 2.0**-20, 2.0**30
"""About 1e-6 and 1e9, and exact factors."""


def whole(rng: Generator, size: Any, low: int, high: int) -> Floats:
    """Whole numbers from ``low`` to ``high``, both included."""
    return np.asarray(rng.integers(low, high + 1, size), dtype=np.float64)


def weights(rng: Generator, size: Any) -> Floats:
    """Positive numbers as objectives have them: whole, equal, of two values, decimal, tiny, huge, or of all sizes."""
    draws: tuple[Callable[[], Floats], ...] = (
        lambda: whole(rng, size, 1, 9),
        lambda: np.full(size, float(rng.integers(1, 9))),
        lambda: whole(rng, size, 1, 2),
        lambda: whole(rng, size, 100, 1000),
        lambda: whole(rng, size, 1, 99) / 10.0,
        lambda: whole(rng, size, 1, 99) * 1e-6,
        lambda: whole(rng, size, 1, 99) * 1e9,
        lambda: 10.0 ** rng.uniform(-3, 3, size),
    )
    return draws[int(rng.integers(len(draws)))]()
