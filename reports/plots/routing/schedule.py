"""Schedules of routes: driving, waiting and service along the hours, with the windows that bind."""

import math
from typing import Any

import numpy as np

from ....formulations.routing.judge import Schedule, schedule
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Route, Routes
from ....formulations.solution import Solution
from .. import PLOTS
from ..drawing import ALARM, COLOURS, INK, legend_below, new_axes, roomy
from .routes import heading, route_ranks

LABELLED_ROWS = 60
"""Number of routes above which the rows have no names."""

LABELLED_VISITS = 220
"""Number of visits above which none has its id beside it."""


def plot_schedule(
    problem: RoutingProblem, answer: Routes, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """Gantt chart of an answer: a row per route, on the schedule that it is judged by.

    Driving is a thin line, service a bar in the colour of the route, waiting hatched; below, a line goes from each begin of service to the
    end of the site's window: the shorter, the less may be late. A visit that begins after its window is red. Time runs to the right, as
    moments where times are moments in the data, else in the units of the data.
    """
    ax = new_axes() if ax is None else ax
    roomy(ax, height=1.6 + 0.17 * len(answer))
    rows = [schedule(problem, route) for route in answer]
    ids, many = problem.sites.ids, sum(map(len, answer)) > LABELLED_VISITS
    ends = max((row.finish for row in rows), default=1.0)
    begins = min((row.departure for row in rows), default=0.0)
    span = max(ends - begins, 1e-12)
    ranks = route_ranks(problem, answer)
    for k, (route, row) in enumerate(zip(answer, rows, strict=True)):
        _draw_row(ax, problem, route, row, k, COLOURS[ranks[k] % len(COLOURS)], span, len(rows) > LABELLED_ROWS)
        last = -math.inf
        for i, site in enumerate(route.visits):
            at = (row.begin[i] + row.ends[i]) / 2.0
            if not many and at - last > 0.013 * span * max(len(ids[site]), 1):
                ax.text(at, k - 0.34, ids[site], ha="center", va="bottom", fontsize=6.5, color="#555555")
                last = at
    names = problem.vehicle_names(answer)
    if len(names) <= LABELLED_ROWS:
        ax.set_yticks(range(len(names)), names, fontsize=8)
    else:
        ax.set_yticks([])
        ax.set_ylabel(f"{len(names)} routes", fontsize=9)
    ax.set_ylim(len(names) - 0.4, -0.75)
    ax.set_xlim(begins - 0.02 * span, ends + 0.02 * span)
    _finish(ax)
    _time_axis(ax, problem, span)
    heading(ax, problem, answer, solution, title, "schedule")
    return ax


def _draw_row(ax: Any, problem: RoutingProblem, route: Route, row: Schedule, k: int, colour: str, span: float, crowded: bool) -> None:
    arrival, begin, leave = row.arrival, row.begin, row.ends
    visits = list(route.visits)
    starts, arrivals = row.leaves, np.append(arrival, row.finish)
    ax.hlines(np.full(len(starts), k), starts, arrivals, color=colour, linewidth=1.1, alpha=0.75, zorder=2)
    ax.plot([row.departure, row.finish], [k, k], "|", color=colour, markersize=9, zorder=3)
    waits = begin - arrival > 1e-9 * span
    if waits.any():
        ax.barh(
            np.full(int(waits.sum()), k), (begin - arrival)[waits], left=arrival[waits], height=0.3,
            facecolor="#F2F2F2" if crowded else "white",
            edgecolor="#AAAAAA", hatch="" if crowded else "////", linewidth=0.0 if crowded else 0.6, zorder=2,
        )  # fmt: skip
    due = problem.sites.due[visits]
    late = begin > due + 1e-9 * span
    shades = [ALARM if bad else colour for bad in late.tolist()]
    least = 0.002 * span  # a visit that takes no time is seen all the same
    ax.barh(
        np.full(len(visits), k), np.maximum(leave - begin, least), left=begin, height=0.42, color=shades, edgecolor="white", linewidth=0.4,
        zorder=4,
    )  # fmt: skip
    bound = np.nonzero(np.isfinite(due))[0]
    if len(bound) and not crowded:
        below = k + 0.27 + 0.07 * (bound % 3)
        ax.hlines(below, begin[bound], due[bound], color="#AAAAAA", linewidth=1.1, zorder=1)
        ax.plot(due[bound], below, "|", color="#555555", markersize=3.5, zorder=2)


def _finish(ax: Any) -> None:
    from matplotlib.patches import Patch

    handles = [
        ax.plot([], [], color=INK, linewidth=1.1)[0], Patch(facecolor=INK), Patch(facecolor="white", edgecolor="#AAAAAA", hatch="////"),
        ax.plot([], [], color="#AAAAAA", linewidth=1.1)[0],
    ]  # fmt: skip
    legend_below(ax, handles, ["driving", "service", "waiting", "from begin of service to the end of the window"], 4)
    for side in ("top", "right", "left"):
        ax.spines[side].set_visible(False)
    ax.tick_params(labelsize=8, colors="#555555", length=0)
    ax.grid(axis="x", color="#EEEEEE", zorder=0)
    ax.set_axisbelow(True)


STEPS = (1, 5, 15, 60, 300, 900, 1800, 3600, 7200, 14400, 28800, 86400, 604800)
"""Seconds from one mark of a clock to the next."""


def _time_axis(ax: Any, problem: RoutingProblem, span: float) -> None:
    """Marks at full hours and the like, as moments where the problem knows from when its times count."""
    from matplotlib.ticker import MultipleLocator

    clock, label = problem.clock, "time"
    if clock is not None:
        label = f"time ({clock.unit})"
        step = next((s for s in STEPS if span * clock.seconds <= 9 * s), None)
        if step is not None and clock.of_day:
            ax.xaxis.set_major_locator(MultipleLocator(step / clock.seconds))
            ax.xaxis.set_major_formatter(lambda at, _: str(clock.moments([at])[0]).removesuffix(":00"))
            label = "time of day"
        elif step is not None and (start := clock.midnight) is not None:
            shape = "%H:%M:%S" if step < 60 else "%H:%M" if span * clock.seconds <= 86400 else "%d %b %H:%M"
            ax.xaxis.set_major_locator(MultipleLocator(step / clock.seconds))
            ax.xaxis.set_major_formatter(lambda at, _: clock.moments([at])[0].strftime(shape))
            label = f"hours of {start:%Y-%m-%d}" if span * clock.seconds <= 86400 and not start.hour else "time"
    ax.set_xlabel(label, fontsize=9, color="#555555")


PLOTS.add("routing:schedule", plot_schedule)
