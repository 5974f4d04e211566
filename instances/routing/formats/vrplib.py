"""TSPLIB and VRPLIB files: TSP, ATSP, CVRP, and the extensions for time windows, service and route duration (VRPLIB), orienteering (OPLib),
and simultaneous pickups and deliveries (LKH-3).

Sites are the file's own node numbers "1" to "n". Solution files (``.sol``) count customers from 1 in the file's order and
call the depot 0; ``.tour`` files use node numbers.

The file is scanned here, line by line, and not with the package ``vrplib``: that one keeps no line numbers for messages, does
not know ATT, GEO, MAN_2D, UPPER_ROW or the diagonal layouts, ignores node numbers, and computes Euclidean distances by a
formula that rounds differently. The tests compare both readers where both can read.

How the fleet is found: a ``VEHICLES`` header is an upper limit. Else a name that ends in ``-k5`` is one, and a note says so,
except in Uchoa's set X, where k is the least possible number of routes and the fleet is unlimited.
``DISTANCE`` limits a route's duration, service included, as in the files of Christofides, Mingozzi and Toth.

OPLib's orienteering problems (``TYPE: OP``) ask for one tour through the depot whose length is at most ``COST_LIMIT``; the score of the
depot counts.

LKH-3's files of pairs (``TYPE: PDPTW``) have a row ``node, demand, ready, due, service, pickup, delivery`` each, which names the partner;
the depot is node 1. A row ``node, pickup, delivery`` leaves the others to the sections that tell them elsewhere. A ``DEMAND_SECTION`` of
several columns tells several loads, and ``CAPACITY`` as many numbers. LKH-3's files with pickups and deliveries at the same sites (``TYPE:
VRPSPD, VRPMPD`` or ``MVRPB``) have a row ``node, 0, ready, due, service, pickup, delivery`` each. They write a window that all nodes share
and no route can outlast where there is none. Their ``EXACT_2D`` distances are Euclidean and not rounded.

Source: Reinelt, TSPLIB 95; CVRPLIB; the VRPLIB format of the package vrplib; OPLib, of Kobeaga, Merino and Lozano (2018), Computers and
Operations Research 90; LKH-3, Helsgaun (2017), Roskilde University.
"""

from __future__ import annotations

import math
import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import label, number, refuse, shown, whole
from ..fleet import with_problems
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..sites import Shipment
from ..travel import EXPLICIT, METRICS, Travel
from ._tsplib import FLEET_IN_NAME, SET_X, Lines, Specification, edge_weights, node_list, node_table, scan
from ._tsplib_writer import EXACT_2D, always_open, write
from ._vrplib_fleet import RICH_HEADERS, RICH_SECTIONS, backhauls_of, depots_of, fleet_of, groups_of, is_rich, prizes_of, skills_of
from .li_lim import pairs_of

Floats = NDArray[np.float64]

