"""Robots and tasks in CSV: one row per robot or task, with its role, name and place; documented in ``docs/formats.md``."""

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Table, check_kind, check_name, name_of, no_place, settings_of, table_of, titles_of, written
from ...text import an, plain, shown
from ..robot_tasks import METRICS, PROBLEMS, RobotTasks

KEYS = ("name", "problem", "metric")
COLUMNS = ("role", "name", "x", "y", "weight")
ROLES = ("robot", "task")
CHOICES = {"problem": PROBLEMS, "metric": METRICS[:-1]}


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds the titles ``role``, ``x`` and ``y``."""
    return {"role", "x", "y"} <= titles_of(text)


def read(text: str, path: Path) -> RobotTasks:
    """The instance; see ``Format.read``."""
    settings, start = settings_of(text, KEYS, COLUMNS, CHOICES)
    table = table_of(text, start, COLUMNS, "robots and tasks")
    role, *_ = table.columns(("role", "x", "y"), start + 1, ("role", "x", "y"))
    for cell, line in zip(role, table.at, strict=True):
        if cell not in ROLES:
            raise InputError("role is unknown", "unknown-name", line=line, expected="robot or task", found=shown(cell))
    robots, tasks = ([k for k, cell in enumerate(role) if cell == wanted] for wanted in ROLES)
    place = np.column_stack([table.numbers(title, [*robots, *tasks]) for title in ("x", "y")])
    weights = None
    if "weight" in table.titles:
        column = table.column("weight") or []
        wrong = next((k for k in robots if column[k]), None)
        if wrong is not None:
            raise InputError(
                "a robot has no weight", "contradiction", line=table.at[wrong], expected="an empty cell", found=shown(column[wrong])
            )
        weights = table.numbers("weight", tasks)
    names = [_names(table, members, wanted) for members, wanted in zip((robots, tasks), ROLES, strict=True)]
    return RobotTasks(
        len(robots), len(tasks), settings["metric"][1] if "metric" in settings else METRICS[0], place, weights=weights,
        robot_names=names[0], task_names=names[1], name=name_of(settings, path), format="robot-tasks",
        problem=settings["problem"][1] if "problem" in settings else PROBLEMS[0],
    )  # fmt: skip


def _names(table: Table, members: list[int], role: str) -> tuple[str, ...] | None:
    column = table.column("name")
    if column is None:
        return None
    seen: dict[str, int] = {}
    for k in members:
        check_name(an(role), column[k], table.at[k])
        if column[k] in seen:
            raise InputError(f"the {role} {shown(column[k])} stands twice, first in line {seen[column[k]]}", "duplicate", line=table.at[k])
        seen[column[k]] = table.at[k]
    return tuple(seen)


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    check_kind(instance, RobotTasks, "robots and tasks", "robot-tasks")
    if instance.metric == METRICS[-1] or instance.positions is None:
        raise no_place(instance, "robot-tasks", "a matrix of distances")
    settings = [("name", instance.name), ("problem", instance.problem), ("metric", instance.metric)]
    n, weights = instance.num_robots, np.asarray(instance.weights)
    names = [*map(instance.robot_name, range(n)), *map(instance.task_name, range(instance.num_tasks))]
    rows = [["robot" if k < n else "task", names[k], *map(plain, place)] for k, place in enumerate(instance.positions.tolist())]
    if weights.any():
        for row, weight in zip(rows, [""] * n + [plain(w) for w in weights], strict=True):
            row.append(weight)
    return written(settings, COLUMNS[: 4 + int(weights.any())], rows)


FORMATS.enter(
    Format(
        "robot-tasks", "robots and tasks with their places from CSV, one row each", recognises, read, write, (".csv",), "", PROBLEMS,
        answer="paths or parts", solutions=(".json",), kinds=("robot-tasks",),
    )
)  # fmt: skip
