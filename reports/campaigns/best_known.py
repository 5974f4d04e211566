"""Best known values beside instances: ``bks.csv``, with the columns ``instance, value`` and perhaps ``convention, objective``."""

import csv
import math
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

from ...instances.errors import InputError
from ...instances.text import read_text
from .instance_list import Named

FILE = "bks.csv"
LEVELS_UP = 4
"""Folders that are looked in: that of the instance, and those above it."""

CONVENTIONS = {"tsplib": "file", "tsplib-nint": "file", "euclidean-double": "exact", "dimacs-trunc1": "trunc1", "dimacs": "trunc1"}
"""Other words for conventions of distance."""

Value = tuple[str | None, str | None, float]
"""Convention and sense, where the table says them, and the value."""


def best_known(instances: Iterable[Named], table: Path | None = None) -> dict[str, list[Value]]:
    """Best known values of instances from published tables, by the hash of the instance files.

    ``table`` holds for all; by default it is the nearest ``bks.csv`` in the folder of each instance and those above. Raises InputError for
    a table that cannot be read, or lacks a column.
    """
    found: dict[str, list[Value]] = {}
    for one in instances:
        place = table or _beside(one.path.resolve())
        if place is not None and (values := _read(place).get(one.name)):
            found[one.hash] = values
    return found


def value_for(values: list[Value], convention: str, sense: str) -> float | None:
    """The value that is meant for a problem; None where there is none, or the table has several."""
    fitting = {value for own, aims, value in values if own in (None, convention) and aims in (None, sense)}
    return fitting.pop() if len(fitting) == 1 else None


def _beside(path: Path) -> Path | None:
    return next((folder / FILE for folder in list(path.parents)[:LEVELS_UP] if (folder / FILE).is_file()), None)


@lru_cache(maxsize=8)
def _read(table: Path) -> dict[str, list[Value]]:
    lines = csv.DictReader(read_text(table).splitlines())
    for name in ("instance", "value"):
        if name not in (lines.fieldnames or ()):
            raise InputError(f"has no column {name!r}", "missing", file=table)
    values: dict[str, list[Value]] = {}
    for line in lines:
        objective, said = (line.get("objective") or "").lower(), line.get("convention") or ""
        if "-then-" in objective:  # of objectives in order of priority: one number says too little
            continue
        try:
            value = float(line["value"])
        except (TypeError, ValueError):
            raise InputError(f"{line['value']!r} is no number", file=table, line=lines.line_num) from None
        sense = "max" if "max" in objective else "min" if objective else None
        if math.isfinite(value):
            values.setdefault(line["instance"], []).append((CONVENTIONS.get(said, said) or None, sense, value))
    return values
