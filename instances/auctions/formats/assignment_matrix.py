"""Costs of assignments as a matrix in CSV: one row per robot, one column per bin; documented in ``docs/formats.md``."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import CORNER, check_kind, delimiter_of, name_of, no_place, rows_of, settings_of, written
from ...text import number, plain, shown
from ..assignment import PROBLEMS, AssignmentInstance

FORBIDDEN = ("", "-", "inf")
KEYS = ("name",)
TITLES = f"{CORNER} and the names of the bins as titles, then rows of a robot's name and its costs"

_FEW = 50
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", re.I)


def recognises(text: str) -> bool:
    """True if the first line that is no comment begins with ``robot/bin``."""
    for line in text.split("\n"):
        if line.strip() and not line.lstrip().startswith("#"):
            return line.split(delimiter_of(line))[0].strip().strip('"').lower() == CORNER
    return False


def lacks(text: str) -> str | None:
    """The titles that a matrix lacks: a table with numbers in all cells but those of the first row and the first column."""
    lines = [line for line in text.split("\n")[:_FEW] if line.strip() and not line.lstrip().startswith("#")]
    rows = [[cell.strip().strip('"') for cell in line.split(delimiter_of(lines[0]))] for line in lines]
    if len(rows) < 2 or len(rows[0]) < 2 or any(len(row) != len(rows[0]) for row in rows):
        return None
    return TITLES if all(cell.lower() in FORBIDDEN or _NUMBER.fullmatch(cell) for row in rows[1:] for cell in row[1:]) else None


def read(text: str, path: Path) -> AssignmentInstance:
    """The instance; see ``Format.read``. An empty cell, ``-`` and ``inf`` forbid a pair."""
    settings, start = settings_of(text, KEYS, (CORNER,))
    titles: list[str] = []
    robots, costs = [], []
    for line, cells in rows_of(text, start):
        if not titles:
            titles = cells
            if titles[0].lower() != CORNER:
                raise InputError("is a matrix without its corner", line=line, expected=TITLES, found=shown(titles[0]))
            if len(titles) < 2:
                raise InputError("there are no bins", "missing", line=line, expected=f"{CORNER} and one title a bin")
            continue
        if len(cells) != len(titles):
            raise InputError(
                "row has a wrong length", "wrong-shape", line=line, expected=f"{len(titles)} values", found=f"{len(cells)} values"
            )
        robots.append(cells[0])
        costs.append([math.inf if c.lower() in FORBIDDEN else number(c, line, "cost") for c in cells[1:]])
    if not robots:
        raise InputError(
            "holds no robots", "missing", line=start + 1, expected="at least one row below the titles", found="the end of the file"
        )
    return AssignmentInstance.from_matrix(
        np.array(costs), robot_names=tuple(robots), bin_names=tuple(titles[1:]), name=name_of(settings, path), format="assignment-matrix"
    )


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    check_kind(instance, AssignmentInstance, "costs of robots and bins", "assignment-matrix")
    positions = (instance.robot_positions, instance.bin_positions)
    for what, values in (("times of being filled", instance.filled), *(("positions", places) for places in positions)):
        if values is not None:
            raise no_place(instance, "assignment-matrix", what)
    rows = (
        [instance.robot_name(i), *("-" if math.isinf(c) else plain(c) for c in costs)] for i, costs in enumerate(instance.matrix().tolist())
    )
    return written([("name", instance.name)], (CORNER, *(instance.bin_name(j) for j in range(instance.num_bins))), rows)


FORMATS.enter(
    Format(
        "assignment-matrix", "costs from CSV, one row a robot and one column a bin", recognises, read, write, (), PROBLEMS[0], PROBLEMS,
        answer="assignment", solutions=(".json", ".csv"), kinds=("assignment",), lacks=lacks,
    )
)  # fmt: skip
