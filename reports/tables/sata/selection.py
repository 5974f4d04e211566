"""What selection problems hold."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..facts import plain_text
from ..table import Row
from .sensing import graph_rows


def _function(f: dict[str, Any]) -> list[Row]:
    text = "{kind} of {items} items by {elements} elements, {entries} entries" if "items" in f else "{kind}, of {elements} elements"
    return [("function", text.format(**{**f, "kind": "the user's own" if f["kind"] == "user" else f["kind"]}))]


def _constraint(c: dict[str, Any]) -> list[Row]:
    words = {
        "cardinality": "cardinality: at most {limit} elements",
        "knapsack": "knapsack: costs up to {budget:g} of {cost:g} in all",
        "partition": "partition matroid: at most {each} of each of {groups} groups, {rank} elements in all",
    }
    limits = c.get("limits")
    each = f"{limits[0]}" + (f" to {limits[-1]}" if len(limits) > 1 else "") if limits else "0"
    return [("constraint", words[c["kind"]].format(each=each, **c) if c["kind"] in words else plain_text(c))]


TABLES.add("selection", Tables({"graph": graph_rows, "function": _function, "constraint": _constraint}))
