"""Tasks for robots: each is done by one robot, in the order of its path, from where it stands and without a way back."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.auctions.robot_tasks import RobotTasks
from ...instances.errors import InputError, UsageError
from ...instances.generators.settings import Setting
from ...instances.instance import digest
from ...instances.printable import printable
from ..evaluation import Check, Evaluation, Violation, judge
from ..problem import PROBLEMS, Problem
from ..references import indices_of

if TYPE_CHECKING:
    import pandas as pd

Paths = tuple[tuple[int, ...], ...]
"""The tasks of each robot in the order in which it does them."""

OBJECTIVES = ("mini-sum", "mini-max", "mini-ave")
OBJECTIVE = Setting(
    OBJECTIVES[0], "what is least: the sum of all paths, the longest path, or the mean way until a task is done", choices=OBJECTIVES
)


class TaskAllocation(Problem):
    """Every task in the path of one robot; no robot returns.

    An answer is a tuple with one tuple of tasks a robot, as numbers from 0.

    Parameters
    ----------
    instance : RobotTasks
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

    def __init__(self, instance: RobotTasks, objective: str = OBJECTIVES[0]) -> None:
        self.instance, self.objective = instance, OBJECTIVE.value("objective", objective)
        self.name, self.problem, self.notes = instance.name, "task-allocation", instance.notes

    @property
    def num_robots(self) -> int:
        return self.instance.num_robots

    @property
    def num_tasks(self) -> int:
        return self.instance.num_tasks

    @property
    def senses(self) -> tuple[str, ...]:
        return ("min",)

    @property
    def convention(self) -> str:
        return "exact"

    def digest(self) -> str:
        return digest("task-allocation", self.num_robots, self.instance.distances, self.objective)

    def features(self) -> frozenset[str]:
        """The objective."""
        return frozenset({f"objective:{self.objective}"})

    @property
    def size(self) -> int:
        return self.num_tasks

    def linear_entries(self) -> int:
        return 4 * self.instance.distances.size

    def facts(self) -> dict[str, Any]:
        return {"objective": self.objective, "team": self.instance.facts()}

    def legs(self, robot: int, path: Sequence[int]) -> NDArray[np.float64]:
        """Distances from stop to stop of a path."""
        if not len(path):
            return np.zeros(0)
        tasks = np.asarray(path, dtype=np.int64)
        return self.instance.distances[np.concatenate([[robot], tasks[:-1] + self.num_robots]), tasks]

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
        """Recompute the objective, and test that there is one path a robot, and every task is in one of them."""
        tasks = self.num_tasks
        if not isinstance(answer, tuple) or not all(isinstance(path, tuple) and all(type(t) is int for t in path) for path in answer):
            raise InputError("an answer is a tuple of tuples of tasks, one a robot, as numbers from 0", found=printable(repr(answer), 80))
        if len(answer) != self.num_robots:
            raise InputError("an answer has one path a robot", expected=str(self.num_robots), found=str(len(answer)))
        given = [t for path in answer for t in path]
        unknown = [t for t in given if not 0 <= t < tasks]
        if unknown:
            raise InputError(f"task number {unknown[0]} does not exist", expected=f"0 to {tasks - 1}")
        count = np.bincount(np.array(given, dtype=np.int64), minlength=tasks)
        name = self.instance.task_name
        checks: list[tuple[Check, list[Violation]]] = [
            judge("done", 1.0 - count, lambda k: f"nobody does task {name(k)}"),
            judge("once", count - 1.0, lambda k: f"task {name(k)} is done {count[k]} times"),
        ]
        lengths = [math.fsum(self.legs(robot, path)) for robot, path in enumerate(answer)]
        busy = sum(1 for path in answer if path)
        quantities = {"busy_robots": float(busy), "total_length": math.fsum(lengths), "longest_path": max(lengths)}
        faults = tuple(fault for _, found in checks for fault in found)
        return Evaluation((self.value(answer),), tuple(check for check, _ in checks), faults, quantities)

    def answer_at_hand(self) -> Paths:
        """All tasks by the first robot."""
        return (tuple(range(self.num_tasks)), *((),) * (self.num_robots - 1))

    # -- answers as files and tables ---------------------------------------------------------------------------------

    def answer_to_json(self, answer: Paths) -> dict[str, Any]:
        told = self.instance
        paths = [
            {"robot": told.robot_name(robot), "tasks": [told.task_name(task) for task in path]} for robot, path in enumerate(answer)
        ]
        return {"kind": "task-paths", "paths": paths}

    def answer_from_json(self, data: Any) -> Paths:
        paths = data.get("paths") if isinstance(data, Mapping) and data.get("kind") == "task-paths" else None
        if not isinstance(paths, list) or not all(isinstance(path, Mapping) and path.keys() == {"robot", "tasks"} for path in paths):
            expected = 'an object {"kind": "task-paths", "paths": [{"robot": ..., "tasks": [...]}, ...]}'
            raise InputError("not an answer to a task-allocation problem", expected=expected)
        robots = {self.instance.robot_name(r): r for r in range(self.num_robots)}
        tasks = {self.instance.task_name(t): t for t in range(self.num_tasks)}
        made: list[tuple[int, ...]] = [()] * self.num_robots
        seen: set[str] = set()
        for path in paths:
            robot, given = str(path["robot"]), path["tasks"]
            if robot not in robots or robot in seen:
                raise InputError(f"robot {printable(robot, 80)!r} {'has two paths' if robot in seen else 'does not exist'}")
            seen.add(robot)
            unknown = next((t for t in given if str(t) not in tasks), None) if isinstance(given, list) else given
            if not isinstance(given, list) or unknown is not None:
                raise InputError(f"the path of robot {robot} holds an unknown task {printable(str(unknown), 80)!r}")
            made[robots[robot]] = tuple(tasks[str(task)] for task in given)
        return tuple(made)

    def answer_of(self, given: Any) -> Paths:
        """Tuples of numbers from 0, or lists of numbers or names, one a robot."""
        if isinstance(given, tuple) and all(isinstance(path, tuple) and all(type(t) is int for t in path) for path in given):
            return given
        if isinstance(given, str | bytes | Mapping) or not isinstance(given, Iterable):
            raise UsageError("paths are a list with one list of tasks a robot, by number from 0 or by name")
        names = {self.instance.task_name(task): task for task in range(self.num_tasks)}
        paths = list(given)
        if any(isinstance(path, str | bytes | Mapping) or not isinstance(path, Iterable) for path in paths):
            raise UsageError("paths are a list with one list of tasks a robot, by number from 0 or by name")
        return tuple(tuple(indices_of(path, names, "task")) for path in paths)

    def check_start(self, answer: Any) -> None:
        """See ``Problem.check_start``."""
        known = isinstance(answer, tuple) and all(isinstance(path, tuple) for path in answer)
        if not known or len(answer) != self.num_robots or any(not 0 <= t < self.num_tasks for path in answer for t in path):
            raise UsageError(f"the start is no answer of {self.name}: it has {self.num_robots} robots and {self.num_tasks} tasks")

    def answer_to_frame(self, answer: Paths) -> pd.DataFrame:
        """One row a task: robot, place in its path, task, the leg to it, and the way until there."""
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

    def __repr__(self) -> str:
        return f"<TaskAllocation {self.name}: {self.num_robots} robots, {self.num_tasks} tasks, {self.objective}>"


@PROBLEMS.register("task-allocation")
def make(instance: Any, name: str, settings: dict[str, Any]) -> TaskAllocation:
    """The problem of an instance; setting ``objective``."""
    if not isinstance(instance, RobotTasks):
        raise UsageError(f"{instance.name} holds no robots and tasks, so it cannot be read as {name}")
    if settings.pop("convention", None) not in (None, "exact"):
        raise UsageError(f"{name} problems take distances as they are: the convention can only be exact")
    objective = settings.pop("objective", OBJECTIVE.default)
    if settings:
        raise UsageError(f"{name} has no setting {', '.join(settings)}; it takes objective")
    return TaskAllocation(instance, objective)
