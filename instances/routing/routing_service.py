"""Tables of distances and durations as routing services answer them: OSRM's ``table`` and Valhalla's ``sources_to_targets``.

OSRM: ``distances`` in metres, ``durations`` in seconds, null where there is no way. Valhalla: a list of ``distance`` in ``units``
(kilometres or miles) and ``time`` in seconds. Sources and destinations must be the sites, all of them in their order.

Source: OSRM API documentation, "Table service"; Valhalla documentation, "Matrix service".
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from ..clock import SECONDS
from ..document import kind_of, parse_json
from ..errors import InputError, UsageError
from ..number_arrays import Floats
from ..suggestions import did_you_mean
from ..text import read_text
from .travel import UNITS_OF_DISTANCE


@dataclass(frozen=True, eq=False)
class ServiceTable:
    """Answer of a service: metres and seconds between all sites, infinite where it knows no way; at least one of them is given."""

    service: str
    metres: Floats | None
    seconds: Floats | None

    def in_units(self, distance: str, time: str | None) -> tuple[Floats, Floats | None, tuple[str, ...]]:
        """Distances, durations and notes on them, in these units; costs are durations where there are no distances."""
        unit = "s" if time is None else time
        durations = None if self.seconds is None else self.seconds / SECONDS[unit]
        if self.metres is None:
            assert durations is not None
            return durations, None, (f"{self.service} told no distances: what routes cost is their time on the move, in {unit}",)
        note = f"distances by {self.service} in {distance}" + (f", durations in {unit}" if durations is not None else "")
        return self.metres / 1000.0 * UNITS_OF_DISTANCE[distance], durations, (note,)


def unit_of_distance(name: str) -> str:
    """``name``, if it is a unit of distance."""
    if name not in UNITS_OF_DISTANCE:
        message = f"unknown unit of distance {name!r}; choose from {', '.join(UNITS_OF_DISTANCE)}{did_you_mean(name, UNITS_OF_DISTANCE)}"
        raise UsageError(message, "unknown-name")
    return name


def is_table(data: Any) -> bool:
    """True if a document is meant as such a table."""
    return isinstance(data, Mapping) and bool({"sources_to_targets", "durations", "distances"} & data.keys())


def table_from_file(path: str | PathLike[str]) -> ServiceTable:
    """The table in a JSON file; an InputError names the file."""
    try:
        return table_of(parse_json(read_text(path)))
    except InputError as error:
        raise error.at(file=path) from None


def table_of(data: Any) -> ServiceTable:
    """The table in a parsed answer; InputError for anything else."""
    if not isinstance(data, Mapping):
        raise InputError("is no table of a routing service", expected="an object", found=kind_of(data))
    if data.get("code", "Ok") != "Ok" or "error" in data:
        said = data.get("message", data.get("error", data.get("code")))
        raise InputError("the routing service found no table", "missing", found=str(said)[:80])
    if not is_table(data):
        raise InputError("is no table of a routing service", expected="distances or durations (OSRM), or sources_to_targets (Valhalla)",
                         found=", ".join(map(str, data))[:80] or "an empty object")  # fmt: skip
    if "sources_to_targets" in data:
        return _valhalla(data)
    metres, seconds = (_square(data.get(key), key) for key in ("distances", "durations"))
    return ServiceTable("OSRM", metres, seconds)


def _valhalla(data: Mapping[str, Any]) -> ServiceTable:
    units = str(data.get("units", "kilometers"))
    factor = {"kilometers": 1000.0, "km": 1000.0, "miles": 1609.344, "mi": 1609.344}.get(units)
    if factor is None:
        raise InputError("units of the table are unknown", "unknown-name", expected="kilometers or miles", found=units[:40])
    answer = data["sources_to_targets"]
    if isinstance(answer, Mapping):  # the terse form
        metres, seconds = _square(answer.get("distances"), "distances"), _square(answer.get("durations"), "durations")
    elif isinstance(answer, list) and all(isinstance(row, list) and all(isinstance(c, Mapping) for c in row) for row in answer):
        metres = _square([[cell.get("distance") for cell in row] for row in answer], "distance")
        seconds = _square([[cell.get("time") for cell in row] for row in answer], "time")
    else:
        raise InputError("sources_to_targets must be lists of objects", expected='{"distance": ..., "time": ...}', found=kind_of(answer))
    if metres is None and seconds is None:
        raise InputError("sources_to_targets holds neither distances nor times", "missing")
    return ServiceTable("Valhalla", None if metres is None else metres * factor, seconds)


def _square(rows: Any, what: str) -> Floats | None:
    if rows is None:
        return None
    if not isinstance(rows, list) or not all(isinstance(row, list) for row in rows):
        raise InputError(f"{what} of the table must be a list of lists", found=kind_of(rows))
    n = len(rows)
    for k, row in enumerate(rows):
        if len(row) != n:
            message = f"{what}[{k}] of the table has a wrong length: sources and destinations must be the same sites"
            raise InputError(message, "wrong-shape", expected=str(n), found=str(len(row)))
        for j, value in enumerate(row):
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if value is not None and not (number and value >= 0):
                message = f"{what}[{k}][{j}] of the table must be a number that is not negative, or null"
                raise InputError(message, "out-of-range" if number else "malformed", found=str(value)[:40])
    return np.array([[math.inf if value is None else value for value in row] for row in rows], dtype=np.float64).reshape(n, n)
