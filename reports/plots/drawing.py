"""Shared parts of plots: axes, colours, captions and bars."""

import functools
import io
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from ...formulations.problem import Problem
from ...formulations.rendering import number, percent
from ...formulations.solution import Solution
from ...instances.number_arrays import Floats as Floats
from ...instances.printable import printable
from . import PLOTS, Plot

COLOURS = ("#332288", "#DDAA33", "#117733", "#CC3377", "#33AADD", "#882255", "#44AA99", "#EE7733", "#777777")
"""Distinct for all common kinds of colour vision, after Tol (2021), "Colour schemes"; cycled with line styles."""

INK, QUIET, ALARM = "#222222", "#C9C9C9", "#B42318"

SHOWN_TEXT = 120
"""Characters of a line that are shown."""

LABELLED_BARS = 60
"""Bars up to which each is named."""


def new_axes() -> Any:
    """Axes of pyplot in a notebook or where pyplot is in use, else without any display."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    if shell is not None or "matplotlib.pyplot" in sys.modules:
        import matplotlib.pyplot as plt

        return plt.subplots(figsize=(8.0, 6.4), layout="constrained")[1]
    return axes_without_display()


def roomy(ax: Any, width: float = 0.0, height: float = 0.0) -> None:
    """Make a figure that holds these axes alone at least as large as said, in inches, up to three times its usual size."""
    figure = ax.figure
    if len(figure.axes) == 1:
        wide, high = figure.get_size_inches()
        figure.set_size_inches(max(wide, min(width, 24.0)), max(high, min(height, 19.2)))


def figure_without_display(width: float, height: float, layout: str | None = "constrained") -> Any:
    """A figure that pyplot does not know; sizes are in inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout=layout)  # type: ignore[arg-type]
    FigureCanvasAgg(figure)
    return figure


def axes_without_display() -> Any:
    """Axes of a figure that pyplot does not know."""
    return figure_without_display(8.0, 6.4).add_subplot()


def png_of(figure: Any, dpi: int) -> bytes:
    """A figure as a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi)
    return buffer.getvalue()


def rounded(value: Any) -> str:
    """A number, or several, with three decimals for a caption."""
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
    ax.annotate(
        detail, (0.0, 1.0), xycoords="axes fraction", xytext=(0, 6), textcoords="offset points", fontsize=9, color="#555555", va="bottom"
    )
    literal(ax)


def literal(ax: Any) -> None:
    """Show every text as it is, at most ``SHOWN_TEXT`` characters a line: names out of files may hold dollar signs, but are no formulas."""
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


def entitled(ax: Any, problem: Problem, answer: Any, solution: Solution | None, title: str | None, what: str) -> Any:
    """Put the problem's name and solver (or ``title``), its figures and a line about what is shown above the axes, and return them."""
    by = "" if solution is None else f" by {solution.solver}"
    head = f"{problem.name}: {problem.problem}{by}" if title is None else title
    entitle(ax, head, f"{problem.sense} {figures_of(problem, answer, solution)}\n{what}" if title is None else "")
    return ax


def as_plot(draw: Callable[[Any, Any, Any], str]) -> Plot:
    """A plot of a function ``draw(axes, problem, answer)`` that returns a line about what it drew; a heading is put above."""

    @functools.wraps(draw)
    def plot(problem: Any, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None) -> Any:
        axes = new_axes() if ax is None else ax
        return entitled(axes, problem, answer, solution, title, draw(axes, problem, answer))

    return plot


def plot_of(family: str) -> Callable[[Callable[[Any, Any, Any], str]], Plot]:
    """Register a function that ``as_plot`` takes as the plot of a family."""
    return lambda draw: PLOTS.add(family, as_plot(draw))


def bars(
    ax: Any, values: Floats, names: list[str], what: str, *, worst: float | None = None, colours: Any = COLOURS[0], ascending: bool = False,
    bound: tuple[float, str] | None = None,
) -> None:  # fmt: skip
    """One bar each, in the order of the instance while they can be named, else or if asked for from the least to the largest.

    ``worst`` is a line across all bars, ``bound`` another one, with the kind of the bound.
    """
    named = len(values) <= LABELLED_BARS
    order = np.arange(len(values)) if named and not ascending else np.argsort(values, kind="stable")
    if not isinstance(colours, str):
        colours = [colours[k] for k in order.tolist()]
    ax.bar(np.arange(len(values)), values[order], width=0.8 if named else 1.0, color=colours, zorder=2)
    close = (
        worst is not None
        and bound is not None
        and abs(worst - bound[0]) < 0.03 * max(float(np.abs(values).max(initial=0.0)), abs(bound[0]))
    )
    for level, text, colour, style in (
        (worst, "" if worst is None else f"{worst:.4g}", INK, "-"),
        *(((bound[0], f"bound {bound[0]:.4g}\n({bound[1]})", ALARM, (0, (5, 2))),) if bound is not None else ()),
    ):
        if level is not None:
            ax.axhline(level, color=colour, linewidth=1.2, linestyle=style, zorder=3)
            above = 0 if not close else (-9 if colour == INK else 9)
            ax.annotate(text, (1.0, level), xycoords=("axes fraction", "data"), xytext=(4, above), textcoords="offset points",
                        color=colour, fontsize=8.5, va="center")  # fmt: skip
    if named:
        ax.set_xticks(np.arange(len(values)), [names[k] for k in order.tolist()], fontsize=7.5, rotation=90 if len(values) > 20 else 0)
    else:
        ax.set_xticks([])
    remark = f", {len(values)} of them in ascending order" if not named else ", in ascending order" if ascending else ""
    ax.set_xlabel(f"{what}s{remark}", fontsize=9, color="#555555")
    margin = max(0.6, (8 - len(values)) / 2)  # few bars stay slender
    ax.set_xlim(-margin, len(values) - 1 + margin)
    chart_axes(ax)


def legend_below(ax: Any, handles: Any, labels: Any, columns: int, lines: float = 3.6) -> None:
    """A legend below the axes, ``lines`` of text below their lower edge."""
    ax.legend(
        handles, labels, loc="upper left", bbox_to_anchor=(0.0, 0.0), borderaxespad=lines, ncols=columns, frameon=False, fontsize=8.5,
        handlelength=2.4,
    )  # fmt: skip


def open_frame(ax: Any) -> None:
    """No frame above and to the right."""
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def chart_axes(ax: Any) -> None:
    """A chart: no frame above and to the right, quiet ticks."""
    open_frame(ax)
    ax.tick_params(labelsize=8, colors="#555555")
    ax.grid(axis="y", color="#EEEEEE", zorder=0)
    ax.set_axisbelow(True)


def plain(ax: Any, title: str) -> None:
    """A quiet panel with a small title on the left."""
    ax.set_title(title, loc="left", fontsize=10, color=INK)
    ax.tick_params(labelsize=8, colors="#555555")
    open_frame(ax)


def band(ax: Any, x: Any, mean: Any, half: Any, alpha: float = 0.25, **line: Any) -> None:
    """A line of means, and their intervals as a band."""
    ax.plot(x, mean, linewidth=1.6, **line)
    ax.fill_between(x, mean - half, mean + half, color=line["color"], alpha=alpha, linewidth=0)
