"""VROOM's JSON: jobs, shipments and vehicles over matrices of travel times.

Locations are rows of the matrices (``location_index``, ``start_index``, ``end_index``): nobody is asked for the distance of two places on a
map. Where there are no matrices, ``--set speed=50`` stands for them: great circles between the coordinates, at so many km an hour.

Each task may be left out: VROOM first assigns as much priority, then as many tasks as it can, and then minimises the cost. So every
site has a reward of ``priority (n + 1) + 1`` for n sites, and rewards come before the total cost.

Jobs are sites with their own number as id, shipments two sites ``pickup 3`` and ``delivery 3``, and the places where vehicles start or end
are depots ``location 0``. Vehicles that are alike make one type, named for their numbers (``vehicle 1 2 5``). A vehicle without a start or
an end has the depot ``anywhere``, which is no distance from any site.

Costs per hour and kilometre are taken as they are, not rounded to whole numbers as VROOM does. Breaks, setup times, numbers of tasks, and
limits of distance beside costs by time have no place in the data and are refused by name. ``--set ignore=breaks,steps`` leaves out what
only restricts, or where VROOM's own search begins, and is told.

Source: VROOM, Coupey, Nicod and Varnier, the description of its API, version 1.14.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...document import array, dump_json, fields, integer, kind_of, parse_json, real, square
from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import an, label
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..sites import Shipment
from ..travel import EXPLICIT, Travel
from ..vehicle_type import Energy
from ._limits import cannot, refuse_inexpressible
from ._vroom_settings import IGNORED, SETTINGS, location_of, on_the_globe, without

Floats = NDArray[np.float64]

PROBLEMS = ("min-cost-vrp",)
OBJECTIVE = ("reward", "total-cost")
ANYWHERE = "anywhere"

DOCUMENT = ("jobs", "shipments", "vehicles", "matrices", "matrix", "options")
TASK = ("id", "description", "location", "location_index", "setup", "service", "time_windows")
JOB = (*TASK, "delivery", "pickup", "skills", "priority")
SHIPMENT = ("pickup", "delivery", "amount", "skills", "priority")
VEHICLE = (
    "id", "profile", "description", "start", "start_index", "end", "end_index", "capacity", "costs", "skills", "type", "time_window",
    "breaks", "speed_factor", "max_tasks", "max_travel_time", "max_distance", "steps",
)  # fmt: skip
COSTS = ("fixed", "per_hour", "per_km", "per_task_hour")
LACKING = {"setup": 0, "breaks": [], "max_tasks": None, "steps": [], "per_task_hour": 0}
"""Keys that the data have no place for, and the value that asks nothing."""

_VEHICLES, _WAYBOUND = re.compile(r'"vehicles"\s*:'), re.compile(r'"waybound"\s*:')


def recognises(text: str) -> bool:
    """Whether a JSON object has vehicles, and is none of waybound's and no GeoJSON."""
    return (
        '"FeatureCollection"' not in text
        and text.lstrip().startswith("{")
        and _VEHICLES.search(text) is not None
        and _WAYBOUND.search(text) is None
    )


# -- reading -------------------------------------------------------------------------------------------------------------


@dataclass
class _Site:
    """What is known of a site before there are arrays; ``place`` is its row of the matrices, None for anywhere."""

    id: str
    place: int | None
    depot: bool = False
    service: float = 0.0
    windows: Sequence[tuple[float, float]] = ()
    delivery: Sequence[int] = ()
    pickup: Sequence[int] = ()
    skills: frozenset[str] = frozenset()
    priority: int = 0
    location: tuple[float, float] | None = None


