"""The table of a comparison: each method's answer, its verified bound, and on whose word it ended."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...formulations.rendering import Line, number, percent
from .table import Column, Table

if TYPE_CHECKING:
    from ..comparison import Compared, Comparison


def comparison_table(comparison: Comparison) -> Table:
    """One row per method; the gap is to the best verified bound of all."""
    rows = [
        (
            run.name,
            "-" if run.solution is None else number(run.solution.objective),
            number(_verified(run)),
            percent(comparison.gap(run)),
            "-" if run.seconds is None else f"{run.seconds:.2f}",
            run.status,
            run.remark,
        )
        for run in comparison.runs
    ]
    columns = (
        Column("method"), Column("objective", right=True), Column("verified bound", right=True), Column("gap", right=True),
        Column("seconds", right=True), Column("status"), Column("remark", wide=True),
    )  # fmt: skip
    problem = comparison.problem
    title = f"{problem.name}: {problem.problem}, {problem.sense}, convention {problem.convention}"
    return Table(title, columns, tuple(rows))


def _verified(run: Compared) -> float | list[float] | None:
    """Verified bounds from a run, level by level."""
    if run.solution is None or run.verified is None or not run.solution.certificate.levels:
        return run.verified
    return [run.verified, *(level.bound for level in run.solution.certificate.levels)]


def comparison_lines(comparison: Comparison) -> list[Line]:
    """The best answer, the best verified bound, and contradictions."""
    best, lines = comparison.best, [Line("fault", fault, "bad") for fault in comparison.faults]
    if best is not None:
        lines.append(
            Line("best answer", f"{number(best.objective)}, by {best.solver}; every answer in the table was checked from the data")
        )
    if comparison.infeasible:
        lines.append(Line("best bound", "there is no answer, verified", "bad"))
    elif comparison.bound is None:
        lines.append(Line("best bound", "none was verified, so that no gap is known", "quiet"))
    else:
        bounds = [comparison.bound] if best is None or best.evaluation is None else comparison.bounds(best.evaluation.values)
        text = f"{number(bounds)}, verified: {comparison.bound_source}; gaps are to this one"
        lines.append(Line("best bound", text, "good"))
    return lines
