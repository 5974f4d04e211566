"""What joint assignments hold."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _rows(g: dict[str, Any]) -> list[Row]:
    late = f", {g['not_yet_full']} of them not yet full" if g["not_yet_full"] else ""
    return [
        ("robots", f"{g['robots']}, {g['bringing']} of them have something to bring"),
        ("bins", f"{g['bins']}{late}"),
        ("requests", str(g["requests"])),
    ]


TABLES.add("joint-assignment", Tables({"joint_assignment": _rows}))
