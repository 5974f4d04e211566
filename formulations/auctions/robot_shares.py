"""Base of the problems whose answers give every task to one robot."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ...instances.auctions.robot_tasks import RobotTasks
from ...instances.errors import InputError, UsageError
from ...instances.instance import with_settings
from ...instances.printable import printable
from ...instances.text import an
from ..evaluation import Check, Violation, judge
from ..problem import Problem, refuse_settings
from ..references import indices_of

Shares = tuple[tuple[int, ...], ...]
"""The tasks of each robot, as numbers from 0."""


class RobotShares(Problem):
    """A problem whose answer is a tuple with one tuple of tasks a robot, as numbers from 0; ``answer_kind`` is its kind in JSON."""

    senses = ("min",)
    instance: RobotTasks
    answer_kind: ClassVar[str]

    @property
    def num_robots(self) -> int:
        return self.instance.num_robots

    @property
    def num_tasks(self) -> int:
        return self.instance.num_tasks

    @property
    def size(self) -> int:
        return self.num_tasks

    def answer_at_hand(self) -> Shares:
        """All tasks to the first robot."""
        return (tuple(range(self.num_tasks)), *((),) * (self.num_robots - 1))

    def judge_shares(self, answer: Any) -> tuple[tuple[Check, ...], tuple[Violation, ...]]:
        """Test that there is one tuple per robot, and every task in one of them; InputError for what is no answer."""
        tasks = self.num_tasks
        if not isinstance(answer, tuple) or not all(isinstance(share, tuple) and all(type(t) is int for t in share) for share in answer):
            raise InputError("an answer is a tuple of tuples of tasks, one a robot, as numbers from 0", found=printable(repr(answer), 80))
        if len(answer) != self.num_robots:
            raise InputError("an answer has one tuple a robot", "wrong-shape", expected=str(self.num_robots), found=str(len(answer)))
        shared_out = [t for share in answer for t in share]
        unknown = [t for t in shared_out if not 0 <= t < tasks]
        if unknown:
            raise InputError(f"task number {unknown[0]} does not exist", "unknown-name", expected=f"0 to {tasks - 1}")
        count = np.bincount(np.array(shared_out, dtype=np.int64), minlength=tasks)
        name = self.instance.task_name
        checks: list[tuple[Check, list[Violation]]] = [
            judge("done", 1.0 - count, lambda k: f"nobody does task {name(k)}"),
            judge("once", count - 1.0, lambda k: f"task {name(k)} is done {count[k]} times"),
        ]
        return tuple(check for check, _ in checks), tuple(fault for _, broken in checks for fault in broken)

    def answer_to_json(self, answer: Shares) -> dict[str, Any]:
        data = self.instance
        shares = [{"robot": data.robot_name(r), "tasks": [data.task_name(task) for task in share]} for r, share in enumerate(answer)]
        return {"kind": self.answer_kind, "shares": shares}

    def answer_from_json(self, data: Any) -> Shares:
        shares = data.get("shares") if isinstance(data, Mapping) and data.get("kind") == self.answer_kind else None
        if not isinstance(shares, list) or not all(isinstance(share, Mapping) and share.keys() == {"robot", "tasks"} for share in shares):
            expected = f'an object {{"kind": "{self.answer_kind}", "shares": [{{"robot": ..., "tasks": [...]}}, ...]}}'
            raise InputError(f"not an answer to {an(self.problem)} problem", expected=expected)
        robots = {self.instance.robot_name(r): r for r in range(self.num_robots)}
        tasks = {self.instance.task_name(t): t for t in range(self.num_tasks)}
        tasks_of_robots: list[tuple[int, ...]] = [()] * self.num_robots
        seen: set[str] = set()
        for share in shares:
            robot, listed = str(share["robot"]), share["tasks"]
            if robot not in robots or robot in seen:
                raise InputError(
                    f"robot {printable(robot, 80)!r} {'stands twice' if robot in seen else 'does not exist'}",
                    "duplicate" if robot in seen else "unknown-name",
                )
            seen.add(robot)
            unknown = next((str(t) for t in listed if str(t) not in tasks), None) if isinstance(listed, list) else str(listed)
            if unknown is not None:
                raise InputError(f"the share of robot {robot} holds an unknown task {printable(str(unknown), 80)!r}", "unknown-name")
            tasks_of_robots[robots[robot]] = tuple(tasks[str(task)] for task in listed)
        return tuple(tasks_of_robots)

    def answer_of(self, given: Any) -> Shares:
        """Tuples of numbers from 0, or lists of numbers or names, one a robot."""
        if isinstance(given, tuple) and all(isinstance(share, tuple) and all(type(t) is int for t in share) for share in given):
            return given
        if isinstance(given, str | bytes | Mapping) or not isinstance(given, Iterable):
            raise UsageError("shares are a list with one list of tasks a robot, by number from 0 or by name", "malformed")
        names = {self.instance.task_name(task): task for task in range(self.num_tasks)}
        shares = list(given)
        if any(isinstance(share, str | bytes | Mapping) or not isinstance(share, Iterable) for share in shares):
            raise UsageError("shares are a list with one list of tasks a robot, by number from 0 or by name", "malformed")
        return tuple(tuple(indices_of(share, names, "task")) for share in shares)

    def check_start(self, answer: Any) -> None:
        shares = isinstance(answer, tuple) and len(answer) == self.num_robots and all(isinstance(share, tuple) for share in answer)
        if not shares or any(type(t) is not int or not 0 <= t < self.num_tasks for share in answer for t in share):
            raise UsageError(
                f"the start is no answer of {self.name}: it has {self.num_robots} robots and {self.num_tasks} tasks", "foreign"
            )


def robot_tasks(instance: Any, name: str) -> RobotTasks:
    """The instance, if it holds robots and tasks; UsageError otherwise."""
    if not isinstance(instance, RobotTasks):
        raise UsageError(f"{instance.name} holds no robots and tasks, so it cannot be read as {name}", "foreign")
    return instance


def settings_of(name: str, settings: Mapping[str, Any], known: tuple[str, ...]) -> dict[str, Any]:
    """The settings beside the convention; UsageError for one that is not ``known``."""
    refuse_settings(name, settings, known)
    return {key: value for key, value in settings.items() if key != "convention"}


def saved(problem: RobotShares, **settings: Any) -> RobotTasks:
    """The instance with the settings that make this problem of it."""
    tasks: RobotTasks = with_settings(replace(problem.instance, problem=problem.problem), settings)
    return tasks
