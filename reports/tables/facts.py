"""Facts of a problem, as data and as a table."""

from typing import Any

from ...formulations.problem import Problem
from ...formulations.rendering import number
from . import TABLES
from .table import Column, Table

SHOWN_NAMES = 10
"""Names in a row of the table; the facts hold them all."""


def facts(problem: Problem) -> dict[str, Any]:
    """The facts of a problem as plain JSON values."""
    return {
        "name": problem.name,
        "problem": problem.problem,
        "family": problem.family,
        "senses": list(problem.senses),
        "convention": problem.convention,
        "instance_hash": problem.digest(),
        "features": sorted(problem.features()),
        "forms": problem.forms(),
        "notes": list(problem.remarks()),
        **problem.facts(),
    }


COMMON = ("name", "problem", "family", "senses", "convention", "instance_hash", "features", "forms", "notes", "objective")
"""Facts that ``facts_table`` shows of every problem; the others are the problem's own."""


def problem_table(problem: Problem) -> Table:
    """The facts of a problem, one a row."""
    return facts_table(facts(problem))


def facts_table(data: dict[str, Any]) -> Table:
    """The facts of a problem, one a row."""
    rows_of = TABLES[data["family"]].facts if data["family"] in TABLES else {}
    aim = f" {data['objective']}" if "objective" in data else ""
    rows = [("problem", f"{data['problem']}, {' then '.join(data['senses'])}{aim}"), ("convention", data["convention"])]
    for name, value in data.items():
        if name not in COMMON:
            rows += rows_of[name](value) if name in rows_of else [(name.replace("_", " "), plain_text(value))]
    rows += [("features", ", ".join(data["features"])), ("forms", ", ".join(data["forms"]) or "none"), ("hash", data["instance_hash"])]
    rows += [("note", note) for note in data["notes"]]
    return Table(data["name"], (Column(""), Column("", wide=True)), tuple(rows))


def plain_text(value: Any) -> str:
    """Any JSON value on one line: numbers short, long lists cut."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {plain_text(v)}" for key, v in value.items()) or "none"
    if isinstance(value, list | tuple):
        return some(list(map(plain_text, value))) if value else "none"
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "none"}[value]
    return number(value) if isinstance(value, int | float) else str(value)


def some(names: list[str]) -> str:
    """The first of many names."""
    return ", ".join(names[:SHOWN_NAMES]) + (", ..." if len(names) > SHOWN_NAMES else "")