def read(text: str, path: Path, settings: Mapping[str, Any] | None = None) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    data, given, notes = parse_json(text), settings or {}, tuple[str, ...]()
    if not isinstance(data, dict):
        raise InputError("must hold one object", found=kind_of(data))
    if "routes" in data and "vehicles" not in data:
        raise InputError("is a solution file, not an instance")
    fields(data, "the document", DOCUMENT, ("vehicles",))
    for key, apply in (("ignore", without), ("speed", on_the_globe)):
        if given.get(key) is not None:
            data, told = apply(data, given[key])
            notes += told
    matrices = _matrices(data)
    size = next(iter(matrices.values()))["durations"].shape[0]
    vehicles = [_vehicle(item, f"vehicles[{k}]", matrices, size) for k, item in enumerate(array(data["vehicles"], "vehicles"))]
    if not vehicles:
        raise InputError("vehicles is empty", expected="at least one vehicle")
    _different([v.id for v in vehicles], "vehicles")
    sites, tasks, shipments = _depots(vehicles), *_tasks(data, size)
    dimensions = {len(v.capacity) for v in vehicles} | {len(s.delivery or s.pickup) for s in tasks if s.delivery or s.pickup}
    dimensions |= {len(load) for *_, load in shipments if load}
    if len(dimensions) > 1:
        raise InputError(
            "loads and capacities have different lengths", expected="the same everywhere", found=", ".join(map(str, sorted(dimensions)))
        )
    made = _instance(label(path.stem), [*sites, *tasks], shipments, vehicles, matrices, max(1, *dimensions))
    located = given.get("speed") is not None and made.sites.coordinates is not None
    return replace(made, notes=notes, sites=replace(made.sites, geographic=located))


@dataclass
class _Vehicle:
    id: int
    profile: str
    start: int | None
    end: int | None
    places: Mapping[int, tuple[float, float]]
    capacity: Sequence[int]
    skills: frozenset[str]
    shift: tuple[float, float]
    speed: float
    longest_travel: float
    longest_distance: float
    fixed: float
    per_hour: float
    per_km: float

    def kind(self) -> tuple[Any, ...]:
        """What vehicles of one type share."""
        return (
            self.profile, self.start, self.end, tuple(self.capacity), self.skills, self.shift, self.speed, self.longest_travel,
            self.longest_distance, self.fixed, self.per_hour, self.per_km,
        )  # fmt: skip


def _matrices(data: Mapping[str, Any]) -> dict[str, dict[str, Floats]]:
    """By profile: durations, and distances and costs where they are given, all of one size."""
    if "matrix" in data:
        if "matrices" in data:
            raise InputError("matrix stands beside matrices", expected="one of them")
        size = len(array(data["matrix"], "matrix"))
        found = {"car": {"durations": square(data["matrix"], "matrix", size)}}
    else:
        given = data.get("matrices")
        if not isinstance(given, dict) or not given:
            expected = "matrices of durations, or --set speed=50 (km an hour) for great circles between the coordinates"
            raise InputError("matrices are missing, and no server is asked for travel times", expected=expected)
        size, found = -1, {}
        for profile, item in given.items():
            where = f"matrices.{label(profile)}"
            fields(item, where, ("durations", "distances", "costs"), ("durations",))
            size = len(array(item["durations"], f"{where}.durations")) if size < 0 else size
            found[profile] = {key: square(item[key], f"{where}.{key}", size) for key in item}
    for profile, item in found.items():
        for key, matrix in item.items():
            if (matrix < 0).any():
                raise InputError(
                    f"{key} of profile {label(profile)} hold a negative number", expected="0 or more", found=f"{matrix.min():g}"
                )
    if size < 1:
        raise InputError("matrices are empty", expected="a row for each location")
    return found


def _known(data: Any, path: str, known: Collection[str], required: Collection[str] = ()) -> Mapping[str, Any]:
    """``fields``, and what the data have no place for is refused."""
    fields(data, path, known, required)
    for key, nothing in LACKING.items():
        if key in data and data[key] != nothing:
            cure = f", or --set ignore={key} to plan without" if key in IGNORED else ""
            raise InputError(f"{path}.{key} is not supported", expected=f"no {key}{cure}")
    return data  # type: ignore[no-any-return]


