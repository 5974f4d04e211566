"""Stochastic greedy: a guarantee in expectation, tested on means over many seeds."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import planted
from .families import selection as random
from .families import selection_traps as traps

REPEATS = 30
"""Seeds for each instance."""


def _ratio(eps: float) -> Any:
    """1 / (1 - 1/e - eps), in expectation (Mirzasoleiman, Badanidiyuru, Karbasi, Vondrák and Krause 2015, theorem 1)."""
    return lambda problem: 1.0 / (1.0 - math.exp(-1.0) - eps)


guarantee_study(
    "stochastic-greedy",
    "at most k elements from samples, stated 1 - 1/e - eps in expectation",
    600,
    [Configuration(f"eps = {eps:g}", "stochastic-greedy", _ratio(eps), {"eps": eps}, REPEATS) for eps in (0.1, 0.3)],
    (
        *random.random_families("cardinality"),
        planted.planted_covers("cardinality"),
        replace(traps.geometric_covers("cardinality"), effort=5),
    ),
)
