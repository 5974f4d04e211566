"""What maps of rooms hold."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _rows(g: dict[str, Any]) -> list[Row]:
    return [
        ("rooms", f"{g['rooms']}, {g['doors']} doors, {g['heard_at_base']} rooms are heard at the base"),
        ("robots", f"{g['robots']}, {g['steps']} steps each, {g['silence']} of them in a row without contact"),
        ("first gains", f"exploring {g['exploring']:.6g}, mapping {g['mapping']:.6g}, searching {g['searching']:.6g}"),
    ]


TABLES.add("room-exploration", Tables({"exploration": _rows}))