def _place(data: Mapping[str, Any], key: str, path: str, size: int) -> int:
    if key not in data:
        raise InputError(f"{path} lacks the key {key!r}", expected="a row of the matrices: no server is asked for travel times")
    place = integer(data[key], f"{path}.{key}", 0)
    if place >= size:
        raise InputError(f"{path}.{key} is no row of the matrices", expected=f"0 to {size - 1}", found=str(place))
    return place


def _window(data: Any, path: str) -> tuple[float, float]:
    opens, closes = (float(integer(v, f"{path}[{k}]", 0)) for k, v in enumerate(array(data, path, 2)))
    if opens > closes:
        raise InputError(f"{path} closes before it opens", expected="a begin and a later end", found=f"{opens:g}, {closes:g}")
    return opens, closes


def _amounts(data: Mapping[str, Any], key: str, path: str) -> list[int]:
    return [integer(v, f"{path}.{key}[{k}]", 0) for k, v in enumerate(array(data.get(key, []), f"{path}.{key}"))]


def _skills(data: Mapping[str, Any], path: str) -> frozenset[str]:
    return frozenset(str(integer(v, f"{path}.skills[{k}]", 0)) for k, v in enumerate(array(data.get("skills", []), f"{path}.skills")))


def _priority(data: Mapping[str, Any], path: str) -> int:
    value = integer(data.get("priority", 0), f"{path}.priority", 0)
    if value > 100:
        raise InputError(f"{path}.priority is too large", expected="0 to 100", found=str(value))
    return value


def _vehicle(item: Any, path: str, matrices: Mapping[str, Mapping[str, Floats]], size: int) -> _Vehicle:
    data = _known(item, path, VEHICLE, ("id",))
    profile = data.get("profile", "car")
    if not isinstance(profile, str) or profile not in matrices:
        expected = ", ".join(label(name) for name in matrices)
        raise InputError(f"{path}.profile has no matrices", expected=expected, found=kind_of(profile))
    ends: dict[str, int | None] = {}
    places: dict[int, tuple[float, float]] = {}
    for key in ("start", "end"):
        given = f"{key}_index" in data or key in data
        ends[key] = place = _place(data, f"{key}_index", path, size) if given else None
        if place is not None and (at := location_of(data, key, path)) is not None:
            places[place] = at
    if ends["start"] is None and ends["end"] is None:
        raise InputError(f"{path} neither starts nor ends anywhere", expected="start_index or end_index")
    costs = _known(data.get("costs", {}), f"{path}.costs", COSTS)
    fixed, per_hour, per_km = (
        real(costs.get(key, default), f"{path}.costs.{key}") for key, default in (("fixed", 0), ("per_hour", 3600), ("per_km", 0))
    )
    own = matrices[profile]
    if "costs" in own and {"per_hour", "per_km"} & costs.keys():
        raise InputError(f"{path}.costs stand beside costs of profile {label(profile)}", expected="one of them")
    if per_km and "distances" not in own:
        raise InputError(f"{path}.costs.per_km needs distances of profile {label(profile)}")
    speed = real(data.get("speed_factor", 1), f"{path}.speed_factor")
    if not 0 < speed <= 5:
        raise InputError(f"{path}.speed_factor is out of range", expected="above 0, at most 5", found=f"{speed:g}")
    longest = {
        key: math.inf if key not in data else float(integer(data[key], f"{path}.{key}", 0)) for key in ("max_travel_time", "max_distance")
    }
    if math.isfinite(longest["max_distance"]) and (per_hour or not per_km or "costs" in own):
        raise InputError(
            f"{path}.max_distance is not supported where costs are not by distance alone", expected="costs per_km, and per_hour 0"
        )
    return _Vehicle(
        integer(data["id"], f"{path}.id", 0), profile, ends["start"], ends["end"], places, _amounts(data, "capacity", path),
        _skills(data, path), _window(data["time_window"], f"{path}.time_window") if "time_window" in data else (-math.inf, math.inf), speed,
        longest["max_travel_time"], longest["max_distance"], fixed, per_hour, per_km,
    )  # fmt: skip


