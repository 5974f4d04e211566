"""Pictures of answers. One module a family, in its wing's room; it registers its plot in ``PLOTS``."""

import io
from os import PathLike
from pathlib import Path
from typing import Any, Protocol

from ... import _guard as _guard
from ...formulations.problem import Problem
from ...formulations.solution import Solution
from ...instances.errors import UsageError
from ...instances.registry import Registry
from ...instances.suggestions import did_you_mean

SUFFIXES = (".png", ".svg", ".pdf")
"""Suffixes of files that a picture is written to."""


class Plot(Protocol):
    """Draws an answer on ``ax``, new axes by default, and returns the axes.

    ``solution`` gives objective, bound and gap for the caption; ``title`` replaces the default one. A plot may take further keywords.
    """

    def __call__(self, problem: Any, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None) -> Any: ...


PLOTS: Registry[Plot] = Registry("plot", "waybound.reports.plots.*", group="waybound.plots")
"""Plots by family of problems."""


HISTORY = "history"
"""The view of all families: objective and bound over time."""


def views(problem: Problem) -> list[str]:
    """Names of further views of an answer: those registered as ``family:view``, and its history."""
    return [*(name.partition(":")[2] for name in PLOTS if name.startswith(f"{problem.family}:")), HISTORY]


def check_drawable(problem: Problem, view: str | None = None) -> None:
    """Raise UsageError if no plot is registered for the problem's family, or no such view."""
    if view is not None and view not in views(problem):
        there = f"there are {', '.join(views(problem))}{did_you_mean(view, views(problem))}"
        raise UsageError(f"answers to {problem.problem} problems have no view {view!r}; {there}", "unknown-name")
    if view != HISTORY and problem.family not in PLOTS:
        raise UsageError(f"answers to {problem.problem} problems cannot be drawn", "unsupported")


def plot_solution(solution: Solution, *, view: str | None = None, **options: Any) -> Any:
    """Draw the answer of a solution; ``solution.plot`` calls this.

    ``view`` is another picture than the first: ``history``; ``schedule`` and ``loads`` of routes; ``risks`` and ``violations`` of risk
    allocations. Further options are those of the family's plot. Raises UsageError if answers of this family cannot be drawn, or have no
    such view.
    """
    check_drawable(solution.problem, view)
    if view == HISTORY:
        from .history import plot_history

        return plot_history(solution, **options)
    name = solution.problem.family + ("" if view is None else f":{view}")
    return PLOTS[name](solution.problem, solution.answer, **{"solution": solution, **options})


def save_plot(solution: Solution, path: str | PathLike[str], view: str | None = None) -> None:
    """Draw a solution into a PNG, SVG or PDF file, whole or not at all; needs no display. Raises UsageError for another suffix."""
    from .drawing import axes_without_display

    _suffix(path)
    save_axes(plot_solution(solution, ax=axes_without_display(), view=view), path)


def _suffix(path: str | PathLike[str]) -> str:
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise UsageError(f"{path}: a plot is written as .png, .svg or .pdf", "unsupported")
    return suffix


def save_axes(drawn: Any, path: str | PathLike[str]) -> None:
    """Write the figure of matplotlib axes into a PNG, SVG or PDF file, whole or not at all. Raises UsageError for another suffix."""
    from matplotlib import rc_context

    from ...instances.atomic import atomic_write

    suffix = _suffix(path)
    buffer = io.BytesIO()
    # No dates and no random ids: the same answer gives the same file.
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(suffix, {})
    with rc_context({"svg.hashsalt": "waybound"}):
        drawn.figure.savefig(buffer, format=suffix[1:], dpi=160, metadata=dates)
    atomic_write(path, buffer.getvalue())
