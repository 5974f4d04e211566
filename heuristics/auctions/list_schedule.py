"""Heuristic ``list-schedule``: bins of an orchard one after the other, each by the robot that has it home the soonest."""

import heapq

from ...formulations.auctions.orchard_day import OrchardDay, in_order
from ...formulations.evidence import Guarantee
from ...formulations.stop import Stopped
from ...instances.auctions.orchard_jobs import OrchardJobs
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic

ORDERS = ("nearest", "longest")

READY = ("all bins are full at the start", "no bin is to be brought", "all robots begin at the repository at once")
"""Conditions under which bins are jobs of fixed lengths on identical machines."""


@heuristic(
    "list-schedule",
    "orchard-day",
    {"objective:makespan", "objective:completion"},
    "bins in the order of their ways, each by the robot that has it home first",
    "2 - 1/m, longest first 4/3 - 1/(3 m), for full bins and robots at the repository; nearest first is then optimal for the sum",
)
def list_schedule(problem: OrchardDay, context: Context, *, order: str = "nearest") -> Outcome:
    """Bins by the length of their trip, shortest (``order="nearest"``) or longest first.

    A bin comes after those that its group fills before it, unless all are full.
    """
    if order not in ORDERS:
        raise UsageError(f"list-schedule: order must be one of {', '.join(ORDERS)}, not {order!r}", "unknown-name")
    jobs = problem.jobs
    length = (jobs.out + jobs.home).tolist()
    after = [-1] * jobs.num_bins if is_ready(jobs) else jobs.after.tolist()  # full bins wait for none
    following = {before: k for k, before in enumerate(after) if before >= 0}
    sign = 1 if order == "nearest" else -1
    ready = [(sign * length[k], k) for k, before in enumerate(after) if before < 0]
    heapq.heapify(ready)
    listed: list[int] = []
    while ready:
        k = heapq.heappop(ready)[1]
        listed.append(k)
        if k in following:
            heapq.heappush(ready, (sign * length[following[k]], following[k]))
    stop = context.begin()
    try:
        return Outcome(in_order(jobs, listed, stop), _guarantee(problem, order))
    except Stopped:
        return Outcome(None, limit=stop.reached())


def is_ready(jobs: OrchardJobs) -> bool:
    """Whether the conditions ``READY`` hold."""
    waits = bool((jobs.work > 0).any() or not jobs.standing.all() or jobs.away.any() or (jobs.robot_free > 0).any())
    return not waits


def _guarantee(problem: OrchardDay, order: str) -> Guarantee | None:
    if not is_ready(problem.jobs):
        return None
    m = problem.jobs.num_robots
    if problem.objective == "completion":
        shortest = "sum of the bins' steps = least sum"
        return Guarantee(1.0, shortest, READY, "Conway, Maxwell and Miller (1967)") if order == "nearest" else None
    if order == "longest":
        return Guarantee(4 / 3 - 1 / (3 * m), "last step <= (4/3 - 1/(3 m)) optimum for m robots", READY, "Graham (1969), theorem 2")
    return Guarantee(2 - 1 / m, "last step <= (2 - 1/m) optimum for m robots", READY, "Graham (1966)")
