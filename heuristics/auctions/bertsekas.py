"""Heuristic ``bertsekas``: bids raise the price of a bin by its lead over the second best bin, and epsilon."""

import math

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.evidence import Guarantee
from ...instances.errors import UsageError
from ...solvers.engines.auctions.assignment_steps.auction import FACTOR, Auction, auction
from ..heuristic import Context, Outcome, heuristic

SOURCE = "Bertsekas (1979), A distributed algorithm for the assignment problem; Bertsekas and Castañon (1992)"


@heuristic(
    "bertsekas",
    "bin-assignment",
    {"objective:sum"},
    "bids raise prices, with epsilon scaling: optimal assignments, and prices that prove it",
    "1 for whole costs; n epsilon more than the optimum for a given epsilon; for others what the prices of the answer prove",
)
def bertsekas(
    problem: BinAssignment, context: Context, *, epsilon: float | None = None, scaling: bool = True, factor: float = FACTOR
) -> Outcome:
    """Whoever has no bin bids for the best one at present prices; whoever is outbid bids again.

    With ``epsilon`` > 0, in the unit of the costs, the answer costs at most n epsilon more than the optimum, n being the larger of the
    numbers of robots and bins. It is at most the range of the costs, and a whole number, at least one, of the finest steps. By default it
    is below one n-th of the step in which costs are counted: optimal for whole costs, and to about 10 digits for others. With ``scaling``
    epsilon falls to that value from a part of the largest cost, by ``factor`` > 1 from phase to phase; without, prices may rise in very
    many bids.

    Robots bid for bins, or bins for robots where they are fewer. With more columns than bidders, prices from 0 need no repair; after
    scaling, free columns are made no dearer than the others. Source: docs/formulations/bin-assignment.md#auctions.
    """
    if epsilon is not None and (isinstance(epsilon, bool) or not isinstance(epsilon, int | float) or not 0.0 < epsilon < math.inf):
        raise UsageError(f"epsilon must be a number above 0, not {epsilon!r}; leave it out for an optimal answer", "out-of-range")
    if isinstance(factor, bool) or not isinstance(factor, int | float) or not 1.0 < factor < math.inf:
        raise UsageError(f"factor must be a number above 1, not {factor!r}", "out-of-range")
    if not isinstance(scaling, bool):
        raise UsageError(f"scaling must be true or false, not {scaling!r}", "malformed")
    stop = context.begin()
    ended = auction(problem, stop, epsilon=epsilon or 0.0, factor=float(factor), scaling=scaling)
    statistics = {"bids": ended.bids, "phases": ended.phases, "epsilon": ended.epsilon}
    if not ended.complete:
        why = "prices grew beyond all bounds" if not stop.reached() else "cut short"
        message = f"{why}: the answer is any of the most pairs"
        return Outcome(problem.answer_at_hand(), statistics=statistics, message=message, limit=stop.reached() or "none")
    message = _other(epsilon, ended)
    if problem.pairs > int((problem.largest >= 0).sum()):
        return Outcome(ended.answer, statistics=statistics, message=message)
    value, evidence = problem.evaluate(ended.answer).quantities["sum"], ended.evidence(problem, "auction prices")
    return Outcome(ended.answer, _guarantee(problem, value, evidence.value, ended), (evidence,), statistics, message)


def _other(asked: float | None, ended: Auction) -> str:
    """A message that another epsilon was used than was asked for, and why."""
    if asked is None or math.isclose(asked, ended.epsilon, rel_tol=1e-6):
        return ""
    why = "the range of the costs" if ended.capped else "a whole number of the finest steps in which costs are counted"
    return f"epsilon {asked:g} is run as {ended.epsilon:.6g}, {why}"


def _guarantee(problem: BinAssignment, value: float, proved: float, ended: Auction) -> Guarantee | None:
    """1 or what n epsilon is as a share of this answer where costs are counted exactly; else what the prices prove."""
    if ended.optimal:
        return Guarantee(1.0, "cost = OPT", ("costs are whole multiples of a step, and epsilon is below one n-th of it",), SOURCE)
    if not ended.exact:
        return _ratio(
            value, proved, "cost <= ratio * what the prices of this answer prove", "costs are rounded to steps for the bids alone"
        )
    n, epsilon = max(problem.num_robots, problem.num_bins), ended.epsilon
    more = math.nextafter(n * math.nextafter(epsilon, math.inf), math.inf)
    statement = f"cost <= OPT + n epsilon = OPT + {more:.3g}"
    return _ratio(value, math.nextafter(value, -math.inf) - more, statement, f"n = {n}, epsilon = {epsilon:.3g}")


def _ratio(value: float, least: float, statement: str, assumption: str) -> Guarantee | None:
    """The ratio of the answer to a lower bound, which has to be above 0."""
    least = math.nextafter(least, -math.inf)
    ratio = math.nextafter(value / least, math.inf) if least > 0.0 else math.inf
    return Guarantee(max(1.0, ratio), statement, (assumption,), SOURCE) if ratio < math.inf else None
