"""Assignments for tests: the worked ones of the literature, random ones of every shape, and their optima by enumeration."""

import math
from typing import Any

import numpy as np
from truth.auctions import PairTruth

from waybound.formulations.auctions.bin_assignment import BinAssignment

WORKED: dict[str, list[list[float]]] = {
    "A": [[2, 5, 9], [4, 3, 8], [7, 6, 4]], "F": [[4, 6, 5], [4, 9, 5]], "E": [[3, 7], [2, 6], [4, 5]], "G": [[1, 2, 2], [1, 2, 2]],
    "O": [[1, 2], [2, 5]], "B": [[0, 1], [1, 100]], "D": [[1, 4, 9], [2, 3, 9], [9, 5, 6]],
    "K4": [[10, 12, 19, 11], [5, 10, 7, 8], [12, 14, 13, 11], [8, 15, 11, 9]], "L3": [[9, 11, 332], [11, 31, 352], [180, 160, 161]],
}  # fmt: skip
"""Single epochs of bin auctions after Zhang (2015)."""

OPTIMA = {"A": 9, "F": 9, "E": 7, "G": 3, "O": 4, "B": 2, "D": 10, "K4": 38, "L3": 183}
BOTTLENECKS = {"A": 4, "B": 1, "K4": 11, "L3": 161, "O": 2}


def worked(name: str, **settings: Any) -> BinAssignment:
    return BinAssignment.from_matrix(np.array(WORKED[name], dtype=float), **settings)


def random_costs(rng: np.random.Generator, most: int = 6) -> np.ndarray[Any, Any]:
    """Whole, with ties, or not, with many pairs forbidden or few or none, negative or not."""
    n, m = (int(k) for k in rng.integers(1, most + 1, 2))
    kind = int(rng.integers(5))
    costs = rng.random((n, m)) if kind == 0 else rng.integers(0, 5, (n, m)).astype(float)
    if kind >= 2:
        costs = rng.integers(-50, 50, (n, m)).astype(float) * (1.0 if kind > 2 else 0.37)
        costs[rng.random((n, m)) < (0.0, 0.0, 0.3, 0.5, 0.75)[kind]] = math.inf
    return costs


def enumerated(costs: np.ndarray[Any, Any]) -> tuple[int, float, float]:
    """The most pairs, and of all assignments with as many the least sum and the least largest cost."""
    cheapest, evenest = (PairTruth(BinAssignment.from_matrix(costs, objective=objective)) for objective in ("sum", "bottleneck"))
    return cheapest.pairs, float(cheapest.best[0]), float(evenest.best[0])