SIMULTANEOUS = ("VRPSPD", "VRPMPD", "MVRPB", "VRPSPDTW", "VRPMPDTW")
PAIRED = "PDPTW"
BACKHAULS = "VRPB"
RICH = ("MDVRP", "MDVRPTW", "HFVRP", "PCVRP", "PCVRPTW", BACKHAULS)
"""Types of other collections for several depots, mixed fleets, prizes and backhauls."""
PICKUPS = "PICKUP_AND_DELIVERY_SECTION"
PROBLEMS = {
    "TSP": ("tsp", "min-cost-vrp"),
    "ATSP": ("tsp", "min-cost-vrp"),
    "CVRP": ("cvrp", "min-cost-vrp"),
    "VRPTW": ("vrptw", "min-cost-vrp"),
    "CVRPTW": ("vrptw", "min-cost-vrp"),
    "OP": ("orienteering", "team-orienteering"),
    **dict.fromkeys(SIMULTANEOUS, ("cvrp", "min-cost-vrp")),
    PAIRED: ("pdptw", "min-cost-vrp"),
    **dict.fromkeys(RICH, ("mdvrp", "min-cost-vrp")),
}
EDGE_WEIGHT_TYPES = (*(m for m in METRICS if m.isupper()), EXPLICIT, EXACT_2D)
HEADERS = frozenset(
    {
        "NAME", "COMMENT", "TYPE", "DIMENSION", "EDGE_WEIGHT_TYPE", "EDGE_WEIGHT_FORMAT", "NODE_COORD_TYPE", "DISPLAY_DATA_TYPE",
        "AUTHOR", "SOURCE", "DATE", "VERSION", "BEST_KNOWN", "OPTIMAL_VALUE",
    }
)  # fmt: skip
FLEET_HEADERS = frozenset({"CAPACITY", "VEHICLES", "DISTANCE", "SERVICE_TIME"})
SECTIONS = frozenset({"NODE_COORD_SECTION", "DISPLAY_DATA_SECTION", "EDGE_WEIGHT_SECTION"})
VISITED = frozenset({"DEMAND_SECTION", "DEPOT_SECTION", "TIME_WINDOW_SECTION", "SERVICE_TIME_SECTION"})
KEYWORDS = {
    **dict.fromkeys(("TSP", "ATSP"), (HEADERS | {"VEHICLES"}, SECTIONS)),
    **dict.fromkeys(("CVRP", "VRPTW", "CVRPTW", *RICH), (HEADERS | FLEET_HEADERS | RICH_HEADERS, SECTIONS | VISITED | RICH_SECTIONS)),
    "OP": (HEADERS | {"COST_LIMIT", "TSPSOL"}, SECTIONS | {"DEPOT_SECTION", "NODE_SCORE_SECTION"}),
    **dict.fromkeys(SIMULTANEOUS, (HEADERS | FLEET_HEADERS - {"SERVICE_TIME"}, SECTIONS | {"DEPOT_SECTION", PICKUPS})),
    PAIRED: (HEADERS | FLEET_HEADERS, SECTIONS | VISITED | {PICKUPS}),
}
"""By type: headers and sections that it knows."""
_MARK = re.compile(r"^[ \t]*(?:(?:DIMENSION|EDGE_WEIGHT_TYPE|TYPE|NAME)[ \t]*:|(?:NODE_COORD|EDGE_WEIGHT|DEMAND)_SECTION\b)", re.M)


