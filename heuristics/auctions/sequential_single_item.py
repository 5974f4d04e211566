"""Heuristic ``sequential-single-item``: round after round all robots bid for all open tasks, and the lowest bid wins."""

from ...formulations.auctions.task_allocation import OBJECTIVES, TaskAllocation
from ...formulations.evidence import Guarantee
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from .auction_steps.task_paths import ANY_OBJECTIVE, CUT_SHORT, arrays_of, completed, keeps_triangles, paths_of, rule_of

SOURCE = "Lagoudakis et al. (2005), Auction-based multi-robot routing; its proof on docs/formulations/task-allocation.md#guarantee-2"

MOST_ORDERED = 9
"""Tasks of one robot up to which its best path is found: 2^9 sets for each open task, in every round."""


@heuristic(
    "sequential-single-item",
    "task-allocation",
    ANY_OBJECTIVE,
    "auction of one task a round to the lowest marginal bid (SSI)",
    "2 for the sum of all paths (mini-sum) under the triangle inequality; none for the other objectives",
)
def sequential_single_item(problem: TaskAllocation, context: Context, *, bids: str | None = None, paths: str = "insertion") -> Outcome:
    """Award one task a round, to the robot and for the task of the lowest bid; of equal bids the lower robot, then the lower task.

    ``bids`` says what a bid is: ``sum``, by how much the robot's path grows; ``max``, how long it is then; ``ave``, what is added to the
    ways of all its tasks; by default what the objective counts. With ``paths`` ``insertion`` a robot keeps the order of its path and
    inserts at the cheapest place; with ``optimal`` it takes its best path through up to ``MOST_ORDERED`` tasks. The statistics count
    rounds, and one bid a robot and round: its lowest.

    Source: Lagoudakis et al. (2005), bidding rules BidSumPath, BidMaxPath and BidAvePath; docs/formulations/task-allocation.md#auctions.
    """
    from .auction_steps.bidding_kernels import sequential

    rule = rule_of(problem, bids)
    if paths not in ("insertion", "optimal"):
        raise UsageError(f"paths must be insertion or optimal, not {paths!r}", "unknown-name")
    stop = context.begin()
    number = [objective.removeprefix("mini-") for objective in OBJECTIVES].index(rule)
    path, count, awarded = sequential(stop.flag, *arrays_of(problem), number, MOST_ORDERED if paths == "optimal" else 0)
    answer = paths_of(path, count)
    statistics = {"rounds": int(awarded), "bids": int(awarded) * problem.num_robots}
    if awarded < problem.num_tasks:
        return Outcome(completed(problem, answer), statistics=statistics, message=CUT_SHORT, limit=stop.reached() or "none")
    guarantee = None
    if problem.objective == "mini-sum" and rule == "sum" and not stop.reached():
        holds = keeps_triangles(problem.instance, stop)
        guarantee = None if holds is None else Guarantee(2.0, "sum of paths <= 2 OPT", holds, SOURCE)
    return Outcome(answer, guarantee, statistics=statistics)
