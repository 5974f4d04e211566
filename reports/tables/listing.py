"""Tables of solvers and heuristics."""

from collections.abc import Sequence
from typing import TypeVar

from ...formulations.problem import Problem
from ...solving.listing import HeuristicInfo, SolverInfo, heuristic_table, solver_table
from .table import Column, Listing, Table

Info = TypeVar("Info", SolverInfo, HeuristicInfo)


def list_solvers(problem: Problem | None = None) -> Listing[SolverInfo]:
    """All solvers, installed or not; with a problem, also what each lacks for it. A list that shows itself as a table.

    Parameters
    ----------
    problem : Problem, optional
        Whom to ask about; without one, all that is known of solvers by themselves.

    Returns
    -------
    list of SolverInfo
        ``[info.name for info in wb.solvers(problem) if not info.missing]`` are those that can take it.
    """
    return Listing(solver_table(problem), lambda rows: solvers_table(rows, asked=problem is not None))


def list_heuristics(problem: Problem | None = None) -> Listing[HeuristicInfo]:
    """All heuristics with their stated guarantees; with a problem, also what each lacks for it. A list that shows itself as a table.

    Parameters
    ----------
    problem : Problem, optional
        As of ``solvers``.

    Returns
    -------
    list of HeuristicInfo
    """
    return Listing(heuristic_table(problem), lambda rows: heuristics_table(rows, asked=problem is not None))


def solvers_table(infos: Sequence[SolverInfo], *, asked: bool) -> Table:
    """Solvers; with ``asked``, whether each takes the problem asked about, those that do first."""
    rows = []
    for info in _able_first(infos) if asked else infos:
        if not info.installed:
            state = f"not installed: {info.install}"
        elif not asked:
            state = info.version
        else:
            state = f"does not handle {', '.join(info.missing)}" if info.missing else f"takes it ({info.version})"
        rows.append((info.name, state, info.takes, info.summary))
    columns = (Column("solver"), Column("takes it" if asked else "version"), Column("kinds"), Column("summary", wide=True))
    return Table("Solvers", columns, tuple(rows), most=_able(infos, asked), rest=UNABLE)


def heuristics_table(infos: Sequence[HeuristicInfo], *, asked: bool) -> Table:
    """Heuristics and their guarantees; with ``asked``, whether each takes the problem asked about, those that do first."""
    infos = _able_first(infos) if asked else infos
    columns = [Column("heuristic"), Column("guarantee"), Column("options"), Column("summary", wide=True)]
    rows = [[i.name, i.guarantee, ", ".join(i.parameters) or "-", i.summary] for i in infos]
    if asked:
        columns.insert(1, Column("takes it"))
        for row, info in zip(rows, infos, strict=True):
            row.insert(1, f"does not handle {', '.join(info.missing)}" if info.missing else "takes it")
    return Table("Heuristics", tuple(columns), tuple(tuple(row) for row in rows), most=_able(infos, asked), rest=UNABLE)


UNABLE = "that do not take it"


def _able_first(infos: Sequence[Info]) -> list[Info]:
    """Names of those that take a problem, would if installed, lack a feature, and are for other families."""

    def rank(info: Info) -> tuple[bool, bool, bool]:
        foreign = any(feature.endswith(" problems") for feature in info.missing)
        return bool(info.missing), foreign, isinstance(info, SolverInfo) and not info.installed

    return sorted(infos, key=rank)


def _able(infos: Sequence[Info], asked: bool) -> int | None:
    """How many take the problem asked about; None where all are to be shown: if nobody does, too."""
    able = sum(not info.missing for info in infos)
    return able if asked and 0 < able < len(infos) else None
