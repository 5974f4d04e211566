"""Routes in JSON, GeoJSON and networkx, as tables and as lines of text."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.printable import printable
from ..rendering import Line
from .routes import Route, Routes, Timetable
from .schedule import Schedule, schedule

if TYPE_CHECKING:
    import pandas as pd

    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem


def routes_to_json(problem: RoutingProblem, answer: Routes) -> dict[str, Any]:
    """The answer with the file's own ids; depots where a vehicle reloads or recharges stand among its visits."""
    ids = problem.sites.ids
    routes = []
    for route in answer:
        entry: dict[str, Any] = {"visits": [ids[i] for i in route.visits]}
        if len(problem.fleet) > 1:
            entry["vehicle"] = problem.fleet[route.vehicle].name
        if route.timetable is not None:
            entry["timetable"] = route.timetable.to_json()
        routes.append(entry)
    return {"kind": "routes", "routes": routes}


def routes_from_json(problem: RoutingProblem, data: Any) -> Routes:
    """Inverse of ``routes_to_json``; raises InputError for anything else."""
    if not isinstance(data, Mapping) or data.get("kind") != "routes" or not isinstance(data.get("routes"), list):
        raise InputError("not an answer to a routing problem", expected='an object {"kind": "routes", "routes": [...]}')
    index, types = problem.sites.index(), {v.name: k for k, v in enumerate(problem.fleet)}
    routes = []
    for number, entry in enumerate(data["routes"], start=1):
        if not isinstance(entry, Mapping) or not isinstance(entry.get("visits"), Sequence) or isinstance(entry["visits"], str):
            raise InputError(f"route {number} has no list of visits")
        vehicle = entry.get("vehicle", problem.fleet[0].name)
        if not isinstance(vehicle, str) or vehicle not in types:
            raise InputError(
                f"route {number} names an unknown vehicle {printable(vehicle, 80)!r}", "unknown-name", expected=", ".join(types)
            )
        for site in entry["visits"]:
            if str(site) not in index:
                raise InputError(f"route {number} visits an unknown site {printable(site, 80)!r}", "unknown-name")
        visits = tuple(index[str(s)] for s in entry["visits"])
        stated = entry.get("timetable")
        timetable = None if stated is None else Timetable.from_json(stated, len(visits), f"routes[{number - 1}].timetable")
        routes.append(Route(visits, types[vehicle], timetable))
    return Routes.of(routes)


class Run(NamedTuple):
    """A route with the name of its vehicle, its type and its schedule."""

    name: str
    route: Route
    vehicle: VehicleType
    plan: Schedule

    def stops(self, ids: Sequence[str]) -> list[str]:
        """Ids of all sites in order, the depots at both ends among them."""
        return [ids[k] for k in (self.vehicle.start, *self.route.visits, self.vehicle.end)]


def runs(problem: RoutingProblem, answer: Routes) -> Iterator[Run]:
    """Each route of an answer as it is driven."""
    for name, route in zip(problem.vehicle_names(answer), answer, strict=True):
        yield Run(name, route, problem.fleet[route.vehicle], schedule(problem, route))


def routes_to_frame(problem: RoutingProblem, answer: Routes) -> pd.DataFrame:
    """One row per stop: vehicle, position, site, arrival, begin, departure, load, distance (cumulated).

    ``on_board`` where loads are collected or shipped, ``energy`` where stores are filled on the way; then the attributes of sites.
    Times are moments where the problem was made of timestamps.
    """
    import pandas as pd

    features, sites = problem.features(), problem.sites
    driven = list(runs(problem, answer))
    stops = [(run, k, site) for run in driven for k, site in enumerate(run.route.visits)]
    columns = {
        "vehicle": [run.name for run, _, _ in stops],
        "position": [k + 1 for _, k, _ in stops],
        "site": [sites.ids[site] for _, _, site in stops],
        "arrival": [run.plan.arrival[k] for run, k, _ in stops],
        "begin": [run.plan.begin[k] for run, k, _ in stops],
        "departure": [run.plan.ends[k] for run, k, _ in stops],
        "load": [float(run.plan.load[k]) for run, k, _ in stops],
        "distance": [float(run.plan.distance[k]) for run, k, _ in stops],
    }
    if {"pickups", "shipments", "reloads"} & features:
        columns["on_board"] = [float(run.plan.on_board[0, k + 1]) for run, k, _ in stops]
    if "recharging" in features:
        columns["energy"] = [level for run in driven for level in _energy_left(problem, run.route)]
    taken = {*columns, "on_board", "energy"}
    for title, values in sites.attributes.items():
        columns[f"{title} (given)" if title in taken else title] = [values[site] for _, _, site in stops]
    return _dated(problem, pd.DataFrame(columns), ("arrival", "begin", "departure"))


