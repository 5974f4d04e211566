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

import math
import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...number_arrays import Flags, Floats
from ...text import label, number, shown
from ..fleet import with_problems
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..travel import EXPLICIT, METRICS, Travel
from ._rows import refuse, refuse_closed, refuse_negative
from ._tsplib import FLEET_IN_NAME, SET_X, Lines, Specification, edge_weights, node_column, node_list, node_table, scan
from ._tsplib_writer import EXACT_2D, always_open, write
from ._vrplib_fleet import RICH_HEADERS, RICH_SECTIONS, at_customers, depots_of, fleet_of, groups_of, is_rich, skills_of
from .li_lim import pairs_of

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
"""Headers and sections of each type."""
_MARK = re.compile(r"^[ \t]*(?:(?:DIMENSION|EDGE_WEIGHT_TYPE|TYPE|NAME)[ \t]*:|(?:NODE_COORD|EDGE_WEIGHT|DEMAND)_SECTION\b)", re.M)


def recognises(text: str) -> bool:
    """True if one of TSPLIB's keywords stands at the start of a line."""
    return not text.lstrip().startswith("{") and _MARK.search(text) is not None


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    spec = scan(text)
    if "LINEHAUL_SECTION" in spec.sections and "DEMAND_SECTION" not in spec.sections:
        spec.sections["DEMAND_SECTION"] = spec.sections.pop("LINEHAUL_SECTION")
    if "NODE_SEQUENCE_SECTION" in spec.sections:
        raise InputError("is a solution file, not an instance", "foreign", line=spec.sections["NODE_SEQUENCE_SECTION"].line)
    kind = spec.value("TYPE").upper().split()[0] if "TYPE" in spec.headers else _meant(spec)
    if kind == "TOUR":
        raise InputError("is a solution file, not an instance", "foreign", line=spec.line("TYPE"))
    if kind not in PROBLEMS:
        raise InputError(f"TYPE {shown(kind)} is not supported", "unsupported", line=spec.line("TYPE"), expected=", ".join(PROBLEMS))
    headers, sections = zip(*KEYWORDS.values(), strict=True)
    spec.refuse_unknown(frozenset().union(*headers), frozenset().union(*sections))
    spec.refuse_unknown(*KEYWORDS[kind], f" in a file of TYPE {kind}")
    n = spec.whole("DIMENSION")
    name = label(spec.headers["NAME"][1] if "NAME" in spec.headers and spec.headers["NAME"][1] else path.stem)
    xy, travel = _travel(spec, n, kind)
    is_tsp = kind in ("TSP", "ATSP")
    depots = [0] if is_tsp else depots_of(spec, n) if PICKUPS not in spec.sections and kind != "OP" else [_depot(spec, n)]
    depot, at_depot = depots[0], np.isin(np.arange(n), depots)
    ids = [str(k) for k in range(1, n + 1)]
    if kind == "OP":
        rewards = node_column(spec, "NODE_SCORE_SECTION", n, "score")[0]
        sites = Sites.of(ids, depot=at_depot, reward=rewards, required=False, coordinates=xy)
        return _orienteering(spec, name, sites, travel, depot)
    notes: list[str] = [] if "TYPE" in spec.headers else [f"the file has no TYPE, and is read as {kind} by what it holds"]
    if travel.metric == "GEO" and (angle := _no_minutes(travel.coordinates)) is not None:
        notes.append(f"GEO coordinates are degrees and minutes (DDD.MM), and {angle:g} has 60 minutes or more: decimal degrees belong into "
                     "the columns lat and lon of a CSV file")  # fmt: skip
    lines: list[int] | None
    if kind in SIMULTANEOUS:
        columns, lines = _pickups(spec, travel, depot)
        if "VEHICLES" in spec.headers:
            notes.append("published values of simultaneous pickups and deliveries keep no number of vehicles: set vehicles=unlimited")
    elif kind == PAIRED:
        columns, lines = _pairs(spec, n, depot)
    else:
        columns, lines = _sites(spec, at_depot, kind)
        columns["pickup"] = at_customers(spec, "BACKHAUL_SECTION", "backhaul", n, depots)
    prizes = at_customers(spec, "PRIZE_SECTION", "prize", n, depots)
    groups = groups_of(spec, n, depots, prizes)
    if prizes is not None:
        grouped = np.isin(np.arange(n), [site for group in groups for site in group.sites])
        columns |= {"penalty": prizes, "required": (prizes == 0.0) & ~grouped}
    columns = {key: values for key, values in columns.items() if values is not None}
    sites = Sites.of(ids, depot=at_depot, coordinates=xy, groups=groups, skills=skills_of(spec, n, depots), **columns)
    if is_rich(spec, depots) or prizes is not None or kind in RICH:
        if sites.dimensions > 1:
            raise InputError("several loads beside prizes, several depots or vehicles that differ are not supported", "unsupported",
                             line=spec.sections["DEMAND_SECTION"].line, expected="a DEMAND_SECTION of one column")  # fmt: skip
        return _rich(spec, (name, label(path.stem)), sites, travel, depots, notes, lines, kind == BACKHAULS)
    count = _fleet(spec, name, label(path.stem), notes) if not is_tsp or "VEHICLES" in spec.headers else 1
    capacities, longest = _capacities(spec, sites.dimensions), _limit(spec, "DISTANCE")
    if math.isfinite(longest):
        notes.append(f"DISTANCE {longest:g} limits the duration of a route, service included")
    fleet = (VehicleType(count, capacities[0], start=depot, end=depot, max_duration=longest, further_capacity=capacities[1:]),)
    problems = PROBLEMS[kind] if count == 1 or not is_tsp else ("min-cost-vrp", "min-makespan-vrp")
    if kind in SIMULTANEOUS and (sites.ready.any() or np.isfinite(sites.due).any()):
        problems = PROBLEMS["VRPTW"]
    instance = RoutingInstance(name, "vrplib", sites, travel, fleet, problem=problems[0], problems=problems, notes=tuple(notes))
    refuse_unreachable(instance, lines)
    return instance