def _depots(vehicles: Sequence[_Vehicle]) -> list[_Site]:
    found: dict[int | None, _Site] = {}
    at = {place: xy for v in vehicles for place, xy in v.places.items()}
    for vehicle in vehicles:
        for place in (vehicle.start, vehicle.end):
            name = ANYWHERE if place is None else f"location {place}"
            found.setdefault(place, _Site(name, place, depot=True, location=None if place is None else at.get(place)))
    return list(found.values())


def _task(data: Mapping[str, Any], name: str, path: str, size: int) -> _Site:
    place = _place(data, "location_index", path, size)
    listed = array(data.get("time_windows", []), f"{path}.time_windows")
    if "time_windows" in data and not listed:
        raise InputError(f"{path}.time_windows is empty", expected="at least one window")
    windows = [_window(w, f"{path}.time_windows[{k}]") for k, w in enumerate(listed)]
    for k, (before, after) in enumerate(itertools.pairwise(windows), start=1):
        if after[0] <= before[1]:
            raise InputError(f"{path}.time_windows[{k}] begins before the one before it ends", expected="windows in order and apart")
    service = float(integer(data.get("service", 0), f"{path}.service", 0))
    return _Site(name, place, service=service, windows=windows, location=location_of(data, "location", path))


def _tasks(data: Mapping[str, Any], size: int) -> tuple[list[_Site], list[tuple[str, str, Sequence[int]]]]:
    """Sites of jobs and shipments, and of each shipment the ids of both ends and the load."""
    sites: list[_Site] = []
    shipments: list[tuple[str, str, Sequence[int]]] = []
    for k, item in enumerate(array(data.get("jobs", []), "jobs")):
        path = f"jobs[{k}]"
        job = _known(item, path, JOB, ("id",))
        site = _task(job, str(integer(job["id"], f"{path}.id", 0)), path, size)
        amounts = [_amounts(job, key, path) for key in ("delivery", "pickup")]
        if all(amounts) and len(amounts[0]) != len(amounts[1]):
            raise InputError(
                f"{path} delivers and picks up different numbers of loads", expected=str(len(amounts[0])), found=str(len(amounts[1]))
            )
        sites.append(replace(site, delivery=amounts[0], pickup=amounts[1], skills=_skills(job, path), priority=_priority(job, path)))
    for k, item in enumerate(array(data.get("shipments", []), "shipments")):
        path = f"shipments[{k}]"
        shipment = _known(item, path, SHIPMENT, ("pickup", "delivery"))
        ends = []
        for key in ("pickup", "delivery"):
            step = _known(shipment[key], f"{path}.{key}", TASK, ("id",))
            site = _task(step, f"{key} {integer(step['id'], f'{path}.{key}.id', 0)}", f"{path}.{key}", size)
            ends.append(replace(site, skills=_skills(shipment, path), priority=_priority(shipment, path)))
        sites += ends
        shipments.append((ends[0].id, ends[1].id, _amounts(shipment, "amount", path)))
    if not sites:
        raise InputError("there is nothing to do", expected="jobs or shipments")
    _different([site.id for site in sites], "tasks")
    return sites, shipments


def _different(ids: Sequence[object], what: str) -> None:
    seen: set[object] = set()
    for each in ids:
        if each in seen:
            raise InputError(f"two {what} have the id {each}", expected="different ids")
        seen.add(each)


