"""Answers out of the arrays of compiled auctions, and what is left where they were cut short."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.auctions.task_allocation import OBJECTIVES, Paths, TaskAllocation

Floats = NDArray[np.float64]

ANY_OBJECTIVE = frozenset(f"objective:{objective}" for objective in OBJECTIVES)

CUT_SHORT = "cut short: the tasks that nobody had got are done by the first robot, last"


def arrays_of(problem: TaskAllocation) -> tuple[Floats, Floats]:
    """Distances from the robots and between the tasks, as kernels take them: copies that could be written to."""
    return np.array(problem.instance.starts), np.array(problem.instance.between)


def paths_of(path: NDArray[np.int64], count: NDArray[np.int64]) -> Paths:
    """The first stops of each row."""
    return tuple(tuple(row[:stops].tolist()) for row, stops in zip(path, count.tolist(), strict=True))


def completed(problem: TaskAllocation, paths: Paths) -> Paths:
    """Paths with all tasks: the first robot does those that are missing, last."""
    given = {task for path in paths for task in path}
    missing = tuple(task for task in range(problem.num_tasks) if task not in given)
    return ((*paths[0], *missing), *paths[1:])


def rule_of(problem: TaskAllocation, given: Any) -> str:
    """The bidding rule that is asked for, by default that of the objective."""
    from ....instances.errors import UsageError

    names = tuple(objective.removeprefix("mini-") for objective in OBJECTIVES)
    chosen = problem.objective.removeprefix("mini-") if given is None else given
    if chosen not in names:
        raise UsageError(f"bids must be {', '.join(names)}, not {given!r}")
    return str(chosen)
