"""Tables of graphs of uncertain edge costs."""

from typing import Any

from .. import TABLES, Tables
from ..table import Row


def _graph(g: dict[str, Any]) -> list[Row]:
    shared = f", {g['shared_costs']} of them at the cost of another" if g["shared_costs"] else ""
    (fewest, most), (low, high), (least, largest) = g["out_degree"], g["means"], g["variances"]
    return [
        ("vertices", f"{g['vertices']}, each left by {fewest} to {most} edges"),
        ("edges", f"{g['edges']}{shared}: means {low:.6g} to {high:.6g}, variances {least:.6g} to {largest:.6g}"),
        ("from, to", f"{g['start']}, {g['goal']}"),
        ("positions", "of all vertices" if g["positions"] else "none"),
    ]


TABLES.add("uncertain-path", Tables({"graph": _graph}))