def _instance(
    name: str, listed: list[_Site], shipments: list[tuple[str, str, Sequence[int]]], vehicles: list[_Vehicle],
    matrices: Mapping[str, Mapping[str, Floats]], dimensions: int,
) -> RoutingInstance:  # fmt: skip
    index = {site.id: k for k, site in enumerate(listed)}
    tasks = sum(not site.depot for site in listed)

    xy = [site.location for site in listed if site.location is not None]

    def loads(key: str) -> Floats:
        return np.array([list(getattr(site, key)) or [0] * dimensions for site in listed], dtype=np.float64)

    sites = Sites.of(
        [site.id for site in listed], depot=[site.depot for site in listed], required=False, service=[site.service for site in listed],
        demand=loads("delivery"), pickup=loads("pickup"), reward=[0 if s.depot else s.priority * (tasks + 1) + 1 for s in listed],
        windows={k: site.windows for k, site in enumerate(listed) if site.windows},
        skills={k: site.skills for k, site in enumerate(listed) if site.skills},
        shipments=[Shipment(index[a], index[b], tuple(load) or (0.0,)) for a, b, load in shipments],
        coordinates=None if len(xy) < len(listed) else xy,
    )  # fmt: skip
    places = [site.place for site in listed]
    types: dict[tuple[Any, ...], list[_Vehicle]] = {}
    for vehicle in vehicles:
        types.setdefault(vehicle.kind(), []).append(vehicle)
    fleet: list[VehicleType] = []
    common, shared = None, None
    for alike in types.values():
        first = alike[0]
        key, travel, unit = _travel(first, matrices[first.profile], places)
        if common is None:
            common, shared = travel, key
        start, end = (index[ANYWHERE if place is None else f"location {place}"] for place in (first.start, first.end))
        fleet.append(
            VehicleType(
                len(alike), float(first.capacity[0]) if first.capacity else math.inf, start, end, max_distance=first.longest_distance,
                energy=Energy(first.longest_travel) if math.isfinite(first.longest_travel) else None, fixed_cost=first.fixed,
                unit_cost=unit, name="vehicle " + " ".join(str(v.id) for v in alike),
                further_capacity=tuple(map(float, first.capacity[1:])),
                shift=first.shift, skills=first.skills, travel=None if key == shared else travel,
            )
        )  # fmt: skip
    assert common is not None
    made = RoutingInstance(name, "vroom", sites, common, tuple(fleet), problem=PROBLEMS[0], problems=PROBLEMS, objective=OBJECTIVE)
    refuse_unreachable(made)
    return made


def _travel(vehicle: _Vehicle, own: Mapping[str, Floats], places: Sequence[int | None]) -> tuple[tuple[Any, ...], Travel, float]:
    """What tells it from others, the travel between sites, and the cost of one unit of its distance."""
    durations = own["durations"] / vehicle.speed
    if "costs" in own:
        how, distances, unit = "costs", own["costs"], 1.0
    elif not vehicle.per_km:
        how, distances, unit = "durations", durations, vehicle.per_hour / 3600
    elif not vehicle.per_hour:
        how, distances, unit = "distances", own["distances"], vehicle.per_km / 1000
    else:
        how, unit = f"{vehicle.per_hour} {vehicle.per_km}", 1.0
        distances = durations * (vehicle.per_hour / 3600) + own["distances"] * (vehicle.per_km / 1000)
    made, taken = _between(distances, places), None if how == "durations" else _between(durations, places)
    return (vehicle.profile, vehicle.speed, how), Travel(EXPLICIT, matrix=made, duration_matrix=taken), unit


def _between(matrix: Floats, places: Sequence[int | None]) -> Floats:
    """The matrix between sites; nothing from and to anywhere."""
    at = np.array([0 if place is None else place for place in places])
    nowhere = np.array([place is None for place in places])
    made: Floats = matrix[np.ix_(at, at)]
    made[nowhere] = 0.0
    made[:, nowhere] = 0.0
    return made


# -- writing -------------------------------------------------------------------------------------------------------------

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
    size = max(places.values(), default=-1) + 1
    partner = {k: s for s in sites.shipments for k in (s.pickup, s.delivery)}
    jobs = [
        {**_written_task(instance, k, ids[k], places[k]), **_written_loads(instance, k), **_written_wish(instance, k, priorities[k])}
        for k in sites.customers.tolist()
        if k not in partner
    ]
    shipments = [
        {
            "pickup": _written_task(instance, s.pickup, ids[s.pickup], places[s.pickup]),
            "delivery": _written_task(instance, s.delivery, ids[s.delivery], places[s.delivery]),
            "amount": [_whole(instance, v, "load") for v in (*s.load, *[0.0] * (sites.dimensions - len(s.load)))],
            **_written_wish(instance, s.pickup, priorities[s.pickup]),
        }
        for s in sites.shipments
    ]
    matrices: dict[str, Any] = {}
    vehicles: list[dict[str, Any]] = []
    for kind in range(len(instance.fleet)):
        vehicles += _written_vehicles(instance, kind, places, size, matrices)
    data = {"vehicles": vehicles, "jobs": jobs, "shipments": shipments, "matrices": matrices}
    return dump_json({key: value for key, value in data.items() if value})


