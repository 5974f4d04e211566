"""Progress of searches: the best known answer and bound over time."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from ...formulations.rendering import number
from ...formulations.solution import Solution
from ...instances.errors import UsageError
from ...instances.number_arrays import Floats
from .drawing import ALARM, COLOURS, chart_axes, entitle, figures_of, legend_below, literal, new_axes, rounded

if TYPE_CHECKING:
    from ...formulations.search_history import Event
    from ..comparison import Comparison

History: TypeAlias = "Solution | Comparison | Sequence[Solution] | Mapping[str, Solution]"

SPREAD, FAR = 3.0, 0.3
"""A final value is shown if it is no farther from the best than so many times the way to the bound, or such a share of the value; others
are named."""

LEAST_SECONDS = 1e-2
"""Start of a logarithmic axis of time."""


def plot_history(history: History, *, ax: Any = None, title: str | None = None, level: int = 1) -> Any:
    """Objective and bound over time: answers as full lines, bounds as dashed ones, and a mark where the checked answer ends a line.

    Parameters
    ----------
    history : Solution, Comparison, sequence of Solution, or mapping from names to them
        One run, or several in one picture.
    ax : matplotlib axes, optional
        New ones by default.
    title : str, optional
        Instead of the one made.
    level : int
        Of objectives in order of priority.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    UsageError
        If there is nothing to draw, or no such level.
    """
    named = _named(history)
    if not named:
        raise UsageError("there is no history to draw: no run brought a solution", "missing")
    first = next(iter(named.values()))
    if not 1 <= level <= len(first.problem.senses):
        raise UsageError(f"level must be from 1 to {len(first.problem.senses)}, not {level}", "out-of-range")
    ax = new_axes() if ax is None else ax
    ends = max(s.events[-1].seconds if s.events else 0.0 for s in named.values()) or 1.0
    for k, (name, solution) in enumerate(named.items()):
        _draw(ax, name, solution, level - 1, COLOURS[k % len(COLOURS)], ends, alone=len(named) == 1)
    best = None if isinstance(history, Solution | Sequence | Mapping) else history.bound
    if best is not None and level == 1 and len(named) > 1:
        ax.axhline(best, color="#222222", linewidth=1.0, linestyle=(0, (1, 2)), label=f"best verified bound {rounded(best)}", zorder=2)
    _frame(ax, named, level - 1, ends)
    handles, labels = ax.get_legend_handles_labels()
    legend_below(ax, handles, labels, 2 if len(handles) < 9 else 3, 4.2)
    chart_axes(ax)
    problem = first.problem
    ax.set_ylabel(
        str(problem.facts().get("objective", "objective")) if len(problem.senses) == 1 else f"level {level} of the objective", fontsize=9
    )
    head = title
    if title is None:
        head = f"{problem.name}: search by {first.solver}" if len(named) == 1 else f"{problem.name}: {len(named)} methods"
    if title is not None:
        detail = ""
    elif len(named) == 1 and first.answer is not None:
        detail = f"{problem.senses[level - 1]} {figures_of(problem, first.answer, first)}"
    else:
        detail = f"{problem.senses[level - 1]}; answers: full lines, bounds: dashed, ends of runs: dots"
    entitle(ax, str(head), detail)
    literal(ax)
    return ax


def _named(history: History) -> dict[str, Solution]:
    if isinstance(history, Solution):
        return {history.solver: history}
    if isinstance(history, Mapping):
        return dict(history)
    if not isinstance(history, Sequence):
        return {run.name: run.solution for run in history.runs if run.solution is not None}
    named: dict[str, Solution] = {}
    for solution in history:
        name, k = solution.solver, 2
        while name in named:
            name, k = f"{solution.solver} ({k})", k + 1
        named[name] = solution
    return named


def _steps(events: "Sequence[Event]", side: str, level: int) -> tuple[Floats, Floats]:
    """Seconds and values of one side, where anything is known."""
    pairs = [(e.seconds, getattr(e, side)) for e in events]
    known = [(t, v[level]) for t, v in pairs if v is not None and level < len(v) and v[level] is not None and math.isfinite(v[level])]
    return np.array([t for t, _ in known]), np.array([v for _, v in known], dtype=np.float64)


def _draw(ax: Any, name: str, solution: Solution, level: int, colour: str, ends: float, *, alone: bool) -> None:
    """Draw one run."""
    seconds, values = _steps(solution.events, "objective", level)
    when, bounds = _steps(solution.events, "bound", level)
    label = "answer" if alone else name
    end = solution.events[-1].seconds if solution.events else ends
    if len(values):
        ax.step(np.append(seconds, end), np.append(values, values[-1]), where="post", color=colour, linewidth=1.8, label=label, zorder=4)
        if solution.evaluation is not None:
            ax.plot(end, solution.evaluation.values[level], "o", color=colour, markersize=6, zorder=5, label="_checked")
            if alone:
                text = f"checked: {number(solution.evaluation.values[level])}"
                ax.annotate(text, (end, values[-1]), xytext=(-4, 7), fontsize=8.5, textcoords="offset points", ha="right", color=colour)
    else:
        ax.plot([], [], color=colour, linewidth=1.8, label=f"{label}: none")
    if len(bounds):
        shown = {"verified": "verified in the end", "claimed": "claimed, no evidence"}[solution.bound_kind or "claimed"]
        ax.step(np.append(when, end), np.append(bounds, bounds[-1]), where="post", color=ALARM if alone else colour, linewidth=1.3,
                linestyle=(0, (5, 2)) if solution.bound_kind == "verified" else (0, (1.5, 1.5)), zorder=3,
                label=f"bound, {shown}" if alone else "_bound")  # fmt: skip
        if alone and len(values):
            ax.fill_between([0.0, end], values[-1], bounds[-1], color="#999999", alpha=0.12, linewidth=0, label="what is open in the end")


def _frame(ax: Any, named: Mapping[str, Solution], level: int, ends: float) -> None:
    """Set the limits of the axes by late values, so that a bad first answer does not hide all that follows."""
    sense = next(iter(named.values())).problem.senses[level]
    ends_at = {name: _steps(s.events, "objective", level)[1][-1:].tolist() for name, s in named.items()}
    limits = [v for s in named.values() for v in _steps(s.events, "bound", level)[1][-1:].tolist()]
    finals = [v for values in ends_at.values() for v in values]
    if finals:
        best = min(finals) if sense == "min" else max(finals)
        floor = (max(limits) if sense == "min" else min(limits)) if limits else best
        far = max(SPREAD * abs(best - floor), FAR * abs(best), 1e-12)
        near = [v for v in [*finals, *limits] if abs(v - best) <= far]
        span = max(max(near) - min(near), 0.02 * max(abs(v) for v in near), 1e-12)
        every = [v for s in named.values() for side in ("objective", "bound") for v in _steps(s.events, side, level)[1].tolist()]
        low, high = max(min(every), min(near) - span), min(max(every), max(near) + span)
        margin = 0.06 * max(high - low, span)
        ax.set_ylim(low - margin, high + margin)
        beyond = [(k, name, values[0]) for k, (name, values) in enumerate(ends_at.items()) if values and not low <= values[0] <= high]
        for line, (k, name, value) in enumerate(beyond):
            above = value > high
            text = f"{name} ends {'above' if above else 'below'} the picture, at {rounded(value)}"
            at, colour = (0.99, 0.985 - 0.04 * line if above else 0.02 + 0.04 * line), COLOURS[k % len(COLOURS)]
            ax.annotate(text, at, xycoords="axes fraction", ha="right", va="top" if above else "bottom", fontsize=8.5, color=colour)
    times = [e.seconds for s in named.values() for e in s.events]
    if times and ends > 20.0 * max(min(times), LEAST_SECONDS):
        ax.set_xscale("log")
        ax.set_xlim(max(0.7 * min(times), LEAST_SECONDS), ends * 1.15)
        from matplotlib.ticker import FuncFormatter

        ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    else:
        ax.set_xlim(0.0, ends * 1.05)
    ax.set_xlabel("seconds since the call", fontsize=9, color="#555555")
