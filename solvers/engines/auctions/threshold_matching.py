"""Engine ``threshold-matching``: assignments of the least largest cost, proved by the robots and bins that meet all cheaper pairs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.auctions.matching import largest_matching
from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...backend import BACKENDS, Control, Options, RawResult
from ._bin_engine import BinEngine


@BACKENDS.register("threshold-matching")
class ThresholdMatchingEngine(BinEngine):
    """Matchings of the most pairs among those up to a threshold, halving (Garfinkel 1971; Hopcroft and Karp 1973)."""

    name = "threshold-matching"
    package = "scipy"
    summary = "assignments of the least largest cost by matchings up to a threshold, with a proof"
    interrupts = "keeps the best assignment and the bound so far"
    order = 10
    features = frozenset({"objective:bottleneck"})

    def assign(self, problem: BinAssignment, stop: Stop, options: Options, control: Control) -> RawResult:
        ended = least_threshold(problem, stop)
        value = problem.evaluate(ended.answer).values[0]
        status, limit = ("optimal", "none") if ended.complete else ("feasible", stop.reached())
        evidence = () if ended.evidence is None else (ended.evidence,)
        bound = value if ended.complete else None
        return RawResult(status, limit, ended.answer, value, bound, statistics={"matchings": ended.matchings}, evidence=evidence)


@dataclass(frozen=True)
class Threshold:
    """An assignment, the evidence of the best bound, how many matchings were sought, and whether the search is complete."""

    answer: tuple[int, ...]
    evidence: Evidence | None
    matchings: int
    complete: bool


def least_threshold(problem: BinAssignment, stop: Stop) -> Threshold:
    """Halve the costs until the pairs up to one of them suffice and those below do not.

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
        below = np.zeros(problem.num_robots + 1, dtype=np.int64), problem.bins[:0], np.full(problem.num_robots, -1)
    evidence = problem.uncovered(*below, "robots and bins that meet all cheaper pairs") if problem.pairs else None
    return Threshold(tuple(best.tolist()), evidence, tried, complete)


def _matched(problem: BinAssignment, most: float) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64]]:
    kept = problem.cost <= most
    indptr = np.concatenate([[0], np.cumsum(kept)])[problem.indptr]
    bins = problem.bins[kept]
    if len(bins) == problem.num_robots * problem.num_bins:
        return indptr, bins, problem.largest
    return indptr, bins, largest_matching(indptr.astype(np.int32), bins, problem.num_bins)
