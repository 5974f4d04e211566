"""Bertsekas' auction: bids raise prices by what the second best bin is dearer, and epsilon."""

from __future__ import annotations

import math

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.evidence import Guarantee
from ...instances.errors import UsageError
from ...solvers.engines.assignment_steps.auction import FACTOR, auction
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome

SOURCE = "Bertsekas (1979), A distributed algorithm for the assignment problem; Bertsekas and Castañon (1992)"


def bertsekas(
    problem: BinAssignment, context: Context, *, epsilon: float | None = None, scaling: bool = True, factor: float = FACTOR
) -> Outcome:
    """Whoever has no bin bids for the best one at present prices; who is outbid bids again.

    Parameters
    ----------
    problem : BinAssignment
    context : Context
    epsilon : float, optional
        Above 0, in the unit of the costs: the answer costs at most n epsilon more than the optimum, n being the larger of the numbers of
        robots and bins. By default below one n-th of the step in which costs are counted: optimal for whole costs, and to about 10
        digits for others.
    scaling : bool
        Whether epsilon falls to that value from a part of the largest cost. Without, prices may rise in very many bids.
    factor : float
        Above 1: by which it falls from phase to phase.

    Returns
    -------
    Outcome
        With prices as evidence; ``bids`` and ``phases`` in its statistics.

    Raises
    ------
    UsageError
        For an epsilon of 0 or less, and a factor of 1 or less.

    Notes
    -----
    Robots bid for bins, or bins for robots where they are fewer. Where there are more columns than bidders, prices from 0 need no repair;
    after scaling, those left over are made no dearer than the others. Source: docs/formulations/bin-assignment.md#auctions.
    """
    if epsilon is not None and (isinstance(epsilon, bool) or not isinstance(epsilon, int | float) or not 0.0 < epsilon < math.inf):
        raise UsageError(f"epsilon must be a number above 0, not {epsilon!r}; leave it out for an optimal answer")
    if isinstance(factor, bool) or not isinstance(factor, int | float) or not 1.0 < factor < math.inf:
        raise UsageError(f"factor must be a number above 1, not {factor!r}")
    if not isinstance(scaling, bool):
        raise UsageError(f"scaling must be true or false, not {scaling!r}")
    stop = context.begin()
    found = auction(problem, stop, epsilon=epsilon or 0.0, factor=float(factor), scaling=scaling)
    statistics = {"bids": found.bids, "phases": found.phases, "epsilon": found.epsilon}
    if not found.complete:
        why = "prices grew beyond all bounds" if not stop.reached() else "cut short"
        return Outcome(found.answer, statistics=statistics, message=f"{why}: not all are matched", limit=stop.reached() or "none")
    if problem.pairs > int((problem.largest >= 0).sum()):
        return Outcome(found.answer, statistics=statistics)
    value = problem.evaluate(found.answer).quantities["sum"]
    return Outcome(
        found.answer,
        _guarantee(problem, value, found.epsilon, found.exact, epsilon),
        (found.evidence(problem, "auction prices"),),
        statistics,
    )


def _guarantee(problem: BinAssignment, value: float, epsilon: float, exact: bool, given: float | None) -> Guarantee | None:
    """1 where the costs are counted exactly and epsilon is small enough, else what n epsilon come to in parts of this answer."""
    n = max(problem.num_robots, problem.num_bins)
    step = 1.0 if bool((problem.cost == problem.cost.round()).all()) else 0.0
    if exact and (given is None or (step and given * n < step)):
        return Guarantee(1.0, "cost = OPT", ("costs are whole multiples of a step, and epsilon is below one n-th of it",), SOURCE)
    more = n * epsilon * (2.0 if not exact else 1.0)
    if value <= more:
        return None
    return Guarantee(value / (value - more), f"cost <= OPT + n epsilon = OPT + {more:.3g}", (f"n = {n}, epsilon = {epsilon:.3g}",), SOURCE)


HEURISTICS.add(
    "bertsekas",
    Heuristic(
        "bertsekas", ("bin-assignment",), frozenset({"objective:sum"}), bertsekas,
        "bids raise prices, with epsilon scaling: optimal assignments, and prices that prove it",
        "1 for whole costs; for others and for a given epsilon, n epsilon more than the optimum",
    ),
)  # fmt: skip