def _whole(instance: RoutingInstance, value: float, what: str) -> int:
    if not float(value).is_integer() or not 0 <= value < 2**53:
        raise cannot(instance, "vroom", f"the format has whole numbers of at least 0, and {an(what)} is {value:g}")
    return int(value)


def _priorities(instance: RoutingInstance) -> list[int]:
    """Priority of each site, of what rewards stand for."""
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
    """A number for each task: its id without what it is, or else its place among the sites."""
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


def _written_task(instance: RoutingInstance, k: int, number: int, place: int) -> dict[str, Any]:
    sites = instance.sites
    made: dict[str, Any] = {"id": number, "location_index": place}
    if sites.coordinates is not None:
        made["location"] = sites.coordinates[k].tolist()
    if sites.service[k]:
        made["service"] = _whole(instance, sites.service[k], "service time")
    windows = sites.windows[k] if sites.windows and sites.windows[k] else ((float(sites.ready[k]), float(sites.due[k])),)
    if windows != ((0.0, math.inf),):
        if math.isinf(windows[-1][1]):
            raise cannot(instance, "vroom", f"the window of site {sites.ids[k]} has no end")
        made["time_windows"] = [[_whole(instance, v, "time") for v in window] for window in windows]
    return made


def _written_loads(instance: RoutingInstance, k: int) -> dict[str, Any]:
    sites = instance.sites
    made = {}
    for key, values in (("delivery", (sites.demand[k], *sites.further_demand[k])), ("pickup", (sites.pickup[k], *sites.further_pickup[k]))):
        if any(values):
            made[key] = [_whole(instance, v, key) for v in values]
    return made


def _written_wish(instance: RoutingInstance, k: int, priority: int) -> dict[str, Any]:
    skills = sorted(instance.sites.skills[k]) if instance.sites.skills else []
    if not all(_NUMBER.match(each) for each in skills):
        raise cannot(instance, "vroom", f"skills are numbers there, not {', '.join(skills)}")
    return {**({"skills": [int(each) for each in skills]} if skills else {}), **({"priority": priority} if priority else {})}


