"""What generalised assignments hold."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _rows(g: dict[str, Any]) -> list[Row]:
    def between(key: str) -> str:
        return f"{g[key][0]:.6g} to {g[key][1]:.6g}" if g[key] else "none"

    forbidden = f", {g['forbidden']} pairs forbidden" if g["forbidden"] else ""
    return [
        ("agents", f"{g['agents']}, capacities {between('capacity')}, {g['capacity_of_all']:.6g} together"),
        ("jobs", f"{g['jobs']}{forbidden}"),
        ("profits" if g["objective"] == "profit" else "costs", between("values")),
        ("consumption", between("consumption")),
    ]


TABLES.add("generalised-assignment", Tables({"generalised_assignment": _rows}))
