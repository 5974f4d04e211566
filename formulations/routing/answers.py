"""Routes in JSON, and as a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.errors import InputError
from ...instances.printable import printable
from .routes import Route, Routes
from .schedule import schedule

if TYPE_CHECKING:
    import pandas as pd

    from .problem import RoutingProblem


def routes_to_json(problem: RoutingProblem, answer: Routes) -> dict[str, Any]:
    """The answer with the file's own ids; depots where a vehicle reloads or recharges stand among its visits."""
    ids = problem.sites.ids
    routes = []
    for route in answer:
        entry: dict[str, Any] = {"visits": [ids[i] for i in route.visits]}
        if len(problem.fleet) > 1:
            entry["vehicle"] = problem.fleet[route.vehicle].name
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
            raise InputError(f"route {number} names an unknown vehicle {printable(vehicle, 80)!r}", expected=", ".join(types))
        for site in entry["visits"]:
            if str(site) not in index:
                raise InputError(f"route {number} visits an unknown site {printable(site, 80)!r}")
        routes.append(Route(tuple(index[str(s)] for s in entry["visits"]), types[vehicle]))
    return Routes.of(routes)


def routes_to_frame(problem: RoutingProblem, answer: Routes) -> pd.DataFrame:
    """One row a stop; see ``RoutingProblem.answer_to_frame``."""
    import pandas as pd

    held = problem.features()
    carried, filled = bool({"pickups", "shipments", "reloads"} & held), "recharging" in held
    rows = []
    for name, route in zip(problem.vehicle_names(answer), answer, strict=True):
        plan = schedule(problem, route)
        left = _energy_left(problem, route) if filled else []
        for k, site in enumerate(route.visits):
            row: dict[str, Any] = {
                "vehicle": name, "position": k + 1, "site": problem.sites.ids[site],
                "arrival": plan.arrival[k], "begin": plan.begin[k], "departure": plan.begin[k] + problem.sites.service[site],
                "load": float(plan.load[k]), "distance": float(plan.distance[k]),
            }  # fmt: skip
            if carried:
                row["on_board"] = float(plan.on_board[0, k + 1])
            if filled:
                row["energy"] = left[k]
            rows.append(row)
    columns = ["vehicle", "position", "site", "arrival", "begin", "departure", "load", "distance"]
    return pd.DataFrame(rows, columns=[*columns, *(["on_board"] if carried else []), *(["energy"] if filled else [])])


def _energy_left(problem: RoutingProblem, route: Route) -> list[float | None]:
    """What the store holds on leaving each stop; None where the vehicle has none that is charged for travel."""
    vehicle = problem.fleet[route.vehicle]
    if vehicle.energy is None or vehicle.energy.charge != "travel":
        return [None] * len(route.visits)
    stops = np.array([vehicle.start, *route.visits], dtype=np.int64)
    drawn = vehicle.energy.rate * problem.travel_of(route.vehicle).duration(stops[:-1], stops[1:])
    left: list[float | None] = []
    held = vehicle.energy.at_departure
    for site, part in zip(route.visits, drawn.tolist(), strict=True):
        held = vehicle.energy.capacity if site in vehicle.stations else held - part
        left.append(held)
    return left
