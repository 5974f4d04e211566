"""Vehicle types from a frame, one row per type, or from mappings with the keys of waybound's JSON."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from ..clock import Times
from ..document import fields, json_numbers
from ..errors import InputError
from ..number_arrays import Flags
from .foreign_names import hint
from .frame_columns import id_text, words_of
from .frame_lists import placed
from .frame_travel import matrix_of, without_infinities
from .json_vehicles import TRAVEL_KEYS, VEHICLE_KEYS, decode_travel, decode_vehicle
from .sites import Sites
from .travel import EXPLICIT, Travel
from .vehicle_type import VehicleType

SPANS = ("max_duration", "regular_duration")
SHIFT = ("shift_start", "shift_end")
FURTHER = tuple(f"capacity{k}" for k in range(2, 10))
WORDS = ("skills", "reloads")
ENDS = ("start", "end")
MEANT = {"start": "the first depot", "end": "a return to the start"}
"""Values of a vehicle that has no such key."""


def fleet_of(fleet: Any, sites: Sites, times: Times) -> tuple[VehicleType, ...]:
    """Vehicle types of a frame, one row per type, or of a list of mappings and ``VehicleType``.

    A frame without ``count`` has one vehicle per row, ``inf`` or ``unlimited`` stands for any number; ``shift_start, shift_end`` and
    ``capacity2, ...`` stand for lists. ``times`` reads ``max_duration, regular_duration`` and shifts.
    """
    framed = hasattr(fleet, "columns")
    rows = _rows(fleet) if framed else list(fleet)
    index, kinds = sites.index(), []
    for k, row in enumerate(rows):
        path = f"fleet[{k}]"
        if isinstance(row, VehicleType):
            kinds.append(row)
            continue
        if not isinstance(row, Mapping):
            raise InputError(f"{path} must be a mapping or a VehicleType", found=type(row).__name__)
        with placed(fleet, k):
            if framed and "count" in row:
                row = {**row, "count": _count(row["count"], f"{path}.count")}
            travel, shut = _own_travel(row.get("travel"), sites, times, f"{path}.travel")
            keys = _json_keys({key: value for key, value in row.items() if key != "travel"}, path, times)
            keys.setdefault("name", f"vehicle {k + 1}" if len(rows) > 1 else "vehicle")
            if framed and "count" not in fleet.columns:
                keys.setdefault("count", 1)
            kinds.append(_travelling(decode_vehicle(keys, path, index, sites), travel, shut, sites))
    names = [v.name for v in kinds]
    if len(set(names)) < len(names):
        with placed(fleet, next(k for k, name in enumerate(names) if name in names[:k])):
            raise InputError("vehicle types must have different names", "duplicate", found=", ".join(names))
    return tuple(kinds)


def _own_travel(travel: Any, sites: Sites, times: Times, path: str) -> tuple[Travel | None, Flags | None]:
    """Distances and durations of one type of vehicle, None where it has no own ones, and the moves that it cannot make.

    ``travel`` is a matrix as of ``from_frame``, the name of a metric, a ``Travel``, or a mapping as in JSON with matrices of any kind.
    """
    if travel is None or (isinstance(travel, float) and math.isnan(travel)):
        return None, None
    if isinstance(travel, Travel):
        return travel, None
    whole = {"metric": travel} if isinstance(travel, str) else {"metric": EXPLICIT, "matrix": travel}
    data: dict[str, Any] = dict(travel) if isinstance(travel, Mapping) else whole
    fields(data, path, TRAVEL_KEYS, ("metric",))
    known = (("matrix", "distance", None), ("durations", "duration", times), ("variances", "variance", None))
    try:
        read = {key: matrix_of(data[key], sites.ids, what, clock) for key, what, clock in known if data.get(key) is not None}
    except InputError as error:
        raise InputError(f"{path}: {error.message}", error.code, expected=error.expected, found=error.found) from None
    shut = None
    if read.keys() & {"matrix", "durations"}:
        matrix, durations, shut = without_infinities(read.get("matrix", np.zeros((len(sites),) * 2)), read.get("durations"))
        read |= {key: values for key, values in (("matrix", matrix), ("durations", durations)) if key in read and values is not None}
    closing = data.get("closing")
    if closing is not None and not isinstance(closing, list):
        data["closing"] = [json_numbers(row) for row in np.asarray(closing, dtype=np.float64)]
    return decode_travel({**data, **{key: values.tolist() for key, values in read.items()}}, sites, "", path), shut


def _travelling(vehicle: VehicleType, travel: Travel | None, shut: Flags | None, sites: Sites) -> VehicleType:
    """The vehicle type with its travel; a move that it cannot make has closed before it can set out."""
    if travel is None or shut is None:
        return vehicle if travel is None else replace(vehicle, travel=travel)
    opens = max(float(sites.ready[vehicle.start]), vehicle.shift[0])
    closes = np.full(shut.shape, math.inf) if travel.closing is None else travel.closing.copy()
    closes[shut] = opens - max(1.0, abs(opens))
    return replace(vehicle, travel=replace(travel, closing=closes))


def shared_bans(kinds: tuple[VehicleType, ...], forbidden: Flags | None, sites: Sites) -> tuple[tuple[VehicleType, ...], Flags | None]:
    """The types without the moves that none of them can make, and these moves forbidden to all, which more methods understand."""
    shut = [
        None if v.travel is None or v.travel.closing is None else v.travel.closing < max(float(sites.ready[v.start]), v.shift[0])
        for v in kinds
    ]
    if any(each is None for each in shut):
        return kinds, forbidden
    common = np.logical_and.reduce([each for each in shut if each is not None])
    others = []
    for v in kinds:
        assert v.travel is not None and v.travel.closing is not None
        closes = np.where(common, math.inf, v.travel.closing)
        others.append(replace(v, travel=replace(v.travel, closing=closes if np.isfinite(closes).any() else None)))
    return tuple(others), common if forbidden is None else common | forbidden


def entries_of(fleet: Any) -> Any:
    """The fleet as a frame, or as a list of its entries; None for none."""
    if fleet is None or hasattr(fleet, "columns"):
        return fleet
    if isinstance(fleet, str | bytes | PathLike | Mapping) or not isinstance(fleet, Iterable):
        found = f"one {'mapping' if isinstance(fleet, Mapping) else type(fleet).__name__}: {fleet!r}"[:100]
        expected = "[{'capacity': 5}], one entry a type, or pandas.read_csv(file)"
        raise InputError("fleet must be a frame or a list", expected=expected, found=found)
    return list(fleet)


def see_times(fleet: Any, times: Times) -> None:
    """Let the moments of shifts count for the origin of time."""
    if hasattr(fleet, "columns"):
        for title in (*SHIFT, "shift"):
            if title in fleet.columns:
                times.see(fleet[title])
    elif isinstance(fleet, Sequence):
        for row in fleet:
            if isinstance(row, Mapping):
                times.see([row[key] for key in (*SHIFT, "shift") if key in row])


def _rows(frame: Any) -> list[dict[str, Any]]:
    import pandas as pd

    known = (*VEHICLE_KEYS, *SHIFT, *FURTHER)
    with placed(frame):
        for title in frame.columns:
            if title not in known:
                message = f"the fleet has an unknown column {str(title)!r}{hint(str(title), 'fleet', known)}"
                raise InputError(message, "unknown-name", expected=", ".join((*VEHICLE_KEYS, *SHIFT)))
    rows: list[dict[str, Any]] = frame.to_dict("records")
    if "name" not in frame.columns and not isinstance(frame.index, pd.RangeIndex):
        for name, row in zip(frame.index.tolist(), rows, strict=True):
            row["name"] = str(name)
    return rows


def _count(value: Any, path: str) -> Any:
    """The number of vehicles in a row. An empty cell is refused: it could mean one vehicle, or any number."""
    if isinstance(value, str):
        text = value.strip().casefold()
        return math.inf if text in ("inf", "unlimited") else int(text) if text.isdecimal() else value
    if plain_value(value) is None and value != math.inf:
        message = f"{path} is missing"
        raise InputError(message, "missing", expected="a number, unlimited or inf for any number, or no column 'count' for 1 each")
    return value


def _json_keys(row: Mapping[Any, Any], path: str, times: Times) -> dict[str, Any]:
    """A row as JSON has it: missing values and infinite limits left out, times as numbers."""
    keys: dict[str, Any] = {}
    for key, value in ((str(key), value) for key, value in row.items()):
        what = f"{path}.{key}"
        if key in SPANS:
            keys[key] = times.span(value, what)
        elif key in SHIFT:
            keys[key] = times.moment(value, what)
        elif key == "shift" and isinstance(value, Sequence) and not isinstance(value, str):
            keys[key] = [times.moment(moment, what) for moment in value]
        elif key in ENDS and plain_value(value) is None:
            # Other tools mean an open end; here it was the first depot, and neither is said.
            usual = f"a depot, or no {key!r} at all for {MEANT[key]}"
            message = f"{what} is missing"
            raise InputError(message, "missing", expected=f"{usual}; an open end is a depot of its own, at distance 0 from all sites")
        else:
            keys[key] = words_of(value, what) if key in WORDS and isinstance(value, str) else value
    keys = {key: plain for key, value in keys.items() if (plain := plain_value(value)) is not None}
    if keys.keys() & set(SHIFT):
        if "shift" in keys:
            raise InputError(f"{path} tells its shift twice", "duplicate", expected="shift, or shift_start and shift_end")
        keys["shift"] = [keys.pop(key, None) for key in SHIFT]
    loads = [keys.pop(key, None) for key in FURTHER]
    while loads and loads[-1] is None:
        del loads[-1]
    if loads:
        keys["capacity"] = [keys.get("capacity"), *loads]
    if isinstance(keys.get("energy"), int | float):
        keys["energy"] = {"capacity": keys["energy"]}
    for key in ("count", "max_reloads"):
        if isinstance(keys.get(key), float) and keys[key].is_integer():
            keys[key] = int(keys[key])
    keys |= {key: id_text(keys[key]) for key in (*ENDS, "name") if key in keys}
    if "reloads" in keys:
        keys["reloads"] = [str(site) for site in keys["reloads"]]
    unknown = next((key for key in keys if key not in VEHICLE_KEYS), None)
    if unknown is not None:
        message = f"{path} has an unknown key {unknown!r}{hint(unknown, 'fleet', VEHICLE_KEYS)}"
        raise InputError(message, "unknown-name", expected=", ".join(VEHICLE_KEYS))
    return keys


def plain_value(value: Any) -> Any:
    """A value of a frame as one of JSON; None where it is missing or no limit."""
    import pandas as pd

    if hasattr(value, "tolist"):
        value = value.tolist()
    if value is pd.NA or value is pd.NaT:
        return None
    if isinstance(value, float) and not -math.inf < value < math.inf:
        if value == -math.inf:
            raise InputError("a number of the fleet is minus infinity", "out-of-range", expected="a number of at least 0")
        return None
    if isinstance(value, Mapping):  # a store, whose limits stay what they are
        return {key: inner.tolist() if hasattr(inner, "tolist") else _listed(inner) for key, inner in value.items()}
    if isinstance(value, tuple | set | frozenset):
        value = sorted(value) if not isinstance(value, tuple) else list(value)
    return [plain_value(v) for v in value] if isinstance(value, list) else value


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
