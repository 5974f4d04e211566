"""Heuristic ``auction``: robots bid for their cheapest bins, and the lowest cost wins ("one-turn English auction")."""

import itertools
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.bin_assignment import Assignment, BinAssignment
from ...formulations.evidence import Guarantee
from ...formulations.stop import Stop
from ...formulations.tolerance import LIMIT
from ...instances.auctions.assignment import AssignmentInstance
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic

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
        raise UsageError(f"mode must be one of {', '.join(MODES)}, not {mode!r}", "unknown-name")
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


MOST_TRIPLES = 2_000_000_000
"""Robots x robots x bins up to which the quadrangle inequality is tested: some seconds."""

QUADRANGLE = "c_ij <= c_il + c_kl + c_kj for all robots i, k and bins j, l, to 11 digits"


def quadrangle(problem: BinAssignment, stop: Stop) -> bool:
    """Whether all pairs are allowed and their costs keep the quadrangle inequality, as travel times in a metric do, waiting included.

    It implies costs of at least 0. The side of fewer is compared pair by pair.
    """
    from .conflict_kernels import quadrangle_broken

    if not problem.complete:
        return False
    matrix = problem.matrix()
    if problem.num_robots > problem.num_bins:
        matrix = np.ascontiguousarray(matrix.T)
    if matrix.shape[0] * matrix.size > MOST_TRIPLES:
        return False
    return bool(quadrangle_broken(stop.flag, matrix, LIMIT) == 0)


def completed(problem: BinAssignment, taken: NDArray[np.int64], stop: Stop) -> tuple[Assignment, int]:
    """An assignment of the most pairs that keeps as many of ``taken`` as possible, and how many it changes."""
    from ...solvers.engines.auctions.assignment_steps.auction import auction

    most = int((problem.largest >= 0).sum())
    if int((taken >= 0).sum()) >= most:
        return tuple(taken.tolist()), 0
    kept = taken[problem.robots] == problem.bins
    changes = AssignmentInstance(problem.num_robots, problem.num_bins, problem.indptr, problem.bins, np.where(kept, 0.0, 1.0))
    repaired = auction(BinAssignment(changes), stop)
    answer = repaired.answer if repaired.complete else problem.answer_at_hand()
    return answer, int((np.array(answer) != taken).sum())


def cut_short(problem: BinAssignment, stop: Stop, statistics: Mapping[str, float] | None = None) -> Outcome:
    """The outcome of an auction that was stopped: any assignment of the most pairs."""
    message = "cut short: the answer is any of the most pairs"
    return Outcome(problem.answer_at_hand(), statistics=dict(statistics or {}), message=message, limit=stop.reached() or "time")


def changes_message(changed: int) -> str:
    """A message that a completed assignment differs from the auction's."""
    return f"as many pairs as possible need other bins for {changed} robots than it found" if changed else ""
