"""Costs of assignments as lists of pairs in CSV: one row per pair; documented in ``docs/formats.md``."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Table, check_kind, check_name, name_of, settings_of, table_of, titles_of, written
from ...number_arrays import Floats
from ...text import an, number, plain, shown
from ..assignment import PROBLEMS, AssignmentInstance
from ..assignment_frame import COLUMNS, FURTHER

KEYS = ("name",)


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds the titles ``robot``, ``bin`` and ``cost``, and at most those of ``FURTHER``."""
    return set(COLUMNS) <= titles_of(text) <= {*COLUMNS, *FURTHER}


def read(text: str, path: Path) -> AssignmentInstance:
    """The instance; see ``Format.read``. Robots and bins are numbered as they first appear, alone in a row where no pair names them."""
    settings, start = settings_of(text, KEYS, COLUMNS)
    table = table_of(text, start, (*COLUMNS, *FURTHER), "pairs")
    cells = dict(zip(COLUMNS, table.columns(COLUMNS, start + 1, COLUMNS), strict=True))
    seen: dict[tuple[str, str], int] = {}
    costs = []
    for robot, name, cost, line in zip(cells["robot"], cells["bin"], cells["cost"], table.at, strict=True):
        for what, own, other in (("robot", robot, name), ("bin", name, robot)):
            check_name(what, own, line, optional=bool(other) and not cost)
        if not robot or not name:
            continue  # a robot or a bin that has no pair, perhaps
        if (robot, name) in seen:
            raise InputError(
                f"the pair stands twice, first in line {seen[robot, name]}", "duplicate", line=line, found=f"{shown(robot)}, {shown(name)}"
            )
        seen[robot, name] = line
        costs.append(number(cost, line, "cost"))
    names = [[name for name in dict.fromkeys(cells[title]) if name] for title in COLUMNS[:2]]
    numbers = [{name: k for k, name in enumerate(own)} for own in names]
    ends = [[own[pair[k]] for pair in seen] for k, own in enumerate(numbers)]
    return AssignmentInstance.from_pairs(
        len(names[0]), len(names[1]), ends[0], ends[1], np.array(costs), robot_names=tuple(names[0]), bin_names=tuple(names[1]),
        name=name_of(settings, path), format="assignment-pairs", **_further(table, cells),
    )  # fmt: skip


def _further(table: Table, owners: dict[str, list[str]]) -> dict[str, Floats]:
    """Times of being filled and positions, one a robot or bin."""
    columns: dict[str, Floats] = {}
    for title, what in FURTHER.items():
        values: dict[str, tuple[float, int]] = {}
        for name, cell, line in zip(owners[what], table.column(title) or [], table.at, strict=title in table.titles):
            if not name:
                if cell:
                    raise InputError(
                        f"{title} stands in a row without {an(what)}", "contradiction", line=line, expected="an empty cell",
                        found=shown(cell),
                    )  # fmt: skip
                continue
            value = math.inf if title == "filled" and cell.lower() == "inf" else number(cell, line, title)
            first, at = values.setdefault(name, (value, line))
            if first != value:
                message = f"{title} of {what} {shown(name)} is another one than in line {at}"
                raise InputError(message, "contradiction", line=line, expected=plain(first), found=shown(cell))
        if values:
            columns[title] = np.array([value for value, _ in values.values()])
    further = {"filled": columns["filled"]} if "filled" in columns else {}
    for what in ("robot", "bin"):
        places = [columns[title] for title in (f"{what}-x", f"{what}-y") if title in columns]
        if len(places) == 1:
            raise InputError(f"places of {what}s need both {what}-x and {what}-y", "missing", found=", ".join(table.titles))
        if places:
            further[f"{what}_positions"] = np.column_stack(places)
    return further


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    check_kind(instance, AssignmentInstance, "costs of robots and bins", "assignment-pairs")
    further: dict[str, Floats | None] = {"filled": instance.filled}
    for what in ("robot", "bin"):
        places = getattr(instance, f"{what}_positions")
        further |= {f"{what}-{axis}": None if places is None else places[:, k] for k, axis in enumerate("xy")}
    columns = {title: values.tolist() for title, values in further.items() if values is not None}
    return written([("name", instance.name)], (*COLUMNS, *columns), (_cells(instance, columns, *row) for row in _rows(instance)))


def _rows(instance: AssignmentInstance) -> Iterator[tuple[int, int, float]]:
    """Robot, bin and cost of each row, -1 and NaN where it names one of them alone, such that each is first met in its place."""
    met = 0  # bins below it have been named
    bounds, bins, costs = instance.indptr.tolist(), instance.bins.tolist(), instance.cost.tolist()
    for robot in range(instance.num_robots):
        if bounds[robot] == bounds[robot + 1]:
            yield robot, -1, math.nan
        for k in range(bounds[robot], bounds[robot + 1]):
            for lone in range(met, bins[k]):
                yield -1, lone, math.nan
            met = max(met, bins[k] + 1)
            yield robot, bins[k], costs[k]
    for lone in range(met, instance.num_bins):
        yield -1, lone, math.nan


def _cells(instance: AssignmentInstance, held: Mapping[str, list[float]], robot: int, number: int, cost: float) -> list[str]:
    row = [instance.robot_name(robot) if robot >= 0 else "", instance.bin_name(number) if number >= 0 else ""]
    row.append("" if math.isnan(cost) else plain(cost))
    of = {"robot": robot, "bin": number}
    values = [(values, of[FURTHER[title]]) for title, values in held.items()]
    return [*row, *("" if k < 0 else "inf" if math.isinf(own[k]) else plain(own[k]) for own, k in values)]


FORMATS.enter(
    Format(
        "assignment-pairs", "robots, bins and costs of pairs from CSV, one row each", recognises, read, write, (".csv",), PROBLEMS[0],
        PROBLEMS, answer="assignment", solutions=(".json", ".csv"), kinds=("assignment",),
    )
)  # fmt: skip
