"""Li and Lim's text format: pickups and deliveries in pairs on one vehicle, with time windows.

First line: number of vehicles, capacity, speed; then nine columns: number, coordinates, demand, ready time, due date, service time, and
the numbers of the partners. Row 0 is the depot. A pickup has a positive demand and names its delivery in the last column; a delivery has
as much less than nothing, and names its pickup in the one before. Sites keep the file's numbers, by which solution files name them too.

The published files give a speed of 1, or of 0; one unit of distance takes one unit of time either way. Any other is refused.

Source: Li and Lim (2001), 13th IEEE International Conference on Tools with Artificial Intelligence; SINTEF's pages on the PDPTW.
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import label, plain, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..sites import Shipment
from ..travel import Travel
from ._limits import finite, numbered, points_of, refuse_inexpressible, refuse_where
from ._rows import Rows, head, refuse, refuse_closed, refuse_negative, widths

COLUMNS = ("number", "x", "y", "demand", "ready time", "due date", "service time", "pickup", "delivery")
PROBLEMS = ("pdptw", "min-cost-vrp")


def recognises(text: str) -> bool:
    """True if a line of three numbers is followed by one of nine."""
    return widths(head(text, 2)) == [3, 9]


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, (vehicles, capacity, speed) = rows.values("first line", ("number of vehicles", "capacity", "speed"))
    count = whole(plain(vehicles), line, "number of vehicles", least=1)
    if capacity <= 0:
        raise InputError("capacity must be positive", "out-of-range", line=line, expected="more than 0", found=plain(capacity))
    if speed not in (0.0, 1.0):
        raise InputError("speed is not supported", "unsupported", line=line, expected="0 or 1", found=plain(speed))
    table, at = rows.table("customer table", COLUMNS)
    n = len(table)
    if n < 3:
        raise InputError("ends early", "missing", line=rows.lines[-1][0], expected="a depot and at least one pair", found=f"{n} rows")
    message = "numbers must run 0, 1, 2, ..."
    refuse(table[:, 0] != np.arange(n), at, message, table[:, 0], "one more than in the row above, from 0", "malformed")
    demand, ready, due, service = table[:, 3:7].T
    refuse_negative(at, service_time=service)
    refuse_closed(at, table[:, 4:6])
    at_depot = (np.arange(n) == 0) & (table[:, [3, 6, 7, 8]] != 0).any(axis=1)
    refuse(at_depot, at, "the depot has a demand, a service time or a partner", table[:, [3, 6, 7, 8]], "0", "contradiction")
    xy, pairs, fleet = table[:, 1:3], pairs_of(demand, table[:, 7:], at), (VehicleType(count, capacity),)
    sites = Sites.of(range(n), ready=ready, due=due, service=service, coordinates=xy, shipments=pairs)
    name, travel = label(path.stem), Travel("euclidean", xy)
    instance = RoutingInstance(name, "li-lim", sites, travel, fleet, problem=PROBLEMS[0], problems=PROBLEMS)
    refuse_unreachable(instance, at)
    return instance


def pairs_of(demand: np.ndarray, partners: np.ndarray, at: Sequence[int], first: int = 0) -> list[Shipment]:
    """Pairs in the order of their pickups, each named by both of its rows.

    ``demand`` has shape (rows,) or (rows, loads), and ``first`` is the number of the first row, which is the depot.
    """
    n = len(demand)
    loads, index = demand.reshape(n, -1), np.arange(n)
    one = (partners == 0).sum(axis=1) == 1
    message = "a customer needs one partner: a pickup its delivery, a delivery its pickup"
    refuse(~one & (index > 0), at, message, partners, "one of two", "contradiction")
    strange = ((partners != np.floor(partners)) | (partners < 0) | (partners >= n + first)).any(axis=1)
    refuse(strange, at, "partner does not exist", partners, f"{first + 1} to {n - 1 + first}", "unknown-name")
    pickup = partners[:, 0] == 0
    other = np.maximum(partners.max(axis=1).astype(np.int64) - first, 0)
    back = (other[other] != index) | (pickup[other] == pickup)
    refuse(back & (index > 0), at, "partner names another one", other + first, "a pair that names each other", "contradiction")
    wrong = (loads < 0).any(axis=1) | ~(loads > 0).any(axis=1)
    refuse(wrong & pickup & (index > 0), at, "demand of a pickup must be positive", demand, "more than 0")
    unlike = (loads != -loads[other]).any(axis=1)
    refuse(unlike & (index > 0), at, "a delivery is not as much as its pickup", demand, "the same, negative", "contradiction")
    return [Shipment(int(k), int(other[k]), tuple(loads[k].tolist())) for k in index[1:] if pickup[k]]


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(instance, "li-lim", {"capacity", "shipments", "time-windows", "depot-windows", "service-times", "limited-fleet"})
    sites, vehicle, n, xy = instance.sites, instance.fleet[0], len(instance.sites), points_of(instance, "li-lim")
    ends = [k for shipment in sites.shipments for k in (shipment.pickup, shipment.delivery)]
    refuse_where(
        instance, "li-lim",
        (vehicle.count is None or not 0 < vehicle.capacity < math.inf or not finite(sites.due),
         "the format needs a number of vehicles, a capacity, and a due date for every site"),
        (instance.problem not in PROBLEMS or not numbered(instance, 0),
         "sites must be numbered 0, 1, 2, ... from the depot, and all be visited"),
        (sorted(ends) != list(range(1, n)) or not all(shipment.load[0] > 0 for shipment in sites.shipments),
         "every customer must be one end of one shipment with a load"),
    )  # fmt: skip
    demand, partners = np.zeros(n), np.zeros((n, 2), dtype=np.int64)
    for shipment in sites.shipments:
        demand[shipment.pickup], demand[shipment.delivery] = shipment.load[0], -shipment.load[0]
        partners[shipment.pickup, 1], partners[shipment.delivery, 0] = shipment.delivery, shipment.pickup
    columns = (*xy.T, demand, sites.ready, sites.due, sites.service, *partners.T)
    lines = ["\t".join([site, *map(plain, row)]) for site, *row in zip(sites.ids, *columns, strict=True)]
    return "\n".join([f"{vehicle.count}\t{plain(vehicle.capacity)}\t1", *lines]) + "\n"


FORMATS.enter(Format("li-lim", "Li and Lim text (PDPTW)", recognises, read, write, (".pdptw",), PROBLEMS[0], PROBLEMS))
