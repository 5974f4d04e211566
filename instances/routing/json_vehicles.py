"""Travel and vehicle types in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..document import array, fields, integer, json_number, json_numbers, real, reals, square, string, strings
from ..errors import InputError
from .sites import Sites
from .travel import EXPLICIT, METRICS, Travel
from .vehicle_type import Energy, VehicleType

Floats = NDArray[np.float64]

TRAVEL_KEYS = ("metric", "x", "y", "matrix", "durations", "closing", "variances", "pace", "convention")
VEHICLE_KEYS = (
    "name", "count", "capacity", "start", "end", "max_duration", "max_distance", "energy", "fixed_cost", "unit_cost",
    "unit_duration_cost", "regular_duration", "unit_overtime_cost", "shift", "skills", "speed", "travel", "reloads", "max_reloads",
    "committed", "risk",
)  # fmt: skip
ENERGY_KEYS = ("capacity", "rate", "charge", "stations", "initial")


def encode_travel(travel: Travel, sites: Sites) -> dict[str, Any]:
    """The keys of ``travel``; coordinates are left out where they are those of the sites."""
    data: dict[str, Any] = {"metric": travel.metric}
    same = travel.metric != EXPLICIT and sites.coordinates is not None and np.array_equal(travel.coordinates, sites.coordinates)  # type: ignore[arg-type]
    if travel.coordinates is not None and not same:
        data["x"], data["y"] = (json_numbers(column) for column in travel.coordinates.T)
    if travel.matrix is not None:
        data["matrix"] = json_numbers(travel.matrix)
    if travel.duration_matrix is not None:
        data["durations"] = json_numbers(travel.duration_matrix)
    if travel.closing is not None and np.isfinite(travel.closing).any():
        data["closing"] = [json_numbers(row) for row in travel.closing]
    if travel.variances is not None:
        data["variances"] = json_numbers(travel.variances)
    if travel.pace != 1.0:
        data["pace"] = json_number(travel.pace)
    return data


def decode_travel(data: Any, sites: Sites, convention: str, path: str = "travel") -> Travel:
    """Inverse of ``encode_travel``."""
    fields(data, path, TRAVEL_KEYS, ("metric",))
    metric, n = string(data["metric"], f"{path}.metric"), len(sites)
    if metric not in (*METRICS, EXPLICIT):
        raise InputError(f"{path}.metric is unknown", expected=", ".join((*METRICS, EXPLICIT)), found=metric)
    if (metric == EXPLICIT) != ("matrix" in data):
        raise InputError(f"{path} by {metric} {'needs' if metric == EXPLICIT else 'has no'} matrix")
    if path == "travel" and "convention" in data:
        raise InputError("travel has a convention of its own", expected="the key convention of the document")
    own = decode_coordinates(data, path, n)
    if own is None and metric != EXPLICIT:
        own = sites.coordinates
    matrix = square(data["matrix"], f"{path}.matrix", n) if "matrix" in data else None
    durations, variances = (square(data[key], f"{path}.{key}", n) if key in data else None for key in ("durations", "variances"))
    closing = None
    if "closing" in data:
        rows = array(data["closing"], f"{path}.closing", n)
        closing = np.array([reals(row, f"{path}.closing[{k}]", n, null=math.inf) for k, row in enumerate(rows)])
    convention = string(data["convention"], f"{path}.convention") if "convention" in data else convention
    return Travel(
        metric, coordinates=own, matrix=matrix, duration_matrix=durations, convention=convention, closing=closing, variances=variances,
        pace=real(data.get("pace", 1.0), f"{path}.pace"),
    )  # fmt: skip


def decode_coordinates(data: Any, path: str, n: int, keys: tuple[str, str] = ("x", "y")) -> Floats | None:
    """The two columns ``keys``, of which there are both or none."""
    given = [key for key in keys if key in data]
    if len(given) == 1:
        raise InputError(f"{path} has {given[0]} alone", expected=" and ".join(keys))
    return np.column_stack([reals(data[key], f"{path}.{key}", n) for key in given]) if given else None


def encode_vehicle(vehicle: VehicleType, sites: Sites) -> dict[str, Any]:
    """The keys of a vehicle type; those that hold nothing but defaults are left out."""
    ids = sites.ids
    capacity = json_number(vehicle.capacity) if not vehicle.further_capacity else [json_number(v) for v in vehicle.capacities]
    data: dict[str, Any] = {
        "name": vehicle.name, "count": vehicle.count, "capacity": capacity, "start": ids[vehicle.start], "end": ids[vehicle.end],
    }  # fmt: skip
    for key in ("max_duration", "max_distance", "regular_duration"):
        if math.isfinite(getattr(vehicle, key)):
            data[key] = json_number(getattr(vehicle, key))
    if vehicle.energy is not None:
        data["energy"] = _encode_energy(vehicle.energy, sites)
    for key, default in (("fixed_cost", 0.0), ("unit_cost", 1.0), ("unit_duration_cost", 0.0), ("unit_overtime_cost", 0.0), ("speed", 1.0)):
        if getattr(vehicle, key) != default:
            data[key] = json_number(getattr(vehicle, key))
    if vehicle.shift != (-math.inf, math.inf):
        data["shift"] = [json_number(v) for v in vehicle.shift]
    if vehicle.skills:
        data["skills"] = sorted(vehicle.skills)
    if vehicle.travel is not None:
        data["travel"] = {**encode_travel(vehicle.travel, sites), "convention": vehicle.travel.convention}
    if vehicle.reloads:
        data["reloads"] = [ids[k] for k in vehicle.reloads]
    if vehicle.max_reloads is not None:
        data["max_reloads"] = vehicle.max_reloads
    if vehicle.committed:
        data["committed"] = True
    if vehicle.risk is not None:
        data["risk"] = json_number(vehicle.risk)
    return data


def _encode_energy(energy: Energy, sites: Sites) -> dict[str, Any]:
    data: dict[str, Any] = {"capacity": json_number(energy.capacity), "rate": json_number(energy.rate), "charge": energy.charge}
    if energy.stations:
        data["stations"] = [sites.ids[k] for k in energy.stations]
    if energy.initial is not None:
        data["initial"] = json_number(energy.initial)
    return data


def decode_vehicle(data: Any, path: str, index: dict[str, int], sites: Sites) -> VehicleType:
    """Inverse of ``encode_vehicle``; ``index`` is that of the sites."""
    fields(data, path, VEHICLE_KEYS)
    first = sites.ids[int(sites.depots[0])]

    def site(value: Any, key: str) -> int:
        name = string(value, f"{path}.{key}")
        if name not in index:
            raise InputError(f"{path}.{key} names no site", expected="an id of sites.id", found=name)
        return index[name]

    def places(given: Any, key: str) -> tuple[int, ...]:
        return tuple(site(value, f"{key}[{k}]") for k, value in enumerate(array(given, f"{path}.{key}")))

    def limit(key: str) -> float:
        return real(data.get(key), f"{path}.{key}", null=math.inf)

    def cost(key: str, default: float = 0.0) -> float:
        return real(data.get(key, default), f"{path}.{key}")

    energy = None
    if data.get("energy") is not None:
        store = fields(data["energy"], f"{path}.energy", ENERGY_KEYS, ("capacity",))
        initial = store.get("initial")
        energy = Energy(
            real(store["capacity"], f"{path}.energy.capacity"), real(store.get("rate", 1.0), f"{path}.energy.rate"),
            string(store.get("charge", "travel"), f"{path}.energy.charge"), places(store.get("stations", []), "energy.stations"),
            None if initial is None else real(initial, f"{path}.energy.initial"),
        )  # fmt: skip
    count, most, loads = data.get("count"), data.get("max_reloads"), data.get("capacity")
    if not isinstance(loads, list):
        loads = [loads]
    elif not loads:
        raise InputError(f"{path}.capacity is empty", expected="one number a load dimension")
    capacities = [real(v, f"{path}.capacity", null=math.inf) for v in loads]
    begin, end = array(data.get("shift", [None, None]), f"{path}.shift", 2)
    committed = data.get("committed", False)
    if not isinstance(committed, bool):
        raise InputError(f"{path}.committed must be true or false")
    own, start = data.get("travel"), data.get("start", first)
    return VehicleType(
        count=None if count is None else integer(count, f"{path}.count", 1),
        capacity=capacities[0],
        start=site(start, "start"),
        end=site(data.get("end", start), "end"),
        max_duration=limit("max_duration"),
        max_distance=limit("max_distance"),
        energy=energy,
        fixed_cost=cost("fixed_cost"),
        unit_cost=cost("unit_cost", 1.0),
        name=string(data.get("name", "vehicle"), f"{path}.name"),
        further_capacity=tuple(capacities[1:]),
        unit_duration_cost=cost("unit_duration_cost"),
        regular_duration=limit("regular_duration"),
        unit_overtime_cost=cost("unit_overtime_cost"),
        shift=(real(begin, f"{path}.shift[0]", null=-math.inf), real(end, f"{path}.shift[1]", null=math.inf)),
        skills=frozenset(strings(data.get("skills", []), f"{path}.skills")),
        speed=cost("speed", 1.0),
        travel=None if own is None else decode_travel(own, sites, "", f"{path}.travel"),
        reloads=places(data.get("reloads", []), "reloads"),
        max_reloads=None if most is None else integer(most, f"{path}.max_reloads", 0),
        committed=committed,
        risk=optional_real(data, "risk", f"{path}."),
    )


def optional_real(data: dict[str, Any], key: str, path: str = "") -> float | None:
    """A number that may be missing or null."""
    return None if data.get(key) is None else real(data[key], f"{path}{key}")
