"""Tasks shared out among robots so that no part costs much more than another."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.auctions.robot_tasks import RobotTasks
from ...instances.errors import InputError
from ...instances.generators.settings import Setting
from ...instances.instance import digest
from ..evaluation import Evaluation
from ..problem import PROBLEMS
from .robot_shares import RobotShares, Shares, robot_tasks, saved, settings_of

if TYPE_CHECKING:
    import pandas as pd

Parts = Shares
"""The tasks of each robot, in no particular order."""

OBJECTIVES = ("min-max", "min-difference")
OBJECTIVE = Setting(OBJECTIVES[0], "what is least: the largest cost of a part, or the largest less the smallest", choices=OBJECTIVES)

EDGES = ("mst", "clique", "none")
EDGE = Setting(EDGES[0], "distances that a part costs: a minimum spanning tree, all pairs, or none", choices=EDGES)


class BalancedPartition(RobotShares):
    """Every task in the part of one robot. A part costs the weights of its tasks, and distances between them; one without tasks nothing.

    An answer is a tuple with one tuple of tasks a robot, as numbers from 0. Where robots stand plays no part.

    Parameters
    ----------
    instance : RobotTasks
        With distances between tasks that do not depend on the direction.
    objective : str
        ``min-max``: the largest cost of a part. ``min-difference``: the largest less the smallest.
    edges : str
        ``mst``: a minimum spanning tree of the part. ``clique``: all pairs of its tasks. ``none``: weights alone.

    Raises
    ------
    InputError
        If distances depend on the direction.
    UsageError
        For another objective, or other edges.

    Notes
    -----
    Source: Zhang (2015), (4.3) and (4.4), as read in docs/formulations/balanced-partition.md#model.
    """

    family: ClassVar[str] = "balanced-partition"
    answer_kind: ClassVar[str] = "task-parts"

    def __init__(self, instance: RobotTasks, objective: str = OBJECTIVES[0], edges: str = EDGES[0]) -> None:
        self.instance, self.objective, self.edges = instance, OBJECTIVE.value("objective", objective), EDGE.value("edges", edges)
        self.name, self.problem, self.notes = instance.name, "balanced-partition", instance.notes
        lopsided = np.argwhere(instance.between != instance.between.T)
        if len(lopsided) and self.edges != "none":
            a, b = (instance.task_name(task) for task in lopsided[0].tolist())
            raise InputError(
                "distances between tasks must not depend on the direction", "unsupported", found=f"they do between {a} and {b}"
            )

    @property
    def weights(self) -> NDArray[np.float64]:
        return np.asarray(self.instance.weights)

    def digest(self) -> str:
        between = self.instance.between if self.edges != "none" else 0
        return digest("balanced-partition", self.num_robots, self.weights, between, self.objective, self.edges)

    def features(self) -> frozenset[str]:
        return frozenset({f"objective:{self.objective}", f"edges:{self.edges}"})

    def linear_entries(self) -> int:
        pairs = self.num_tasks * (self.num_tasks - 1) // 2 if self.edges == "clique" else 0
        return self.num_robots * (3 * self.num_tasks + 4 * pairs)

    def facts(self) -> dict[str, Any]:
        return {"objective": self.objective, "edges": self.edges, "team": self.instance.facts()}

    def terms(self, part: Sequence[int]) -> list[float]:
        """The weights and distances that add up to the cost of a part."""
        tasks = np.asarray(part, dtype=np.int64)
        own = self.instance.between[np.ix_(tasks, tasks)]
        terms: list[float] = self.weights[tasks].tolist()
        if self.edges == "clique":
            return [*terms, *own[np.triu_indices(len(tasks), 1)].tolist()]
        if self.edges == "none" or len(tasks) < 2:
            return terms
        near, waiting = own[0].copy(), np.arange(len(tasks)) > 0
        for _ in range(len(tasks) - 1):  # Prim (1957)
            node = int(np.where(waiting, near, math.inf).argmin())
            terms.append(float(near[node]))
            waiting[node] = False
            near = np.minimum(near, own[node])
        return terms

    def costs(self, parts: Parts) -> list[float]:
        """The cost of each part, from the data."""
        return [math.fsum(self.terms(part)) for part in parts]

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the objective, and test that there is one part per robot, and every task is in one of them."""
        checks, faults = self.judge_shares(answer)
        terms = [self.terms(part) for part in answer]
        costs = [math.fsum(own) for own in terms]
        size = max(math.fsum(map(abs, own)) for own in terms)
        value = max(costs) - (min(costs) if self.objective == "min-difference" else 0.0)
        quantities = {"largest_part": max(costs), "smallest_part": min(costs), "all_parts": math.fsum(costs)}
        return Evaluation((value,), checks, faults, quantities, (max(size, abs(value)),))

    def answer_to_frame(self, answer: Parts) -> "pd.DataFrame":
        """One row per task: robot, task, its weight, and the cost of the part that it is in."""
        import pandas as pd

        data, costs = self.instance, self.costs(answer)
        rows = [
            (data.robot_name(robot), data.task_name(task), float(self.weights[task]), costs[robot])
            for robot, part in enumerate(answer)
            for task in part
        ]
        return pd.DataFrame(rows, columns=["robot", "task", "weight", "part_cost"])

    def to_instance(self) -> RobotTasks:
        return saved(self, objective=self.objective, edges=self.edges)

    def __repr__(self) -> str:
        return f"<BalancedPartition {self.name}: {self.num_tasks} tasks, {self.num_robots} parts, {self.objective}, edges {self.edges}>"


@PROBLEMS.register("balanced-partition")
def make(instance: Any, name: str, settings: dict[str, Any]) -> BalancedPartition:
    """The problem of an instance; settings ``objective`` and ``edges``."""
    return BalancedPartition(robot_tasks(instance, name), **settings_of(name, settings, ("objective", "edges")))
