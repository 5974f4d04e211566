"""Maps of routes: where sites lie, a scale bar, arrows along the way, and a legend for any number of routes."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ....formulations.rendering import number
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.solution import Solution
from ....instances.errors import UsageError
from ....instances.routing.travel import EXPLICIT
from ....instances.suggestions import did_you_mean
from .. import PLOTS
from ..drawing import COLOURS, Floats, bare, entitle, figures_of, literal, new_axes, roomy
from ..positions import SCALED_SITES, scaled_positions

LINE_STYLES = ("-", (0, (5, 1.5)), (0, (1.5, 1.2)), (0, (6, 1.5, 1.5, 1.5)))

FEW_ROUTES = 12
"""Number of routes above which the legs from and to the depot are fainter."""

LABELLED_SITES = 30
"""Number of sites up to which they are labelled by their ids."""

CONVENTIONS = {
    "file": "distances rounded as the file prescribes", "exact": "distances not rounded", "trunc1": "distances truncated to 1 decimal",
    "trunc2": "distances truncated to 2 decimals", "round": "distances rounded to whole numbers", "ceil": "distances rounded up",
}  # fmt: skip
"""Conventions of distances in words."""

KM_A_DEGREE = 6371.0088 * math.pi / 180.0
"""Length of a degree of latitude, on a sphere of the Earth's mean radius."""

LEGEND_COLUMN = 26
"""Routes in a column of a legend, and a half more where there are several columns."""

LEGEND_ENTRIES = 156
"""Number of routes above which the legend says how many more there are."""

MOST_ARROWS = 240
"""Most arrows on one map."""


