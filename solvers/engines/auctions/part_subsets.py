"""Engine ``part-subsets``: optimal partitions of a few tasks, from the cost of every set of them."""

from __future__ import annotations

import math
from typing import cast

import numpy as np

from ....formulations.auctions.balanced_partition import EDGES, OBJECTIVES, BalancedPartition
from ....formulations.problem import Problem
from ....formulations.tolerance import EQUAL
from ...backend import BACKENDS, Control, Engine, Options, RawResult

MOST_TASKS = 16
"""The least largest part takes 3^tasks steps a robot; the least spread as many as there are partitions that are not left aside."""


@BACKENDS.register("part-subsets")
class PartSubsets(Engine):
    """The least largest part by a dynamic program over sets; the least spread by enumeration that leaves aside what is no better.

    Source: docs/formulations/balanced-partition.md#exact.
    """

    name = "part-subsets"
    package = "numba"
    modules = ("numba",)
    summary = f"exact partitions of up to {MOST_TASKS} tasks, from the cost of every set of them"
    interrupts = "keeps the best partition of the least spread; has none of the least largest part before its end"
    honours = frozenset()
    one_thread = True
    order = 10
    family = "balanced-partition"
    features = frozenset({*(f"objective:{objective}" for objective in OBJECTIVES), *(f"edges:{edges}" for edges in EDGES)})

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        lacking = super().missing(problem)
        if lacking or cast("BalancedPartition", problem).num_tasks <= MOST_TASKS:
            return lacking
        return frozenset({f"more than {MOST_TASKS} tasks"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
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
    """By how much a better spread may have been missed.

    The largest cost is rounded by parts of what the answer itself adds up, but two parts of large distances may be equal within their
    rounding alone, beside an answer of small ones. 0 where sums are exact.
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
