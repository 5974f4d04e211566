"""Loads of vehicles along their routes, beside their capacities."""

import math
from typing import Any

import numpy as np

from ....formulations.routing.judge import schedule
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.solution import Solution
from ....instances.errors import UsageError
from .. import PLOTS
from ..drawing import ALARM, COLOURS, chart_axes, legend_below, new_axes, roomy
from .routes import heading, route_ranks

LABELLED_ROUTES = 60
"""Number of routes above which the bars have no names."""


def plot_loads(
    problem: RoutingProblem, answer: Routes, *, ax: Any = None, solution: Solution | None = None, title: str | None = None,
    dimension: int = 1,
) -> Any:  # fmt: skip
    """The load on board of each route, leg by leg: a bar per route, from its start on the left to its end, as high as what it carries.

    ``dimension`` is that of the load, from 1, where there are several.
    """
    boards = [schedule(problem, route).on_board for route in answer]
    dimensions = 1 + problem.sites.further_demand.shape[1]
    if not 1 <= dimension <= dimensions:
        raise UsageError(f"dimension must be from 1 to {dimensions}, not {dimension}", "out-of-range")
    ax = new_axes() if ax is None else ax
    roomy(ax, width=1.0 + 0.14 * len(answer))
    capacities, ranks = [], route_ranks(problem, answer)
    for k, (route, board) in enumerate(zip(answer, boards, strict=True)):
        load, capacity = board[dimension - 1], _capacity(problem, route.vehicle, dimension)
        capacities.append(capacity)
        steps = k - 0.4 + 0.8 * np.arange(len(load) + 1) / len(load)
        over = load.max(initial=0.0) > capacity
        colour = ALARM if over else COLOURS[ranks[k] % len(COLOURS)]
        ax.stairs(load, steps, fill=True, color=colour, alpha=0.85, zorder=3)
        ax.plot([k - 0.4, k + 0.4], [0.0, 0.0], color=colour, linewidth=1.0, zorder=3)
        if math.isfinite(capacity):
            ax.plot(
                [k - 0.46, k + 0.46], [capacity, capacity], color="#222222", linewidth=1.4, zorder=4, label="capacity" if k == 0 else "_"
            )
            if len(boards) <= 24:
                used = float(load.max(initial=0.0)) / capacity if capacity > 0 else math.nan
                ax.annotate(f"{100 * used:.0f} %", (k, capacity), xytext=(0, 3), textcoords="offset points", ha="center", fontsize=7.5)
    names = problem.vehicle_names(answer)
    if len(names) <= LABELLED_ROUTES:
        ax.set_xticks(range(len(names)), names, fontsize=8, rotation=90 if len(names) > 10 else 0)
    else:
        ax.set_xticks([])
        ax.set_xlabel(f"{len(names)} routes", fontsize=9)
    ax.set_xlim(-0.7, len(names) - 0.3)
    ax.set_ylabel("load on board" + (f", dimension {dimension}" if dimensions > 1 else ""), fontsize=9)
    ax.set_ylim(
        0.0, 1.12 * max(1e-12, *(float(b[dimension - 1].max(initial=0.0)) for b in boards), *(c for c in capacities if c < math.inf))
    )
    if any(math.isfinite(c) for c in capacities):
        handles, labels = ax.get_legend_handles_labels()
        legend_below(ax, handles, labels, 1, 3.0 if len(names) <= 10 else 7.5 if len(names) <= LABELLED_ROUTES else 3.6)
    chart_axes(ax)
    heading(ax, problem, answer, solution, title, "loads", "; each bar from departure to return")
    return ax


def _capacity(problem: RoutingProblem, kind: int, dimension: int) -> float:
    capacities = problem.fleet[kind].capacities
    return float(capacities[dimension - 1]) if dimension <= len(capacities) else math.inf


PLOTS.add("routing:loads", plot_loads)
