"""Sensing graphs as edge lists in CSV: one row per edge, with robot, action, target and weight; documented in ``docs/formats.md``.

A row without a target declares an action that sees nothing, one with a robot alone a robot without actions, and one with a target
alone a target that nobody sees. Without a column ``weight`` every edge weighs 1.
"""

import math
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Table, check_kind, name_of, no_place, settings_of, table_of, titles_of, written
from ...number_arrays import Floats
from ...text import number, plain
from ..sensing_graph import PROBLEMS, SensingGraph, graph_of_edges
from ..sensing_rows import COLUMNS, ORDERS, Named, edges_of_rows, exact_rows

CHOICES = {"problem": PROBLEMS, "duplicates": ("error", "sum"), "order": ORDERS}
KEYS = ("name", *CHOICES)


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds the titles ``robot``, ``action`` and ``target``, and none of a table of sites."""
    titles = titles_of(text)
    return {"robot", "action", "target"} <= titles and "id" not in titles and not {"x", "y"} <= titles


def read(text: str, path: Path) -> SensingGraph:
    """The instance; see ``Format.read``."""
    settings, start = settings_of(text, KEYS, COLUMNS, CHOICES)
    table = table_of(text, start, COLUMNS, "edges")
    cells = table.columns(COLUMNS[:3], start + 1, COLUMNS)
    robot, action, target = (Named.of(column) for column in cells)
    for title, named in (("robot", robot), ("action", action), ("target", target)):
        for code, name in enumerate(named.labels):
            if not name.isprintable():
                line = table.at[int(np.argmax(named.codes == code))]
                raise InputError(f"{title} cannot be printed", line=line, expected="a name", found=ascii(name)[:40])
    usual = {"problem": PROBLEMS[0], "duplicates": "error", "order": ORDERS[0]}
    chosen = {key: settings[key][1] if key in settings else value for key, value in usual.items()}
    edges = edges_of_rows(
        robot, action, target, _weights(table, cells), lines=table.at, order=chosen["order"], duplicates=chosen["duplicates"],
        name=name_of(settings, path), format="edges", problem=chosen["problem"],
    )  # fmt: skip
    return graph_of_edges(**edges)


def _weights(table: Table, cells: list[list[str]]) -> Floats | None:
    column = table.column("weight")
    if column is None:
        return None
    for line, weight, *row in zip(table.at, column, *cells, strict=True):
        if all(row) and not weight:
            raise InputError("the weight of the edge is empty", "missing", line=line, expected="a number")
    return np.array([number(cell, line, "weight") if cell else math.nan for cell, line in zip(column, table.at, strict=True)])


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    check_kind(instance, SensingGraph, "sensing graph", "edges")
    if instance.action_positions is not None or instance.target_positions is not None:
        raise no_place(instance, "edges", "positions")
    if instance.problems != PROBLEMS:
        raise no_place(instance, "edges", "a choice of problems")
    rows = exact_rows(instance)
    settings = [("name", instance.name), ("problem", instance.problem)]
    if rows.order != ORDERS[0]:
        settings.append(("order", rows.order))
    columns = [
        ["" if code < 0 else name_of(code) for code in codes.tolist()]
        for codes, name_of in (
            (rows.robot, instance.robot_name), (rows.action, instance.action_labels.__getitem__), (rows.target, instance.target_name),
        )
    ]  # fmt: skip
    if (instance.weights != 1.0).any():
        columns.append(["" if math.isnan(w) else plain(w) for w in rows.weight.tolist()])
    return written(settings, COLUMNS[: len(columns)], zip(*columns, strict=True))


FORMATS.enter(
    Format(
        "edges", "edge list of a sensing graph from CSV, one row each", recognises, read, write, (".csv",), "", PROBLEMS, sense="max",
        answer="actions", solutions=(".json",), kinds=("sensing",),
    )
)  # fmt: skip
