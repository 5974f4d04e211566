"""Engines ``task-subsets`` and ``part-subsets``: optimal paths, or partitions, of a few tasks, from the cost of every set of tasks."""

import math
from typing import cast

import numpy as np

from ....formulations.auctions.balanced_partition import EDGES, OBJECTIVES as PART_OBJECTIVES, BalancedPartition
from ....formulations.auctions.task_allocation import OBJECTIVES, Paths, TaskAllocation
from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ....formulations.tolerance import EQUAL
from ...backend import BACKENDS, Control, Engine, Options, RawResult

MOST_TASKS = 16
"""The work grows as 3^tasks for each robot but the first, 43 million steps, or for a least spread as the number of partitions tried."""


class SubsetEngine(Engine):
    """An engine that looks at every set of tasks, of which there must be few."""

    package = "numba"
    honours = frozenset()
    one_thread = True
    order = 10

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if lacking or cast("TaskAllocation | BalancedPartition", problem).num_tasks <= MOST_TASKS:
            return lacking
        return frozenset({f"more than {MOST_TASKS} tasks"})


@BACKENDS.register("task-subsets")
class TaskSubsets(SubsetEngine):
    """The cheapest path of each robot through every set of tasks (Held and Karp 1962), and the best way to share all tasks.

    Source: docs/formulations/task-allocation.md#exact.
    """

    name = "task-subsets"
    summary = f"dynamic program over sets of up to {MOST_TASKS} tasks: optimal paths for every objective"
    interrupts = "has no answer before its end"
    family = "task-allocation"
    features = frozenset(f"objective:{objective}" for objective in OBJECTIVES)

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        best = best_paths(cast("TaskAllocation", problem), stop)
        if best is None:
            return RawResult("unknown", stop.reached())
        return RawResult("optimal", "none", best[0], best[1], best[1])


def best_paths(problem: TaskAllocation, stop: Stop) -> tuple[Paths, float] | None:
    """An optimal answer and its value; None where ``stop`` came first."""
    from .task_subset_steps.subset_kernels import best_shares, costs_of_robots, costs_to_go, path_through

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


@BACKENDS.register("part-subsets")
class PartSubsets(SubsetEngine):
    """The least largest part by a dynamic program over sets; the least spread by enumeration that prunes what is no better.

    Source: docs/formulations/balanced-partition.md#exact.
    """

    name = "part-subsets"
    summary = f"exact partitions of up to {MOST_TASKS} tasks, from the cost of every set of them"
    interrupts = "keeps the best partition of the least spread; has none of the least largest part before its end"
    family = "balanced-partition"
    features = frozenset({*(f"objective:{objective}" for objective in PART_OBJECTIVES), *(f"edges:{edges}" for edges in EDGES)})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        from .task_subset_steps.part_kernels import CLIQUE, NONE, TREE, costs_of_sets, least_spread
        from .task_subset_steps.subset_kernels import best_shares

        stop = self.begin(problem, options, control)
        asked = cast("BalancedPartition", problem)
        kind = {"none": NONE, "clique": CLIQUE, "mst": TREE}[asked.edges]
        cost = costs_of_sets(stop.flag, np.array(asked.weights), np.array(asked.instance.between), kind)
        if stop.reached():
            return RawResult("unknown", stop.reached())
        if asked.objective == "min-max":
            value, shares = best_shares(stop.flag, np.tile(cost, (asked.num_robots, 1)), True)
            whole = not stop.reached()
        else:
            value, shares, whole = least_spread(stop.flag, cost, asked.num_robots)
        if not np.isfinite(value) or (not whole and asked.objective == "min-max"):
            return RawResult("unknown", stop.reached())
        parts = tuple(tuple(task for task in range(asked.num_tasks) if members >> task & 1) for members in shares.tolist())
        judged = asked.evaluate(parts)
        best = judged.values[0]
        if not whole:
            return RawResult("feasible", stop.reached(), parts, best)
        if _rounding(asked) > EQUAL * max(abs(best), judged.size):
            return RawResult("feasible", "none", parts, best, message="a better spread may be lost in rounding: distances are far larger")
        return RawResult("optimal", "none", parts, best, best)


def _rounding(problem: BalancedPartition) -> float:
    """Largest error by which a better spread may have been missed; 0 where sums are exact.

    The largest cost is rounded by shares of what the answer itself adds up, but two parts of large distances may be equal within their
    rounding alone, beside an answer of small ones.
    """
    if problem.objective == "min-max":
        return 0.0
    tasks = problem.num_tasks
    upper = problem.instance.between[np.triu_indices(tasks, 1)] if problem.edges != "none" else np.zeros(0)
    numbers = np.concatenate([problem.weights, upper])
    size = float(np.abs(numbers).sum())
    power = 52 - math.frexp(size)[1]
    if bool((np.ldexp(np.rint(np.ldexp(numbers, power)), -power) == numbers).all()):
        return 0.0
    return len(numbers) * float(np.finfo(np.float64).eps) * size
