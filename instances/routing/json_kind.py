"""Routing instances in waybound's JSON; the keys are documented in ``docs/formats.md``."""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..clock import Clock
from ..document import array, fields, flags, integer, json_number, json_numbers, kind_of, matrix, positions, real, reals, string, strings
from ..errors import InputError, UsageError
from ..kinds import KINDS, Kind
from .instance import Group, RoutingInstance, Shipment, Sites
from .json_vehicles import decode_travel, decode_vehicle, encode_travel, encode_vehicle, site_of, truth
from .reach import refuse_powerless, refuse_unreachable
from .sites import with_unused

KEYS = (
    "name", "problem", "problems", "convention", "sites", "travel", "fleet", "min_vehicles", "team_risk", "objective", "notes", "forbidden",
    "clock",
)  # fmt: skip
SITE_KEYS = (
    "id", "depot", "x", "y", "demand", "pickup", "ready", "due", "windows", "service", "reward", "required", "penalty", "skills",
    "shipments", "groups", "lat", "lon", "attributes",
)  # fmt: skip


def encode(instance: RoutingInstance) -> dict[str, Any]:
    """The keys of a routing instance; columns and keys that hold nothing but defaults are left out."""
    data: dict[str, Any] = {"name": instance.name, "problem": instance.problem}
    if instance.problems != (instance.problem,):
        data["problems"] = list(instance.problems)
    data["convention"] = instance.travel.convention
    data["sites"] = _encode_sites(instance.sites)
    data["travel"] = encode_travel(instance.travel, instance.sites)
    data["fleet"] = [encode_vehicle(vehicle, instance.sites) for vehicle in instance.fleet]
    if instance.min_vehicles:
        data["min_vehicles"] = instance.min_vehicles
    if instance.team_risk is not None:
        data["team_risk"] = json_number(instance.team_risk)
    data |= {key: list(words) for key, words in (("objective", instance.objective), ("notes", instance.notes)) if words}
    if instance.forbidden is not None:
        ids = instance.sites.ids
        data["forbidden"] = [[ids[i], ids[j]] for i, j in np.argwhere(instance.forbidden).tolist()]
    if instance.clock is not None:
        further = {"origin": instance.clock.origin} if instance.clock.origin else {"of-day": True} if instance.clock.of_day else {}
        data["clock"] = {"unit": instance.clock.unit, **further}
    return data


def _encode_sites(sites: Sites) -> dict[str, Any]:
    data: dict[str, Any] = {"id": list(sites.ids), "depot": sites.depot.tolist()}
    if sites.coordinates is not None:
        across, along = ("lon", "lat") if sites.geographic else ("x", "y")
        data[across], data[along] = (json_numbers(column) for column in sites.coordinates.T)
    for name in ("demand", "pickup"):
        loads = np.column_stack([getattr(sites, name), getattr(sites, f"further_{name}")])
        if loads.any() or (name == "demand" and sites.dimensions > 1):
            data[name] = json_numbers(loads[:, 0] if sites.dimensions == 1 else loads)
    plain = {"ready": 0.0, "due": math.inf, "service": 0.0, "reward": 0.0, "penalty": 0.0}
    for name, default in plain.items():
        values = getattr(sites, name)
        if (values != default).any():
            data[name] = json_numbers(values)
    if (sites.required != ~sites.depot).any():
        data["required"] = sites.required.tolist()
    listed: dict[str, Any] = {
        "windows": {sites.ids[k]: [[json_number(a), json_number(b)] for a, b in w] for k, w in enumerate(sites.windows) if w},
        "skills": {sites.ids[k]: sorted(names) for k, names in enumerate(sites.skills) if names},
        "shipments": [_encode_shipment(shipment, sites) for shipment in sites.shipments],
        "groups": [{"sites": [sites.ids[k] for k in group.sites], "required": group.required} for group in sites.groups],
        "attributes": {title: [plain_json(v) for v in values] for title, values in sites.attributes.items()},
    }
    return data | {key: values for key, values in listed.items() if values}


def _encode_shipment(shipment: Shipment, sites: Sites) -> dict[str, Any]:
    load = [json_number(v) for v in shipment.load]
    return {"pickup": sites.ids[shipment.pickup], "delivery": sites.ids[shipment.delivery], "load": load if len(load) > 1 else load[0]}


def decode(data: dict[str, Any]) -> RoutingInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "sites", "travel", "fleet"))
    problem = string(data["problem"], "problem")
    problems = strings(data.get("problems", [problem]), "problems")
    if problem not in problems:
        raise InputError("problems must hold problem", "contradiction", expected=problem, found=", ".join(problems))
    sites = _decode_sites(data["sites"])
    convention = string(data["convention"], "convention") if "convention" in data else ""
    travel = decode_travel(data["travel"], sites, convention)
    index = sites.index()
    fleet = [decode_vehicle(item, f"fleet[{k}]", index, sites) for k, item in enumerate(array(data["fleet"], "fleet"))]
    names = [vehicle.name for vehicle in fleet]
    if len(set(names)) != len(names):
        raise InputError("vehicle types must have different names", "duplicate", found=", ".join(names))
    instance = RoutingInstance(
        string(data["name"], "name"), "json", sites, travel, tuple(fleet), problem=problem, problems=problems,
        min_vehicles=integer(data.get("min_vehicles", 0), "min_vehicles", 0), objective=strings(data.get("objective", []), "objective"),
        notes=with_unused(strings(data.get("notes", []), "notes"), sites.attributes),
        team_risk=None if data.get("team_risk") is None else real(data["team_risk"], "team_risk"),
        forbidden=_forbidden(data["forbidden"], index) if "forbidden" in data else None,
        clock=_clock(data["clock"]) if "clock" in data else None,
    )  # fmt: skip
    refuse_unreachable(instance)
    refuse_powerless(instance)
    return instance