def recognises(text: str) -> bool:
    """Whether one of TSPLIB's keywords stands at the start of a line."""
    return not text.lstrip().startswith("{") and _MARK.search(text) is not None


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    spec = scan(text)
    if "LINEHAUL_SECTION" in spec.sections and "DEMAND_SECTION" not in spec.sections:
        spec.sections["DEMAND_SECTION"] = spec.sections.pop("LINEHAUL_SECTION")
    if "NODE_SEQUENCE_SECTION" in spec.sections:
        raise InputError("is a solution file, not an instance", line=spec.sections["NODE_SEQUENCE_SECTION"].line)
    kind = spec.value("TYPE").upper().split()[0] if "TYPE" in spec.headers else _meant(spec)
    if kind == "TOUR":
        raise InputError("is a solution file, not an instance", line=spec.line("TYPE"))
    if kind not in PROBLEMS:
        raise InputError(f"TYPE {shown(kind)} is not supported", line=spec.line("TYPE"), expected=", ".join(PROBLEMS))
    headers, sections = zip(*KEYWORDS.values(), strict=True)
    spec.refuse_unknown(frozenset().union(*headers), frozenset().union(*sections))
    spec.refuse_unknown(*KEYWORDS[kind], f" in a file of TYPE {kind}")
    n = spec.dimension()
    name = label(spec.headers["NAME"][1] if "NAME" in spec.headers and spec.headers["NAME"][1] else path.stem)
    xy, travel = _travel(spec, n, kind)
    is_tsp = kind in ("TSP", "ATSP")
    depots = [0] if is_tsp else depots_of(spec, n) if PICKUPS not in spec.sections and kind != "OP" else [_depot(spec, n)]
    depot, flags = depots[0], np.isin(np.arange(n), depots)
    ids = [str(k) for k in range(1, n + 1)]
    if kind == "OP":
        return _orienteering(spec, name, Sites.of(ids, depot=flags, reward=_scores(spec, n), required=False, coordinates=xy), travel, depot)
    notes: list[str] = [] if "TYPE" in spec.headers else [f"the file has no TYPE, and is read as {kind} by what it holds"]
    if travel.metric == "GEO" and (found := _no_minutes(travel.coordinates)) is not None:
        notes.append(f"GEO coordinates are degrees and minutes (DDD.MM), and {found:g} has 60 minutes or more: decimal degrees belong into "
                     "the columns lat and lon of a CSV file")  # fmt: skip
    demand: Floats
    pickup, dimensions = np.zeros(n), 1
    worth: dict[str, Any] = {}
    lines: list[int] | None
    if kind in SIMULTANEOUS:
        demand, pickup, service, ready, due, lines = _pickups(spec, travel, depot)
        if "VEHICLES" in spec.headers:
            notes.append("published values of simultaneous pickups and deliveries keep no number of vehicles: set vehicles=unlimited")
    elif kind == PAIRED:
        worth["shipments"], service, ready, due, lines = _pairs(spec, n, depot)
        dimensions = max((len(shipment.load) for shipment in worth["shipments"]), default=1)
        demand = np.zeros((n, dimensions))
    else:
        demand, service, ready, due, lines = _sites(spec, flags, kind)
        pickup, dimensions = backhauls_of(spec, n, depots), demand.shape[1]
    prizes = prizes_of(spec, n, depots)
    groups = groups_of(spec, n, depots, prizes)
    free = np.isin(np.arange(n), [site for group in groups for site in group.sites])
    worth |= {} if prizes is None else {"penalty": prizes, "required": (prizes == 0.0) & ~free}
    worth |= {"groups": groups, "skills": skills_of(spec, n, depots)}
    sites = Sites.of(ids, depot=flags, demand=demand, pickup=pickup, ready=ready, due=due, service=service, coordinates=xy, **worth)
    if is_rich(spec, depots) or prizes is not None or kind in RICH:
        if dimensions > 1:
            raise InputError("several loads beside prizes, several depots or vehicles that differ are not supported",
                             line=spec.sections["DEMAND_SECTION"].line, expected="a DEMAND_SECTION of one column")  # fmt: skip
        return _rich(spec, (name, label(path.stem)), sites, travel, depots, notes, lines, kind == BACKHAULS)
    count = _fleet(spec, name, label(path.stem), notes) if not is_tsp or "VEHICLES" in spec.headers else 1
    capacities, longest = _capacities(spec, dimensions), _limit(spec, "DISTANCE")
    if math.isfinite(longest):
        notes.append(f"DISTANCE {longest:g} limits the duration of a route, service included")
    fleet = (VehicleType(count, capacities[0], start=depot, end=depot, max_duration=longest, further_capacity=capacities[1:]),)
    problems = PROBLEMS[kind] if count == 1 or not is_tsp else ("min-cost-vrp", "min-makespan-vrp")
    if kind in SIMULTANEOUS and (ready.any() or np.isfinite(due).any()):
        problems = PROBLEMS["VRPTW"]
    made = RoutingInstance(name, "vrplib", sites, travel, fleet, problem=problems[0], problems=problems, notes=tuple(notes))
    refuse_unreachable(made, lines)
    return made


