"""Travel and vehicle types in waybound's JSON; the keys are documented in ``docs/formats.md``."""

import math
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..document import array, fields, integer, json_number, json_numbers, matrix, positions, real, square, string, strings
from ..errors import InputError
from .sites import Sites
from .travel import EXPLICIT, METRICS, Travel
from .vehicle_type import Energy, VehicleType

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
    closing = travel.closing if travel.closing is not None and np.isfinite(travel.closing).any() else None
    matrices = {"matrix": travel.matrix, "durations": travel.duration_matrix, "closing": closing, "variances": travel.variances}
    data |= {key: json_numbers(values) for key, values in matrices.items() if values is not None}
    if travel.pace != 1.0:
        data["pace"] = json_number(travel.pace)
    return data


def decode_travel(data: Any, sites: Sites, convention: str, path: str = "travel") -> Travel:
    """Inverse of ``encode_travel``."""
    fields(data, path, TRAVEL_KEYS, ("metric",))
    metric, n = string(data["metric"], f"{path}.metric"), len(sites)
    if metric not in (*METRICS, EXPLICIT):
        raise InputError(f"{path}.metric is unknown", "unknown-name", expected=", ".join((*METRICS, EXPLICIT)), found=metric)
    if (metric == EXPLICIT) != ("matrix" in data):
        message = f"{path} by {metric} {'needs' if metric == EXPLICIT else 'has no'} matrix"
        raise InputError(message, "missing" if metric == EXPLICIT else "contradiction")
    if path == "travel" and "convention" in data:
        raise InputError("travel has a convention of its own", "contradiction", expected="the key convention of the document")
    own = positions(data, path, n)
    if own is None and metric != EXPLICIT:
        own = sites.coordinates
    distances, durations, variances = (
        square(data[key], f"{path}.{key}", n) if key in data else None for key in ("matrix", "durations", "variances")
    )
    closing = matrix(data["closing"], f"{path}.closing", n, n, null=math.inf) if "closing" in data else None
    convention = string(data["convention"], f"{path}.convention") if "convention" in data else convention
    return Travel(
        metric, coordinates=own, matrix=distances, duration_matrix=durations, convention=convention, closing=closing, variances=variances,
        pace=real(data.get("pace", 1.0), f"{path}.pace"),
    )  # fmt: skip


class Key(NamedTuple):
    """Reader and writer of one key of a vehicle type in JSON; a value that equals the default is not written."""

    default: Any
    read: Callable[[Any, str], Any]
    write: Callable[[Any], Any] = json_number


def _null(read: Callable[..., Any], *further: Any) -> Callable[[Any, str], Any]:
    """``read``, where null stands for None."""
    return lambda data, path: None if data is None else read(data, path, *further)


def truth(data: Any, path: str) -> bool:
    """True or false."""
    if not isinstance(data, bool):
        raise InputError(f"{path} must be true or false")
    return data


def _shift(data: Any, path: str) -> tuple[float, float]:
    begin, end = array(data, path, 2)
    return real(begin, f"{path}[0]", null=-math.inf), real(end, f"{path}[1]", null=math.inf)


LIMIT = Key(math.inf, partial(real, null=math.inf))
COST = Key(0.0, real)
ONE = Key(1.0, real)


def site_of(data: Any, path: str, index: Mapping[str, int]) -> int:
    """Index of the site whose id stands there."""
    name = string(data, path)
    if name not in index:
        raise InputError(f"{path} names no site", "unknown-name", expected="an id of sites.id", found=name)
    return index[name]


def vehicle_keys(sites: Sites, index: Mapping[str, int]) -> dict[str, Key]:
    """Keys of a vehicle type but for its capacity and travel, in the order of JSON."""

    def site(data: Any, path: str) -> int:
        return site_of(data, path, index)

    def places(data: Any, path: str) -> tuple[int, ...]:
        return tuple(site(value, f"{path}[{k}]") for k, value in enumerate(array(data, path)))

    def ids(numbers: Iterable[int]) -> list[str]:
        return [sites.ids[k] for k in numbers]

    energy_keys = {
        "capacity": Key(None, real), "rate": Key(None, real), "charge": Key(None, string, str), "stations": Key((), places, ids),
        "initial": Key(None, _null(real)),
    }  # fmt: skip

    def energy(data: Any, path: str) -> Energy:
        fields(data, path, ENERGY_KEYS, ("capacity",))
        return Energy(**{key: energy_keys[key].read(value, f"{path}.{key}") for key, value in data.items()})

    return {
        "name": Key(None, string, str),
        "count": Key("", _null(integer, 1), lambda count: count),
        "start": Key(None, site, lambda k: sites.ids[k]),
        "end": Key(None, site, lambda k: sites.ids[k]),
        "max_duration": LIMIT,
        "max_distance": LIMIT,
        "regular_duration": LIMIT,
        "energy": Key(None, _null(energy), lambda store: _written(store, energy_keys)),
        "fixed_cost": COST,
        "unit_cost": ONE,
        "unit_duration_cost": COST,
        "unit_overtime_cost": COST,
        "speed": ONE,
        "shift": Key((-math.inf, math.inf), _shift, lambda shift: [json_number(v) for v in shift]),
        "skills": Key(frozenset(), lambda data, path: frozenset(strings(data, path)), sorted),
        "reloads": Key((), places, ids),
        "max_reloads": Key(None, _null(integer, 0), int),
        "committed": Key(False, truth, bool),
        "risk": Key(None, _null(real)),
    }


def _written(value: Any, keys: Mapping[str, Key]) -> dict[str, Any]:
    held = {key: getattr(value, key) for key in keys}
    return {key: keys[key].write(entry) for key, entry in held.items() if entry != keys[key].default}


def encode_vehicle(vehicle: VehicleType, sites: Sites) -> dict[str, Any]:
    """The keys of a vehicle type; those that hold nothing but defaults are left out."""
    data = _written(vehicle, vehicle_keys(sites, {}))
    capacity = json_number(vehicle.capacity) if not vehicle.further_capacity else [json_number(v) for v in vehicle.capacities]
    data = {"name": data.pop("name"), "count": data.pop("count"), "capacity": capacity, **data}
    if vehicle.travel is None:
        return data
    after = {key: data.pop(key) for key in VEHICLE_KEYS[-4:] if key in data}
    return {**data, "travel": {**encode_travel(vehicle.travel, sites), "convention": vehicle.travel.convention}, **after}


def decode_vehicle(data: Any, path: str, index: Mapping[str, int], sites: Sites) -> VehicleType:
    """Inverse of ``encode_vehicle``; ``index`` is that of the sites."""
    fields(data, path, VEHICLE_KEYS)
    values = {key: known.read(data[key], f"{path}.{key}") for key, known in vehicle_keys(sites, index).items() if key in data}
    loads = data.get("capacity")
    if not isinstance(loads, list):
        loads = [loads]
    elif not loads:
        raise InputError(f"{path}.capacity is empty", "missing", expected="one number a load dimension")
    capacity, *further = (real(v, f"{path}.capacity", null=math.inf) for v in loads)
    start = values.setdefault("start", int(sites.depots[0]))
    values.setdefault("end", start)
    travel = decode_travel(data["travel"], sites, "", f"{path}.travel") if data.get("travel") is not None else None
    return VehicleType(**values, capacity=capacity, further_capacity=tuple(further), travel=travel)
