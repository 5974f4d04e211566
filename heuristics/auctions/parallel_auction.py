"""Heuristic ``parallel-auction``: all tasks are auctioned at once, each by itself."""

import numpy as np

from ...formulations.auctions.task_allocation import TaskAllocation
from ...formulations.stop import Stop
from ..heuristic import Context, Outcome, heuristic
from .auction_steps.task_paths import ANY_OBJECTIVE, CUT_SHORT, arrays_of, completed


@heuristic("parallel-auction", "task-allocation", ANY_OBJECTIVE, "all tasks at once, each to the robot that stands nearest")
def parallel_auction(problem: TaskAllocation, context: Context) -> Outcome:
    """Each task goes to the nearest robot; then every robot inserts its tasks one after the other, the cheapest first.

    There is no guarantee: with n robots around a cluster of tasks the sum of paths may come to almost n times the optimum, and the longest
    path is not looked at. There is one round, with a bid of each robot for each task.

    Source: Lagoudakis et al. (2005); docs/formulations/task-allocation.md#auctions.
    """
    stop = context.begin()
    starts, between = arrays_of(problem)
    nearest = starts.argmin(axis=0)
    paths = []
    for robot in range(problem.num_robots):
        tasks = np.nonzero(nearest == robot)[0]
        paths.append(_path(stop, starts[[robot]][:, tasks], between[np.ix_(tasks, tasks)], tasks, problem.objective == "mini-ave"))
    limit = stop.reached() or "none"
    answer, statistics = tuple(paths), {"rounds": 1, "bids": starts.size}
    if sum(map(len, answer)) < problem.num_tasks:
        return Outcome(completed(problem, answer), statistics=statistics, message=CUT_SHORT, limit=limit)
    return Outcome(answer, statistics=statistics)


def _path(stop: Stop, start: np.ndarray, between: np.ndarray, tasks: np.ndarray, waiting: bool) -> tuple[int, ...]:
    """The path of one robot alone: an auction with one bidder."""
    from .auction_steps.bidding_kernels import SUM, WAYS, sequential

    if len(tasks) == 0:
        return ()
    path, count, _ = sequential(stop.flag, np.ascontiguousarray(start), np.ascontiguousarray(between), WAYS if waiting else SUM, 0)
    return tuple(tasks[path[0, : count[0]]].tolist())