def _meant(spec: Specification) -> str:
    """The TYPE of a file without that header, by the sections that it has."""
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
    """The instance with vehicles of several kinds or depots, prizes, and backhauls, after all deliveries of a route where ``late``."""
    longest = _limit(spec, "DISTANCE")
    fleet = fleet_of(spec, len(sites), depots, longest, partial(_fleet, spec, *names, notes))
    objective: tuple[str, ...] = ()
    if sites.penalty.any():
        notes.append("a customer with a prize may be left out, and its prize is then a cost")
        objective = ("total-cost + penalties",)
    forbidden = None
    if late:
        notes.append("no route goes from the depot to a backhaul, or from one to a delivery")
        forbidden = np.outer(sites.depot, sites.pickup > 0) | np.outer(sites.pickup > 0, sites.demand > 0)
        np.fill_diagonal(forbidden, False)
    name, told = names[0], tuple(notes)
    instance = with_problems(
        RoutingInstance(name, "vrplib", sites, travel, fleet, objective=objective, notes=told, forbidden=forbidden)
    )  # fmt: skip
    refuse_unreachable(instance, lines)
    return instance


def _travel(spec: Specification, n: int, kind: str) -> tuple[Floats | None, Travel]:
    """Coordinates for maps, and distances."""
    metric = spec.value("EDGE_WEIGHT_TYPE").upper()
    line = spec.line("EDGE_WEIGHT_TYPE")
    if metric not in EDGE_WEIGHT_TYPES:
        message = f"EDGE_WEIGHT_TYPE {shown(metric)} is not supported"
        raise InputError(message, "unsupported", line=line, expected=", ".join(EDGE_WEIGHT_TYPES))
    coordinates, where = None, None
    for section in ("DISPLAY_DATA_SECTION", "NODE_COORD_SECTION"):
        if section in spec.sections:
            coordinates, where = node_table(spec, section, n, ("x", "y"))
    if metric == EXPLICIT:
        matrix, at = edge_weights(spec, n)
        if kind == "TSP" and not np.array_equal(matrix, matrix.T):
            i, j = (int(k[0]) for k in np.nonzero(matrix != matrix.T))
            message = f"a TSP is symmetric, but the distance from {i + 1} to {j + 1} differs from the one back; TYPE ATSP allows that"
            raise InputError(message, "contradiction", line=int(at[i, j]), expected=str(matrix[j, i]), found=str(matrix[i, j]))
        return coordinates, Travel(EXPLICIT, matrix=matrix)
    if "EDGE_WEIGHT_SECTION" in spec.sections:
        message = f"EDGE_WEIGHT_TYPE {metric} has no EDGE_WEIGHT_SECTION"
        raise InputError(message, "contradiction", line=spec.sections["EDGE_WEIGHT_SECTION"].line)
    if spec.value("EDGE_WEIGHT_FORMAT", "FUNCTION").upper() != "FUNCTION":
        line, layout = spec.line("EDGE_WEIGHT_FORMAT"), spec.value("EDGE_WEIGHT_FORMAT")
        message = f"EDGE_WEIGHT_TYPE {metric} has another EDGE_WEIGHT_FORMAT"
        raise InputError(message, "contradiction", line=line, expected="FUNCTION", found=layout)
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


