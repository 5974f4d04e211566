"""The best paths of a few tasks: cheapest paths through every set, and the best way to share the sets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .....formulations.stop import Stop

if TYPE_CHECKING:
    from .....formulations.auctions.task_allocation import Paths, TaskAllocation

MOST_TASKS = 16
"""The work grows as 3^tasks for each robot but the first: 43 million steps."""


def best_paths(problem: TaskAllocation, stop: Stop) -> tuple[Paths, float] | None:
    """An optimal answer and its value; None where ``stop`` came first.

    Source: Held and Karp (1962) for the paths; docs/formulations/task-allocation.md#exact.
    """
    from .subset_kernels import best_shares, costs_of_robots, costs_to_go, path_through

    instance, waiting = problem.instance, problem.objective == "mini-ave"
    starts, between = (np.array(part) for part in (instance.starts, instance.between))
    to_go = costs_to_go(stop.flag, between, waiting)
    cost = costs_of_robots(stop.flag, starts, to_go, waiting)
    value, shares = best_shares(stop.flag, cost, problem.objective == "mini-max")
    if stop.reached():
        return None
    paths = tuple(
        tuple(path_through(starts[robot], between, to_go, members, waiting).tolist()) for robot, members in enumerate(shares.tolist())
    )
    return paths, float(value) / (problem.num_tasks if waiting else 1)
