"""What robots and tasks hold, whatever is asked of them."""

from __future__ import annotations

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _team(team: dict[str, Any]) -> list[Row]:
    (nearest, farthest), weights = team["distances"], team["weights"]
    return [
        ("robots", str(team["robots"])),
        ("tasks", f"{team['tasks']}, of weight {weights:.6g} together" if weights else str(team["tasks"])),
        ("distances", f"{team['metric']}, {nearest:.6g} to {farthest:.6g}"),
    ]


TABLES.add("task-allocation", Tables({"team": _team}))
TABLES.add("balanced-partition", Tables({"team": _team}))
