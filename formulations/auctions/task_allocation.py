"""Tasks for robots: each is done by one robot, in the order of its path, from where it stands and without a way back."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.auctions.robot_tasks import RobotTasks
from ...instances.generators.settings import Setting
from ...instances.instance import digest
from ..evaluation import Evaluation
from ..problem import PROBLEMS
from .robot_shares import RobotShares, Shares, robot_tasks, saved, settings_of

if TYPE_CHECKING:
    import pandas as pd

Paths = Shares
"""The tasks of each robot in the order in which it does them."""

OBJECTIVES = ("mini-sum", "mini-max", "mini-ave")
OBJECTIVE = Setting(
    OBJECTIVES[0], "what is least: the sum of all paths, the longest path, or the mean way until a task is done", choices=OBJECTIVES
)


class TaskAllocation(RobotShares):
    """Every task in the path of one robot; no robot returns.

    An answer is a tuple with one tuple of tasks a robot, as numbers from 0.

    Parameters
    ----------
    instance : RobotTasks
        Robots, tasks, and distances.
    objective : str
        ``mini-sum``: the sum of the lengths of all paths. ``mini-max``: the longest. ``mini-ave``: the mean over all tasks of how far
        its robot goes until it is there.

    Raises
    ------
    UsageError
        For another objective.

    Notes
    -----
    Source: Lagoudakis et al. (2005), Auction-based multi-robot routing, section II; docs/formulations/task-allocation.md#model.
    """

    family: ClassVar[str] = "task-allocation"
    answer_kind: ClassVar[str] = "task-paths"

    def __init__(self, instance: RobotTasks, objective: str = OBJECTIVES[0]) -> None:
        self.instance, self.objective = instance, OBJECTIVE.value("objective", objective)
        self.name, self.problem, self.notes = instance.name, "task-allocation", instance.notes

    def digest(self) -> str:
        return digest("task-allocation", self.num_robots, self.instance.distances, self.objective)

    def features(self) -> frozenset[str]:
        return frozenset({f"objective:{self.objective}"})

    def linear_entries(self) -> int:
        return 4 * self.instance.distances.size

    def facts(self) -> dict[str, Any]:
        return {"objective": self.objective, "team": self.instance.facts()}

    def legs(self, robot: int, path: Sequence[int]) -> NDArray[np.float64]:
        """Distances from stop to stop of a path."""
        if not len(path):
            return np.zeros(0)
        tasks = np.asarray(path, dtype=np.int64)
        return np.asarray(self.instance.distances[np.concatenate([[robot], tasks[:-1] + self.num_robots]), tasks])

    def value(self, paths: Paths) -> float:
        """The objective of paths, from the data."""
        legs = [self.legs(robot, path) for robot, path in enumerate(paths)]
        if self.objective == "mini-max":
            return max((math.fsum(own) for own in legs), default=0.0)
        if self.objective == "mini-sum":
            return math.fsum(leg for own in legs for leg in own.tolist())
        ahead = [own * np.arange(len(own), 0, -1) for own in legs]  # every leg is on the way of all tasks after it
        return math.fsum(leg for own in ahead for leg in own.tolist()) / self.num_tasks

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute the objective, and test that there is one path per robot, and every task is in one of them."""
        checks, faults = self.judge_shares(answer)
        lengths = [math.fsum(self.legs(robot, path)) for robot, path in enumerate(answer)]
        busy = sum(1 for path in answer if path)
        quantities = {"busy_robots": float(busy), "total_length": math.fsum(lengths), "longest_path": max(lengths)}
        return Evaluation((self.value(answer),), checks, faults, quantities)

    def answer_to_frame(self, answer: Paths) -> "pd.DataFrame":
        """One row per task: robot, place in its path, task, the leg to it, and the way until there."""
        import pandas as pd

        columns: dict[str, list[Any]] = {"robot": [], "place": [], "task": [], "leg": [], "distance": []}
        for robot, path in enumerate(answer):
            legs = self.legs(robot, path)
            columns["robot"] += [self.instance.robot_name(robot)] * len(path)
            columns["place"] += range(1, len(path) + 1)
            columns["task"] += [self.instance.task_name(task) for task in path]
            columns["leg"] += legs.tolist()
            columns["distance"] += np.cumsum(legs).tolist()
        return pd.DataFrame(columns)

    def to_instance(self) -> RobotTasks:
        return saved(self, objective=self.objective)

    def __repr__(self) -> str:
        return f"<TaskAllocation {self.name}: {self.num_robots} robots, {self.num_tasks} tasks, {self.objective}>"


@PROBLEMS.register("task-allocation")
def make(instance: Any, name: str, settings: dict[str, Any]) -> TaskAllocation:
    """The problem of an instance; setting ``objective``."""
    return TaskAllocation(robot_tasks(instance, name), **settings_of(name, settings, ("objective",)))
