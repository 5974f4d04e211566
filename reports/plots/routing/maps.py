"""What maps share: where sites lie, a scale bar, arrows along the way, and a legend for any number of routes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.rendering import number
from ..drawing import roomy
from ..positions import SCALED_SITES, scaled_positions

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem
    from ....formulations.routing.routes import Routes

Floats = NDArray[np.float64]


KM_A_DEGREE = 6371.0088 * math.pi / 180.0
"""Of latitude, on a sphere of the Earth's mean radius."""

LEGEND_COLUMN = 26
"""Routes in a column of a legend, and a half more where there are several columns."""

LEGEND_ENTRIES = 156
"""Of more routes the legend says how many there are."""

MOST_ARROWS = 240
"""On one map."""


def site_positions(problem: RoutingProblem) -> tuple[Floats, bool]:
    """Positions to draw at, shape (sites, 2), and whether they were made by scaling the distances.

    On the globe they are longitude and latitude in decimal degrees.
    """
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
    middle = float((where[:, 1].min() + where[:, 1].max()) / 2.0) if globe else 0.0
    ax.set_aspect(1.0 / max(math.cos(math.radians(middle)), 0.01), adjustable="datalim")
    ax.margins(0.06)
    ax.set_xticks([])
    ax.set_yticks([])
    for side in ax.spines.values():
        side.set_visible(False)


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
    told = (
        (f"{number(1000.0 * length)} m" if length < 1.0 else f"{number(length)} km")
        if globe
        else f"{number(length)} unit{'s' if length != 1.0 else ''}"
    )
    ax.annotate(
        told, ((left + right) / 2.0, down), xytext=(0, -4), textcoords="offset points", ha="center", va="top", fontsize=8, color="#555555"
    )


def _round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not longer."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= length * (1.0 + 1e-9))


def route_ranks(problem: RoutingProblem, answer: Routes, where: Floats | None = None) -> list[int]:
    """Of each route its place by the angle of its centre seen from its depot: it chooses the colour, the same in every picture of an
    answer, and other than that of the neighbours on the map."""
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
    """Heads of arrows in the middle of ``count`` legs of a way, evenly along it; ``way`` has shape (stops, 2)."""
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
