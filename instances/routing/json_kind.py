"""Routing instances in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..document import array, fields, flags, integer, json_number, json_numbers, real, reals, square, string, strings
from ..errors import InputError
from ..kinds import KINDS, Kind
from .instance import Energy, RoutingInstance, Sites, VehicleType
from .reach import refuse_unreachable
from .travel import EXPLICIT, METRICS, Travel

KEYS = ("name", "problem", "problems", "convention", "sites", "travel", "fleet", "min_vehicles", "objective", "notes")
SITE_KEYS = ("id", "depot", "x", "y", "demand", "ready", "due", "service", "reward", "required")
TRAVEL_KEYS = ("metric", "x", "y", "matrix", "durations")
VEHICLE_KEYS = ("name", "count", "capacity", "start", "end", "max_duration", "max_distance", "energy", "fixed_cost", "unit_cost")
ENERGY_KEYS = ("capacity", "rate", "charge")


def encode(instance: RoutingInstance) -> dict[str, Any]:
    """The keys of a routing instance; columns and keys that hold nothing but defaults are left out."""
    data: dict[str, Any] = {"name": instance.name, "problem": instance.problem}
    if instance.problems != (instance.problem,):
        data["problems"] = list(instance.problems)
    data["convention"] = instance.travel.convention
    data["sites"] = _encode_sites(instance.sites)
    data["travel"] = _encode_travel(instance.travel, instance.sites)
    data["fleet"] = [_encode_vehicle(vehicle, instance.sites) for vehicle in instance.fleet]
    if instance.min_vehicles:
        data["min_vehicles"] = instance.min_vehicles
    if instance.objective:
        data["objective"] = list(instance.objective)
    if instance.notes:
        data["notes"] = list(instance.notes)
    return data


def _encode_sites(sites: Sites) -> dict[str, Any]:
    data: dict[str, Any] = {"id": list(sites.ids), "depot": sites.depot.tolist()}
    if sites.coordinates is not None:
        data["x"], data["y"] = (json_numbers(column) for column in sites.coordinates.T)
    plain = {"demand": 0.0, "ready": 0.0, "due": math.inf, "service": 0.0, "reward": 0.0}
    for name, default in plain.items():
        values = getattr(sites, name)
        if (values != default).any():
            data[name] = json_numbers(values)
    if (sites.required != ~sites.depot).any():
        data["required"] = sites.required.tolist()
    return data


def _encode_travel(travel: Travel, sites: Sites) -> dict[str, Any]:
    data: dict[str, Any] = {"metric": travel.metric}
    same = travel.metric != EXPLICIT and sites.coordinates is not None and np.array_equal(travel.coordinates, sites.coordinates)  # type: ignore[arg-type]
    if travel.coordinates is not None and not same:
        data["x"], data["y"] = (json_numbers(column) for column in travel.coordinates.T)
    if travel.matrix is not None:
        data["matrix"] = json_numbers(travel.matrix)
    if travel.duration_matrix is not None:
        data["durations"] = json_numbers(travel.duration_matrix)
    return data


def _encode_vehicle(vehicle: VehicleType, sites: Sites) -> dict[str, Any]:
    data: dict[str, Any] = {
        "name": vehicle.name, "count": vehicle.count, "capacity": json_number(vehicle.capacity),
        "start": sites.ids[vehicle.start], "end": sites.ids[vehicle.end],
    }  # fmt: skip
    for key in ("max_duration", "max_distance"):
        if math.isfinite(getattr(vehicle, key)):
            data[key] = json_number(getattr(vehicle, key))
    if vehicle.energy is not None:
        data["energy"] = {
            "capacity": json_number(vehicle.energy.capacity), "rate": json_number(vehicle.energy.rate), "charge": vehicle.energy.charge
        }  # fmt: skip
    if vehicle.fixed_cost:
        data["fixed_cost"] = json_number(vehicle.fixed_cost)
    if vehicle.unit_cost != 1.0:
        data["unit_cost"] = json_number(vehicle.unit_cost)
    return data


def decode(data: dict[str, Any]) -> RoutingInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "sites", "travel", "fleet"))
    problem = string(data["problem"], "problem")
    problems = strings(data.get("problems", [problem]), "problems")
    if problem not in problems:
        raise InputError("problems must hold problem", expected=problem, found=", ".join(problems))
    sites = _decode_sites(data["sites"])
    convention = string(data["convention"], "convention") if "convention" in data else ""
    travel = _decode_travel(data["travel"], sites, convention)
    index = sites.index()
    fleet = [_decode_vehicle(item, f"fleet[{k}]", index, sites) for k, item in enumerate(array(data["fleet"], "fleet"))]
    names = [vehicle.name for vehicle in fleet]
    if len(set(names)) != len(names):
        raise InputError("vehicle types must have different names", found=", ".join(names))
    made = RoutingInstance(
        string(data["name"], "name"), "json", sites, travel, tuple(fleet), problem=problem, problems=problems,
        min_vehicles=integer(data.get("min_vehicles", 0), "min_vehicles", 0), objective=strings(data.get("objective", []), "objective"),
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip
    refuse_unreachable(made)
    return made


def _decode_sites(data: Any) -> Sites:
    fields(data, "sites", SITE_KEYS, ("id",))
    ids = strings(data["id"], "sites.id")
    n = len(ids)
    columns: dict[str, Any] = {}
    for key in ("demand", "ready", "service", "reward"):
        if key in data:
            columns[key] = reals(data[key], f"sites.{key}", n)
    if "due" in data:
        columns["due"] = reals(data["due"], "sites.due", n, null=math.inf)
    for key in ("depot", "required"):
        if key in data:
            columns[key] = flags(data[key], f"sites.{key}", n)
    at_depot = columns.get("depot", np.arange(n) == 0) & columns.get("required", np.zeros(n, dtype=bool))
    if at_depot.any():
        k = int(np.argmax(at_depot))
        raise InputError(f"sites.required[{k}] asks for a visit to a depot", expected="false", found="true")
    return Sites.of(ids, coordinates=_coordinates(data, "sites", n), **columns)


def _coordinates(data: Any, path: str, n: int) -> Any:
    given = [key for key in ("x", "y") if key in data]
    if len(given) == 1:
        raise InputError(f"{path} has {given[0]} alone", expected="x and y")
    return np.column_stack([reals(data[key], f"{path}.{key}", n) for key in given]) if given else None


def _decode_travel(data: Any, sites: Sites, convention: str) -> Travel:
    fields(data, "travel", TRAVEL_KEYS, ("metric",))
    metric, n = string(data["metric"], "travel.metric"), len(sites)
    if metric not in (*METRICS, EXPLICIT):
        raise InputError("travel.metric is unknown", expected=", ".join((*METRICS, EXPLICIT)), found=metric)
    if (metric == EXPLICIT) != ("matrix" in data):
        raise InputError(f"travel by {metric} {'needs' if metric == EXPLICIT else 'has no'} matrix")
    own = _coordinates(data, "travel", n)
    if own is None and metric != EXPLICIT:
        own = sites.coordinates
    matrix = square(data["matrix"], "travel.matrix", n) if "matrix" in data else None
    durations = square(data["durations"], "travel.durations", n) if "durations" in data else None
    return Travel(metric, coordinates=own, matrix=matrix, duration_matrix=durations, convention=convention)


def _decode_vehicle(data: Any, path: str, index: dict[str, int], sites: Sites) -> VehicleType:
    fields(data, path, VEHICLE_KEYS)
    first = sites.ids[int(sites.depots[0])]
    ends = []
    for key in ("start", "end"):
        site = string(data.get(key, first), f"{path}.{key}")
        if site not in index:
            raise InputError(f"{path}.{key} names no site", expected="an id of sites.id", found=site)
        ends.append(index[site])
    energy = None
    if data.get("energy") is not None:
        store = fields(data["energy"], f"{path}.energy", ENERGY_KEYS, ("capacity",))
        energy = Energy(
            real(store["capacity"], f"{path}.energy.capacity"), real(store.get("rate", 1.0), f"{path}.energy.rate"),
            string(store.get("charge", "travel"), f"{path}.energy.charge"),
        )  # fmt: skip
    count = data.get("count")
    return VehicleType(
        count=None if count is None else integer(count, f"{path}.count", 1),
        capacity=real(data.get("capacity"), f"{path}.capacity", null=math.inf),
        start=ends[0],
        end=ends[1],
        max_duration=real(data.get("max_duration"), f"{path}.max_duration", null=math.inf),
        max_distance=real(data.get("max_distance"), f"{path}.max_distance", null=math.inf),
        energy=energy,
        fixed_cost=real(data.get("fixed_cost", 0.0), f"{path}.fixed_cost"),
        unit_cost=real(data.get("unit_cost", 1.0), f"{path}.unit_cost"),
        name=string(data.get("name", "vehicle"), f"{path}.name"),
    )


KINDS.add("routing", Kind("routing", encode, decode))
