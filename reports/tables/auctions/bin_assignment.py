"""What costs of robots and bins hold."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _assignment(g: dict[str, Any]) -> list[Row]:
    forbidden = f", {g['forbidden']} forbidden" if g["forbidden"] else ", all of them"
    (few, many), (least, most) = g["bins_a_robot"], g["robots_a_bin"]
    whole = ", all whole" if g["whole_costs"] else ""
    rows = [
        ("robots", f"{g['robots']}, each for {few} to {many} bins"),
        ("bins", f"{g['bins']}, each for {least} to {most} robots"),
        ("pairs", f"{g['pairs']}{forbidden}"),
    ]
    if g["costs"]:
        rows.append(("costs", f"{g['costs'][0]:.6g} to {g['costs'][1]:.6g}{whole}"))
    if g["not_yet_full"]:
        rows.append(("waiting", f"{g['not_yet_full']} bins are not yet full"))
    return [*rows, ("positions", "of robots and bins" if g["positions"] else "none")]


TABLES.add("bin-assignment", Tables({"assignment": _assignment}))