def _orienteering(spec: Specification, name: str, sites: Sites, travel: Travel, depot: int) -> RoutingInstance:
    longest = spec.number("COST_LIMIT")
    if longest < 0:
        raise spec.fault("COST_LIMIT", "is negative", "0 or more")
    fleet = (VehicleType(1, start=depot, end=depot, max_distance=longest),)
    return RoutingInstance(name, "vrplib", sites, travel, fleet, problem=PROBLEMS["OP"][0], problems=PROBLEMS["OP"])


def _depot(spec: Specification, n: int) -> int:
    nodes, lines = node_list(spec, "DEPOT_SECTION", n)
    if len(nodes) != 1:
        line = lines[-1] if lines else spec.sections["DEPOT_SECTION"].line
        raise InputError("the number of depots is not supported", "unsupported", line=line, expected="one depot", found=str(len(nodes)))
    if n < 2:
        raise InputError("there is no customer", "missing", line=spec.line("DIMENSION"), expected="DIMENSION of at least 2", found=str(n))
    return nodes[0] - 1


Columns = dict[str, Any]
"""Arguments of ``Sites.of``."""


def _sites(spec: Specification, at_depot: Flags, kind: str) -> tuple[Columns, list[int] | None]:
    """Demand, service, ready and due times, and the lines that say most about each site."""
    n = len(at_depot)
    columns: Columns = {"demand": np.zeros((n, 1))}
    lines: Lines | None = None
    if kind in ("CVRP", "CVRPTW") or "DEMAND_SECTION" in spec.sections or "CAPACITY" in spec.headers:
        demand, lines = _demands(spec, n)
        columns["demand"], shown_demand = demand, demand[:, 0] if demand.shape[1] == 1 else demand
        refuse((demand < 0).any(axis=1), lines, "demand is negative", shown_demand, "0 or more")
        refuse(at_depot & (demand != 0).any(axis=1), lines, "the depot has a demand", shown_demand, "0", "contradiction")
        if not spec.sections.keys() & {"CAPACITY_SECTION", "CAPACITIES"} and kind not in RICH:
            spec.value("CAPACITY")
    services = _services(spec, at_depot)
    if services is not None:
        columns["service"], lines = services[0], lines if services[1] is None else services[1]
    if kind in ("VRPTW", "CVRPTW", "MDVRPTW", "PCVRPTW") or "TIME_WINDOW_SECTION" in spec.sections:
        if kind == "CVRP":
            message = "TYPE CVRP has no TIME_WINDOW_SECTION; TYPE VRPTW has"
            raise InputError(message, "contradiction", line=spec.sections["TIME_WINDOW_SECTION"].line)
        windows, lines = _windows(spec, n)
        columns["ready"], columns["due"] = windows.T
    return columns, None if lines is None else lines.tolist()