def _forbidden(data: Any, index: dict[str, int]) -> NDArray[np.bool_]:
    moves = np.zeros((len(index), len(index)), dtype=bool)
    for k, pair in enumerate(array(data, "forbidden")):
        tail, head = (site_of(name, f"forbidden[{k}]", index) for name in array(pair, f"forbidden[{k}]", 2))
        moves[tail, head] = True
    return moves


def _clock(data: Any) -> Clock:
    entries = fields(data, "clock", ("unit", "origin", "of-day"), ("unit",))
    of_day = entries.get("of-day", False)
    if not isinstance(of_day, bool):
        raise InputError("clock.of-day must be true or false", found=repr(of_day)[:40])
    try:
        unit = string(entries["unit"], "clock.unit")
        return Clock(unit, string(entries["origin"], "clock.origin") if "origin" in entries else "", of_day)
    except UsageError as error:
        raise InputError(f"clock.unit: {error}", error.code) from None


def _attributes(data: Any, n: int) -> dict[str, Any]:
    columns = fields(data, "sites.attributes", data if isinstance(data, dict) else ())
    for title, values in columns.items():
        string(title, "a key of sites.attributes")
        for k, value in enumerate(array(values, f"sites.attributes.{title}", n)):
            if value is not None and not isinstance(value, bool | int | float | str):
                raise InputError(f"sites.attributes.{title}[{k}] must be a text, a number, true, false or null", found=kind_of(value))
    return dict(columns)


def plain_json(value: Any) -> Any:
    """An attribute as JSON has it."""
    plain = value is None or isinstance(value, bool | int | str) or (isinstance(value, float) and math.isfinite(value))
    return value if plain else str(value)


def _decode_sites(data: Any) -> Sites:
    fields(data, "sites", SITE_KEYS, ("id",))
    ids = strings(data["id"], "sites.id")
    n, index = len(ids), {site: k for k, site in enumerate(ids)}
    columns: dict[str, Any] = {key: read(data[key], f"sites.{key}", n) for key, read in ARRAYS.items() if key in data}
    for key, of_site in OF_SITES.items():
        if key in data:
            held = fields(data[key], f"sites.{key}", data[key] if isinstance(data[key], dict) else ())
            at = [site_of(site, f"a key of sites.{key}", index) for site in held]
            columns[key] = {k: of_site(held[ids[k]], f"sites.{key}.{ids[k]}") for k in at}
    for key, of_item in LISTS.items():
        if key in data:
            items = enumerate(array(data[key], f"sites.{key}"))
            columns[key] = [of_item(item, f"sites.{key}[{k}]", index) for k, item in items]
    at_depot = columns.get("depot", np.arange(n) == 0) & columns.get("required", np.zeros(n, dtype=bool))
    if at_depot.any():
        k = int(np.argmax(at_depot))
        raise InputError(f"sites.required[{k}] asks for a visit to a depot", "contradiction", expected="false", found="true")
    if "attributes" in data:
        columns["attributes"] = _attributes(data["attributes"], n)
    here, there = positions(data, "sites", n), positions(data, "sites", n, ("lon", "lat"))
    if here is not None and there is not None:
        raise InputError("sites have two kinds of coordinates", "contradiction", expected="x and y, or lon and lat")
    return Sites.of(ids, coordinates=there if here is None else here, geographic=there is not None, **columns)


def _loads(data: Any, path: str, n: int) -> Any:
    """One number per site, or one list per site if there are several load dimensions."""
    rows = array(data, path, n)
    if not any(isinstance(row, list) for row in rows):
        return reals(rows, path, n)
    width = len(rows[0]) if isinstance(rows[0], list) else 1
    return matrix(rows, path, n, width)


def _windows(data: Any, path: str) -> list[tuple[float, float]]:
    pairs = [array(pair, f"{path}[{k}]", 2) for k, pair in enumerate(array(data, path))]
    return [(real(a, f"{path}[{k}][0]"), real(b, f"{path}[{k}][1]", null=math.inf)) for k, (a, b) in enumerate(pairs)]


def _shipment(data: Any, path: str, index: dict[str, int]) -> Shipment:
    fields(data, path, ("pickup", "delivery", "load"), ("pickup", "delivery"))
    load = data.get("load", 0)
    loads = [real(v, f"{path}.load") for v in (load if isinstance(load, list) else [load])]
    return Shipment(site_of(data["pickup"], f"{path}.pickup", index), site_of(data["delivery"], f"{path}.delivery", index), tuple(loads))


def _group(data: Any, path: str, index: dict[str, int]) -> Group:
    fields(data, path, ("sites", "required"), ("sites",))
    required = truth(data.get("required", True), f"{path}.required")
    return Group(tuple(site_of(name, f"{path}.sites", index) for name in strings(data["sites"], f"{path}.sites")), required)


ARRAYS: dict[str, Callable[[Any, str, int], Any]] = {
    "demand": _loads, "pickup": _loads, "ready": reals, "service": reals, "reward": reals, "penalty": reals,
    "due": partial(reals, null=math.inf), "depot": flags, "required": flags,
}  # fmt: skip
OF_SITES: dict[str, Callable[[Any, str], Any]] = {"windows": _windows, "skills": strings}
LISTS: dict[str, Callable[[Any, str, dict[str, int]], Any]] = {"shipments": _shipment, "groups": _group}
"""Readers of columns with one entry per site, with entries of some sites by their ids, and of lists."""


KINDS.add("routing", Kind("routing", encode, decode))