def _written_vehicles(
    instance: RoutingInstance, kind: int, places: Mapping[int, int], size: int, matrices: dict[str, Any]
) -> list[dict[str, Any]]:
    vehicle, sites = instance.fleet[kind], instance.sites
    if vehicle.count is None:
        raise cannot(instance, "vroom", "the format needs a number of vehicles")
    if vehicle.count > 100_000:
        raise cannot(instance, "vroom", f"the format lists each vehicle, and there are {vehicle.count:,}")
    made: dict[str, Any] = {"profile": "car" if vehicle.travel is None else f"type {kind + 1}"}
    costs = _written_matrices(instance, kind, made["profile"], places, size, matrices)
    if vehicle.fixed_cost:
        costs["fixed"] = _whole(instance, vehicle.fixed_cost, "cost")
    if costs:
        made["costs"] = costs
    for key, site in (("start", vehicle.start), ("end", vehicle.end)):
        if site in places:
            made[f"{key}_index"] = places[site]
            if sites.coordinates is not None:
                made[key] = sites.coordinates[site].tolist()
    limits = (vehicle.capacity, *vehicle.further_capacity)
    if any(map(math.isfinite, limits)):
        made["capacity"] = [_whole(instance, v, "capacity") for v in limits]
    elif sites.demand.any() or sites.pickup.any() or sites.shipments:
        raise cannot(instance, "vroom", "vehicles that carry loads need a capacity")
    if vehicle.skills:
        if not all(_NUMBER.match(each) for each in vehicle.skills):
            raise cannot(instance, "vroom", f"skills are numbers there, not {', '.join(sorted(vehicle.skills))}")
        made["skills"] = sorted(int(each) for each in vehicle.skills)
    opens = max(vehicle.shift[0], float(sites.ready[vehicle.start]))
    closes = min(vehicle.shift[1], float(sites.due[vehicle.end]), float(sites.due[vehicle.start]))
    if (opens, closes) != (0.0, math.inf) or vehicle.shift != (-math.inf, math.inf):
        if math.isinf(closes) or sites.due[vehicle.start] < sites.due[vehicle.end]:
            raise cannot(instance, "vroom", "the format has one window for departure and return")
        made["time_window"] = [_whole(instance, opens, "time"), _whole(instance, closes, "time")]
    if vehicle.energy is not None:
        if vehicle.energy.rate != 1 or vehicle.energy.stations or vehicle.energy.at_departure < vehicle.energy.capacity:
            raise cannot(instance, "vroom", "the format limits travel time, and no other energy")
        made["max_travel_time"] = _whole(instance, vehicle.energy.capacity, "limit")
    if math.isfinite(vehicle.max_distance):
        if "per_km" not in costs:
            raise cannot(instance, "vroom", "the format limits distances where costs are by distance")
        made["max_distance"] = _whole(instance, vehicle.max_distance, "limit")
    given = [int(each) for each in re.findall(r"[0-9]{1,17}", vehicle.name)]
    named = vehicle.name == "vehicle " + " ".join(map(str, given)) and len(given) == vehicle.count
    before = sum(v.count or 0 for v in instance.fleet[:kind])
    return [{"id": number, **made} for number in (given if named else range(before + 1, before + vehicle.count + 1))]


def _written_matrices(
    instance: RoutingInstance, kind: int, profile: str, places: Mapping[int, int], size: int, matrices: dict[str, Any]
) -> dict[str, Any]:
    """Adds the matrices of a profile, and returns the costs that go with them."""
    vehicle = instance.fleet[kind]
    travel = vehicle.travel or instance.travel
    at = list(places)

    def rows(values: Floats, what: str) -> list[list[int]]:
        whole = np.zeros((size, size))
        where = [places[k] for k in at]
        whole[np.ix_(where, where)] = values[np.ix_(at, at)]
        worst = whole[whole != np.floor(whole)]
        if len(worst):
            _whole(instance, float(worst[0]), what)
        return [[int(v) for v in row] for row in whole.tolist()]

    costs: dict[str, Any] = {}
    if not travel.own_durations:
        lengths = rows(travel.distances, "distance")
        held = {"durations": lengths, "distances": lengths}  # VROOM asks for distances even where they cost nothing
        if vehicle.unit_cost != 1:
            costs["per_hour"] = _whole(instance, vehicle.unit_cost * 3600, "cost of an hour")
    elif vehicle.unit_cost == 1 and math.isinf(vehicle.max_distance):
        lengths = rows(travel.distances, "distance")
        held = {"durations": rows(travel.durations, "duration"), "distances": lengths, "costs": lengths}
    else:
        held = {"durations": rows(travel.durations, "duration"), "distances": rows(travel.distances, "distance")}
        costs = {"per_hour": 0, "per_km": _whole(instance, vehicle.unit_cost * 1000, "cost of a kilometre")}
    if matrices.setdefault(profile, held) != held:
        raise cannot(instance, "vroom", "vehicles that share their travel differ in what it costs")
    return costs


FORMATS.add(
    "vroom",
    Format(
        "vroom", "VROOM's JSON (jobs, shipments, vehicles, matrices)", recognises, read, write, (), PROBLEMS[0], PROBLEMS,
        solutions=(".json", ".sol", ".tour", ".vroom"), settings=SETTINGS,
    ),
)  # fmt: skip
