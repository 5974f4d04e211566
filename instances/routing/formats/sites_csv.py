"""Sites from CSV: a frame of sites as text, one row per site, with what it has no place for in comment lines at the top or in ``--set``;
documented in ``docs/formats.md``.

The delimiter is the one of ``, ; | tab`` that occurs most often in the line of titles. Without a column ``depot`` the first
site is the depot. Solution files count customers from 1 in the file's order, depots left out.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...clock import moment_of, span_of
from ...errors import InputError
from ...formats import FORMATS, Format
from ...formats.table import Table, settings_of, table_of, titles_of, written
from ...number_arrays import Floats
from ...text import is_number, number, plain, shown
from ..fleet import equal_fleet
from ..foreign_names import ours
from ..frame_columns import COLUMNS, columns_of, known, mapped, own_title
from ..geography import refuse_alone
from ..instance import RoutingInstance, VehicleType
from ..reach import refuse_unreachable
from ..travel import EXPLICIT, GEOGRAPHIC, convention_named
from ._frame_settings import KEYS as SETTINGS, arguments, flag, in_file, kept, named, of_set
from ._limits import refuse_inexpressible, refuse_where
from ._rows import refuse

WRITTEN = ("demand", "ready", "due", "service", "reward")
LIMITS = {"capacity": "capacity", "max-duration": "max_duration", "max-distance": "max_distance", "fixed-cost": "fixed_cost",
          "unit-cost": "unit_cost"}  # fmt: skip
PLACES = ("x", "y", "lat", "lon")
STATES = ("easting", "northing")
"""Titles of places in tables of states (``risk-states``)."""
NAMES = ("name", "problem", "convention")
KEYS = (*NAMES, *SETTINGS)
EXPRESSIBLE = frozenset(
    {
        "capacity", "demands", "time-windows", "depot-windows", "service-times", "demand-or-service-of-depots", "rewards", "optional-sites",
        "limited-fleet", "min-vehicles", "heterogeneous-fleet", "multiple-depots", "max-duration", "max-distance", "fixed-cost",
        "unit-cost",
    }
)  # fmt: skip


def recognises(text: str) -> bool:
    """True if the first line that is no comment holds titles of coordinates, or ``id``, among others, and no roles."""
    titles = {own if (own := ours(title)) in PLACES and title not in STATES else title for title in titles_of(text)}
    return len(titles) > 1 and ("id" in titles or {"x", "y"} <= titles or bool({"lat", "lon"} & titles)) and "role" not in titles


def read(text: str, path: Path, settings: Mapping[str, Any] | None = None) -> RoutingInstance:
    """The instance; see ``Format.read``. ``settings`` go before those in the file."""
    import pandas as pd

    from ..frames import instance_from_frame

    keys, start = settings_of(text, KEYS, COLUMNS)
    table = table_of(text, start, str, "sites")
    at, n = table.at, len(table.rows)
    own = {key: value for key, value in keys.items() if key not in NAMES}
    given = arguments(own | of_set(settings or {}), path.parent, n)
    if "convention" in keys:
        given["convention"] = named(convention_named, *keys["convention"])
    try:
        mapping = {theirs: title for title, theirs in mapped(table.titles, given.get("columns") or {}).items()}
        meant = [mapping.get(title) or own_title(title) or title for title in table.titles]
        columns = {title: _column(table, k, meant) for k, title in enumerate(table.titles)}
        frame = pd.DataFrame({title: pd.Series(column) for title, column in columns.items()}, index=pd.RangeIndex(n))
        titles = columns_of(frame, given.get("columns"), given.get("extra", ())).titles
        refuse_alone(titles)
    except InputError as error:
        raise in_file(error).at(line=start + 1) from None
    if "depot" in titles and not frame[titles["depot"]].eq(True).any():
        raise InputError("no row is marked as depot", "missing", line=at[-1], expected="at least one true in the column depot")
    if n == (frame[titles["depot"]].eq(True).sum() if "depot" in titles else 1):
        raise InputError("there is no customer", "missing", line=at[-1], expected="a row that is no depot")
    try:
        instance = instance_from_frame(frame, **given, name=keys["name"][1] if "name" in keys else path.stem, source="csv")
    except InputError as error:
        raise in_file(error) from None
    if "problem" in keys:
        line, problem = keys["problem"]
        if problem not in instance.problems:
            message = f"the data do not allow the problem {shown(problem)}"
            raise InputError(message, "contradiction", line=line, expected=", ".join(instance.problems))
        instance = replace(instance, problem=problem)
    refuse_unreachable(instance, at)
    return instance


def _column(table: Table, k: int, meant: list[str]) -> Any:
    """The k-th column, whose title means ``meant[k]``, as numbers, times, flags or texts; a cell that is none is refused with its line."""
    title, cells, at = meant[k], [row[k] for row in table.rows], table.at
    if title in ("id", "node", "skills"):
        return _ids(cells, at) if title == "id" else [cell or None for cell in cells]
    if title in ("required", "depot"):
        return np.array([flag(cell, line, title) for cell, line in zip(cells, at, strict=True)], dtype=object)
    if title in ("ready", "due", "service"):
        if all(is_number(cell) for cell in cells if cell):
            times = np.array([float(cell) if cell else math.nan for cell in cells])
            if title == "service":
                refuse(times < 0, at, "service is negative", times, "0 or more")
            elif title == "due" and "ready" in meant:
                _refuse_closed([row[meant.index("ready")] for row in table.rows], times, at)
            return times
        read = span_of if title == "service" else moment_of
        return np.array([read(cell, line, title) for cell, line in zip(cells, at, strict=True)], dtype=object)
    if title in PLACES:
        return np.array([number(cell, line, title) for cell, line in zip(cells, at, strict=True)])
    if known(title):
        values = np.array([number(cell, line, title) if cell else 0.0 for cell, line in zip(cells, at, strict=True)])
        refuse(values < 0, at, f"{title} is negative", values, "0 or more")
        return values
    return kept(cells)


def _refuse_closed(opens: list[str], due: Floats, at: list[int]) -> None:
    """Raise InputError where a window in numbers closes before it opens."""
    ready = np.array([float(cell) if is_number(cell) else -math.inf for cell in opens])
    window = np.column_stack([np.where(np.isfinite(ready), ready, 0.0), due])
    refuse(window[:, 0] > due, at, "time window closes before it opens", window, "ready <= due", "contradiction")


def _ids(cells: list[str], at: list[int]) -> list[str]:
    first: dict[str, int] = {}
    for k, cell in enumerate(cells):
        if not cell or not cell.isprintable():
            message = "id is empty or cannot be printed"
            raise InputError(message, "malformed" if cell else "missing", line=at[k], expected="a name", found=ascii(cell))
        if cell in first:
            raise InputError(f"id {shown(cell)} stands already in line {first[cell]}", "duplicate", line=at[k], expected="different ids")
        first[cell] = at[k]
    return cells


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``. Matrices would need a file of their own, and are refused."""
    refuse_inexpressible(instance, "csv", EXPRESSIBLE)
    sites, travel, vehicle = instance.sites, instance.travel, instance.fleet[0]
    limits = {attribute: getattr(vehicle, attribute) for attribute in LIMITS.values()}
    refuse_where(
        instance, "csv",
        (vehicle.capacity == 0, "it has no place for a capacity of 0"),
        (instance.fleet != equal_fleet(sites, count=vehicle.count, **limits), "it has no place for vehicles that differ"),
        (travel.metric == EXPLICIT or not np.array_equal(travel.coordinates, sites.coordinates),  # type: ignore[arg-type]
         "its distances do not follow from its coordinates"),
        (sites.geographic != (travel.metric in GEOGRAPHIC),
         f"its distances are {travel.metric}, and its coordinates {'' if sites.geographic else 'no '}angles"),
        (instance.clock is not None and instance.clock.origin, "its times are those of a calendar"),
    )  # fmt: skip
    places = ("lon", "lat") if sites.geographic else ("x", "y")
    titles = ("id", *places, *WRITTEN, "required", "depot", *sites.attributes)
    twice = len({own_title(title) or title for title in titles}) < len(titles)
    refuse_where(instance, "csv", (twice, "it keeps a column that is called as one that counts"))
    settings: list[tuple[str, str]] = [("name", instance.name), ("problem", instance.problem), ("metric", travel.metric)]
    settings += [("convention", travel.convention), ("vehicles", "unlimited" if vehicle.count is None else str(vehicle.count))]
    usual = VehicleType()
    settings += [(key, plain(limits[a])) for key, a in LIMITS.items() if limits[a] != getattr(usual, a)]
    if instance.min_vehicles:
        settings.append(("min-vehicles", str(instance.min_vehicles)))
    if instance.clock is not None:
        settings.append(("time-unit", instance.clock.unit))
    if sites.attributes:
        settings.append(("extra", "true"))
    assert sites.coordinates is not None
    reals = [*sites.coordinates.T, sites.demand, sites.ready, sites.due, sites.service, sites.reward]
    rows = (
        [
            site, *("" if math.isinf(v) else plain(v) for v in (float(values[k]) for values in reals)),
            *("true" if flags[k] else "false" for flags in (sites.required, sites.depot)),
            *("" if values[k] is None else str(values[k]) for values in sites.attributes.values()),
        ]
        for k, site in enumerate(sites.ids)
    )  # fmt: skip
    return written(settings, titles, rows)


FORMATS.enter(
    Format(
        "csv", "sites from CSV, one row each", recognises, read, write, (".csv",), problems=("vrptw", "cvrp", "tsp", "min-cost-vrp"),
        settings=SETTINGS,
    )
)  # fmt: skip
