"""The least largest cost of an assignment, by matchings among the pairs up to a threshold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .....formulations.auctions.matching import largest_matching
from .....formulations.evidence import Evidence
from .....formulations.stop import Stop

if TYPE_CHECKING:
    from .....formulations.auctions.bin_assignment import BinAssignment


@dataclass(frozen=True)
class Threshold:
    """An assignment, the evidence of the best bound, how many matchings were sought, and whether the search came to its end."""

    answer: tuple[int, ...]
    evidence: Evidence | None
    matchings: int
    complete: bool


def least_threshold(problem: BinAssignment, stop: Stop) -> Threshold:
    """Halve the costs until the pairs up to one of them suffice and those below do not.

    Notes
    -----
    Source: Garfinkel (1971), An improved algorithm for the bottleneck assignment problem; the robots and bins that prove it are those of
    König's theorem for the pairs below.
    """
    costs = np.unique(problem.cost)
    low, high, best, tried = 0, len(costs) - 1, problem.largest, 0
    below: tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]] | None = None
    while low < high and problem.pairs and not stop.reached():
        middle = (low + high) // 2
        indptr, bins, matched = _matched(problem, float(costs[middle]))
        tried += 1
        if int((matched >= 0).sum()) >= problem.pairs:
            high, best = middle, matched
        else:
            low, below = middle + 1, (indptr, bins, matched)
    complete = low >= high or not problem.pairs
    if below is None:  # the cheapest pairs suffice, or nothing was tried: no pair costs less
        empty = np.zeros(problem.num_robots + 1, dtype=np.int64), problem.bins[:0], np.full(problem.num_robots, -1)
        below = empty
    evidence = problem.uncovered(*below, "robots and bins that meet all cheaper pairs") if problem.pairs else None
    return Threshold(tuple(best.tolist()), evidence, tried, complete)


def _matched(problem: BinAssignment, most: float) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]:
    kept = problem.cost <= most
    indptr = np.concatenate([[0], np.cumsum(kept)])[problem.indptr]
    bins = problem.bins[kept]
    if len(bins) == problem.num_robots * problem.num_bins:
        return indptr, bins, problem.largest
    return indptr, bins, largest_matching(indptr.astype(np.int32), bins, problem.num_bins)
