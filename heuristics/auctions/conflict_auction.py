"""Heuristic ``auction``: robots bid for their cheapest bins, and the lowest cost wins ("one-turn English auction")."""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.evidence import Guarantee
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from ._bin_auctions import QUADRANGLE, changes_message, completed, cut_short, quadrangle

MODES = ("deferred", "immediate")

BLOCK = 500_000
"""Pairs that are sorted between two looks at the clock."""

SOURCE = "Reingold and Tarjan (1981), On a greedy heuristic for complete matching"


def greedy_ratio(pairs: int) -> float:
    """2 n^(log2 3/2) - 1, the ratio of matchings that take the cheapest pair first, for costs that keep the quadrangle inequality."""
    return float(2.0 * max(1, pairs) ** math.log2(1.5) - 1.0)


@heuristic(
    "auction",
    "bin-assignment",
    {"objective:sum", "objective:bottleneck"},
    "robots bid for their cheapest bins, the lowest cost wins",
    "2 n^0.585 - 1 for n pairs whose costs keep the quadrangle inequality, where later bids may win (deferred)",
)
def conflict_auction(problem: BinAssignment, context: Context, *, mode: str = "deferred") -> Outcome:
    """Robots without a bin bid for their cheapest one until all have one, or none is left.

    With ``mode`` ``deferred`` a cheaper later bid wins a bin from its holder, so that the outcome is that of taking the cheapest pair again
    and again. With ``immediate`` a bin that is won is kept, and nothing is guaranteed. Where pairs are forbidden the auction may match
    fewer than possible; then as few robots as possible get other bins.

    Source: Zhang (2015), section 3.4.2, algorithm 1, read as in docs/formulations/bin-assignment.md#auctions. Equal costs go to the lower
    bin, equal bids to the lower robot. The ratio is that of Reingold and Tarjan (1981), whose proof needs no more than the inequality.
    """
    from .conflict_kernels import conflict_rounds

    if mode not in MODES:
        raise UsageError(f"mode must be one of {', '.join(MODES)}, not {mode!r}")
    stop = context.begin()
    order = _by_cost(problem, stop)
    if order is None:
        return cut_short(problem, stop)
    indptr = problem.indptr.astype(np.int64)
    taken, rounds, bids, whole = conflict_rounds(
        stop.flag, indptr, problem.bins[order].astype(np.int64), problem.cost[order], problem.num_bins, mode == "immediate"
    )
    statistics = {"rounds": int(rounds), "bids": int(bids)}
    if not whole:
        return cut_short(problem, stop, statistics)
    answer, changed = completed(problem, taken, stop)
    guarantee = None
    if mode == "deferred" and problem.objective == "sum" and quadrangle(problem, stop):
        pairs = problem.pairs
        ratio = greedy_ratio(pairs)
        statement = f"cost <= (2 n^(log2 3/2) - 1) OPT, that is {ratio:.4g} OPT for n = {pairs} pairs"
        guarantee = Guarantee(ratio, statement, (QUADRANGLE,), SOURCE)
    return Outcome(answer, guarantee, (), {**statistics, **({"changed": changed} if changed else {})}, changes_message(changed))


def _by_cost(problem: BinAssignment, stop: Stop) -> NDArray[np.int64] | None:
    """Pairs of each robot from the cheapest on, equal ones by their bin; None where there was no time for it."""
    indptr, order = problem.indptr, np.empty(len(problem.cost), dtype=np.int64)
    blocks = np.searchsorted(indptr, np.arange(0, len(order), BLOCK), side="left").tolist()
    for first, last in itertools.pairwise([*dict.fromkeys([0, *blocks]), len(indptr) - 1]):
        if stop.reached():
            return None
        part = slice(int(indptr[first]), int(indptr[last]))
        order[part] = part.start + np.lexsort((problem.bins[part], problem.cost[part], problem.robots[part]))
    return order
