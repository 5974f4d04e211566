"""Blocks of an answer as far as its family has no others: its pictures and its table."""

from collections.abc import Sequence

from ...formulations.solution import Solution
from ..plots import HISTORY, PLOTS, plot_solution, views
from ..plots.drawing import axes_without_display
from .blocks import DataTable, Figure, Folded
from .rendering import Block

SHOWN_ROWS = 30
"""Rows of an answer above which they are folded."""


def default_blocks(solution: Solution) -> list[Block]:
    """The pictures of the family's plots, and the answer as a table."""
    problem = solution.problem
    blocks: list[Block] = [chart for _, chart in charts(solution, ["", *views(problem)])] if problem.family in PLOTS else []
    return [*blocks, answer_table(solution)]


def answer_table(solution: Solution) -> Block:
    """The answer as a table, folded away where it is long."""
    frame = solution.problem.answer_to_frame(solution.answer)
    table = DataTable(frame, title="Answer")
    return Folded(f"Answer ({len(frame)} rows)", [table]) if len(frame) > SHOWN_ROWS else table


def charts(solution: Solution, names: Sequence[str]) -> list[tuple[str, Figure]]:
    """Views of an answer with their titles; "" is the first one, and the history is left to the page."""
    blocks = []
    for name in names:
        if name != HISTORY:
            drawn = plot_solution(solution, view=name or None, ax=axes_without_display())
            title = name.replace("-", " ").capitalize() or "Picture"
            blocks.append((title, Figure(drawn, f"{title} of the answer")))
    return blocks
