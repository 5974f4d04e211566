"""Vehicle types from a frame, one row a type, or from mappings with the keys of waybound's JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..clock import Times
from ..document import fields, json_numbers
from ..errors import InputError
from .foreign_names import hint
from .frame_columns import words_of
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


def fleet_of(given: Any, sites: Sites, times: Times) -> tuple[VehicleType, ...]:
    """Vehicle types of a frame, one row a type, or of a list of mappings and ``VehicleType``.

    A frame without ``count`` has one vehicle a row, ``inf`` or ``unlimited`` stands for any number; ``shift_start, shift_end`` and
    ``capacity2, ...`` stand for lists. ``times`` reads ``max_duration, regular_duration`` and shifts.
    """
    framed = hasattr(given, "columns")
    rows = _rows(given) if framed else list(given)
    index, kinds = sites.index(), []
    for k, row in enumerate(rows):
        if isinstance(row, VehicleType):
            kinds.append(row)
            continue
        if not isinstance(row, Mapping):
            raise InputError(f"fleet[{k}] must be a mapping or a VehicleType", found=type(row).__name__)
        with placed(given, k):
            if framed and "count" in row:
                row = {**row, "count": _count(row["count"], f"fleet[{k}].count")}
            own = own_travel(row.get("travel"), sites, times, f"fleet[{k}].travel")
            held = _held({key: value for key, value in row.items() if key != "travel"}, f"fleet[{k}]", times)
            held.setdefault("name", f"vehicle {k + 1}" if len(rows) > 1 else "vehicle")
            if framed and "count" not in given.columns:
                held.setdefault("count", 1)
            kinds.append(_travelling(decode_vehicle(held, f"fleet[{k}]", index, sites), own, sites))
    names = [v.name for v in kinds]
    if len(set(names)) < len(names):
        with placed(given, next(k for k, name in enumerate(names) if name in names[:k])):
            raise InputError("vehicle types must have different names", found=", ".join(names))
    return tuple(kinds)


@dataclass(frozen=True, eq=False)
class OwnTravel:
    """Distances and durations of one type of vehicle, and the moves that it cannot make."""

    travel: Travel
    shut: NDArray[np.bool_] | None = None


def own_travel(given: Any, sites: Sites, times: Times, path: str) -> OwnTravel | None:
    """What a vehicle's ``travel`` tells: a matrix as of ``from_frame``, the name of a metric, a ``Travel``, or a mapping as in JSON with
    matrices of any kind; None where it is missing."""
    if given is None or (isinstance(given, float) and math.isnan(given)):
        return None
    if isinstance(given, Travel):
        return OwnTravel(given)
    whole = {"metric": given} if isinstance(given, str) else {"metric": EXPLICIT, "matrix": given}
    data: dict[str, Any] = dict(given) if isinstance(given, Mapping) else whole
    fields(data, path, TRAVEL_KEYS, ("metric",))
    known = (("matrix", "distance", None), ("durations", "duration", times), ("variances", "variance", None))
    try:
        read = {key: matrix_of(data[key], sites.ids, what, clock) for key, what, clock in known if data.get(key) is not None}
    except InputError as error:
        raise InputError(f"{path}: {error.message}", expected=error.expected, found=error.found) from None
    shut = None
    if read.keys() & {"matrix", "durations"}:
        matrix, durations, shut = without_infinities(read.get("matrix", np.zeros((len(sites),) * 2)), read.get("durations"))
        read |= {key: values for key, values in (("matrix", matrix), ("durations", durations)) if key in read and values is not None}
    closing = data.get("closing")
    if closing is not None and not isinstance(closing, list):
        data["closing"] = [json_numbers(row) for row in np.asarray(closing, dtype=np.float64)]
    return OwnTravel(decode_travel({**data, **{key: values.tolist() for key, values in read.items()}}, sites, "", path), shut)


def _travelling(vehicle: VehicleType, own: OwnTravel | None, sites: Sites) -> VehicleType:
    """The vehicle type with its travel; a move that it cannot make has closed before it can set out."""
    if own is None or own.shut is None:
        return vehicle if own is None else replace(vehicle, travel=own.travel)
    opens = max(float(sites.ready[vehicle.start]), vehicle.shift[0])
    closes = np.full(own.shut.shape, math.inf) if own.travel.closing is None else own.travel.closing.copy()
    closes[own.shut] = opens - max(1.0, abs(opens))
    return replace(vehicle, travel=replace(own.travel, closing=closes))


def shared_bans(
    kinds: tuple[VehicleType, ...], forbidden: NDArray[np.bool_] | None, sites: Sites
) -> tuple[tuple[VehicleType, ...], NDArray[np.bool_] | None]:
    """Moves that no type of vehicle can make are forbidden to the problem, which more methods understand; the types without them."""
    shut = [
        None if v.travel is None or v.travel.closing is None else v.travel.closing < max(float(sites.ready[v.start]), v.shift[0])
        for v in kinds
    ]
    if any(each is None for each in shut):
        return kinds, forbidden
    common = np.logical_and.reduce([each for each in shut if each is not None])
    left = []
    for v in kinds:
        assert v.travel is not None and v.travel.closing is not None
        closes = np.where(common, math.inf, v.travel.closing)
        left.append(replace(v, travel=replace(v.travel, closing=closes if np.isfinite(closes).any() else None)))
    return tuple(left), common if forbidden is None else common | forbidden


def fleet_given(given: Any) -> Any:
    """A frame, or the list of what is given otherwise; None for none."""
    if given is None or hasattr(given, "columns"):
        return given
    if isinstance(given, str | bytes | PathLike | Mapping) or not isinstance(given, Iterable):
        found = f"one {'mapping' if isinstance(given, Mapping) else type(given).__name__}: {given!r}"
        raise InputError("fleet must be a frame or a list", expected="[{'capacity': 5}], one entry a type, or pandas.read_csv(file)",
                         found=found[:100])  # fmt: skip
    return list(given)


def see_times(given: Any, times: Times) -> None:
    """Let the moments of shifts count for the origin of time."""
    if hasattr(given, "columns"):
        for title in (*SHIFT, "shift"):
            if title in given.columns:
                times.see(given[title])
    elif isinstance(given, Sequence):
        for row in given:
            if isinstance(row, Mapping):
                times.see([row[key] for key in (*SHIFT, "shift") if key in row])


def _rows(frame: Any) -> list[dict[str, Any]]:
    import pandas as pd

    known = (*VEHICLE_KEYS, *SHIFT, *FURTHER)
    with placed(frame):
        for title in frame.columns:
            if title not in known:
                told = hint(str(title), "fleet", known)
                raise InputError(f"the fleet has an unknown column {str(title)!r}{told}", expected=", ".join((*VEHICLE_KEYS, *SHIFT)))
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
        raise InputError(f"{path} is missing", expected="a number, unlimited or inf for any number, or no column 'count' for 1 each")
    return value


def _held(row: Mapping[Any, Any], path: str, times: Times) -> dict[str, Any]:
    """A row as JSON has it: missing values and infinite limits left out, times as numbers."""
    held: dict[str, Any] = {}
    for key, value in ((str(key), value) for key, value in row.items()):
        what = f"{path}.{key}"
        if key in SPANS:
            held[key] = times.span(value, what)
        elif key in SHIFT:
            held[key] = times.moment(value, what)
        elif key == "shift" and isinstance(value, Sequence) and not isinstance(value, str):
            held[key] = [times.moment(moment, what) for moment in value]
        elif key in ENDS and plain_value(value) is None:
            # Other tools mean an open end; here it was the first depot, and neither is said.
            raise InputError(
                f"{what} is missing",
                expected=f"a depot, or no {key!r} at all for {MEANT[key]}; an open end is a depot of its own, at distance 0 from all sites",
            )
        elif key in WORDS and isinstance(value, str):
            held[key] = words_of(value, what)
        else:
            held[key] = value
    held = {key: plain for key, value in held.items() if (plain := plain_value(value)) is not None}
    if held.keys() & set(SHIFT):
        if "shift" in held:
            raise InputError(f"{path} tells its shift twice", expected="shift, or shift_start and shift_end")
        held["shift"] = [held.pop(key, None) for key in SHIFT]
    loads = [held.pop(key, None) for key in FURTHER]
    while loads and loads[-1] is None:
        del loads[-1]
    if loads:
        held["capacity"] = [held.get("capacity"), *loads]
    if isinstance(held.get("energy"), int | float):
        held["energy"] = {"capacity": held["energy"]}
    for key in ("count", "max_reloads"):
        if isinstance(held.get(key), float) and held[key].is_integer():
            held[key] = int(held[key])
    for key in ("start", "end", "name"):
        if key in held:
            number = held[key]
            held[key] = str(int(number)) if isinstance(number, float) and number.is_integer() else str(number)
    if "reloads" in held:
        held["reloads"] = [str(site) for site in held["reloads"]]
    unknown = next((key for key in held if key not in VEHICLE_KEYS), None)
    if unknown is not None:
        told = hint(unknown, "fleet", VEHICLE_KEYS)
        raise InputError(f"{path} has an unknown key {unknown!r}{told}", expected=", ".join(VEHICLE_KEYS))
    return held


def plain_value(value: Any) -> Any:
    """A value of a frame as one of JSON; None where it is missing or no limit."""
    import pandas as pd

    if hasattr(value, "tolist"):
        value = value.tolist()
    if value is pd.NA or value is pd.NaT:
        return None
    if isinstance(value, float) and not -math.inf < value < math.inf:
        if value == -math.inf:
            raise InputError("a number of the fleet is minus infinity", expected="a number of at least 0")
        return None
    if isinstance(value, Mapping):  # a store, whose limits stay what they are
        return {key: inner.tolist() if hasattr(inner, "tolist") else _listed(inner) for key, inner in value.items()}
    if isinstance(value, tuple | set | frozenset):
        value = sorted(value) if not isinstance(value, tuple) else list(value)
    return [plain_value(v) for v in value] if isinstance(value, list) else value


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
