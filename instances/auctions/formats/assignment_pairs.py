"""Costs of assignments as lists of pairs in CSV: one row a pair; documented in ``docs/formats.md``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...formats.table import settings_of, table_of, titles_of, written
from ...text import label, number, plain, shown
from ..assignment import PROBLEMS, AssignmentInstance

COLUMNS = ("robot", "bin", "cost")
KEYS = ("name",)


def recognises(text: str) -> bool:
    """Whether the first line that is no comment holds the titles ``robot``, ``bin`` and ``cost``."""
    return titles_of(text) == set(COLUMNS)


def read(text: str, path: Path) -> AssignmentInstance:
    """The instance; see ``Format.read``. Robots and bins are numbered as they first appear."""
    settings, start = settings_of(text, KEYS, COLUMNS)
    table = table_of(text, start, COLUMNS, "pairs")
    cells = {title: table.column(title) or [] for title in COLUMNS}
    seen: dict[tuple[str, str], int] = {}
    for robot, name, line in zip(cells["robot"], cells["bin"], table.at, strict=True):
        for what, given in (("robot", robot), ("bin", name)):
            if not given or not given.isprintable():
                raise InputError(f"{what} must have a name", line=line, expected="a printable name", found=ascii(given)[:40])
        if (robot, name) in seen:
            raise InputError(f"the pair stands twice, first in line {seen[robot, name]}", line=line, found=f"{shown(robot)}, {shown(name)}")
        seen[robot, name] = line
    costs = np.array([number(cell, at, "cost") for cell, at in zip(cells["cost"], table.at, strict=True)])
    names = [list(dict.fromkeys(cells[title])) for title in COLUMNS[:2]]
    numbers = [{name: k for k, name in enumerate(own)} for own in names]
    ends = [[own[cell] for cell in cells[title]] for own, title in zip(numbers, COLUMNS[:2], strict=True)]
    return AssignmentInstance.from_pairs(
        len(names[0]), len(names[1]), ends[0], ends[1], costs, robot_names=tuple(names[0]), bin_names=tuple(names[1]),
        name=label(settings["name"][1] if "name" in settings else path.stem), format="assignment-pairs",
    )  # fmt: skip


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    if not isinstance(instance, AssignmentInstance):
        raise UsageError(
            f"{getattr(instance, 'name', 'this')} has no costs of robots and bins and cannot be written as assignment-pairs; use json"
        )
    for what, held in (
        ("times of being filled", instance.filled),
        ("positions", instance.robot_positions),
        ("positions", instance.bin_positions),
    ):
        if held is not None:
            raise UsageError(f"{instance.name} cannot be written as assignment-pairs, which has no place for {what}; use json")
    used = np.bincount(instance.bins, minlength=instance.num_bins) > 0
    if not (np.diff(instance.indptr) > 0).all() or not used.all():
        raise UsageError(f"{instance.name} cannot be written as assignment-pairs: a robot or bin has no pair; use json")
    names = [instance.robot_name(k) for k in instance.robots.tolist()], [instance.bin_name(k) for k in instance.bins.tolist()]
    rows = zip(*names, map(plain, instance.cost.tolist()), strict=True)
    return written([("name", instance.name)], COLUMNS, rows)


FORMATS.add(
    "assignment-pairs",
    Format(
        "assignment-pairs", "robots, bins and costs of pairs from CSV, one row each", recognises, read, write, (".csv",),
        PROBLEMS[0], PROBLEMS, "exact", sense="min", answer="assignment", solutions=(".json", ".csv"), kinds=("assignment",),
    ),
)  # fmt: skip
