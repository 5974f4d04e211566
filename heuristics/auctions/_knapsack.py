"""Knapsacks: exact by lists of undominated sets, greedy where the lists grow too long."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...formulations.stop import NEVER, Stop

Floats = NDArray[np.float64]

LONGEST = 1 << 15
"""Undominated sets that are kept; all of them, for whole weights, where the capacity is no more."""

MOST_KEPT = 1 << 25
"""Over all things: 5 bytes each."""


def knapsack(worth: Floats, weights: Floats, most: float, stop: Stop = NEVER) -> tuple[NDArray[np.int64], bool]:
    """Things that weigh no more than ``most`` together, and whether they are worth the most, or else half of that at least.

    Parameters
    ----------
    worth, weights : arrays of shape (things,)
        Both at least 0.
    most : float
    stop : Stop
        Where it ends this, the greedy things are taken.

    Notes
    -----
    Source: Nemhauser and Ullmann (1969), Discrete dynamic programming and capital allocation; else the better of the greedy set and the
    first thing that does not fit (Dantzig 1957).
    """
    there = np.nonzero((worth > 0.0) & (weights <= most))[0]
    order = there[np.argsort(-_rates(worth[there], weights[there]), kind="stable")]
    total, weight = np.zeros(1), np.zeros(1)
    stages: list[tuple[NDArray[np.int32], NDArray[np.bool_]]] = []
    kept = 0
    for k in order.tolist():
        both = np.concatenate([total, total + worth[k]]), np.concatenate([weight, weight + weights[k]])
        came = np.tile(np.arange(len(total), dtype=np.int32), 2)
        took = np.arange(2 * len(total)) >= len(total)
        by = np.lexsort((-both[0], both[1]))
        by = by[both[1][by] <= most]
        ahead = np.concatenate([[-1.0], np.maximum.accumulate(both[0][by])[:-1]])
        by = by[both[0][by] > ahead]  # what weighs no less is worth more
        kept += len(by)
        if len(by) > LONGEST or kept > MOST_KEPT or stop.reached():
            return _greedy(worth, weights, most, order), False
        total, weight = both[0][by], both[1][by]
        stages.append((came[by], took[by]))
    chosen, at = [], len(total) - 1
    for k, (came, took) in zip(order[::-1].tolist(), stages[::-1], strict=True):
        if took[at]:
            chosen.append(k)
        at = int(came[at])
    return np.array(sorted(chosen), dtype=np.int64), True


def _rates(worth: Floats, weights: Floats) -> Floats:
    with np.errstate(divide="ignore", over="ignore"):
        return np.where(weights > 0.0, worth / weights, np.inf)


def _greedy(worth: Floats, weights: Floats, most: float, order: NDArray[np.int64]) -> NDArray[np.int64]:
    fits = np.cumsum(weights[order]) <= most
    if fits.all():
        return np.sort(order)
    first = int(np.argmin(fits))
    prefix = order[:first]
    return np.sort(prefix) if worth[prefix].sum() >= worth[order[first]] else order[first : first + 1]
