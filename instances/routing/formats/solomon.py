"""Solomon's text format, also used by Gehring and Homberger: vehicle routing with time windows.

A name, ``VEHICLE`` with number and capacity, ``CUSTOMER`` with a table of seven columns. The first row is the depot, whose
window is the planning horizon. Sites keep the file's numbers ("0" is the depot); solution files count customers from 1
in the file's order, which is the same.

The format does not say how many customers there are, so what is cut off must be noticed otherwise: numbers must run 0, 1, 2, ...;
a last row that is not ended must not be shorter than the rows of a table of fixed width; and names of the published files stand
for a number of customers (C101: 100, or 50 or 25 in the short versions; RC2_10_1: 1000).

Source: Solomon (1987), Operations Research 35(2); Gehring and Homberger (1999). Distances are Euclidean doubles unless a
convention says otherwise.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...errors import InputError, UsageError
from ...formats import FORMATS, Format
from ...text import label, lines_of, number, numbers, plain, refuse, shown, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..travel import Travel
from ._limits import refuse_inexpressible

_MARK = re.compile(r"^[ \t]*VEHICLE[ \t]*\n\s*NUMBER[ \t]+CAPACITY", re.I | re.M)
_SOLOMON = re.compile(r"(?:R|C|RC)[12]\d\d\Z", re.I)
_HOMBERGER = re.compile(r"(?:R|C|RC)[12]_(2|4|6|8|10)_\d+\Z", re.I)
COLUMNS = ("number", "x", "y", "demand", "ready time", "due date", "service time")
PROBLEMS = ("vrptw", "min-cost-vrp")


def recognises(text: str) -> bool:
    """Whether the two headings of the vehicle table stand on lines of their own."""
    return _MARK.search(text) is not None


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    lines = lines_of(text)
    position = 0

    def following(what: str) -> tuple[int, str]:
        nonlocal position
        if position >= len(lines):
            raise InputError("ends early", line=lines[-1][0], expected=what, found="the end of the file")
        position += 1
        return lines[position - 1]

    def heading(*words: str) -> None:
        line, found = following(" ".join(words))
        if found.upper().split()[: len(words)] != list(words):
            raise InputError("heading is missing", line=line, expected=" ".join(words), found=shown(found))

    name = label(path.stem)
    if lines[0][1].upper() != "VEHICLE":
        name = label(following("the name")[1])
    heading("VEHICLE")
    heading("NUMBER", "CAPACITY")
    line, found = following("number and capacity of the vehicles")
    tokens = found.split()
    if len(tokens) != 2:
        raise InputError("vehicle line has a wrong length", line=line, expected="number and capacity", found=f"{len(tokens)} values")
    count = whole(tokens[0], line, "number of vehicles", least=1)
    capacity = number(tokens[1], line, "capacity")
    if capacity <= 0:
        raise InputError("capacity must be positive", line=line, expected="more than 0", found=tokens[1])
    heading("CUSTOMER")
    line, found = following("the titles of the columns")
    if not found.upper().startswith("CUST"):
        raise InputError("the titles of the columns are missing", line=line, expected="CUST NO. XCOORD. ...", found=shown(found))
    rows: list[list[float]] = []
    at: list[int] = []
    for line, found in lines[position:]:
        row = numbers(found, line, "customer table")
        if len(row) != len(COLUMNS):
            raise InputError("row of the customer table has a wrong length", line=line, expected="7 values", found=f"{len(row)} values")
        if row[0] != len(rows):
            known = at[int(row[0])] if row[0] in range(len(rows)) else None
            message = f"number {row[0]:g} stands already in line {known}" if known else "customer numbers must run 0, 1, 2, ..."
            raise InputError(message, line=line, expected=str(len(rows)), found=f"{row[0]:g}")
        rows.append(row)
        at.append(line)
    _refuse_cut(text, name, at)
    if len(rows) < 2:
        raise InputError("ends early", line=lines[-1][0], expected="a depot and at least one customer", found=f"{len(rows)} rows")
    table = np.array(rows, dtype=np.float64)
    demand, ready, due, service = table[:, 3:].T
    refuse(demand < 0, at, "demand is negative", demand, "0 or more")
    refuse(service < 0, at, "service time is negative", service, "0 or more")
    refuse(ready > due, at, "time window closes before it opens", table[:, 4:6], "ready time <= due date")
    refuse((np.arange(len(rows)) == 0) & ((demand != 0) | (service != 0)), at, "the depot has a demand or a service time", rows, "0")
    xy = table[:, 1:3]
    sites = Sites.of(range(len(rows)), demand=demand, ready=ready, due=due, service=service, coordinates=xy)
    made = RoutingInstance(
        name, "solomon", sites, Travel("euclidean", xy), (VehicleType(count, capacity),), problem="vrptw", problems=PROBLEMS
    )
    refuse_unreachable(made, at)
    return made


def _refuse_cut(text: str, name: str, at: list[int]) -> None:
    raw = text.split("\n")
    widths = {len(raw[line - 1].rstrip()) for line in at[:-1]}
    if raw[-1].strip() and len(at) > 3 and len(widths) == 1 and (found := len(raw[-1].rstrip())) < min(widths):
        raise InputError("last row is cut off", line=at[-1], expected=f"{min(widths)} characters as in the rows above", found=str(found))
    sizes: tuple[int, ...] = ()
    if _SOLOMON.match(name):
        sizes = (25, 50, 100)
    elif match := _HOMBERGER.match(name):
        sizes = (100 * int(match[1]),)
    if sizes and len(at) - 1 not in sizes:
        raise InputError(
            f"ends early or is changed: the name {name} stands for another number of customers; rename it if this is meant",
            line=at[-1] if at else len(raw), expected=" or ".join(map(str, sizes)), found=str(max(len(at) - 1, 0)),
        )  # fmt: skip


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    expressible = {"capacity", "demands", "time-windows", "depot-windows", "service-times", "limited-fleet"}
    refuse_inexpressible(instance, "solomon", expressible)
    sites, travel = instance.sites, instance.travel
    if travel.metric != "euclidean" or travel.coordinates is None:
        raise UsageError(f"{instance.name} cannot be written as solomon: its distances are {travel.metric}, not Euclidean")
    if travel.convention != "exact":
        raise UsageError(f"{instance.name} cannot be written as solomon: its convention is {travel.convention}, the format means exact")
    vehicle = instance.fleet[0]
    if vehicle.count is None or not np.isfinite(vehicle.capacity):
        raise UsageError(f"{instance.name} cannot be written as solomon: the format needs a number of vehicles and a capacity")
    if not np.isfinite(sites.due).all():
        raise UsageError(f"{instance.name} cannot be written as solomon: the format needs a due date for every site")
    if sites.depots.tolist() != [0] or sites.ids != tuple(str(k) for k in range(len(sites))):
        raise UsageError(f"{instance.name} cannot be written as solomon: sites must be numbered 0, 1, 2, ... from the depot")
    if not instance.name.strip() or instance.name.strip().upper() == "VEHICLE" or len(instance.name.splitlines()) != 1:
        raise UsageError(f"{instance.name!r} cannot be the name of a solomon file")
    head = ["CUST NO.", "XCOORD.", "YCOORD.", "DEMAND", "READY TIME", "DUE DATE", "SERVICE TIME"]
    table = zip(
        sites.ids, *travel.coordinates.T, sites.demand, sites.ready, sites.due, sites.service, strict=True
    )  # fmt: skip
    rows = [" ".join(f"{(c if isinstance(c, str) else plain(c)):>12}" for c in row) for row in table]
    titles = " ".join(f"{title:>12}" for title in head).strip()
    top = [instance.name.strip(), "", "VEHICLE", "NUMBER     CAPACITY", f"{vehicle.count:>6} {plain(vehicle.capacity):>12}", "", "CUSTOMER"]
    return "\n".join([*top, titles, "", *rows]) + "\n"


FORMATS.add(
    "solomon",
    Format("solomon", "Solomon / Gehring-Homberger text (VRPTW)", recognises, read, write, (".txt",), "vrptw", PROBLEMS, "exact"),
)
