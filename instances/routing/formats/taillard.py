"""Taillard's text format of mixed fleets, as VRPSolverEasy carries it: Golden, Assad, Levy and Gheysens' files with costs of distance.

First line ``n``, the number of customers; then ``i x y demand`` for the depot, 0, and each customer; then ``k``, the number of vehicle
types, and ``capacity, fixed cost, unit cost, least number, largest number`` of each. Sites keep the file's numbers.

Source: Golden, Assad, Levy and Gheysens (1984), Computers and Operations Research 11(1); Taillard (1999), RAIRO 33(1).
"""

from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import label, plain, whole
from ..features import features
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel
from ._limits import numbered, refuse_inexpressible, refuse_where
from ._rows import Rows, head, refuse, refuse_negative, widths

POINT = ("number", "x", "y", "demand")
VEHICLE = ("capacity", "fixed cost", "unit cost", "least number", "largest number")
PROBLEMS = ("cvrp", "min-cost-vrp")
EXPRESSIBLE = frozenset({"capacity", "demands", "limited-fleet", "heterogeneous-fleet", "fixed-cost", "unit-cost"})


def recognises(text: str) -> bool:
    """True if a line of one number is followed by the depot's row, 0, and a customer's, 1, of four."""
    lines = head(text, 3)
    return widths(lines) == [1, 4, 4] and lines[1][0] == "0" and lines[2][0] == "1"


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, (count,) = rows.values("first line", ("number of customers",))
    n = whole(plain(count), line, "number of customers", least=1)
    points = [rows.values("point", POINT) for _ in range(min(n + 1, len(rows.lines)))]
    at, table = [line for line, _ in points], np.array([values for _, values in points])
    refuse(table[:, 0] != np.arange(len(table)), at, "points are numbered from 0 on", table[:, 0], "the next number", "malformed")
    refuse_negative(at, demand=table[:, 3])
    line, (kinds,) = rows.values("number of vehicle types", ("number of vehicle types",))
    types, lines = rows.table("vehicle type", VEHICLE, whole(plain(kinds), line, "number of vehicle types", least=1))
    refuse(types[:, 0] <= 0, lines, "capacity must be positive", types[:, 0], "more than 0")
    refuse((types[:, 1:3] < 0).any(axis=1), lines, "a cost is negative", types[:, 1:3], "0 or more")
    refuse(types[:, 3] != 0, lines, "a least number of vehicles of one type is not supported", types[:, 3], "0", "unsupported")
    fleet = tuple(
        VehicleType(whole(plain(row[4]), at_line, "largest number", least=1), row[0], fixed_cost=row[1], unit_cost=row[2], name=f"type {k}")
        for k, (row, at_line) in enumerate(zip(types.tolist(), lines, strict=True), start=1)
    )
    if table[0, 3] != 0:
        raise InputError("the depot has a demand", "contradiction", line=at[0], expected="0", found=plain(table[0, 3]))
    sites = Sites.of(range(n + 1), demand=table[:, 3], coordinates=table[:, 1:3])
    travel = Travel("euclidean", coordinates=table[:, 1:3])
    return RoutingInstance(label(path.stem), "taillard", sites, travel, fleet, problem=PROBLEMS[0], problems=PROBLEMS)


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(instance, "taillard", EXPRESSIBLE)
    sites, travel = instance.sites, instance.travel
    names = tuple(f"type {k}" for k in range(1, len(instance.fleet) + 1))
    refuse_where(
        instance, "taillard",
        ("capacity" not in features(instance) or travel.metric != "euclidean" or travel.convention != "exact",
         "it needs capacities, and Euclidean distances that are not rounded"),
        (not numbered(instance, 0) or not np.array_equal(travel.coordinates, sites.coordinates),  # type: ignore[arg-type]
         "sites must be numbered from 0, the depot, and have the coordinates that distances follow from"),
        (any(v.count is None or not np.isfinite(v.capacity) or v.capacity == 0 for v in instance.fleet),
         "each type of vehicle needs a capacity and a number"),
        (tuple(v.name for v in instance.fleet) != names, f"vehicle types must be called {', '.join(names)}"),
    )  # fmt: skip
    assert sites.coordinates is not None
    points = np.column_stack([np.arange(len(sites)), sites.coordinates, sites.demand])
    rows = [[len(sites) - 1], *points.tolist(), [len(instance.fleet)]]
    rows += [[v.capacity, v.fixed_cost, v.unit_cost, 0, v.count] for v in instance.fleet]
    return "".join(" ".join(plain(value) for value in row) + "\n" for row in rows)


FORMATS.enter(Format("taillard", "Taillard text (mixed fleets)", recognises, read, write, (".hvrp",), PROBLEMS[0], PROBLEMS))
