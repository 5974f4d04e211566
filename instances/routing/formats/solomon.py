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

import re
from pathlib import Path

import numpy as np

from ...errors import Code, InputError, UsageError
from ...formats import FORMATS, Format
from ...text import label, number, numbers, plain, shown, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..travel import Travel
from ._limits import finite, numbered, refuse_inexpressible
from ._rows import Rows, refuse, refuse_closed, refuse_negative, refuse_other_size

_MARK = re.compile(r"^[ \t]*VEHICLE[ \t]*\n\s*NUMBER[ \t]+CAPACITY", re.I | re.M)
_SOLOMON = re.compile(r"(?:R|C|RC)[12]\d\d\Z", re.I)
_HOMBERGER = re.compile(r"(?:R|C|RC)[12]_(2|4|6|8|10)_\d+\Z", re.I)
COLUMNS = ("number", "x", "y", "demand", "ready time", "due date", "service time")
PROBLEMS = ("vrptw", "min-cost-vrp")


def recognises(text: str) -> bool:
    """True if the two headings of the vehicle table stand on lines of their own."""
    return _MARK.search(text) is not None


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    name = label(path.stem) if rows.lines[0][1].upper() == "VEHICLE" else label(rows.next("the name")[1])
    _heading(rows, "VEHICLE")
    _heading(rows, "NUMBER", "CAPACITY")
    line, vehicles = rows.next("number and capacity of the vehicles")
    tokens = vehicles.split()
    if len(tokens) != 2:
        message = "vehicle line has a wrong length"
        raise InputError(message, "wrong-shape", line=line, expected="number and capacity", found=f"{len(tokens)} values")
    count = whole(tokens[0], line, "number of vehicles", least=1)
    capacity = number(tokens[1], line, "capacity")
    if capacity <= 0:
        raise InputError("capacity must be positive", "out-of-range", line=line, expected="more than 0", found=tokens[1])
    _heading(rows, "CUSTOMER")
    line, titles = rows.next("the titles of the columns")
    if not titles.upper().startswith("CUST"):
        message = "the titles of the columns are missing"
        raise InputError(message, "missing", line=line, expected="CUST NO. XCOORD. ...", found=shown(titles))
    customers: list[list[float]] = []
    at: list[int] = []
    for line, row in rows.lines[rows.at :]:
        values = numbers(row, line, "customer table")
        if len(values) != len(COLUMNS):
            message = "row of the customer table has a wrong length"
            raise InputError(message, "wrong-shape", line=line, expected="7 values", found=f"{len(values)} values")
        if values[0] != len(customers):
            known = at[int(values[0])] if values[0] in range(len(customers)) else None
            message = f"number {values[0]:g} stands already in line {known}" if known else "customer numbers must run 0, 1, 2, ..."
            code: Code = "duplicate" if known else "malformed"
            raise InputError(message, code, line=line, expected=str(len(customers)), found=f"{values[0]:g}")
        customers.append(values)
        at.append(line)
    _refuse_cut(text, name, at)
    n = len(customers)
    if n < 2:
        raise InputError("ends early", "missing", line=rows.lines[-1][0], expected="a depot and at least one customer", found=f"{n} rows")
    table = np.array(customers, dtype=np.float64)
    xy, (demand, ready, due, service) = table[:, 1:3], table[:, 3:].T
    refuse_negative(at, demand=demand, service_time=service)
    refuse_closed(at, table[:, 4:6])
    at_depot = (np.arange(n) == 0) & ((demand != 0) | (service != 0))
    refuse(at_depot, at, "the depot has a demand or a service time", customers, "0", "contradiction")
    sites = Sites.of(range(n), demand=demand, ready=ready, due=due, service=service, coordinates=xy)
    travel, fleet = Travel("euclidean", xy), (VehicleType(count, capacity),)
    instance = RoutingInstance(name, "solomon", sites, travel, fleet, problem=PROBLEMS[0], problems=PROBLEMS)
    refuse_unreachable(instance, at)
    return instance


def _heading(rows: Rows, *words: str) -> None:
    """Raise InputError unless the next line begins with ``words``."""
    line, text = rows.next(" ".join(words))
    if text.upper().split()[: len(words)] != list(words):
        raise InputError("heading is missing", "missing", line=line, expected=" ".join(words), found=shown(text))


def _refuse_cut(text: str, name: str, at: list[int]) -> None:
    """Raise InputError where the last row is shorter than the others, or the name stands for another number of customers."""
    raw = text.split("\n")
    widths = {len(raw[line - 1].rstrip()) for line in at[:-1]}
    if raw[-1].strip() and len(at) > 3 and len(widths) == 1 and (length := len(raw[-1].rstrip())) < min(widths):
        raise InputError("last row is cut off", line=at[-1], expected=f"{min(widths)} characters as in the rows above", found=str(length))
    customers = max(len(at) - 1, 0)
    sizes: tuple[int, ...] = (customers,)
    if _SOLOMON.match(name):
        sizes = (25, 50, 100)
    elif match := _HOMBERGER.match(name):
        sizes = (100 * int(match[1]),)
    refuse_other_size(name, "customers", sizes, customers, at[-1] if at else len(raw))


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(
        instance, "solomon", {"capacity", "demands", "time-windows", "depot-windows", "service-times", "limited-fleet"}
    )  # fmt: skip
    sites, travel, vehicle, name = instance.sites, instance.travel, instance.fleet[0], instance.name.strip()
    for wrong, why in (
        (travel.metric != "euclidean" or travel.coordinates is None, f"its distances are {travel.metric}, not Euclidean"),
        (travel.convention != "exact", f"its convention is {travel.convention}, the format means exact"),
        (vehicle.count is None or not np.isfinite(vehicle.capacity), "the format needs a number of vehicles and a capacity"),
        (not finite(sites.due), "the format needs a due date for every site"),
        (not numbered(instance, 0), "sites must be numbered 0, 1, 2, ... from the depot"),
    ):
        if wrong:
            raise UsageError(f"{instance.name} cannot be written as solomon: {why}", "unsupported")
    if not name or name.upper() == "VEHICLE" or len(instance.name.splitlines()) != 1:
        raise UsageError(f"{instance.name!r} cannot be the name of a solomon file", "unsupported")
    assert travel.coordinates is not None
    table = zip(sites.ids, *travel.coordinates.T, sites.demand, sites.ready, sites.due, sites.service, strict=True)
    rows = [" ".join(f"{(c if isinstance(c, str) else plain(c)):>12}" for c in row) for row in table]
    titles = ("CUST NO.", "XCOORD.", "YCOORD.", "DEMAND", "READY TIME", "DUE DATE", "SERVICE TIME")
    top = [name, "", "VEHICLE", "NUMBER     CAPACITY", f"{vehicle.count:>6} {plain(vehicle.capacity):>12}", "", "CUSTOMER"]
    return "\n".join([*top, " ".join(f"{title:>12}" for title in titles).strip(), "", *rows]) + "\n"


FORMATS.enter(Format("solomon", "Solomon / Gehring-Homberger text (VRPTW)", recognises, read, write, (".txt",), PROBLEMS[0], PROBLEMS))
