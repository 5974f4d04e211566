"""Costs of assignments as a matrix in CSV: one row a robot, one column a bin; documented in ``docs/formats.md``."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...formats.table import delimiter_of, settings_of, written
from ...text import label, number, plain
from ..assignment import PROBLEMS, AssignmentInstance

CORNER = "robot/bin"
FORBIDDEN = ("", "-", "inf")
KEYS = ("name",)


def recognises(text: str) -> bool:
    """Whether the first line that is no comment begins with ``robot/bin``."""
    for line in text.split("\n"):
        if line.strip() and not line.lstrip().startswith("#"):
            return line.split(delimiter_of(line))[0].strip().strip('"').lower() == CORNER
    return False


def read(text: str, path: Path) -> AssignmentInstance:
    """The instance; see ``Format.read``. An empty cell, ``-`` and ``inf`` forbid a pair."""
    settings, start = settings_of(text, KEYS, (CORNER,))
    lines = text.split("\n")[start:]
    reader = csv.reader(io.StringIO("\n".join(lines)), delimiter=delimiter_of(lines[0]), strict=True)
    titles: list[str] = []
    robots, costs = [], []
    try:
        for row in reader:
            cells, line = [cell.strip() for cell in row], start + reader.line_num
            if not any(cells):
                continue
            if not titles:
                titles = cells
                if len(titles) < 2:
                    raise InputError("there are no bins", line=line, expected=f"{CORNER} and one title a bin")
                continue
            if len(cells) != len(titles):
                raise InputError("row has a wrong length", line=line, expected=f"{len(titles)} values", found=f"{len(cells)} values")
            robots.append(cells[0])
            costs.append([math.inf if c.lower() in FORBIDDEN else number(c, line, "cost") for c in cells[1:]])
    except csv.Error as error:
        raise InputError(f"is no CSV: {error}", line=start + reader.line_num) from None
    if not robots:
        raise InputError("holds no robots", line=start + 1, expected="at least one row below the titles", found="the end of the file")
    return AssignmentInstance.from_matrix(
        np.array(costs), robot_names=tuple(robots), bin_names=tuple(titles[1:]),
        name=label(settings["name"][1] if "name" in settings else path.stem), format="assignment-matrix",
    )  # fmt: skip


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    if not isinstance(instance, AssignmentInstance):
        raise UsageError(
            f"{getattr(instance, 'name', 'this')} has no costs of robots and bins and cannot be written as assignment-matrix; use json"
        )
    for what, held in (
        ("times of being filled", instance.filled),
        ("positions", instance.robot_positions),
        ("positions", instance.bin_positions),
    ):
        if held is not None:
            raise UsageError(f"{instance.name} cannot be written as assignment-matrix, which has no place for {what}; use json")
    rows = (
        [instance.robot_name(i), *("-" if math.isinf(c) else plain(c) for c in costs)] for i, costs in enumerate(instance.matrix().tolist())
    )
    return written([("name", instance.name)], (CORNER, *(instance.bin_name(j) for j in range(instance.num_bins))), rows)


FORMATS.add(
    "assignment-matrix",
    Format(
        "assignment-matrix", "costs from CSV, one row a robot and one column a bin", recognises, read, write, (),
        PROBLEMS[0], PROBLEMS, "exact", sense="min", answer="assignment", solutions=(".json", ".csv"), kinds=("assignment",),
    ),
)  # fmt: skip