def plot_routes(
    problem: RoutingProblem, answer: Routes, *, ax: Any = None, solution: Solution | None = None, title: str | None = None,
    labels: str = "",
) -> Any:  # fmt: skip
    """Map of an answer: depots as squares, customers as dots, one colour and line style a route, arrows that say which way it goes.

    ``labels`` is a column of the sites that is only kept: its values are written below their ids, on maps of few sites. Sites without
    coordinates are placed by classical scaling of their distances (Torgerson 1952, "Multidimensional scaling: I. Theory and method",
    Psychometrika 17); the title says so.
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
    if left_out := _left_out(problem, answer):
        ax.scatter(where[left_out, 0], where[left_out, 1], s=26, facecolors="white", edgecolors="#888888", linewidths=1.0, zorder=3)
    if len(problem.sites) <= LABELLED_SITES:
        _label_sites(ax, problem, where, labels)


def _left_out(problem: RoutingProblem, answer: Routes) -> list[int]:
    visited = {i for route in answer for i in route.visits}
    return [int(i) for i in problem.customers if int(i) not in visited]


def _label_sites(ax: Any, problem: RoutingProblem, where: Floats, labels: str) -> None:
    """Ids beside the sites, and below them what is kept of these, without those that would be written over others."""
    kept = problem.sites.attributes
    if labels and labels not in kept:
        known = f"; choose from {', '.join(kept)}{did_you_mean(labels, kept)}" if kept else ": the sites have no columns that are only kept"
        raise UsageError(f"labels name the column {labels!r}, which is not kept{known}", "unknown-name")
    below = [f"\n{value}" if value is not None else "" for value in kept[labels]] if labels else [""] * len(problem.sites)
    extent = float(np.ptp(where, axis=0).max()) or 1.0
    written: list[Floats] = []
    for k, site in enumerate(problem.sites.ids):
        # A label is wider than high.
        if all(abs(where[k] - other) @ np.array([1.0, 1.6]) > 0.045 * extent for other in written):
            ax.annotate(site + below[k], where[k], xytext=(5, 4), textcoords="offset points", fontsize=7.5, color="#444444", zorder=6)
            written.append(where[k])


def _title(problem: RoutingProblem, answer: Routes, solution: Solution | None, placed: bool) -> tuple[str, str]:
    head = f"{problem.name}: {len(answer)} {'route' if len(answer) == 1 else 'routes'}"
    if solution is not None:
        head += f" by {solution.solver}"
    rounded = CONVENTIONS.get(problem.convention, problem.convention)
    if problem.convention == "file" and problem.travel.metric == EXPLICIT:
        rounded = "distances as given"
    detail = f"{problem.objective} {figures_of(problem, answer, solution)}; {rounded}"
    if left_out := len(_left_out(problem, answer)):
        detail += f"\n{left_out} {'site' if left_out == 1 else 'sites'} left out (hollow)"
    if placed:
        detail += "\nno coordinates in the file: sites placed by scaling of their distances"
    return head, detail


def site_positions(problem: RoutingProblem) -> tuple[Floats, bool]:
    """Positions to draw at, shape (sites, 2), on the globe in decimal degrees (longitude, latitude), and whether they were scaled from
    distances."""
    xy, travel = problem.sites.coordinates, problem.travel
    if xy is None and travel.coordinates is not None:
        xy = travel.coordinates[:, ::-1] if travel.metric == "GEO" else travel.coordinates  # latitude stands first there
    if xy is None:
        return scaled_positions(travel.distances), True
    at = np.asarray(xy)
    if travel.metric == "GEO":  # degrees.minutes
        whole = np.trunc(at)
        at = whole + (at - whole) * 5.0 / 3.0
    return at, False


def geographic(problem: RoutingProblem) -> bool:
    """Whether positions are longitude and latitude."""
    return (
        problem.travel.metric == "GEO" or problem.travel.metric.startswith("haversine") or bool(getattr(problem.sites, "geographic", False))
    )


def map_axes(ax: Any, where: Floats, globe: bool) -> None:
    """A map: equal scales, on the globe for the mean latitude, no ticks, no frame."""
    bare(ax)
    if globe:
        middle = float((where[:, 1].min() + where[:, 1].max()) / 2.0)
        ax.set_aspect(1.0 / max(math.cos(math.radians(middle)), 0.01), adjustable="datalim")


def scale_bar(ax: Any, where: Floats, globe: bool) -> None:
    """A bar of a round length below the map, in km on the globe, else in the units of the coordinates."""
    width = float(np.ptp(where[:, 0]))
    unit = KM_A_DEGREE * math.cos(math.radians(float((where[:, 1].min() + where[:, 1].max()) / 2.0))) if globe else 1.0
    span = max(width, float(np.ptp(where[:, 1])) / (1.0 if not globe else max(unit / KM_A_DEGREE, 0.01))) * unit
    if not span > 0.0 or not math.isfinite(span):
        return
    length = _round_length(span / 5.0)
    right, low = float(where[:, 0].max()), float(where[:, 1].min())
    down = low - 0.07 * (float(np.ptp(where[:, 1])) or width)
    left = right - length / unit
    ax.plot([left, right], [down, down], color="#555555", linewidth=2.2, solid_capstyle="butt", zorder=6, clip_on=False, gid="scale")
    text = f"{number(length)} unit{'s' if length != 1.0 else ''}"
    if globe:
        text = f"{number(1000.0 * length)} m" if length < 1.0 else f"{number(length)} km"
    ax.annotate(
        text, ((left + right) / 2.0, down), xytext=(0, -4), textcoords="offset points", ha="center", va="top", fontsize=8, color="#555555"
    )


def _round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not longer."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= length * (1.0 + 1e-9))


def heading(
    ax: Any, problem: RoutingProblem, answer: Routes, solution: Solution | None, title: str | None, what: str, detail: str = ""
) -> None:
    """The title of a chart: ``title``, or problem, ``what`` is shown and solver, above the figures of the answer and ``detail``."""
    by = "" if solution is None else f" by {solution.solver}"
    figures = f"{problem.objective} {figures_of(problem, answer, solution)}{detail}"
    entitle(ax, *((f"{problem.name}: {what}{by}", figures) if title is None else (title, "")))


def route_ranks(problem: RoutingProblem, answer: Routes, where: Floats | None = None) -> list[int]:
    """The place of each route by the angle of its centre seen from its depot.

    It chooses the colour, the same in every picture of an answer, and other than that of the neighbours on the map.
    """
    if where is None:
        if problem.sites.coordinates is None and len(problem.sites) > SCALED_SITES:
            return list(range(len(answer)))  # there is no map to agree with
        where = site_positions(problem)[0]
    angles = []
    for route in answer:
        centre = where[list(route.visits)].mean(axis=0) - where[problem.fleet[route.vehicle].start]
        angles.append(math.atan2(centre[1], centre[0]))
    return np.argsort(np.argsort(angles, kind="stable")).tolist()  # type: ignore[no-any-return]


def arrows(ax: Any, way: Floats, colour: str, count: int, size: float) -> None:
    """Heads of arrows in the middle of ``count`` legs of a way of shape (stops, 2), evenly along it."""
    legs = np.hypot(*np.diff(way, axis=0).T) if len(way) > 1 else np.zeros(0)
    total = float(legs.sum())
    if not total > 0.0:
        return
    ends = np.cumsum(legs)
    chosen = {int(np.searchsorted(ends, total * (k + 0.5) / count)) for k in range(count)}
    for k in sorted(chosen):
        a, b = way[min(k, len(legs) - 1)], way[min(k, len(legs) - 1) + 1]
        middle, onward = a + 0.52 * (b - a), a + 0.58 * (b - a)
        ax.annotate(
            "", onward, middle, annotation_clip=True, zorder=4,
            arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 0.0, "mutation_scale": size, "shrinkA": 0.0, "shrinkB": 0.0},
        )  # fmt: skip


def legend_of_routes(ax: Any, handles: Sequence[Any], labels: Sequence[str]) -> None:
    """A legend to the right of the map, in as many columns as it takes; a figure of its own becomes wider for it."""
    shown = min(len(handles), LEGEND_ENTRIES)
    columns = math.ceil(shown / LEGEND_COLUMN) if shown <= LEGEND_COLUMN else math.ceil(shown / (1.5 * LEGEND_COLUMN))
    chosen, names = list(handles[:shown]), [str(label) for label in labels[:shown]]
    if len(handles) > shown:
        from matplotlib.lines import Line2D

        chosen, names = [*chosen[:-1], Line2D([], [], linestyle="")], [*names[:-1], f"and {len(handles) - shown + 1} more"]
    small = shown > LEGEND_COLUMN
    roomy(ax, width=8.0 + 1.15 * (columns - 1))
    ax.legend(
        chosen, names, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, ncols=columns, fontsize=6.8 if small else 9,
        handlelength=2.2 if small else 2.6, labelspacing=0.3 if small else 0.7, columnspacing=1.0, handletextpad=0.5,
    )  # fmt: skip


PLOTS.add("routing", plot_routes)
