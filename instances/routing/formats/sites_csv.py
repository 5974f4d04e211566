"""Sites from CSV: one row a site, with the fleet in comment lines at the top; documented in ``docs/formats.md``.

The delimiter is the one of ``, ; | tab`` that occurs most often in the line of titles. Without a column ``depot`` the first
site is the depot. Solution files count customers from 1 in the file's order, depots left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...formats.table import Settings, delimiter_of, settings_of, table_of, titles_of, written
from ...text import label, number, numbers, plain, read_text, refuse, shown, whole
from ..fleet import equal_fleet, with_problems
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..travel import EXPLICIT, METRICS, Travel, convention_named
from ._limits import refuse_inexpressible

COLUMNS = ("id", "x", "y", "demand", "ready", "due", "service", "reward", "required", "depot")
DEFAULTS = {"demand": 0.0, "ready": 0.0, "due": math.inf, "service": 0.0, "reward": 0.0}
LIMITS = {"capacity": "capacity", "max-duration": "max_duration", "max-distance": "max_distance", "fixed-cost": "fixed_cost",
          "unit-cost": "unit_cost"}  # fmt: skip
KEYS = ("name", "problem", "metric", "convention", "vehicles", "min-vehicles", *LIMITS, "matrix", "durations")
FLAGS = {"1": True, "true": True, "yes": True, "0": False, "false": False, "no": False}
EXPRESSIBLE = frozenset(
    {
        "capacity", "demands", "time-windows", "depot-windows", "service-times", "demand-or-service-of-depots", "rewards", "optional-sites",
        "limited-fleet", "min-vehicles", "heterogeneous-fleet", "multiple-depots", "max-duration", "max-distance", "fixed-cost",
        "unit-cost",
    }
)  # fmt: skip


def recognises(text: str) -> bool:
    """Whether the first line that is no comment holds the titles ``x`` and ``y``, or ``id``, among others, and no roles."""
    titles = titles_of(text)
    return len(titles) > 1 and ("id" in titles or {"x", "y"} <= titles) and "role" not in titles


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    keys, start = settings_of(text, KEYS, COLUMNS)
    table = table_of(text, start, COLUMNS, "sites")
    at, n = table.at, len(table.rows)
    if ("x" in table.titles) != ("y" in table.titles):
        raise InputError("coordinates need two columns", line=start + 1, expected="x and y", found="one of them")
    column = {title: [row[k] for row in table.rows] for k, title in enumerate(table.titles)}

    def reals(title: str, default: float | None) -> NDArray[np.float64]:
        cells = column.get(title, [""] * n)
        values = [default if default is not None and not c else number(c, at[k], title) for k, c in enumerate(cells)]
        return np.array(values, dtype=np.float64)

    def marks(title: str) -> NDArray[np.bool_] | None:
        return None if title not in column else np.array([_flag(c, at[k], title) for k, c in enumerate(column[title])])

    data: dict[str, Any] = {title: reals(title, default) for title, default in DEFAULTS.items()}
    for title in ("demand", "service", "reward"):
        refuse(data[title] < 0, at, f"{title} is negative", data[title], "0 or more")
    window = np.column_stack([data["ready"], data["due"]])
    refuse(data["ready"] > data["due"], at, "time window closes before it opens", window, "ready <= due")
    depot, required = marks("depot"), marks("required")
    if depot is not None and not depot.any():
        raise InputError("no row is marked as depot", line=at[-1], expected="at least one true in the column depot")
    xy = np.column_stack([reals("x", None), reals("y", None)]) if "x" in column else None
    sites = Sites.of(_ids(column.get("id"), n, at), depot=depot, required=required, coordinates=xy, **data)
    if n == len(sites.depots):
        raise InputError("there is no customer", line=at[-1], expected="a row that is no depot")
    travel = _travel(keys, xy, n, path)
    return _instance(keys, sites, travel, path, at)


def _ids(cells: list[str] | None, n: int, at: list[int]) -> list[str]:
    if cells is None:
        return [str(k) for k in range(n)]
    first: dict[str, int] = {}
    for k, cell in enumerate(cells):
        if not cell or not cell.isprintable():
            raise InputError("id is empty or cannot be printed", line=at[k], expected="a name", found=ascii(cell))
        if cell in first:
            raise InputError(f"id {shown(cell)} stands already in line {first[cell]}", line=at[k], expected="different ids")
        first[cell] = at[k]
    return cells


def _flag(cell: str, line: int, title: str) -> bool:
    if not cell:
        return title == "required"
    if cell.lower() not in FLAGS:
        raise InputError(f"{title} must be true or false", line=line, expected=", ".join(FLAGS), found=shown(cell))
    return FLAGS[cell.lower()]


def _travel(keys: Settings, xy: NDArray[np.float64] | None, n: int, path: Path) -> Travel:
    convention = ""
    if "convention" in keys:
        try:
            convention = convention_named(keys["convention"][1])
        except UsageError as error:
            raise InputError(str(error), line=keys["convention"][0]) from None
    durations = _matrix(path, keys["durations"], n) if "durations" in keys else None
    if "matrix" in keys:
        if "metric" in keys:
            raise InputError("metric stands beside a matrix", line=keys["metric"][0], expected="one of them")
        return Travel(EXPLICIT, matrix=_matrix(path, keys["matrix"], n), duration_matrix=durations, convention=convention)
    metric = keys["metric"][1] if "metric" in keys else "euclidean"
    if metric not in METRICS:
        raise InputError(f"metric {shown(metric)} is unknown", line=keys["metric"][0], expected=", ".join(METRICS))
    if xy is None:
        raise InputError("there are neither coordinates nor a matrix", expected="columns x and y, or a line `# matrix: file.csv`")
    return Travel(metric, coordinates=xy, duration_matrix=durations, convention=convention)


def _matrix(path: Path, setting: tuple[int, str], n: int) -> NDArray[np.float64]:
    """A square table of numbers from a file of its own, named relative to ``path``."""
    line, name = setting
    file = path.parent / name
    try:
        if file.exists() and not file.is_file():  # a file must not make the reader wait at a pipe
            raise InputError("is no plain file", file=file)
        lines = [(k, row) for k, row in enumerate(read_text(file).split("\n"), start=1) if row.strip()]
    except InputError as error:
        raise InputError(f"matrix {shown(name)} {error.message}", line=line, found=error.found) from None
    if len(lines) != n:
        raise InputError("matrix has a wrong number of rows", file=file, line=lines[min(n, len(lines) - 1)][0], expected=str(n),
                         found=str(len(lines)))  # fmt: skip
    made = np.empty((n, n))
    delimiter = delimiter_of(lines[0][1])
    for k, (at, row) in enumerate(lines):
        cells = row.split(delimiter) if delimiter in row else row.split()
        try:
            values = numbers(" ".join(c if c.strip() else "?" for c in cells), at, "matrix")
            if len(values) != n:
                raise InputError("row of the matrix has a wrong length", line=at, expected=str(n), found=str(len(values)))
            made[k] = values
            refuse((made[k] < 0) & (np.arange(n) != k), [at] * n, "distance is negative", made[k], "0 or more")
        except InputError as error:
            raise error.at(file=file) from None
    return made


def _instance(keys: Settings, sites: Sites, travel: Travel, path: Path, at: list[int]) -> RoutingInstance:
    limits: dict[str, float] = {}
    for key, attribute in LIMITS.items():
        if key in keys:
            line, value = keys[key]
            limits[attribute] = number(value, line, key)
            if limits[attribute] < 0:
                raise InputError(f"{key} is negative", line=line, expected="0 or more", found=value)
            if limits[attribute] == 0 and attribute == "capacity":
                raise InputError("capacity must be positive", line=line, expected="more than 0", found=value)
    count = None
    if "vehicles" in keys and keys["vehicles"][1].lower() != "unlimited":
        count = whole(keys["vehicles"][1], keys["vehicles"][0], "vehicles", least=1)
    least = whole(keys["min-vehicles"][1], keys["min-vehicles"][0], "min-vehicles", least=0) if "min-vehicles" in keys else 0
    fleet = equal_fleet(sites, count=count, **limits)
    notes = (f"{'any number of' if count is None else count} vehicles at each of {len(fleet)} depots",) if len(fleet) > 1 else ()
    name = label(keys["name"][1] if "name" in keys else path.stem)
    made = with_problems(RoutingInstance(name, "csv", sites, travel, fleet, min_vehicles=least, notes=notes))
    if "problem" in keys:
        line, problem = keys["problem"]
        if problem not in made.problems:
            raise InputError(f"the data do not allow the problem {shown(problem)}", line=line, expected=", ".join(made.problems))
        made = replace(made, problem=problem)
    refuse_unreachable(made, at)
    return made


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``. Matrices would need a file of their own, and are refused."""
    refuse_inexpressible(instance, "csv", EXPRESSIBLE)
    sites, travel, vehicle = instance.sites, instance.travel, instance.fleet[0]
    limits = {attribute: getattr(vehicle, attribute) for attribute in LIMITS.values()}
    if vehicle.capacity == 0:
        raise UsageError(f"{instance.name} cannot be written as csv, which has no place for a capacity of 0; use json")
    if instance.fleet != equal_fleet(sites, count=vehicle.count, **limits):
        raise UsageError(f"{instance.name} cannot be written as csv, which has no place for vehicles that differ; use json")
    if travel.metric == EXPLICIT or not np.array_equal(travel.coordinates, sites.coordinates):  # type: ignore[arg-type]
        raise UsageError(f"{instance.name} cannot be written as csv: its distances do not follow from its coordinates; use json")
    settings: list[tuple[str, str]] = [("name", instance.name), ("problem", instance.problem), ("metric", travel.metric)]
    settings += [("convention", travel.convention), ("vehicles", "unlimited" if vehicle.count is None else str(vehicle.count))]
    usual = VehicleType()
    settings += [(key, plain(limits[a])) for key, a in LIMITS.items() if limits[a] != getattr(usual, a)]
    if instance.min_vehicles:
        settings.append(("min-vehicles", str(instance.min_vehicles)))
    real: Callable[[float], str] = lambda v: "" if math.isinf(v) else plain(v)  # noqa: E731
    assert sites.coordinates is not None
    reals = [*sites.coordinates.T, sites.demand, sites.ready, sites.due, sites.service, sites.reward]
    rows = (
        [site, *(real(float(values[k])) for values in reals), *("true" if flags[k] else "false" for flags in (sites.required, sites.depot))]
        for k, site in enumerate(sites.ids)
    )
    return written(settings, COLUMNS, rows)


FORMATS.add(
    "csv",
    Format(
        "csv", "sites from CSV, one row each", recognises, read, write, (".csv",), "",
        ("vrptw", "cvrp", "tsp", "min-cost-vrp"), "exact",
    ),
)  # fmt: skip