def _meant(spec: Specification) -> str:
    """The TYPE of a file that does not say it."""
    if "NODE_SCORE_SECTION" in spec.sections:
        return "OP"
    if PICKUPS in spec.sections:
        return "VRPSPD"
    if "TIME_WINDOW_SECTION" in spec.sections:
        return "VRPTW"
    visited = {"DEMAND_SECTION", "DEPOT_SECTION", "SERVICE_TIME_SECTION"} | RICH_SECTIONS
    if spec.sections.keys() & visited or spec.headers.keys() & (FLEET_HEADERS - {"VEHICLES"} | RICH_HEADERS):
        return "CVRP"
    if spec.sections.keys() & SECTIONS:
        return "ATSP" if spec.headers.get("EDGE_WEIGHT_FORMAT", (0, ""))[1].upper() == "FULL_MATRIX" else "TSP"
    spec.value("TYPE")
    raise AssertionError("value() refuses what is missing")


def _rich(
    spec: Specification, names: tuple[str, str], sites: Sites, travel: Travel, depots: list[int], notes: list[str],
    lines: list[int] | None, late: bool,
) -> RoutingInstance:  # fmt: skip
    """Vehicles of several kinds or depots, sites that are worth a prize, and backhauls that come ``late``: after the deliveries."""
    longest = _limit(spec, "DISTANCE")
    fleet = fleet_of(spec, len(sites), depots, longest, partial(_fleet, spec, *names, notes))
    objective: tuple[str, ...] = ()
    if sites.penalty.any():
        notes.append("a customer with a prize may be left out, and its prize is then a cost")
        objective = ("total-cost + penalties",)
    moves = None
    if late:
        notes.append("no route goes from the depot to a backhaul, or from one to a delivery")
        moves = np.outer(sites.depot, sites.pickup > 0) | np.outer(sites.pickup > 0, sites.demand > 0)
        np.fill_diagonal(moves, False)
    made = with_problems(
        RoutingInstance(names[0], "vrplib", sites, travel, fleet, objective=objective, notes=tuple(notes), forbidden=moves)
    )
    refuse_unreachable(made, lines)
    return made


def _travel(spec: Specification, n: int, kind: str) -> tuple[Floats | None, Travel]:
    """Coordinates for maps, and distances."""
    metric = spec.value("EDGE_WEIGHT_TYPE").upper()
    line = spec.line("EDGE_WEIGHT_TYPE")
    if metric not in EDGE_WEIGHT_TYPES:
        raise InputError(f"EDGE_WEIGHT_TYPE {shown(metric)} is not supported", line=line, expected=", ".join(EDGE_WEIGHT_TYPES))
    coordinates, where = None, None
    for section in ("DISPLAY_DATA_SECTION", "NODE_COORD_SECTION"):
        if section in spec.sections:
            coordinates, where = node_table(spec, section, n, ("x", "y"))
    if metric == EXPLICIT:
        matrix, at = edge_weights(spec, n)
        if kind == "TSP" and not np.array_equal(matrix, matrix.T):
            i, j = (int(k[0]) for k in np.nonzero(matrix != matrix.T))
            raise InputError(
                f"a TSP is symmetric, but the distance from {i + 1} to {j + 1} differs from the one back; TYPE ATSP allows that",
                line=int(at[i, j]), expected=str(matrix[j, i]), found=str(matrix[i, j]),
            )  # fmt: skip
        return coordinates, Travel(EXPLICIT, matrix=matrix)
    if "EDGE_WEIGHT_SECTION" in spec.sections:
        raise InputError(f"EDGE_WEIGHT_TYPE {metric} has no EDGE_WEIGHT_SECTION", line=spec.sections["EDGE_WEIGHT_SECTION"].line)
    if spec.value("EDGE_WEIGHT_FORMAT", "FUNCTION").upper() != "FUNCTION":
        raise InputError(
            f"EDGE_WEIGHT_TYPE {metric} has another EDGE_WEIGHT_FORMAT", line=spec.line("EDGE_WEIGHT_FORMAT"), expected="FUNCTION",
            found=spec.value("EDGE_WEIGHT_FORMAT"),
        )  # fmt: skip
    own, where = node_table(spec, "NODE_COORD_SECTION", n, ("x", "y"))
    if metric == "GEO":
        refuse((np.abs(own) > (90, 180)).any(axis=1), where, "latitude or longitude out of range", own, "within 90 and 180 degrees")
        coordinates = own[:, ::-1]  # a map has the longitude on its x axis
    return coordinates, Travel("euclidean" if metric == EXACT_2D else metric, coordinates=own)


