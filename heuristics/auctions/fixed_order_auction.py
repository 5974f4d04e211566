"""Heuristic ``fixed-order-auction``: task after task, in a given order, joins the end of the path that is the shortest with it."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.task_allocation import TaskAllocation
from ...formulations.evidence import Guarantee
from ...formulations.references import indices_of
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from .auction_steps.task_paths import ANY_OBJECTIVE, arrays_of, keeps_triangles, paths_of

SOURCE = "each leg is at most OPT; docs/formulations/task-allocation.md#fixed-order"


@heuristic(
    "fixed-order-auction",
    "task-allocation",
    ANY_OBJECTIVE,
    "task after task, in a given order, to the end of the shortest path with it",
    "the number of tasks for one robot (mini-sum, mini-max) under the triangle inequality; none for several robots",
)
def fixed_order_auction(problem: TaskAllocation, context: Context, *, order: Sequence[int | str] | str | None = None) -> Outcome:
    """Each task, in order, goes to the robot whose path is the shortest with the task at its end.

    ``order`` lists all tasks once, by number from 0 or by name (text separated by commas counts as names); by default as numbered. The
    source takes the time until a waypoint's store is full, the shortest first. For one robot, the sum or the longest of paths, and the
    triangle inequality, the path is at most as many times the optimum as there are tasks, which a zigzag attains. For several robots no
    ratio holds: what comes last may lie where the path began.

    Source: Zhang (2015), algorithm 3, as read in docs/formulations/task-allocation.md#errata. It is no sequential single-item auction: the
    order comes from outside, and bids are for the end of a path alone.
    """
    from .auction_steps.bidding_kernels import appended

    stop = context.begin()
    path, count = appended(*arrays_of(problem), _order(problem, order))
    guarantee, tasks = None, problem.num_tasks
    if problem.num_robots == 1 and problem.objective != "mini-ave":
        holds = keeps_triangles(problem.instance, stop)
        if holds is not None:
            guarantee = Guarantee(float(tasks), f"path <= {tasks} OPT", (*holds, "one robot"), SOURCE)
    return Outcome(paths_of(path, count), guarantee, statistics={"rounds": tasks, "bids": tasks * problem.num_robots})


def _order(problem: TaskAllocation, asked: Any) -> NDArray[np.int64]:
    """The indices of all tasks in the order that is asked for."""
    tasks = problem.num_tasks
    if asked is None:
        return np.arange(tasks)
    names = {problem.instance.task_name(task): task for task in range(tasks)}
    items = [part.strip() for part in asked.split(",")] if isinstance(asked, str) else [str(asked)] if isinstance(asked, int) else asked
    try:
        numbers = indices_of(items, names, "task")
    except TypeError:
        numbers = []
    if sorted(numbers) != list(range(tasks)):
        raise UsageError(
            f"order must be a permutation of all {tasks} tasks, by number from 0 or by name, not {str(asked)[:80]!r}", "malformed"
        )
    return np.array(numbers, dtype=np.int64)
