"""Robots and tasks in CSV: one row a robot or task, with its role, name and place; documented in ``docs/formats.md``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...formats.table import Table, settings_of, table_of, titles_of, written
from ...text import an, label, number, plain, shown
from ..robot_tasks import METRICS, PROBLEMS, RobotTasks

KEYS = ("name", "problem", "metric")
COLUMNS = ("role", "name", "x", "y", "weight")
ROLES = ("robot", "task")
CHOICES = {"problem": PROBLEMS, "metric": METRICS[:-1]}


def recognises(text: str) -> bool:
    """Whether the first line that is no comment holds the titles ``role``, ``x`` and ``y``."""
    return {"role", "x", "y"} <= titles_of(text)


def read(text: str, path: Path) -> RobotTasks:
    """The instance; see ``Format.read``."""
    settings, start = settings_of(text, KEYS, COLUMNS)
    for key, choices in CHOICES.items():
        if key in settings and settings[key][1] not in choices:
            line, value = settings[key]
            raise InputError(f"{key} {shown(value)} is unknown", line=line, expected=", ".join(choices))
    table = table_of(text, start, COLUMNS, "robots and tasks")
    for title in ("role", "x", "y"):
        if title not in table.titles:
            raise InputError(f"column {title} is missing", line=start + 1, expected="role, x, y", found=", ".join(table.titles))
    role = table.column("role") or []
    for cell, line in zip(role, table.at, strict=True):
        if cell not in ROLES:
            raise InputError("role is unknown", line=line, expected="robot or task", found=shown(cell))
    robots, tasks = ([k for k, cell in enumerate(role) if cell == wanted] for wanted in ROLES)
    place = np.array([_cells(table, title, [*robots, *tasks]) for title in ("x", "y")]).T
    weights = None
    if "weight" in table.titles:
        column = table.column("weight") or []
        wrong = next((k for k in robots if column[k]), None)
        if wrong is not None:
            raise InputError("a robot has no weight", line=table.at[wrong], expected="an empty cell", found=shown(column[wrong]))
        weights = np.array(_cells(table, "weight", tasks))
    names = [_names(table, members, wanted) for members, wanted in zip((robots, tasks), ROLES, strict=True)]
    return RobotTasks(
        len(robots), len(tasks), settings["metric"][1] if "metric" in settings else METRICS[0], place, weights=weights,
        robot_names=names[0], task_names=names[1], name=label(settings["name"][1] if "name" in settings else path.stem),
        format="robot-tasks", problem=settings["problem"][1] if "problem" in settings else PROBLEMS[0],
    )  # fmt: skip


def _cells(table: Table, title: str, members: list[int]) -> list[float]:
    column = table.column(title) or []
    return [number(column[k], table.at[k], title) for k in members]


def _names(table: Table, members: list[int], role: str) -> tuple[str, ...] | None:
    column = table.column("name")
    if column is None:
        return None
    seen: dict[str, int] = {}
    for k in members:
        if not column[k] or not column[k].isprintable():
            raise InputError(f"{an(role)} must have a name", line=table.at[k], expected="a printable name", found=ascii(column[k])[:40])
        if column[k] in seen:
            raise InputError(f"the {role} {shown(column[k])} stands twice, first in line {seen[column[k]]}", line=table.at[k])
        seen[column[k]] = table.at[k]
    return tuple(seen)


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    if not isinstance(instance, RobotTasks):
        raise UsageError(f"{getattr(instance, 'name', 'this')} holds no robots and tasks, so it cannot be written as robot-tasks; use json")
    if instance.metric == METRICS[-1] or instance.positions is None:
        raise UsageError(f"{instance.name} cannot be written as robot-tasks, which has no place for a matrix of distances; use json")
    settings = [("name", instance.name), ("problem", instance.problem), ("metric", instance.metric)]
    weights = np.asarray(instance.weights)
    rows = [
        [
            "robot" if k < instance.num_robots else "task",
            instance.robot_name(k) if k < instance.num_robots else instance.task_name(k - instance.num_robots),
            *(plain(v) for v in place),
            *(["" if k < instance.num_robots else plain(weights[k - instance.num_robots])] if weights.any() else []),
        ]
        for k, place in enumerate(instance.positions.tolist())
    ]
    return written(settings, COLUMNS[: 4 + int(weights.any())], rows)


FORMATS.add(
    "robot-tasks",
    Format(
        "robot-tasks", "robots and tasks with their places from CSV, one row each", recognises, read, write, (".csv",), "", PROBLEMS,
        "exact", sense="min", answer="paths or parts", solutions=(".json",), kinds=("robot-tasks",),
    ),
)  # fmt: skip