def _dated(problem: RoutingProblem, frame: pd.DataFrame, columns: Sequence[str]) -> pd.DataFrame:
    """The frame with moments or times of day in place of times, where the problem knows from when these count."""
    if problem.clock is not None and (problem.clock.origin or problem.clock.of_day):
        for title in columns:
            frame[title] = problem.clock.moments(frame[title].tolist())
    return frame


def routes_frame(problem: RoutingProblem, answer: Routes) -> pd.DataFrame:
    """One row per route; ``sites`` are in order, from the depot on."""
    import pandas as pd

    driven = list(runs(problem, answer))
    columns = {
        "vehicle": [run.name for run in driven],
        "type": [run.vehicle.name for run in driven],
        "stops": [len(run.route) for run in driven],
        "load": [run.plan.total_load for run in driven],
        "distance": [run.plan.total_distance for run in driven],
        "duration": [run.plan.duration for run in driven],
        "departure": [run.plan.departure for run in driven],
        "return": [run.plan.finish for run in driven],
        "cost": [run.plan.cost(run.vehicle) for run in driven],
        "sites": [" > ".join(run.stops(problem.sites.ids)) for run in driven],
    }
    return _dated(problem, pd.DataFrame(columns), ("departure", "return"))


class Visits(tuple[str, ...]):
    """Ids of the sites of one route in order, without the depots at both ends; ``vehicle`` is its name in tables."""

    vehicle: str

    @classmethod
    def of(cls, ids: Iterable[str], vehicle: str) -> Visits:
        visits = cls(ids)
        visits.vehicle = vehicle
        return visits

    def __repr__(self) -> str:
        return repr(list(self))

    def __reduce__(self) -> Any:
        return Visits.of, (tuple(self), self.vehicle)


def visits_of(problem: RoutingProblem, answer: Routes) -> list[Visits]:
    """The routes by ids."""
    ids = problem.sites.ids
    return [Visits.of((ids[k] for k in r.visits), name) for name, r in zip(problem.vehicle_names(answer), answer, strict=True)]


SHOWN_ROUTES = 20
"""Routes, and sites left out, that are printed."""


def routes_lines(problem: RoutingProblem, answer: Routes) -> list[Line]:
    """A line per route, and one a site that is left out, with the reason."""
    lines = []
    for run in itertools.islice(runs(problem, answer), SHOWN_ROUTES):
        load = f", load {run.plan.total_load:.6g}" if run.plan.total_load else ""
        lines.append(Line(run.name, f"{' > '.join(run.stops(problem.sites.ids))} (distance {run.plan.total_distance:.6g}{load})"))
    if len(answer) > SHOWN_ROUTES:
        lines.append(Line("", f"and {len(answer) - SHOWN_ROUTES} more routes; to_frame() and routes have all", "quiet"))
    unvisited = problem.left_out(answer)
    lines += [Line("left out", f"{one.where}: {one.reason}") for one in unvisited[:SHOWN_ROUTES]]
    if len(unvisited) > SHOWN_ROUTES:
        lines.append(Line("", f"and {len(unvisited) - SHOWN_ROUTES} more; left_out() has all", "quiet"))
    return lines


def _energy_left(problem: RoutingProblem, route: Route) -> list[float | None]:
    """Energy in the store on leaving each stop; None where the vehicle has no store that is charged for travel."""
    vehicle = problem.fleet[route.vehicle]
    if vehicle.energy is None or vehicle.energy.charge != "travel":
        return [None] * len(route.visits)
    stops = np.array([vehicle.start, *route.visits], dtype=np.int64)
    drawn = vehicle.energy.rate * problem.travel_of(route.vehicle).duration(stops[:-1], stops[1:])
    levels: list[float | None] = []
    level = vehicle.energy.at_departure
    for site, part in zip(route.visits, drawn.tolist(), strict=True):
        level = vehicle.energy.capacity if site in vehicle.stations else level - part
        levels.append(level)
    return levels


