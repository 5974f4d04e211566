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

import itertools
import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...document import array, fields, integer, kind_of, parse_json, real, square
from ...errors import InputError
from ...formats import FORMATS, Format
from ...number_arrays import Floats
from ...text import label
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..sites import Shipment
from ..travel import EXPLICIT, Travel
from ..vehicle_type import Energy
from ._vroom_settings import IGNORED, SETTINGS, location_of, on_the_globe, without
from ._vroom_writer import ANYWHERE, OBJECTIVE, write

PROBLEMS = ("min-cost-vrp",)

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
"""Keys that the data have no place for, each with the value that means nothing."""

_VEHICLES, _WAYBOUND = re.compile(r'"vehicles"\s*:'), re.compile(r'"waybound"\s*:')


def recognises(text: str) -> bool:
    """True if a JSON object has vehicles, and is none of waybound's and no GeoJSON."""
    mine = text.lstrip().startswith("{") and '"FeatureCollection"' not in text
    return mine and _VEHICLES.search(text) is not None and _WAYBOUND.search(text) is None


@dataclass
class _Site:
    """A site, before there are arrays; ``place`` is its row of the matrices, None for anywhere."""

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
    data, settings, notes = parse_json(text), settings or {}, tuple[str, ...]()
    if not isinstance(data, dict):
        raise InputError("must hold one object", found=kind_of(data))
    if "routes" in data and "vehicles" not in data:
        raise InputError("is a solution file, not an instance", "foreign")
    fields(data, "the document", DOCUMENT, ("vehicles",))
    for key, apply in (("ignore", without), ("speed", on_the_globe)):
        if settings.get(key) is not None:
            data, remarks = apply(data, settings[key])
            notes += remarks
    matrices = _matrices(data)
    size = next(iter(matrices.values()))["durations"].shape[0]
    vehicles = [_vehicle(item, f"vehicles[{k}]", matrices, size) for k, item in enumerate(array(data["vehicles"], "vehicles"))]
    if not vehicles:
        raise InputError("vehicles is empty", "missing", expected="at least one vehicle")
    _refuse_equal([v.id for v in vehicles], "vehicles")
    sites, tasks, shipments = _depots(vehicles), *_tasks(data, size)
    dimensions = {len(v.kind.capacity) for v in vehicles} | {len(s.delivery or s.pickup) for s in tasks if s.delivery or s.pickup}
    dimensions |= {len(load) for *_, load in shipments if load}
    if len(dimensions) > 1:
        lengths = ", ".join(map(str, sorted(dimensions)))
        raise InputError("loads and capacities have different lengths", "wrong-shape", expected="the same everywhere", found=lengths)
    instance = _instance(label(path.stem), [*sites, *tasks], shipments, vehicles, matrices, max(1, *dimensions))
    located = settings.get("speed") is not None and instance.sites.coordinates is not None
    return replace(instance, notes=notes, sites=replace(instance.sites, geographic=located))


class _Kind(NamedTuple):
    """Properties that vehicles of one type share."""

    profile: str
    start: int | None
    end: int | None
    capacity: tuple[int, ...]
    skills: frozenset[str]
    shift: tuple[float, float]
    speed: float
    longest_travel: float
    longest_distance: float
    fixed: float
    per_hour: float
    per_km: float


class _Vehicle(NamedTuple):
    id: int
    kind: _Kind
    places: Mapping[int, tuple[float, float]]


def _matrices(data: Mapping[str, Any]) -> dict[str, dict[str, Floats]]:
    """Durations of each profile, and distances and costs where there are any, all of one size."""
    if "matrix" in data:
        if "matrices" in data:
            raise InputError("matrix stands beside matrices", "contradiction", expected="one of them")
        size = len(array(data["matrix"], "matrix"))
        matrices = {"car": {"durations": square(data["matrix"], "matrix", size)}}
    else:
        profiles = data.get("matrices")
        if not isinstance(profiles, dict) or not profiles:
            expected = "matrices of durations, or --set speed=50 (km an hour) for great circles between the coordinates"
            raise InputError("matrices are missing, and no server is asked for travel times", "missing", expected=expected)
        size, matrices = -1, {}
        for profile, item in profiles.items():
            where = f"matrices.{label(profile)}"
            fields(item, where, ("durations", "distances", "costs"), ("durations",))
            size = len(array(item["durations"], f"{where}.durations")) if size < 0 else size
            matrices[profile] = {key: square(item[key], f"{where}.{key}", size) for key in item}
    for profile, item in matrices.items():
        for key, matrix in item.items():
            if (matrix < 0).any():
                message = f"{key} of profile {label(profile)} hold a negative number"
                raise InputError(message, "out-of-range", expected="0 or more", found=f"{matrix.min():g}")
    if size < 1:
        raise InputError("matrices are empty", "missing", expected="a row for each location")
    return matrices