def _no_minutes(coordinates: Floats | None) -> float | None:
    """The first number that is no angle in degrees and minutes."""
    assert coordinates is not None
    beyond = np.round(100.0 * np.abs(coordinates - np.trunc(coordinates)), 6) >= 60.0
    return float(coordinates[beyond][0]) if beyond.any() else None


def _scores(spec: Specification, n: int) -> Floats:
    table, lines = node_table(spec, "NODE_SCORE_SECTION", n, ("score",))
    refuse(table[:, 0] < 0, lines, "score is negative", table[:, 0], "0 or more")
    return table[:, 0]


def _orienteering(spec: Specification, name: str, sites: Sites, travel: Travel, depot: int) -> RoutingInstance:
    longest = number(spec.value("COST_LIMIT"), spec.line("COST_LIMIT"), "COST_LIMIT")
    if longest < 0:
        raise InputError("COST_LIMIT is negative", line=spec.line("COST_LIMIT"), expected="0 or more", found=spec.value("COST_LIMIT"))
    fleet = (VehicleType(1, start=depot, end=depot, max_distance=longest),)
    return RoutingInstance(name, "vrplib", sites, travel, fleet, problem=PROBLEMS["OP"][0], problems=PROBLEMS["OP"])


def _depot(spec: Specification, n: int) -> int:
    nodes, lines = node_list(spec, "DEPOT_SECTION", n)
    if len(nodes) != 1:
        raise InputError(
            "the number of depots is not supported", line=lines[-1] if lines else spec.sections["DEPOT_SECTION"].line,
            expected="one depot", found=str(len(nodes)),
        )  # fmt: skip
    if n < 2:
        raise InputError("there is no customer", line=spec.line("DIMENSION"), expected="DIMENSION of at least 2", found=str(n))
    return nodes[0] - 1


def _sites(spec: Specification, at_depot: NDArray[np.bool_], kind: str) -> tuple[Floats, Floats, Floats, Floats, list[int] | None]:
    """Demand, service, ready and due times, and the lines that say most about each site."""
    n = len(at_depot)
    demand, service, ready, due = np.zeros((n, 1)), np.zeros(n), np.zeros(n), np.full(n, math.inf)
    lines: NDArray[np.int64] | None = None
    if kind in ("CVRP", "CVRPTW") or "DEMAND_SECTION" in spec.sections or "CAPACITY" in spec.headers:
        demand, lines = _demands(spec, n)
        refuse((demand < 0).any(axis=1), lines, "demand is negative", _bare(demand), "0 or more")
        refuse(at_depot & (demand != 0).any(axis=1), lines, "the depot has a demand", _bare(demand), "0")
        if not spec.sections.keys() & {"CAPACITY_SECTION", "CAPACITIES"} and kind not in RICH:
            spec.value("CAPACITY")
    told = _services(spec, at_depot)
    if told is not None:
        service, lines = told[0], lines if told[1] is None else told[1]
    if kind in ("VRPTW", "CVRPTW", "MDVRPTW", "PCVRPTW") or "TIME_WINDOW_SECTION" in spec.sections:
        if kind == "CVRP":
            raise InputError("TYPE CVRP has no TIME_WINDOW_SECTION; TYPE VRPTW has", line=spec.sections["TIME_WINDOW_SECTION"].line)
        windows, lines = _windows(spec, n)
        ready, due = windows.T
    return demand, service, ready, due, None if lines is None else lines.tolist()


