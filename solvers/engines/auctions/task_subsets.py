"""Engine ``task-subsets``: optimal paths for a few tasks by a dynamic program over their sets."""

from __future__ import annotations

from typing import cast

from ....formulations.auctions.task_allocation import OBJECTIVES, TaskAllocation
from ....formulations.problem import Problem
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from .task_subset_steps.shares import MOST_TASKS, best_paths


@BACKENDS.register("task-subsets")
class TaskSubsets(Engine):
    """The cheapest path of each robot through every set of tasks (Held and Karp 1962), and the best way to share all tasks.

    Source: docs/formulations/task-allocation.md#exact.
    """

    name = "task-subsets"
    package = "numba"
    modules = ("numba",)
    summary = f"dynamic program over sets of up to {MOST_TASKS} tasks: optimal paths for every objective"
    interrupts = "has no answer before its end"
    honours = frozenset()
    one_thread = True
    order = 10
    family = "task-allocation"
    features = frozenset(f"objective:{objective}" for objective in OBJECTIVES)

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        lacking = super().missing(problem)
        if lacking or cast("TaskAllocation", problem).num_tasks <= MOST_TASKS:
            return lacking
        return frozenset({f"more than {MOST_TASKS} tasks"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        stop = self.begin(problem, options, control)
        found = best_paths(cast("TaskAllocation", problem), stop)
        if found is None:
            return RawResult("unknown", stop.reached())
        return RawResult("optimal", "none", found[0], found[1], found[1])
