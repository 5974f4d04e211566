"""Costs of assignments as lists of pairs in CSV: one row a pair; documented in ``docs/formats.md``."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...formats.table import Table, settings_of, table_of, titles_of, written
from ...text import label, number, plain, shown
from ..assignment import PROBLEMS, AssignmentInstance

COLUMNS = ("robot", "bin", "cost")
FURTHER = {"filled": "bin", "robot-x": "robot", "robot-y": "robot", "bin-x": "bin", "bin-y": "bin"}
"""Columns that may be there, and of what they tell something: the same in every row of it."""

KEYS = ("name",)


def recognises(text: str) -> bool:
    """Whether the first line that is no comment holds the titles ``robot``, ``bin`` and ``cost``, and at most those of ``FURTHER``."""
    return set(COLUMNS) <= titles_of(text) <= {*COLUMNS, *FURTHER}


def read(text: str, path: Path) -> AssignmentInstance:
    """The instance; see ``Format.read``. Robots and bins are numbered as they first appear."""
    settings, start = settings_of(text, KEYS, COLUMNS)
    table = table_of(text, start, (*COLUMNS, *FURTHER), "pairs")
    for title in COLUMNS:
        if title not in table.titles:
            raise InputError(f"column {title} is missing", line=start + 1, expected=", ".join(COLUMNS), found=", ".join(table.titles))
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
        **_further(table, {"robot": cells["robot"], "bin": cells["bin"]}),
    )  # fmt: skip


def _further(table: Table, owners: dict[str, list[str]]) -> dict[str, NDArray[np.float64]]:
    """Times of being filled and positions, one a robot or bin."""
    found: dict[str, NDArray[np.float64]] = {}
    for title, what in FURTHER.items():
        told: dict[str, tuple[float, int]] = {}
        for name, cell, line in zip(owners[what], table.column(title) or [], table.at, strict=title in table.titles):
            value = math.inf if title == "filled" and cell.lower() == "inf" else number(cell, line, title)
            if told.setdefault(name, (value, line))[0] != value:
                raise InputError(
                    f"{title} of {what} {shown(name)} is another one than in line {told[name][1]}", line=line,
                    expected=plain(told[name][0]), found=shown(cell),
                )  # fmt: skip
        if told:
            found[title] = np.array([value for value, _ in told.values()])
    made = {"filled": found["filled"]} if "filled" in found else {}
    for what in ("robot", "bin"):
        x, y = found.get(f"{what}-x"), found.get(f"{what}-y")
        if (x is None) != (y is None):
            raise InputError(f"places of {what}s need both {what}-x and {what}-y", found=", ".join(table.titles))
        if x is not None and y is not None:
            made[f"{what}_positions"] = np.column_stack([x, y])
    return made


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    if not isinstance(instance, AssignmentInstance):
        raise UsageError(
            f"{getattr(instance, 'name', 'this')} has no costs of robots and bins and cannot be written as assignment-pairs; use json"
        )
    used = np.bincount(instance.bins, minlength=instance.num_bins) > 0
    if not (np.diff(instance.indptr) > 0).all() or not used.all():
        raise UsageError(f"{instance.name} cannot be written as assignment-pairs: a robot or bin has no pair; use json")
    names = [instance.robot_name(k) for k in instance.robots.tolist()], [instance.bin_name(k) for k in instance.bins.tolist()]
    columns = [*names, [plain(cost) for cost in instance.cost.tolist()]]
    titles = list(COLUMNS)
    held: dict[str, NDArray[np.float64] | None] = {"filled": instance.filled}
    for what in ("robot", "bin"):
        places = getattr(instance, f"{what}_positions")
        held |= {f"{what}-{axis}": None if places is None else places[:, k] for k, axis in enumerate("xy")}
    at: dict[str, NDArray[Any]] = {"robot": instance.robots, "bin": instance.bins}
    for title, values in held.items():
        if values is not None:
            titles.append(title)
            columns.append(["inf" if math.isinf(v) else plain(v) for v in values[at[FURTHER[title]]].tolist()])
    return written([("name", instance.name)], titles, zip(*columns, strict=True))


FORMATS.add(
    "assignment-pairs",
    Format(
        "assignment-pairs", "robots, bins and costs of pairs from CSV, one row each", recognises, read, write, (".csv",),
        PROBLEMS[0], PROBLEMS, "exact", sense="min", answer="assignment", solutions=(".json", ".csv"), kinds=("assignment",),
    ),
)  # fmt: skip
