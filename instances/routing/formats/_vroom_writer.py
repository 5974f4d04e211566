"""Writing of VROOM's JSON."""

import math
import re
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from ...document import dump_json
from ...number_arrays import Floats
from ...text import an
from ..instance import RoutingInstance
from ._limits import cannot, refuse_inexpressible

OBJECTIVE = ("reward", "total-cost")
ANYWHERE = "anywhere"
"""Depot of vehicles without a start or an end."""

EXPRESSIBLE = frozenset(
    {
        "capacity", "demands", "pickups", "shipments", "several-loads", "time-windows", "several-windows", "depot-windows", "service-times",
        "rewards", "optional-sites", "limited-fleet", "heterogeneous-fleet", "multiple-depots", "open-routes", "energy:travel",
        "fixed-cost", "unit-cost", "separate-durations", "vehicle-travel", "skills", "shifts", "max-distance", "objective",
    }
)  # fmt: skip
_NUMBER = re.compile(r"[0-9]{1,17}\Z")


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``.

    Instances whose sites must all be visited, at least total cost, are written too: VROOM leaves sites out only where it must.
    """
    refuse_inexpressible(instance, "vroom", EXPRESSIBLE)
    sites = instance.sites
    priorities = _priorities(instance)
    ids, places = _numbers(instance), _rows(instance)
    ends = {k for s in sites.shipments for k in (s.pickup, s.delivery)}
    jobs = [
        {**_task(instance, k, ids[k], places[k]), **_loads(instance, k), **_wish(instance, k, priorities[k])}
        for k in sites.customers.tolist()
        if k not in ends
    ]
    shipments = [
        {
            **{key: _task(instance, k, ids[k], places[k]) for key, k in (("pickup", s.pickup), ("delivery", s.delivery))},
            "amount": [_whole(instance, v, "load") for v in (*s.load, *[0.0] * (sites.dimensions - len(s.load)))],
            **_wish(instance, s.pickup, priorities[s.pickup]),
        }
        for s in sites.shipments
    ]
    matrices: dict[str, Any] = {}
    vehicles = [vehicle for kind in range(len(instance.fleet)) for vehicle in _vehicles(instance, kind, places, matrices)]
    data = {"vehicles": vehicles, "jobs": jobs, "shipments": shipments, "matrices": matrices}
    return dump_json({key: value for key, value in data.items() if value})


def _whole(instance: RoutingInstance, value: float, what: str) -> int:
    if not float(value).is_integer() or not 0 <= value < 2**53:
        raise cannot(instance, "vroom", f"the format has whole numbers of at least 0, and {an(what)} is {value:g}")
    return int(value)


def _priorities(instance: RoutingInstance) -> list[int]:
    """Priority of each site, which its reward stands for."""
    sites, at = instance.sites, instance.sites.customers
    if sites.required[at].all() and not sites.reward.any() and instance.objective in ((), ("total-cost",)) and instance.problem in (
        "min-cost-vrp", "cvrp", "vrptw", "mdvrp", "tsp",
    ):  # fmt: skip
        return [0] * len(sites)
    priority = (sites.reward - 1) / (len(at) + 1)
    if instance.objective != OBJECTIVE or sites.required[at].any() or not np.isin(priority[at], np.arange(101)).all():
        raise cannot(instance, "vroom", "VROOM assigns priorities, then tasks, and then minimises costs, and this asks for something else")
    for s in sites.shipments:
        if priority[s.pickup] != priority[s.delivery]:
            raise cannot(instance, "vroom", "both ends of a shipment need the same priority")
    return [0 if sites.depot[k] else int(v) for k, v in enumerate(priority.tolist())]


def _numbers(instance: RoutingInstance) -> list[int]:
    """A number for each task: its id without the word pickup or delivery, or else its place among the sites."""
    sites = instance.sites
    ends = {k: word for s in sites.shipments for k, word in ((s.pickup, "pickup "), (s.delivery, "delivery "))}
    if len(ends) < 2 * len(sites.shipments):
        raise cannot(instance, "vroom", "a site belongs to several shipments")
    bare = [site.removeprefix(ends.get(k, "")) for k, site in enumerate(sites.ids)]
    if all(_NUMBER.match(each) for k, each in enumerate(bare) if not sites.depot[k]):
        return [0 if sites.depot[k] else int(each) for k, each in enumerate(bare)]
    return list(range(len(sites)))


def _rows(instance: RoutingInstance) -> dict[int, int]:
    """A row of the matrices for each site but ``anywhere``; depots keep the row of their name."""
    sites = instance.sites
    kept = {
        k: int(site.removeprefix("location "))
        for k, site in enumerate(sites.ids)
        if re.match(r"location [0-9]{1,7}\Z", site) and sites.depot[k]
    }
    if len(set(kept.values())) < len(kept) or max(kept.values(), default=0) >= 10 * len(sites):
        kept = {}
    free = iter(sorted(set(range(len(sites) + len(kept))) - set(kept.values())))
    return {k: kept[k] if k in kept else next(free) for k in range(len(sites)) if sites.ids[k] != ANYWHERE or not sites.depot[k]}


def _task(instance: RoutingInstance, k: int, number: int, place: int) -> dict[str, Any]:
    sites = instance.sites
    task: dict[str, Any] = {"id": number, "location_index": place}
    if sites.coordinates is not None:
        task["location"] = sites.coordinates[k].tolist()
    if sites.service[k]:
        task["service"] = _whole(instance, sites.service[k], "service time")
    windows = sites.windows[k] if sites.windows and sites.windows[k] else ((float(sites.ready[k]), float(sites.due[k])),)
    if windows != ((0.0, math.inf),):
        if math.isinf(windows[-1][1]):
            raise cannot(instance, "vroom", f"the window of site {sites.ids[k]} has no end")
        task["time_windows"] = [[_whole(instance, v, "time") for v in window] for window in windows]
    return task


def _loads(instance: RoutingInstance, k: int) -> dict[str, Any]:
    sites = instance.sites
    loads = {"delivery": (sites.demand[k], *sites.further_demand[k]), "pickup": (sites.pickup[k], *sites.further_pickup[k])}
    return {key: [_whole(instance, v, key) for v in values] for key, values in loads.items() if any(values)}


def _wish(instance: RoutingInstance, k: int, priority: int) -> dict[str, Any]:
    skills = _skills(instance, instance.sites.skills[k] if instance.sites.skills else ())
    return {key: value for key, value in (("skills", skills), ("priority", priority)) if value}


def _skills(instance: RoutingInstance, words: Collection[str]) -> list[int]:
    """Skills as numbers, in the order of their words."""
    if not all(_NUMBER.match(word) for word in words):
        raise cannot(instance, "vroom", f"skills are numbers there, not {', '.join(sorted(words))}")
    return [int(word) for word in sorted(words)]


def _vehicles(instance: RoutingInstance, kind: int, places: Mapping[int, int], matrices: dict[str, Any]) -> list[dict[str, Any]]:
    """All vehicles of one type; adds its matrices."""
    vehicle, sites = instance.fleet[kind], instance.sites
    if vehicle.count is None:
        raise cannot(instance, "vroom", "the format needs a number of vehicles")
    if vehicle.count > 100_000:
        raise cannot(instance, "vroom", f"the format lists each vehicle, and there are {vehicle.count:,}")
    data: dict[str, Any] = {"profile": "car" if vehicle.travel is None else f"type {kind + 1}"}
    costs = _add_matrices(instance, kind, data["profile"], places, matrices)
    if vehicle.fixed_cost:
        costs["fixed"] = _whole(instance, vehicle.fixed_cost, "cost")
    if costs:
        data["costs"] = costs
    for key, site in (("start", vehicle.start), ("end", vehicle.end)):
        if site in places:
            data[f"{key}_index"] = places[site]
            if sites.coordinates is not None:
                data[key] = sites.coordinates[site].tolist()
    limits = (vehicle.capacity, *vehicle.further_capacity)
    if any(map(math.isfinite, limits)):
        data["capacity"] = [_whole(instance, v, "capacity") for v in limits]
    elif sites.demand.any() or sites.pickup.any() or sites.shipments:
        raise cannot(instance, "vroom", "vehicles that carry loads need a capacity")
    if vehicle.skills:
        data["skills"] = sorted(_skills(instance, vehicle.skills))
    opens = max(vehicle.shift[0], float(sites.ready[vehicle.start]))
    closes = min(vehicle.shift[1], float(sites.due[vehicle.end]), float(sites.due[vehicle.start]))
    if (opens, closes) != (0.0, math.inf) or vehicle.shift != (-math.inf, math.inf):
        if math.isinf(closes) or sites.due[vehicle.start] < sites.due[vehicle.end]:
            raise cannot(instance, "vroom", "the format has one window for departure and return")
        data["time_window"] = [_whole(instance, opens, "time"), _whole(instance, closes, "time")]
    if vehicle.energy is not None:
        if vehicle.energy.rate != 1 or vehicle.energy.stations or vehicle.energy.at_departure < vehicle.energy.capacity:
            raise cannot(instance, "vroom", "the format limits travel time, and no other energy")
        data["max_travel_time"] = _whole(instance, vehicle.energy.capacity, "limit")
    if math.isfinite(vehicle.max_distance):
        if "per_km" not in costs:
            raise cannot(instance, "vroom", "the format limits distances where costs are by distance")
        data["max_distance"] = _whole(instance, vehicle.max_distance, "limit")
    numbers = [int(each) for each in re.findall(r"[0-9]{1,17}", vehicle.name)]
    if vehicle.name != "vehicle " + " ".join(map(str, numbers)) or len(numbers) != vehicle.count:
        before = sum(v.count or 0 for v in instance.fleet[:kind])
        numbers = list(range(before + 1, before + vehicle.count + 1))
    return [{"id": number, **data} for number in numbers]


def _add_matrices(
    instance: RoutingInstance, kind: int, profile: str, places: Mapping[int, int], matrices: dict[str, Any]
) -> dict[str, Any]:  # fmt: skip
    """Adds the matrices of a profile, and returns the costs that go with them."""
    vehicle = instance.fleet[kind]
    travel = vehicle.travel or instance.travel
    size, at, where = max(places.values(), default=-1) + 1, list(places), list(places.values())

    def rows(values: Floats, what: str) -> list[list[int]]:
        whole = np.zeros((size, size))
        whole[np.ix_(where, where)] = values[np.ix_(at, at)]
        worst = whole[whole != np.floor(whole)]
        if len(worst):
            _whole(instance, float(worst[0]), what)
        return [[int(v) for v in row] for row in whole.tolist()]

    costs: dict[str, Any] = {}
    lengths = rows(travel.distances, "distance")
    if not travel.own_durations:
        tables = {"durations": lengths, "distances": lengths}  # VROOM asks for distances even where they cost nothing
        if vehicle.unit_cost != 1:
            costs["per_hour"] = _whole(instance, vehicle.unit_cost * 3600, "cost of an hour")
    elif vehicle.unit_cost == 1 and math.isinf(vehicle.max_distance):
        tables = {"durations": rows(travel.durations, "duration"), "distances": lengths, "costs": lengths}
    else:
        tables = {"durations": rows(travel.durations, "duration"), "distances": lengths}
        costs = {"per_hour": 0, "per_km": _whole(instance, vehicle.unit_cost * 1000, "cost of a kilometre")}
    if matrices.setdefault(profile, tables) != tables:
        raise cannot(instance, "vroom", "vehicles that share their travel differ in what it costs")
    return costs
