"""What is known of a day in the orchard."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _orchard(o: dict[str, Any]) -> list[Row]:
    away = f", {o['robots_away']} of them in the field" if o["robots_away"] else ""
    return [
        ("orchard", f"{o['rows']} lanes of {o['columns']} cells"),
        ("robots", f"{o['robots']}{away}"),
        ("bins", f"{o['bins']}, {o['bins'] - o['bins_standing']} of them to be brought; {o['work']} steps to fill all"),
    ]


TABLES.add("orchard-day", Tables({"orchard": _orchard}))