def _demands(spec: Specification, n: int) -> tuple[Floats, Lines]:
    """All loads, shape (nodes, loads), of which the section has a column each, and their lines."""
    rows = spec.section("DEMAND_SECTION").rows
    width = len(rows[0][1].split()) - 1 if rows else 1
    return node_table(spec, "DEMAND_SECTION", n, ("demand",) * max(1, width))


def _services(spec: Specification, at_depot: Flags) -> tuple[Floats, Lines | None] | None:
    """Service times, and their lines where they stand in a section; None where there are none."""
    if "SERVICE_TIME" in spec.headers:
        if "SERVICE_TIME_SECTION" in spec.sections:
            message = "SERVICE_TIME stands beside a SERVICE_TIME_SECTION"
            raise InputError(message, "contradiction", line=spec.line("SERVICE_TIME"), expected="one of them")
        every = spec.number("SERVICE_TIME")
        if every < 0:
            raise spec.fault("SERVICE_TIME", "is negative", "0 or more", str(every))
        return np.where(at_depot, 0.0, every), None
    if "SERVICE_TIME_SECTION" not in spec.sections:
        return None
    service, lines = node_column(spec, "SERVICE_TIME_SECTION", len(at_depot), "service time")
    refuse(at_depot & (service != 0), lines, "the depot has a service time", service, "0", "contradiction")
    return service, lines


def _windows(spec: Specification, n: int) -> tuple[Floats, Lines]:
    """Ready times and due dates, shape (nodes, 2)."""
    table, lines = node_table(spec, "TIME_WINDOW_SECTION", n, ("ready time", "due date"))
    refuse_closed(lines, table)
    return table, lines


def _pickups(spec: Specification, travel: Travel, depot: int) -> tuple[Columns, list[int]]:
    """Delivery, pickup, service, ready and due times, and the lines."""
    n = len(travel)
    table, lines = node_table(spec, PICKUPS, n, ("0", "ready time", "due date", "service time", "pickup", "delivery"))
    unused, ready, due, service, pickup, delivery = table.T
    message = "second column is not supported"
    refuse(unused != 0, lines, message, unused, "0, as pickups and deliveries stand in the last columns", "unsupported")
    refuse_closed(lines, table[:, 1:3])
    refuse_negative(lines, service_time=service, pickup=pickup, delivery=delivery)
    loads = table[:, 3:]
    message = "the depot has a service time, a pickup or a delivery"
    refuse((np.arange(n) == depot) & (loads != 0).any(axis=1), lines, message, loads, "0", "contradiction")
    spec.value("CAPACITY")
    if always_open(travel, ready, due, service):
        due = np.full(n, math.inf)
    return {"demand": delivery[:, None], "pickup": pickup, "service": service, "ready": ready, "due": due}, lines.tolist()