def _demands(spec: Specification, n: int) -> tuple[Floats, Lines]:
    """Of all loads, shape (nodes, loads): the section has a column for each."""
    rows = spec.section("DEMAND_SECTION").rows
    width = len(rows[0][1].split()) - 1 if rows else 1
    return node_table(spec, "DEMAND_SECTION", n, ("demand",) * max(1, width))


def _bare(values: Floats) -> Floats:
    """One number a row where there is one column, for messages."""
    return values[:, 0] if values.shape[1] == 1 else values


def _services(spec: Specification, at_depot: NDArray[np.bool_]) -> tuple[Floats, Lines | None] | None:
    """Service times, and their lines where they stand in a section; None where there are none."""
    if "SERVICE_TIME" in spec.headers:
        if "SERVICE_TIME_SECTION" in spec.sections:
            raise InputError("SERVICE_TIME stands beside a SERVICE_TIME_SECTION", line=spec.line("SERVICE_TIME"), expected="one of them")
        every = number(spec.value("SERVICE_TIME"), spec.line("SERVICE_TIME"), "SERVICE_TIME")
        if every < 0:
            raise InputError("SERVICE_TIME is negative", line=spec.line("SERVICE_TIME"), expected="0 or more", found=str(every))
        return np.where(at_depot, 0.0, every), None
    if "SERVICE_TIME_SECTION" not in spec.sections:
        return None
    table, lines = node_table(spec, "SERVICE_TIME_SECTION", len(at_depot), ("service time",))
    service = table[:, 0]
    refuse(service < 0, lines, "service time is negative", service, "0 or more")
    refuse(at_depot & (service != 0), lines, "the depot has a service time", service, "0")
    return service, lines


def _windows(spec: Specification, n: int) -> tuple[Floats, Lines]:
    """Ready times and due dates, shape (nodes, 2)."""
    table, lines = node_table(spec, "TIME_WINDOW_SECTION", n, ("ready time", "due date"))
    refuse(table[:, 0] > table[:, 1], lines, "time window closes before it opens", table, "ready time <= due date")
    return table, lines


def _pickups(spec: Specification, travel: Travel, depot: int) -> tuple[Floats, Floats, Floats, Floats, Floats, list[int]]:
    """Delivery, pickup, service, ready and due times, and the lines."""
    n = len(travel)
    table, lines = node_table(spec, PICKUPS, n, ("0", "ready time", "due date", "service time", "pickup", "delivery"))
    unused, ready, due, service, pickup, delivery = table.T
    refuse(unused != 0, lines, "second column is not supported", unused, "0, as pickups and deliveries stand in the last columns")
    refuse(ready > due, lines, "time window closes before it opens", table[:, 1:3], "ready time <= due date")
    for what, values in (("service time", service), ("pickup", pickup), ("delivery", delivery)):
        refuse(values < 0, lines, f"{what} is negative", values, "0 or more")
    loads = table[:, 3:]
    refuse((np.arange(n) == depot) & (loads != 0).any(axis=1), lines, "the depot has a service time, a pickup or a delivery", loads, "0")
    spec.value("CAPACITY")
    if always_open(travel, ready, due, service):
        due = np.full(n, math.inf)
    return delivery, pickup, service, ready, due, lines.tolist()


