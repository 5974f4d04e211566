"""Maps of routes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....instances.errors import UsageError
from ....instances.routing.travel import EXPLICIT
from ....instances.suggestions import did_you_mean
from .. import PLOTS
from ..drawing import COLOURS, entitle, figures_of, literal, new_axes
from .maps import MOST_ARROWS, arrows, geographic, legend_of_routes, map_axes, route_ranks, scale_bar, site_positions

if TYPE_CHECKING:
    from ....formulations.solution import Solution

Floats = NDArray[np.float64]

LINE_STYLES = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), (0, (6, 1.5, 1.5, 1.5)))

FEW_ROUTES = 12
"""Of more routes the legs from and to the depot are fainter."""

LABELLED_SITES = 30
"""Up to this many sites are labelled by their ids."""

CONVENTIONS = {
    "file": "distances rounded as the file prescribes", "exact": "distances not rounded", "trunc1": "distances truncated to 1 decimal",
    "trunc2": "distances truncated to 2 decimals", "round": "distances rounded to whole numbers", "ceil": "distances rounded up",
}  # fmt: skip
"""In words."""


def plot_routes(
    problem: RoutingProblem,
    answer: Routes,
    *,
    ax: Any = None,
    solution: Solution | None = None,
    title: str | None = None,
    labels: str = "",
) -> Any:
    """Map of an answer: depots as squares, customers as dots, one colour and line style a route, arrows that say which way it goes.

    Parameters
    ----------
    problem : RoutingProblem
    answer : Routes
    ax : matplotlib axes, optional
        New ones by default: of pyplot in a notebook or where pyplot is in use, else without any display.
    solution : Solution, optional
        For objective, bound and gap in the title.
    title : str, optional
        Instead of the one made.
    labels : str
        A column of the sites that is only kept: what it holds is written below their ids, on maps of few sites.

    Returns
    -------
    matplotlib.axes.Axes

    Notes
    -----
    Sites without coordinates are placed by classical scaling of their distances (Torgerson 1952, "Multidimensional
    scaling: I. Theory and method", Psychometrika 17); the title says so.
    """
    where, placed = site_positions(problem)
    ax, names = new_axes() if ax is None else ax, problem.vehicle_names(answer)
    ranks = route_ranks(problem, answer, where)
    for k in np.argsort(ranks).tolist():
        _draw_route(ax, problem, answer, where, ranks[k], k, names[k])
    _draw_sites(ax, problem, answer, where, labels)
    globe = geographic(problem)
    map_axes(ax, where, globe)
    if not placed:
        scale_bar(ax, where, globe)
    entitle(ax, *(_title(problem, answer, solution, placed) if title is None else (title, "")))
    if len(answer) > 1:
        handles, names = ax.get_legend_handles_labels()
        order = np.argsort([int(h.get_gid() or 0) for h in handles], kind="stable")
        legend_of_routes(ax, [handles[k] for k in order], [names[k] for k in order])
    literal(ax)
    return ax


def _draw_route(ax: Any, problem: RoutingProblem, answer: Routes, where: Floats, rank: int, number_of: int, name: str) -> None:
    """One route; ``rank`` chooses its colour. On crowded maps lines are thin, and solid, because dashes would not be told apart."""
    route, count = answer.routes[number_of], len(answer)
    vehicle = problem.fleet[route.vehicle]
    colour = COLOURS[rank % len(COLOURS)]
    style = LINE_STYLES[rank // len(COLOURS)] if count <= len(COLOURS) * len(LINE_STYLES) else "-"
    width = float(np.clip(2.1 - count / 40.0, 0.9, 1.9))
    visits = list(route.visits)
    inner, out, back = where[visits], where[[vehicle.start, visits[0]]], where[[visits[-1], vehicle.end]]
    # The legs from and to the depot are faint: near a depot they all meet.
    faint = 1.0 if count == 1 else 0.45 if count <= FEW_ROUTES else 0.2
    for leg in (out, back):
        ax.plot(
            leg[:, 0], leg[:, 1], color=colour, linestyle=style, linewidth=width if count == 1 else 0.55 * width, alpha=faint, zorder=1,
            solid_capstyle="round",
        )  # fmt: skip
    ax.plot(
        inner[:, 0], inner[:, 1], color=colour, linestyle=style, linewidth=width, zorder=2, gid=str(number_of),
        label=f"{name}: {len(route)} visits" if count <= FEW_ROUTES else f"{name} ({len(route)})", solid_capstyle="round",
        solid_joinstyle="round",
    )  # fmt: skip
    crowded = count > FEW_ROUTES  # the legs from and to the depot are hardly seen then
    heads = 8 if count == 1 else min(1 if crowded else 3, MOST_ARROWS // count)
    if heads:
        arrows(ax, inner if crowded else where[[vehicle.start, *visits, vehicle.end]], colour, heads, 7.0 + 4.0 * width)
    ax.scatter(inner[:, 0], inner[:, 1], s=_dot_sizes(problem, visits), color=colour, edgecolors="white", linewidths=0.35 * width, zorder=3)


def _dot_sizes(problem: RoutingProblem, visits: list[int]) -> Any:
    """Areas of the dots: larger for larger demands, smaller on crowded maps."""
    base = float(np.clip(3600.0 / max(len(problem.sites), 1), 9.0, 46.0))
    largest = float(problem.sites.demand.max(initial=0.0))
    return base if largest <= 0 else base * (0.55 + 0.9 * problem.sites.demand[visits] / largest)


def _draw_sites(ax: Any, problem: RoutingProblem, answer: Routes, where: Floats, labels: str) -> None:
    depots = where[problem.sites.depots]
    ax.scatter(depots[:, 0], depots[:, 1], marker="s", s=85, color="#111111", edgecolors="white", linewidths=1.2, zorder=5)
    if left := _left_out(problem, answer):
        ax.scatter(where[left, 0], where[left, 1], s=26, facecolors="white", edgecolors="#888888", linewidths=1.0, zorder=3)
    if len(problem.sites) <= LABELLED_SITES:
        _label_sites(ax, problem, where, labels)


def _left_out(problem: RoutingProblem, answer: Routes) -> list[int]:
    visited = {i for route in answer for i in route.visits}
    return [int(i) for i in problem.customers if int(i) not in visited]


def _label_sites(ax: Any, problem: RoutingProblem, where: Floats, labels: str) -> None:
    """Ids beside the sites, and what is kept of them, without those that would be written over others."""
    kept = problem.sites.attributes
    if labels and labels not in kept:
        known = f"; choose from {', '.join(kept)}{did_you_mean(labels, kept)}" if kept else ": the sites have no columns that are only kept"
        raise UsageError(f"labels name the column {labels!r}, which is not kept{known}")
    told = [f"\n{value}" if value is not None else "" for value in kept[labels]] if labels else [""] * len(problem.sites)
    extent = float(np.ptp(where, axis=0).max()) or 1.0
    written: list[Floats] = []
    for k, site in enumerate(problem.sites.ids):
        # A label is wider than high.
        if all(abs(where[k] - other) @ np.array([1.0, 1.6]) > 0.045 * extent for other in written):
            ax.annotate(site + told[k], where[k], xytext=(5, 4), textcoords="offset points", fontsize=7.5, color="#444444", zorder=6)
            written.append(where[k])


def _title(problem: RoutingProblem, answer: Routes, solution: Solution | None, placed: bool) -> tuple[str, str]:
    head = f"{problem.name}: {len(answer)} {'route' if len(answer) == 1 else 'routes'}"
    if solution is not None:
        head += f" by {solution.solver}"
    rounded = CONVENTIONS.get(problem.convention, problem.convention)
    if problem.convention == "file" and problem.travel.metric == EXPLICIT:
        rounded = "distances as given"
    detail = f"{problem.objective} {figures_of(problem, answer, solution)}; {rounded}"
    if left := len(_left_out(problem, answer)):
        detail += f"\n{left} {'site' if left == 1 else 'sites'} left out (hollow)"
    if placed:
        detail += "\nno coordinates in the file: sites placed by scaling of their distances"
    return head, detail


PLOTS.add("routing", plot_routes)
