"""Knapsack greedy with starting sets of 0 to 3 elements."""

from __future__ import annotations

import math
from typing import Any

from ...guarantees import guarantee_study
from ...judging import Configuration
from .families import planted
from .families import selection as random
from .families import selection_traps as traps

HALF, FULL = (1.0 - math.exp(-1.0)) / 2.0, 1.0 - math.exp(-1.0)
SHARES = {0: HALF, 1: HALF, 2: FULL, 3: FULL}
"""By the size of the starting sets: the better of greedy and the best element (Khuller, Moss and Naor 1999), pairs (Kulik, Schwartz and
Shachnai 2021), triples (Sviridenko 2004)."""


def _ratio(size: int) -> Any:
    return lambda problem: 1.0 / SHARES[size]


guarantee_study(
    "knapsack-greedy",
    "gain per cost from starting sets of 0 to 3 elements, stated (1 - 1/e)/2 and 1 - 1/e",
    2000,
    [Configuration(f"sets of {size}", "knapsack-greedy", _ratio(size), {"enumerate": size}) for size in SHARES],
    (
        *random.random_families("knapsack"), planted.planted_covers("knapsack"), traps.density_traps(), traps.half_traps(),
        traps.shut_outs(), traps.free_elements(), traps.geometric_covers("knapsack"),
    ),
)  # fmt: skip
