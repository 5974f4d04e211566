"""Pictures of answers. One module a family; it registers its plot in ``PLOTS``."""

from __future__ import annotations

import io
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from ... import _guard as _guard
from ...instances.errors import UsageError
from ...instances.registry import Registry

if TYPE_CHECKING:
    from ...formulations.problem import Problem
    from ...formulations.solution import Solution

SUFFIXES = (".png", ".svg", ".pdf")
"""Kinds of files that a picture is written to."""


class Plot(Protocol):
    """Draws an answer on ``ax``, new axes by default, and returns the axes.

    ``solution`` gives objective, bound and gap for the caption; ``title`` stands instead of the one made. A plot may take further keywords.
    """

    def __call__(self, problem: Any, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None) -> Any: ...


PLOTS: Registry[Plot] = Registry("plot", "waybound.reports.plots")
"""By family of problems."""


def check_drawable(problem: Problem) -> None:
    """Raise UsageError if no plot is registered for the problem's family."""
    if problem.family not in PLOTS:
        raise UsageError(f"answers to {problem.problem} problems cannot be drawn")


def plot_solution(solution: Solution, **options: Any) -> Any:
    """Draw the answer of ``solution``; ``solution.plot`` calls this.

    Parameters
    ----------
    solution : Solution
        With an answer.
    **options
        Of the family's plot: ``ax``, ``title``, ...

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    UsageError
        If answers of this family cannot be drawn.
    """
    check_drawable(solution.problem)
    return PLOTS[solution.problem.family](solution.problem, solution.answer, **{"solution": solution, **options})


def save_plot(solution: Solution, path: str | PathLike[str]) -> None:
    """Draw ``solution`` into a PNG, SVG or PDF file, whole or not at all; needs no display.

    Raises
    ------
    UsageError
        If the suffix is another, or answers of this family cannot be drawn.
    """
    from matplotlib import rc_context

    from ...instances.atomic import atomic_write
    from .drawing import axes_without_display

    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise UsageError(f"{path}: a plot is written as .png, .svg or .pdf")
    drawn = plot_solution(solution, ax=axes_without_display())
    buffer = io.BytesIO()
    # No dates and no random ids: the same answer gives the same file.
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(suffix, {})
    with rc_context({"svg.hashsalt": "waybound"}):
        drawn.figure.savefig(buffer, format=suffix[1:], dpi=160, metadata=dates)
    atomic_write(path, buffer.getvalue())