def _pairs(spec: Specification, n: int, depot: int) -> tuple[list[Shipment], Floats, Floats, Floats, list[int]]:
    """Pairs of pickup and delivery, service, ready and due times, and the lines."""
    rows, at_depot = spec.section(PICKUPS).rows, np.arange(n) == 0
    short = bool(rows) and len(rows[0][1].split()) == 3
    columns = ("pickup", "delivery") if short else ("demand", "ready time", "due date", "service time", "pickup", "delivery")
    table, lines = node_table(spec, PICKUPS, n, columns)
    blank = np.column_stack([np.zeros((n, 2)), np.full(n, math.inf), np.zeros(n)])
    held, partners = blank if short else table[:, :4], table[:, -2:]
    refuse(np.asarray(depot != 0), lines, "the depot must be node 1", [depot + 1], "1")
    refuse(held[:, 3] < 0, lines, "service time is negative", held[:, 3], "0 or more")
    refuse(held[:, 1] > held[:, 2], lines, "time window closes before it opens", held[:, 1:3], "ready time <= due date")

    def told(section: str, own: Floats, elsewhere: Floats | None) -> Floats:
        """What stands in a section of its own, which a full row must not contradict."""
        if elsewhere is None:
            return own
        if not short:
            refuse((elsewhere[:, : own.shape[1]] != own).any(axis=1), lines, f"row differs from {section}", own, "the same values")
        return elsewhere

    services = _services(spec, at_depot)
    demand = told("DEMAND_SECTION", held[:, :1], _demands(spec, n)[0] if "DEMAND_SECTION" in spec.sections else None)
    window = told("TIME_WINDOW_SECTION", held[:, 1:3], _windows(spec, n)[0] if "TIME_WINDOW_SECTION" in spec.sections else None)
    service = told("SERVICE_TIME", held[:, 3:], None if services is None else services[0][:, None])
    loads = np.column_stack([demand, service, partners])
    refuse(at_depot & (loads != 0).any(axis=1), lines, "the depot has a demand, a service time or a partner", loads, "0")
    spec.value("CAPACITY")
    return pairs_of(demand, partners, lines.tolist(), first=1), service[:, 0], window[:, 0], window[:, 1], lines.tolist()


def _capacities(spec: Specification, dimensions: int) -> tuple[float, ...]:
    """One for each load; infinite where the file has none."""
    if dimensions == 1 or "CAPACITY" not in spec.headers:
        return (_limit(spec, "CAPACITY"),)
    given = spec.value("CAPACITY").replace(",", " ").split()
    if len(given) != dimensions:
        line, expected = spec.line("CAPACITY"), f"{dimensions} numbers"
        raise InputError("CAPACITY has another number of loads than the demands", line=line, expected=expected, found=str(len(given)))
    values = [number(value, spec.line("CAPACITY"), "CAPACITY") for value in given]
    if min(values) <= 0:
        raise InputError("CAPACITY must be positive", line=spec.line("CAPACITY"), expected="more than 0", found=spec.value("CAPACITY"))
    return tuple(values)


def _limit(spec: Specification, key: str) -> float:
    """A positive header, infinite where the file has none."""
    if key not in spec.headers:
        return math.inf
    value = number(spec.value(key), spec.line(key), key)
    if value <= 0:
        raise InputError(f"{key} must be positive", line=spec.line(key), expected="more than 0", found=spec.value(key))
    return value


def _fleet(spec: Specification, name: str, stem: str, notes: list[str]) -> int | None:
    if "VEHICLES" in spec.headers:
        return whole(spec.value("VEHICLES"), spec.line("VEHICLES"), "VEHICLES", least=1)
    for text in (name, stem):
        if SET_X.match(text):
            notes.append(f"the fleet is unlimited: in Uchoa's set X the k of {text} is the least possible number of routes")
            return None
        if match := FLEET_IN_NAME.search(text):
            count = int(match[1])
            if count < 1:
                raise InputError(f"the name {text} stands for a fleet of no vehicles", line=spec.headers.get("NAME", (None, ""))[0])
            notes.append(f"at most {count} vehicles: the fleet is named only in the file's name {text}, and read as an upper limit")
            return count
    return None


FORMATS.add(
    "vrplib",
    Format(
        "vrplib", "TSPLIB / CVRPLIB / VRPLIB / OPLib / LKH-3 text (TSP, ATSP, CVRP, VRPTW, OP, VRPSPD)", recognises, read, write,
        (".vrp", ".tsp", ".oplib", ".vrpspd"), "",
        ("tsp", "cvrp", "vrptw", "pdptw", "orienteering", "team-orienteering", "min-cost-vrp"), "file",
    ),
)  # fmt: skip
