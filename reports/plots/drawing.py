"""What plots share: axes, colours and captions."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from ...formulations.problem import Problem
from ...formulations.rendering import number, percent
from ...instances.printable import printable

if TYPE_CHECKING:
    from ...formulations.solution import Solution

COLOURS = ("#332288", "#DDAA33", "#117733", "#CC3377", "#33AADD", "#882255", "#44AA99", "#EE7733", "#777777")
"""Distinct for all common kinds of colour vision, after Tol (2021), "Colour schemes"; cycled with line styles."""


SHOWN_TEXT = 120
"""Characters of a line that are shown."""


def new_axes() -> Any:
    """Axes of pyplot in a notebook or where pyplot is in use, else without any display."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if shell is not None or "matplotlib.pyplot" in sys.modules:
        import matplotlib.pyplot as plt

        return plt.subplots(figsize=(8.0, 6.4), layout="constrained")[1]
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


def rounded(value: Any) -> str:
    """Three decimals: a caption is for reading."""
    if isinstance(value, list | tuple):
        return number([None if v is None else round(v, 3) for v in value])
    return number(round(value, 3))


def figures_of(problem: Problem, answer: Any, solution: Solution | None) -> str:
    """Objective, and from a solution bound and gap, for a caption."""
    if solution is None:
        return rounded(problem.evaluate(answer).objective)
    parts = [rounded(solution.objective)]
    if solution.bound is not None:
        parts.append(f"bound {rounded(solution.bound)} ({solution.bound_kind})")
    if solution.gap is not None:
        parts.append(f"gap {percent(solution.gap)}")
    return ", ".join(parts)


def entitle(ax: Any, head: str, detail: str) -> None:
    """A bold heading above the axes, and below it lines of detail."""
    ax.set_title(head + "\n" * (1 + detail.count("\n")), loc="left", fontsize=11, fontweight="bold", color="#222222")
    ax.text(0.0, 1.015, detail, transform=ax.transAxes, fontsize=9, color="#555555", va="bottom")
    literal(ax)


def literal(ax: Any) -> None:
    """Show every text as it is: names out of files are no formulas, though they may hold dollar signs, and leave room for the drawing."""
    from matplotlib.text import Text

    for text in ax.findobj(Text):
        text.set_parse_math(False)
        text.set_text("\n".join(printable(line, SHOWN_TEXT) for line in text.get_text().split("\n")))


def bare(ax: Any) -> None:
    """A map: equal scales, no ticks, no frame."""
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.06)
    ax.set_xticks([])
    ax.set_yticks([])
    for side in ax.spines.values():
        side.set_visible(False)
