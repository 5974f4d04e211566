"""Tables of solvers and heuristics."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from .table import Column, Table

if TYPE_CHECKING:
    from ...solving.listing import HeuristicInfo, SolverInfo


def solvers_table(infos: Sequence[SolverInfo], *, asked: bool) -> Table:
    """Solvers; with ``asked``, whether each takes the problem asked about."""
    rows = []
    for info in infos:
        if not info.installed:
            state = f"not installed: {info.install}"
        elif not asked:
            state = info.version
        else:
            state = f"lacks {', '.join(info.missing)}" if info.missing else f"takes it ({info.version})"
        rows.append((info.name, state, info.takes, info.summary))
    columns = (Column("solver"), Column("takes it" if asked else "version"), Column("kinds"), Column("summary", wide=True))
    return Table("Solvers", columns, tuple(rows))


def heuristics_table(infos: Sequence[HeuristicInfo], *, asked: bool) -> Table:
    """Heuristics with what they guarantee; with ``asked``, whether each takes the problem asked about."""
    columns = [Column("heuristic"), Column("guarantee"), Column("options"), Column("summary", wide=True)]
    rows = [[i.name, i.guarantee, ", ".join(i.parameters) or "-", i.summary] for i in infos]
    if asked:
        columns.insert(1, Column("takes it"))
        for row, info in zip(rows, infos, strict=True):
            row.insert(1, f"lacks {', '.join(info.missing)}" if info.missing else "takes it")
    return Table("Heuristics", tuple(columns), tuple(tuple(row) for row in rows))
