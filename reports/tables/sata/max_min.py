"""What max-min problems hold."""

from __future__ import annotations

from functools import partial
from typing import Any

from .. import TABLES, Tables
from ..table import Row
from .sensing import graph_rows


def _matrix(name: str, sizes: dict[str, Any]) -> list[Row]:
    return [(name, "{rows} rows, {entries} entries, at most {longest_row} in a row".format(**sizes))]


def _structure(one_packing_row: bool) -> list[Row]:
    return [("structure", "one packing row a variable" if one_packing_row else "some variables in several packing rows")]


TABLES.add(
    "max-min",
    Tables(
        {
            "graph": graph_rows, "packing": partial(_matrix, "packing"), "covering": partial(_matrix, "covering"),
            "one_packing_row": _structure,
        }
    ),
)  # fmt: skip