def _pairs(spec: Specification, n: int, depot: int) -> tuple[Columns, list[int]]:
    """Pairs of pickup and delivery, service, ready and due times, and the lines."""
    rows, at_depot = spec.section(PICKUPS).rows, np.arange(n) == 0
    short = bool(rows) and len(rows[0][1].split()) == 3
    columns = ("pickup", "delivery") if short else ("demand", "ready time", "due date", "service time", "pickup", "delivery")
    table, lines = node_table(spec, PICKUPS, n, columns)
    blank = np.column_stack([np.zeros((n, 2)), np.full(n, math.inf), np.zeros(n)])
    held, partners = blank if short else table[:, :4], table[:, -2:]
    refuse(np.asarray(depot != 0), lines, "the depot must be node 1", [depot + 1], "1", "unsupported")
    refuse_negative(lines, service_time=held[:, 3])
    refuse_closed(lines, held[:, 1:3])

    def merged(section: str, own: Floats, elsewhere: Floats | None) -> Floats:
        """Values of a section of their own, which a full row must not contradict; else those of the row."""
        if elsewhere is None:
            return own
        if not short:
            message = f"row differs from {section}"
            refuse((elsewhere[:, : own.shape[1]] != own).any(axis=1), lines, message, own, "the same values", "contradiction")
        return elsewhere

    services = _services(spec, at_depot)
    demand = merged("DEMAND_SECTION", held[:, :1], _demands(spec, n)[0] if "DEMAND_SECTION" in spec.sections else None)
    window = merged("TIME_WINDOW_SECTION", held[:, 1:3], _windows(spec, n)[0] if "TIME_WINDOW_SECTION" in spec.sections else None)
    service = merged("SERVICE_TIME", held[:, 3:], None if services is None else services[0][:, None])
    loads = np.column_stack([demand, service, partners])
    refuse(at_depot & (loads != 0).any(axis=1), lines, "the depot has a demand, a service time or a partner", loads, "0", "contradiction")
    spec.value("CAPACITY")
    shipments, (ready, due) = pairs_of(demand, partners, lines.tolist(), first=1), window.T
    loads = np.zeros((n, max((len(shipment.load) for shipment in shipments), default=1)))
    return {"shipments": shipments, "demand": loads, "service": service[:, 0], "ready": ready, "due": due}, lines.tolist()


def _capacities(spec: Specification, dimensions: int) -> tuple[float, ...]:
    """One capacity for each load, infinite without the header."""
    if dimensions == 1 or "CAPACITY" not in spec.headers:
        return (_limit(spec, "CAPACITY"),)
    tokens, line = spec.value("CAPACITY").replace(",", " ").split(), spec.line("CAPACITY")
    if len(tokens) != dimensions:
        message, expected = "CAPACITY has another number of loads than the demands", f"{dimensions} numbers"
        raise InputError(message, "wrong-shape", line=line, expected=expected, found=str(len(tokens)))
    values = [number(token, line, "CAPACITY") for token in tokens]
    if min(values) <= 0:
        raise spec.fault("CAPACITY", "must be positive", "more than 0")
    return tuple(values)


def _limit(spec: Specification, key: str) -> float:
    """A positive header, infinite where the file has none."""
    if key not in spec.headers:
        return math.inf
    if (value := spec.number(key)) <= 0:
        raise spec.fault(key, "must be positive", "more than 0")
    return value


def _fleet(spec: Specification, name: str, stem: str, notes: list[str]) -> int | None:
    """The number of vehicles, by the header or by a name; adds a note where a name says it."""
    if "VEHICLES" in spec.headers:
        return spec.whole("VEHICLES")
    for text in (name, stem):
        if SET_X.match(text):
            notes.append(f"the fleet is unlimited: in Uchoa's set X the k of {text} is the least possible number of routes")
            return None
        if match := FLEET_IN_NAME.search(text):
            count = int(match[1])
            if count < 1:
                message = f"the name {text} stands for a fleet of no vehicles"
                raise InputError(message, "out-of-range", line=spec.headers.get("NAME", (None, ""))[0])
            notes.append(f"at most {count} vehicles: the fleet is named only in the file's name {text}, and read as an upper limit")
            return count
    return None


FORMATS.enter(
    Format(
        "vrplib", "TSPLIB / CVRPLIB / VRPLIB / OPLib / LKH-3 text (TSP, ATSP, CVRP, VRPTW, OP, VRPSPD)", recognises, read, write,
        (".vrp", ".tsp", ".oplib", ".vrpspd"), convention="file",
        problems=("tsp", "cvrp", "vrptw", "pdptw", "orienteering", "team-orienteering", "min-cost-vrp"),
    )
)  # fmt: skip