def _known(data: Any, path: str, known: Collection[str], required: Collection[str] = ()) -> Mapping[str, Any]:
    """``fields``, without any key that the data have no place for."""
    fields(data, path, known, required)
    for key, nothing in LACKING.items():
        if key in data and data[key] != nothing:
            cure = f", or --set ignore={key} to plan without" if key in IGNORED else ""
            raise InputError(f"{path}.{key} is not supported", "unsupported", expected=f"no {key}{cure}")
    return data  # type: ignore[no-any-return]


def _place(data: Mapping[str, Any], key: str, path: str, size: int) -> int:
    if key not in data:
        raise InputError(f"{path} lacks the key {key!r}", "missing", expected="a row of the matrices: no server is asked for travel times")
    place = integer(data[key], f"{path}.{key}", 0)
    if place >= size:
        raise InputError(f"{path}.{key} is no row of the matrices", "unknown-name", expected=f"0 to {size - 1}", found=str(place))
    return place


def _window(data: Any, path: str) -> tuple[float, float]:
    opens, closes = (float(integer(v, f"{path}[{k}]", 0)) for k, v in enumerate(array(data, path, 2)))
    if opens > closes:
        message = f"{path} closes before it opens"
        raise InputError(message, "contradiction", expected="a begin and a later end", found=f"{opens:g}, {closes:g}")
    return opens, closes


def _amounts(data: Mapping[str, Any], key: str, path: str) -> list[int]:
    return [integer(v, f"{path}.{key}[{k}]", 0) for k, v in enumerate(array(data.get(key, []), f"{path}.{key}"))]


def _skills(data: Mapping[str, Any], path: str) -> frozenset[str]:
    return frozenset(str(integer(v, f"{path}.skills[{k}]", 0)) for k, v in enumerate(array(data.get("skills", []), f"{path}.skills")))


def _priority(data: Mapping[str, Any], path: str) -> int:
    value = integer(data.get("priority", 0), f"{path}.priority", 0)
    if value > 100:
        raise InputError(f"{path}.priority is too large", "out-of-range", expected="0 to 100", found=str(value))
    return value


def _vehicle(item: Any, path: str, matrices: Mapping[str, Mapping[str, Floats]], size: int) -> _Vehicle:
    data = _known(item, path, VEHICLE, ("id",))
    profile = data.get("profile", "car")
    if not isinstance(profile, str) or profile not in matrices:
        expected = ", ".join(label(name) for name in matrices)
        raise InputError(f"{path}.profile has no matrices", "unknown-name", expected=expected, found=kind_of(profile))
    ends: dict[str, int | None] = {}
    places: dict[int, tuple[float, float]] = {}
    for key in ("start", "end"):
        ends[key] = place = _place(data, f"{key}_index", path, size) if {key, f"{key}_index"} & data.keys() else None
        if place is not None and (at := location_of(data, key, path)) is not None:
            places[place] = at
    if ends["start"] is None and ends["end"] is None:
        raise InputError(f"{path} neither starts nor ends anywhere", "missing", expected="start_index or end_index")
    costs = _known(data.get("costs", {}), f"{path}.costs", COSTS)
    fixed, per_hour, per_km = (
        real(costs.get(key, default), f"{path}.costs.{key}") for key, default in (("fixed", 0), ("per_hour", 3600), ("per_km", 0))
    )
    own = matrices[profile]
    if "costs" in own and {"per_hour", "per_km"} & costs.keys():
        raise InputError(f"{path}.costs stand beside costs of profile {label(profile)}", "contradiction", expected="one of them")
    if per_km and "distances" not in own:
        raise InputError(f"{path}.costs.per_km needs distances of profile {label(profile)}", "missing")
    speed = real(data.get("speed_factor", 1), f"{path}.speed_factor")
    if not 0 < speed <= 5:
        raise InputError(f"{path}.speed_factor is out of range", "out-of-range", expected="above 0, at most 5", found=f"{speed:g}")
    limits = ("max_travel_time", "max_distance")
    travel_time, distance = (float(integer(data[key], f"{path}.{key}", 0)) if key in data else math.inf for key in limits)
    if math.isfinite(distance) and (per_hour or not per_km or "costs" in own):
        message = f"{path}.max_distance is not supported where costs are not by distance alone"
        raise InputError(message, "unsupported", expected="costs per_km, and per_hour 0")
    number, capacity, skills = integer(data["id"], f"{path}.id", 0), tuple(_amounts(data, "capacity", path)), _skills(data, path)
    shift = _window(data["time_window"], f"{path}.time_window") if "time_window" in data else (-math.inf, math.inf)
    kind = _Kind(profile, ends["start"], ends["end"], capacity, skills, shift, speed, travel_time, distance, fixed, per_hour, per_km)
    return _Vehicle(number, kind, places)


def _depots(vehicles: Sequence[_Vehicle]) -> list[_Site]:
    depots: dict[int | None, _Site] = {}
    at = {place: xy for v in vehicles for place, xy in v.places.items()}
    for vehicle in vehicles:
        for place in (vehicle.kind.start, vehicle.kind.end):
            location = None if place is None else at.get(place)
            depots.setdefault(place, _Site(_depot_name(place), place, depot=True, location=location))
    return list(depots.values())


def _depot_name(place: int | None) -> str:
    return ANYWHERE if place is None else f"location {place}"


