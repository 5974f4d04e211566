"""Answers from the arrays of compiled auctions, completed where these were cut short, and the condition of their ratios."""

from typing import Any

import numpy as np

from ....formulations.auctions.task_allocation import OBJECTIVES, Paths, TaskAllocation
from ....formulations.stop import Stop
from ....formulations.tolerance import LIMIT
from ....instances.auctions.robot_tasks import RobotTasks
from ....instances.number_arrays import Floats, Integers

ANY_OBJECTIVE = frozenset(f"objective:{objective}" for objective in OBJECTIVES)

CUT_SHORT = "cut short: the tasks that nobody had got are done by the first robot, last"


def arrays_of(problem: TaskAllocation) -> tuple[Floats, Floats]:
    """Distances from the robots and between the tasks, as copies that kernels take."""
    return np.array(problem.instance.starts), np.array(problem.instance.between)


def paths_of(path: Integers, count: Integers) -> Paths:
    """The first ``count`` stops of each row."""
    return tuple(tuple(row[:stops].tolist()) for row, stops in zip(path, count.tolist(), strict=True))


def completed(problem: TaskAllocation, paths: Paths) -> Paths:
    """The paths, with missing tasks at the end of the first one."""
    awarded = {task for path in paths for task in path}
    missing = tuple(task for task in range(problem.num_tasks) if task not in awarded)
    return ((*paths[0], *missing), *paths[1:])


def rule_of(problem: TaskAllocation, asked: Any) -> str:
    """The bidding rule that is asked for, by default that of the objective."""
    from ....instances.errors import UsageError

    names = tuple(objective.removeprefix("mini-") for objective in OBJECTIVES)
    chosen = problem.objective.removeprefix("mini-") if asked is None else asked
    if chosen not in names:
        raise UsageError(f"bids must be {', '.join(names)}, not {asked!r}", "unknown-name")
    return str(chosen)


def keeps_triangles(instance: RobotTasks, stop: Stop) -> tuple[str, ...] | None:
    """The assumptions of a ratio that hold on the distances; None where the triangle inequality fails or ``stop`` came first.

    Distances of a rule of the plane need no test. In a matrix no direct way may be longer than one through a third place, but for the
    rounding of sums, a share of both ways: a bound that adds up m of them holds but for m times that share.
    """
    if instance.metric != "matrix":
        return (f"distances are {instance.metric} ones of the plane",)
    every, between = instance.distances, instance.between
    if (between != between.T).any():
        return None
    for row in every:
        if stop.reached():
            return None
        with np.errstate(over="ignore"):
            through = row[:, None] + between
            around = row[:, None] + row
        if (row > through.min(axis=0) * (1.0 + LIMIT)).any() or (between > around * (1.0 + LIMIT)).any():
            return None
    return ("distances between tasks are symmetric", "the triangle inequality holds")
