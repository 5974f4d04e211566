"""Graphs of uncertain edge costs as edge lists in CSV: one row per edge; documented in ``docs/formats.md``."""

from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Table, check_kind, name_of, no_place, settings_of, table_of, titles_of, written
from ...text import plain, shown
from ..uncertain_graph import COLUMNS, PROBLEMS, UncertainGraph

KEYS = ("name", "start", "goal", "undirected")
FLAGS = {"true": True, "false": False}


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds the titles ``from``, ``to``, ``mean`` and ``variance``."""
    return set(COLUMNS[:4]) <= titles_of(text)


def read(text: str, path: Path) -> UncertainGraph:
    """The instance; see ``Format.read``."""
    settings, start = settings_of(text, KEYS, COLUMNS)
    for key in ("start", "goal"):
        if key not in settings:
            raise InputError(f"setting {key} is missing", "missing", line=1, expected=f"a line '# {key}: NAME' above the table")
    line, undirected = settings.get("undirected", (0, "false"))
    if undirected.lower() not in FLAGS:
        raise InputError("undirected must be true or false", line=line, found=shown(undirected))
    table = table_of(text, start, COLUMNS, "edges")
    table.columns(COLUMNS[:4], start + 1, COLUMNS[:4])
    tails, heads = (_names(table, title) for title in COLUMNS[:2])
    _refuse_pairs(tails, heads, table.at, FLAGS[undirected.lower()])
    costs = {title: table.numbers(title) for title in COLUMNS[2:] if title in table.titles}
    for title, values in costs.items():
        if (values < 0).any():
            k = int(np.argmax(values < 0))
            raise InputError(
                f"{title} is negative", "out-of-range", line=table.at[k], expected="0 or more", found=(table.column(title) or [])[k]
            )
    return UncertainGraph.from_names(
        tails, heads, costs, settings["start"][1], settings["goal"][1], undirected=FLAGS[undirected.lower()],
        name=name_of(settings, path), format="uncertain-edges",
    )  # fmt: skip


def _names(table: Table, title: str) -> list[str]:
    cells = table.column(title) or []
    for cell, line in zip(cells, table.at, strict=True):
        if not cell or not cell.isprintable():
            raise InputError(f"{title} must name a vertex", line=line, expected="a printable name", found=ascii(cell)[:40])
    return cells


def _refuse_pairs(tails: list[str], heads: list[str], lines: list[int], undirected: bool) -> None:
    """Raise InputError for the first edge that leads nowhere or stands twice, with its line."""
    seen: dict[tuple[str, str], int] = {}
    for tail, head, line in zip(tails, heads, lines, strict=True):
        if tail == head:
            raise InputError("an edge leads from a vertex to itself", "contradiction", line=line, found=shown(tail))
        pair = (min(tail, head), max(tail, head)) if undirected else (tail, head)
        if pair in seen:
            raise InputError(
                f"the edge stands twice, first in line {seen[pair]}", "duplicate", line=line, found=f"{shown(tail)} to {shown(head)}"
            )
        seen[pair] = line


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    check_kind(instance, UncertainGraph, "uncertain costs", "uncertain-edges")
    both = instance.undirected
    if instance.positions is not None or (instance.variable is not None and not both):
        raise no_place(instance, "uncertain-edges", "positions" if instance.positions is not None else "costs that edges share")
    settings = [("name", instance.name), ("start", instance.vertex_name(instance.start)), ("goal", instance.vertex_name(instance.goal))]
    kept = np.nonzero(instance.tails < instance.heads)[0] if both else np.arange(instance.num_edges)
    settings += [("undirected", "true")] if both else []
    columns = [[instance.vertex_name(v) for v in ends[kept].tolist()] for ends in (instance.tails, instance.heads)]
    for title in COLUMNS[2:]:
        values = getattr(instance, title)
        if values is not None:
            columns.append([plain(value) for value in values[kept].tolist()])
    return written(settings, COLUMNS[: len(columns)], zip(*columns, strict=True))


FORMATS.enter(
    Format(
        "uncertain-edges", "edges with mean and variance of their costs from CSV, one row each", recognises, read, write, (".csv",),
        PROBLEMS[0], PROBLEMS, answer="path", solutions=(".json",), kinds=("uncertain-graph",),
    )
)  # fmt: skip
