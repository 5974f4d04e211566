"""Settings of ``--set`` for VROOM's files: a speed where they have no matrices, and keys to leave out."""

import copy
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...document import array, real
from ...errors import InputError
from ..travel import Travel

SETTINGS = ("speed", "ignore")
IGNORED = ("setup", "breaks", "max_tasks", "steps")
"""Keys that may be left out, if the user says so: without them more plans are allowed."""
PARTS = ("vehicles", "jobs", "shipments")


def location_of(data: Mapping[str, Any], key: str, path: str) -> tuple[float, float] | None:
    """Longitude and latitude under ``key``, in degrees; None if the key is missing or null."""
    if data.get(key) is None:
        return None
    x, y = (real(v, f"{path}.{key}[{k}]") for k, v in enumerate(array(data[key], f"{path}.{key}", 2)))
    return x, y


def _objects(data: Any, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """All objects within lists and objects, each with its path."""
    if isinstance(data, dict):
        yield path, data
    inside = list(data.items()) if isinstance(data, dict) else list(enumerate(data)) if isinstance(data, list) else []
    for key, value in inside:
        yield from _objects(value, f"{path}[{key}]" if isinstance(key, int) else f"{path}.{key}")


def _parts(data: Mapping[str, Any]) -> list[tuple[str, dict[str, Any]]]:
    return [each for part in PARTS for each in _objects(data.get(part), part)]


def without(data: Mapping[str, Any], ignore: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    """The document without the keys ``ignore`` (names with commas between, or a list of them), and notes on what was left out."""
    names = [name.strip() for name in ignore.split(",")] if isinstance(ignore, str) else [str(name) for name in ignore]
    strange = next((name for name in names if name not in IGNORED), None)
    if strange is not None:
        raise InputError(f"ignore={strange} names nothing that may be left out", "unknown-name", expected=", ".join(IGNORED))
    rest, notes = {key: copy.deepcopy(value) if key in PARTS else value for key, value in data.items()}, []
    for name in names:
        where = [path for path, held in _parts(rest) if held.pop(name, None)]
        if where:
            notes.append(f"{name} left out, as was asked for: {where[0]}{f' and {len(where) - 1} more' if len(where) > 1 else ''}")
    return rest, tuple(notes)


def on_the_globe(data: Mapping[str, Any], speed: Any) -> tuple[dict[str, Any], tuple[str, ...]]:
    """The document with matrices of great circles between its coordinates, in metres and in seconds at ``speed`` km an hour; and a note."""
    if "matrix" in data or "matrices" in data:
        raise InputError("speed stands beside matrices, which tell the durations", "contradiction", expected="one of them")
    try:
        fast = float(speed)
    except (TypeError, ValueError):
        fast = math.nan
    if not 0.0 < fast < math.inf:
        raise InputError("speed must be positive and finite", "out-of-range", expected="speed=50 (km an hour)", found=str(speed))
    located = {key: copy.deepcopy(value) if key in PARTS else value for key, value in data.items()}
    rows: dict[tuple[float, float], int] = {}
    for path, held in _parts(located):
        for key in ("start", "end", "location"):
            if f"{key}_index" in held:
                message = f"{path}.{key}_index is a row of matrices that are not there"
                raise InputError(message, "missing", expected=f"{key}, longitude and latitude")
            at = location_of(held, key, path)
            if at is None:
                continue
            if not (abs(at[0]) <= 180.0 and abs(at[1]) <= 90.0):
                place = f"{at[0]:g}, {at[1]:g}"
                raise InputError(f"{path}.{key} is out of range", "out-of-range", expected="longitude and latitude in degrees", found=place)
            held[f"{key}_index"] = rows.setdefault(at, len(rows))
    if not rows:
        raise InputError("there are no coordinates", "missing", expected="start, end and location, longitude and latitude each")
    metres = Travel("haversine-m", coordinates=np.array(list(rows))).distances
    one = {"durations": (metres * (3.6 / fast)).tolist(), "distances": metres.tolist()}
    profiles = {v["profile"] for _, v in _objects(located.get("vehicles"), "vehicles") if isinstance(v.get("profile"), str)}
    note = f"distances are great circles, driven at {fast:g} km an hour"
    return {**located, "matrices": dict.fromkeys((*sorted(profiles), "car"), one)}, (note,)
