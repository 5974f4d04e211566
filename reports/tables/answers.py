"""Tables of answers."""

from typing import TYPE_CHECKING, Any

from ...formulations.problem import Problem
from . import TABLES
from .table import Column, Table, short

if TYPE_CHECKING:
    import pandas as pd

SHOWN_ROWS = 20
"""Rows of an answer that are shown; a solution file holds them all."""


def answer_tables(problem: Problem, answer: Any) -> list[Table]:
    """Tables of an answer, or where it is None of a problem without one."""
    tables = TABLES[problem.family].answer if problem.family in TABLES else None
    if tables is not None:
        return tables(problem, answer)
    return [] if answer is None else [frame_table(problem.answer_to_frame(answer))]


def frame_table(frame: "pd.DataFrame") -> Table:
    """The first rows of an answer's frame; missing values are empty."""
    numeric = [frame[title].dtype.kind in "iuf" for title in frame.columns]
    columns = tuple(Column(str(title), right=right) for title, right in zip(frame.columns, numeric, strict=True))
    first = frame.head(SHOWN_ROWS)
    rows = [
        tuple("" if lacks else short(float(v)) if right else str(v) for v, lacks, right in zip(row, lacking, numeric, strict=True))
        for row, lacking in zip(first.itertuples(index=False), first.isna().itertuples(index=False), strict=True)
    ]
    more = len(frame) - len(rows)
    if more > 0:
        rows.append((f"and {more} more", *[""] * (len(columns) - 1)))
    return Table("Answer", columns, tuple(rows))