def answer_graph(problem: RoutingProblem, answer: Routes) -> Any:
    """A ``networkx.MultiDiGraph``: a node a site, with its place, demand and attributes, and an edge a move of a route."""
    import networkx as nx

    sites = problem.sites
    graph = nx.MultiDiGraph(name=problem.name)
    for k, site in enumerate(sites.ids):
        place = {} if sites.coordinates is None else {"pos": tuple(sites.coordinates[k].tolist())}
        kept = {title: values[k] for title, values in sites.attributes.items()}
        graph.add_node(site, **{**kept, **place, "depot": bool(sites.depot[k]), "demand": float(sites.demand[k])})
    for run in runs(problem, answer):
        travel, stops = problem.travel_of(run.route.vehicle), (run.vehicle.start, *run.route.visits, run.vehicle.end)
        ends = [0.0, *run.plan.distance.tolist(), run.plan.total_distance]
        for k, (tail, head) in enumerate(itertools.pairwise(stops)):
            length, duration = ends[k + 1] - ends[k], float(travel.duration(tail, head))
            graph.add_edge(sites.ids[tail], sites.ids[head], vehicle=run.name, position=k + 1, distance=length, duration=duration)
    return graph


def answer_geojson(problem: RoutingProblem, answer: Routes) -> dict[str, Any]:
    """A ``FeatureCollection`` (RFC 7946): a line per route, straight from stop to stop, a point per site, and one a stop at a depot on the
    way.

    Raises UsageError if sites have no latitude and longitude.
    """
    sites = problem.sites
    if sites.coordinates is None or not sites.geographic:
        raise UsageError(
            "GeoJSON needs latitude and longitude, which these sites do not have: columns lat and lon of from_frame", "missing"
        )
    places = sites.coordinates.tolist()
    features = []
    for row, route in zip(_rows(routes_frame(problem, answer)), answer, strict=True):
        vehicle = problem.fleet[route.vehicle]
        line = [places[k] for k in (vehicle.start, *route.visits, vehicle.end)]
        features.append(_feature("LineString", line, {"kind": "route", **row, "visits": [sites.ids[k] for k in route.visits]}))
    visits: dict[str, list[dict[str, Any]]] = {}
    for row in _rows(routes_to_frame(problem, answer)):
        visits.setdefault(row.pop("site"), []).append(row)
    reasons = {one.where: one.reason for one in problem.left_out(answer)}
    for k, site in enumerate(sites.ids):
        kept = {title: values[k] for title, values in sites.attributes.items()}
        kind = "depot" if sites.depot[k] else "site"
        stops = visits.get(site, [])
        visit, further = (stops[0], stops[1:]) if stops and kind == "site" else ({}, stops)
        omission = {"left_out": reasons[site]} if site in reasons else {}
        features.append(_feature("Point", places[k], {"kind": kind, "id": site, **kept, **visit, **omission}))
        features += [_feature("Point", places[k], {"kind": "stop", "id": site, **kept, **each}) for each in further]
    return {"type": "FeatureCollection", "features": features}


def _feature(kind: str, coordinates: Any, properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def _rows(frame: Any) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = frame.to_dict("records")
    return [{str(key): value.isoformat() if hasattr(value, "isoformat") else value for key, value in row.items()} for row in rows]


def visits_of_geojson(data: Any) -> dict[str, list[str]] | None:
    """Visits by vehicle in such a document; None where it is none."""
    features = data.get("features") if isinstance(data, dict) and data.get("type") == "FeatureCollection" else None
    if not isinstance(features, list):
        return None
    rows = [f["properties"] for f in features if isinstance(f, dict) and isinstance(f.get("properties"), dict)]
    return {str(row["vehicle"]): row["visits"] for row in rows if row.get("kind") == "route" and {"vehicle", "visits"} <= row.keys()}
