"""A map of routes that zooms, on which a route or a stop is picked to see its facts."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.rendering import number
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.solution import Solution
from ....instances.clock import moment_told
from ....instances.errors import UsageError
from ....instances.printable import printable
from ...plots.drawing import COLOURS, Floats
from ...plots.routing.routes import geographic, route_ranks, site_positions
from ...tables.routing.routes import unserved_sites, unserved_table
from .. import PAGES
from ..blocks import DataTable, Folded, Text, table_of
from ..default_blocks import charts
from ..rendering import Block, Rendering

if TYPE_CHECKING:
    from markupsafe import Markup


WIDTH, LEAST_HEIGHT, MOST_HEIGHT, MARGIN = 1000.0, 420.0, 820.0, 36.0
"""Width, height and margin of the map, in its own units."""

LABELLED_SITES = 40
"""Sites up to which the whole map shows ids; those of a picked route are shown on any map."""

LABEL = (48.0, 30.0)
"""Room around a label, across and down: of labels that are nearer to each other one is shown."""

DASHES = ("", "9 3", "3 3", "10 3 3 3")
"""Lines of routes after each round of colours."""


@dataclass(frozen=True, eq=False)
class RouteMap:
    """The map of an answer. Raises UsageError, when it is written, if there are no coordinates and too many sites to place them."""

    problem: RoutingProblem
    answer: Routes

    def html(self, made: Rendering) -> "Markup":
        problem, answer = self.problem, self.answer
        where, scaled = site_positions(problem)
        at, height = placed(where, geographic(problem))
        made.scripts["route_map.js"] = None
        made.colours |= {colour[1:].lower() for colour in COLOURS}
        ids = [printable(site, 60) for site in problem.sites.ids]
        facts, labelled = self._facts(ids, at), _labelled(at)
        ranks = route_ranks(problem, answer, where)
        routes = [
            {
                "name": told["name"], "summary": told["summary"], "colour": COLOURS[rank % len(COLOURS)][1:].lower(),
                "dash": DASHES[rank // len(COLOURS) % len(DASHES)], "path": _path(at[ends := _sites_of(problem, route)]),
                "inner": _path(at[ends[1:-1]]), "legs": _path(at[ends[:2]]) + _path(at[ends[-2:]]),
                "stops": [(ids[i], *at[i], i in labelled) for i in route.visits],
            }
            for rank, told, route in zip(ranks, facts["routes"], answer, strict=True)
        ]  # fmt: skip
        left = {problem.sites.index()[site]: why for site, why in unserved_sites(problem, answer).items()}
        return made.template(
            "route_map.html", name=made.name("map"), width=WIDTH, height=height, routes=routes, facts=facts, scaled=scaled,
            depots=[(ids[i], *at[i]) for i in problem.sites.depots.tolist()],
            left=[(ids[i], printable(why), *at[i]) for i, why in left.items()],
        )  # fmt: skip

    def _facts(self, ids: list[str], at: Floats) -> dict[str, Any]:
        """Facts about each route and stop, as texts that the script of the page shows."""
        frames = self.problem.answer_frames(self.answer)
        by_route = table_of(frames["routes"].drop(columns=["vehicle", "sites"]), most=None)
        by_stop = table_of(frames["visits"].drop(columns=["vehicle", "site"]), most=None)
        given = _given(self.problem)
        rows, routes = iter(by_stop.rows), []
        labels = [column.name for column in by_route.columns]
        names = self.problem.vehicle_names(self.answer)
        for name, values, route in zip(names, by_route.rows, self.answer, strict=True):
            told = dict(zip(labels, values, strict=True))
            stops = [
                {"id": ids[i], "at": at[i].tolist(), "facts": [*next(rows), *(column[i] for column in given.values())]}
                for i in route.visits
            ]
            summary = f"{told['stops']} {'stop' if told['stops'] == '1' else 'stops'}, load {told['load']}, distance {told['distance']}"
            routes.append({"name": printable(name, 80), "summary": summary, "facts": list(values), "stops": stops})
        return {"routes": routes, "of_route": labels, "of_stop": [*(column.name for column in by_stop.columns), *given]}


def placed(where: Floats, globe: bool) -> tuple[Floats, float]:
    """Positions on the map, shape (sites, 2), and its height; north is up, and on the globe lengths are those at the mean latitude."""
    flat = np.array(where, dtype=np.float64)
    if globe:
        flat[:, 0] *= max(math.cos(math.radians(float((flat[:, 1].min() + flat[:, 1].max()) / 2.0))), 0.01)
    low, span = flat.min(axis=0), np.ptp(flat, axis=0)
    inner = WIDTH - 2.0 * MARGIN
    wanted = inner * span[1] / span[0] if span[0] > 0.0 else math.inf
    room = np.array([inner, min(max(wanted, LEAST_HEIGHT - 2.0 * MARGIN), MOST_HEIGHT - 2.0 * MARGIN)])
    scale = min((float(r / s) for r, s in zip(room, span, strict=True) if s > 0.0), default=1.0)
    offset = MARGIN + (room - span * scale) / 2.0
    at = offset + (flat - low) * scale
    height = float(room[1] + 2.0 * MARGIN)
    at[:, 1] = height - at[:, 1]
    return np.round(at, 1), round(height, 1)


def _labelled(at: Floats) -> set[int]:
    """Sites whose ids are shown on the whole map."""
    chosen: list[int] = []
    for k in range(len(at) if len(at) <= LABELLED_SITES else 0):
        if all((np.abs(at[k] - at[other]) > LABEL).any() for other in chosen):
            chosen.append(k)
    return set(chosen)


def _sites_of(problem: RoutingProblem, route: Any) -> list[int]:
    vehicle = problem.fleet[route.vehicle]
    return [vehicle.start, *route.visits, vehicle.end]


def _path(points: Floats) -> str:
    return "M" + "L".join(f"{x:g} {y:g}" for x, y in points.tolist())


def _given(problem: RoutingProblem) -> dict[str, list[str]]:
    """Facts about each site that the data hold and the schedule does not."""
    sites, clock = problem.sites, problem.clock
    given: dict[str, list[str]] = {}
    if (np.isfinite(sites.due) | (sites.ready > 0.0))[~sites.depot].any():
        given["window"] = [
            f"{moment_told(clock, a)} to {moment_told(clock, b)}" if math.isfinite(b) else f"from {moment_told(clock, a)}"
            for a, b in zip(sites.ready.tolist(), sites.due.tolist(), strict=True)
        ]
    for title in ("demand", "pickup", "service", "reward"):
        values = getattr(sites, title)
        if values[~sites.depot].any():
            given[title] = [number(value) for value in values.tolist()]
    return given


@PAGES.register("routing")
def answer_blocks(problem: RoutingProblem, answer: Routes, solution: Solution) -> list[Block]:
    """The map, the routes, their visits, what is left out, and when vehicles drive and what they carry."""
    frames = problem.answer_frames(answer)
    blocks: list[Block] = [_map(problem, answer), DataTable(frames["routes"], title="Routes")]
    blocks.append(Folded(f"Visits ({len(frames['visits'])})", [DataTable(frames["visits"])]))
    if reasons := unserved_sites(problem, answer):
        blocks.append(DataTable(unserved_table(reasons)))
    return [*blocks, *(Folded(title, [chart]) for title, chart in charts(solution, ("schedule", "loads")))]


def _map(problem: RoutingProblem, answer: Routes) -> Block:
    try:
        site_positions(problem)
    except UsageError as fault:
        return Text(f"There is no map: {fault}")
    return RouteMap(problem, answer)