def _task(data: Mapping[str, Any], name: str, path: str, size: int) -> _Site:
    place = _place(data, "location_index", path, size)
    listed = array(data.get("time_windows", []), f"{path}.time_windows")
    if "time_windows" in data and not listed:
        raise InputError(f"{path}.time_windows is empty", "missing", expected="at least one window")
    windows = [_window(w, f"{path}.time_windows[{k}]") for k, w in enumerate(listed)]
    for k, (before, after) in enumerate(itertools.pairwise(windows), start=1):
        if after[0] <= before[1]:
            message = f"{path}.time_windows[{k}] begins before the one before it ends"
            raise InputError(message, "contradiction", expected="windows in order and apart")
    service = float(integer(data.get("service", 0), f"{path}.service", 0))
    return _Site(name, place, service=service, windows=windows, location=location_of(data, "location", path))


def _tasks(data: Mapping[str, Any], size: int) -> tuple[list[_Site], list[tuple[str, str, Sequence[int]]]]:
    """Sites of jobs and shipments, and the ids of both ends and the load of each shipment."""
    sites: list[_Site] = []
    shipments: list[tuple[str, str, Sequence[int]]] = []
    for k, item in enumerate(array(data.get("jobs", []), "jobs")):
        path = f"jobs[{k}]"
        job = _known(item, path, JOB, ("id",))
        site = _task(job, str(integer(job["id"], f"{path}.id", 0)), path, size)
        amounts = [_amounts(job, key, path) for key in ("delivery", "pickup")]
        if all(amounts) and len(amounts[0]) != len(amounts[1]):
            message = f"{path} delivers and picks up different numbers of loads"
            raise InputError(message, "wrong-shape", expected=str(len(amounts[0])), found=str(len(amounts[1])))
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
        raise InputError("there is nothing to do", "missing", expected="jobs or shipments")
    _refuse_equal([site.id for site in sites], "tasks")
    return sites, shipments


def _refuse_equal(ids: Sequence[object], what: str) -> None:
    seen: set[object] = set()
    for each in ids:
        if each in seen:
            raise InputError(f"two {what} have the id {each}", "duplicate", expected="different ids")
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
    types: dict[_Kind, list[int]] = {}
    for vehicle in vehicles:
        types.setdefault(vehicle.kind, []).append(vehicle.id)
    ways = [_travel(kind, matrices[kind.profile], places) for kind in types]
    shared, common, _ = ways[0]
    fleet = tuple(
        VehicleType(
            len(numbers), float(kind.capacity[0]) if kind.capacity else math.inf, index[_depot_name(kind.start)],
            index[_depot_name(kind.end)], max_distance=kind.longest_distance,
            energy=Energy(kind.longest_travel) if math.isfinite(kind.longest_travel) else None, fixed_cost=kind.fixed, unit_cost=unit,
            name=f"vehicle {' '.join(map(str, numbers))}", further_capacity=tuple(map(float, kind.capacity[1:])), shift=kind.shift,
            skills=kind.skills, travel=None if key == shared else travel,
        )
        for (kind, numbers), (key, travel, unit) in zip(types.items(), ways, strict=True)
    )  # fmt: skip
    instance = RoutingInstance(name, "vroom", sites, common, fleet, problem=PROBLEMS[0], problems=PROBLEMS, objective=OBJECTIVE)
    refuse_unreachable(instance)
    return instance


def _travel(kind: _Kind, own: Mapping[str, Floats], places: Sequence[int | None]) -> tuple[tuple[Any, ...], Travel, float]:
    """A key that is equal for equal travel, the travel between sites, and the cost of one unit of its distance."""
    durations = own["durations"] / kind.speed
    if "costs" in own:
        how, distances, unit = "costs", own["costs"], 1.0
    elif not kind.per_km:
        how, distances, unit = "durations", durations, kind.per_hour / 3600
    elif not kind.per_hour:
        how, distances, unit = "distances", own["distances"], kind.per_km / 1000
    else:
        how, unit = f"{kind.per_hour} {kind.per_km}", 1.0
        distances = durations * (kind.per_hour / 3600) + own["distances"] * (kind.per_km / 1000)
    lengths, taken = _between(distances, places), None if how == "durations" else _between(durations, places)
    return (kind.profile, kind.speed, how), Travel(EXPLICIT, matrix=lengths, duration_matrix=taken), unit


def _between(matrix: Floats, places: Sequence[int | None]) -> Floats:
    """The matrix between sites; nothing from and to anywhere."""
    at = np.array([0 if place is None else place for place in places])
    nowhere = np.array([place is None for place in places])
    between: Floats = matrix[np.ix_(at, at)]
    between[nowhere] = 0.0
    between[:, nowhere] = 0.0
    return between


FORMATS.enter(
    Format(
        "vroom", "VROOM's JSON (jobs, shipments, vehicles, matrices)", recognises, read, write, (), PROBLEMS[0], PROBLEMS,
        solutions=(".json", ".sol", ".tour", ".vroom"), settings=SETTINGS,
    )
)  # fmt: skip
