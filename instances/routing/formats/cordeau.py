"""Cordeau's text format: VRP, VRPTW, and both with several depots.

First line ``type m n t``; then ``t`` lines ``D Q``, longest duration of a route (0 for none; services count) and capacity, one for each
depot; then rows ``i x y d q f a list``, with windows ``e l`` behind: number, coordinates, service time, demand, visits asked for, and the
combinations in which they may be made, one bit each. Types 0 (VRP) and 4 (VRPTW) have ``m`` vehicles, and the depot in row 0; types 2
(MDVRP) and 6 (MDVRPTW) have ``m`` vehicles at each of ``t`` depots, whose rows stand behind those of the customers. Sites keep the
file's numbers, by which solution files name customers too.

Periodic and site-dependent problems (types 1, 3, 5 and 7) are refused, and so are customers whom not every depot may serve.

Source: Cordeau, Gendreau and Laporte (1997), Networks 30(2); Cordeau, Laporte and Mercier (2001), Journal of the Operational Research
Society 52(8).
"""

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...number_arrays import Floats
from ...text import an, label, number, numbers, plain, shown, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..reach import refuse_unreachable
from ..travel import Travel
from ._limits import finite, numbered, points_of, refuse_inexpressible, refuse_where
from ._rows import Rows, head, refuse, refuse_closed, refuse_negative, widths

HEADER = ("type", "m", "n", "t")
TYPES = {0: "VRP", 1: "PVRP", 2: "MDVRP", 3: "SDVRP", 4: "VRPTW", 5: "PVRPTW", 6: "MDVRPTW", 7: "SDVRPTW"}
MOST_DEPOTS = 1000
"""Each depot is a bit of the combinations, which are read as floating point numbers."""

PROBLEMS = {0: ("cvrp", "min-cost-vrp"), 4: ("vrptw", "min-cost-vrp"), 2: ("mdvrp", "min-cost-vrp"), 6: ("mdvrp", "min-cost-vrp")}
EXPRESSIBLE = frozenset(
    {
        "capacity", "demands", "time-windows", "depot-windows", "service-times", "limited-fleet", "heterogeneous-fleet", "multiple-depots",
        "max-duration",
    }
)  # fmt: skip


@dataclass
class Table:
    """Rows ``number, x, y, service, load, ready, due`` with the visits that they ask for, the combinations of these, and their lines."""

    rows: list[list[float]] = field(default_factory=list)
    frequency: list[float] = field(default_factory=list)
    combinations: list[list[float]] = field(default_factory=list)
    at: list[int] = field(default_factory=list)

    @property
    def columns(self) -> Floats:
        return np.array(self.rows, dtype=np.float64).reshape(len(self.rows), 7)

    def read(self, rows: Rows, what: str, first: int, count: int, windows: bool) -> None:
        """Add ``count`` rows that are numbered from ``first``; a claim that the file does not keep ends it early."""
        for k in range(first, first + count):
            line, text = rows.next(f"{what} {k}")
            values = numbers(text, line, what)
            size = values[6] if len(values) > 6 else 0.0
            width = 7 + int(size) + 2 * windows if size in range(len(values)) else -1
            if len(values) != width:
                shape = "number, x, y, service, demand, f, a, a numbers" + ", ready, due" * windows
                message = f"row of {an(what)} has a wrong length"
                raise InputError(message, "wrong-shape", line=line, expected=shape, found=f"{len(values)} values")
            if values[0] != k:
                raise InputError(f"number of {an(what)} is out of order", line=line, expected=str(k), found=plain(values[0]))
            ready, due = values[-2:] if windows else (0.0, np.inf)
            self.rows.append([*values[:5], ready, due])
            self.frequency.append(values[5])
            self.combinations.append(values[7 : 7 + int(size)])
            self.at.append(line)

    def check(self, load: str) -> None:
        """Raise InputError for negative numbers and windows that close before they open; ``load`` names the fifth column."""
        table = self.columns
        refuse_negative(self.at, **{"service_time": table[:, 3], load: table[:, 4]})
        refuse_closed(self.at, table[:, 5:])


def recognises(text: str) -> bool:
    """True if ``type m n t`` is followed by ``D Q``, and not by a row 0 where the type has none or another ``D Q`` belongs."""
    lines = head(text, 3)
    if widths(lines)[:2] != [4, 2] or lines[0][0] not in map(str, TYPES):
        return False
    depot_first = len(lines) > 2 and len(lines[2]) > 2 and lines[2][0] == "0"
    return not depot_first or (lines[0][3] == "1" and lines[0][0] not in ("2", "6"))


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, header = rows.values("first line", HEADER)
    kind, vehicles, n, depots = (whole(plain(v), line, what, least=k) for v, what, k in zip(header, HEADER, (0, 1, 1, 1), strict=True))
    if kind not in PROBLEMS:
        expected = ", ".join(f"{k} ({TYPES[k]})" for k in sorted(PROBLEMS))
        raise InputError(f"type {kind} ({TYPES.get(kind, 'unknown')}) is not supported", "unsupported", line=line, expected=expected)
    several, windows = kind in (2, 6), kind in (4, 6)
    if depots > MOST_DEPOTS:
        raise InputError("there are too many depots", "too-large", line=line, expected=f"at most {MOST_DEPOTS}", found=str(depots))
    if not several and depots != 1:
        raise InputError(f"type {kind} ({TYPES[kind]}) has one depot", "contradiction", line=line, expected="1", found=str(depots))
    limits = [_limit(rows) for _ in range(min(depots, len(rows.lines)))]
    table = Table()
    if not several:
        table.read(rows, "depot", 0, 1, windows)
    table.read(rows, "customer", 1, n, windows)
    if several:
        table.read(rows, "depot", n + 1, depots, windows)
    rows.end()
    table.check("demand")
    columns, at = table.columns, table.at
    depot = np.arange(n + depots) >= n if several else np.arange(n + 1) < 1
    message = "the depot has a demand or a service time"
    refuse(depot & (columns[:, 3:5] != 0).any(axis=1), at, message, columns[:, 3:5], "0", "contradiction")
    every = [2.0**k for k in range(depots)]
    visits = [(frequency, sorted(combinations)) for frequency, combinations in zip(table.frequency, table.combinations, strict=True)]
    refuse(
        ~depot & np.array([each != (1.0, every) for each in visits]), at,
        "customers that some depots alone may serve, or that are visited more than once, are not supported",
        [f"f {plain(frequency)}, list {' '.join(map(plain, combinations))}" for frequency, combinations in visits],
        f"f 1, list {' '.join(map(plain, every))}", "unsupported",
    )  # fmt: skip
    sites = Sites.of(
        [plain(v) for v in columns[:, 0].tolist()], depot=depot, service=columns[:, 3], demand=columns[:, 4], ready=columns[:, 5],
        due=columns[:, 6], coordinates=columns[:, 1:3],
    )  # fmt: skip
    ends = sites.depots.tolist()
    names = ["vehicle"] if len(ends) == 1 else [f"vehicle at {sites.ids[d]}" for d in ends]
    fleet = tuple(
        VehicleType(vehicles, load, start=d, end=d, max_duration=longest, name=name)
        for d, name, (longest, load) in zip(ends, names, limits, strict=True)
    )
    notes = (f"{vehicles} vehicles at each of {depots} depots",) if depots > 1 else ()
    travel, problems = Travel("euclidean", columns[:, 1:3]), PROBLEMS[kind]
    instance = RoutingInstance(label(path.stem), "cordeau", sites, travel, fleet, problem=problems[0], problems=problems, notes=notes)
    refuse_unreachable(instance, at)
    return instance


def _limit(rows: Rows) -> tuple[float, float]:
    """Longest duration and capacity."""
    line, tokens = rows.tokens("line of limits", "longest duration and capacity", 2)
    longest, load = number(tokens[0], line, "longest duration"), number(tokens[1], line, "capacity")
    if longest < 0:
        raise InputError("longest duration is negative", "out-of-range", line=line, expected="0 (none) or more", found=shown(tokens[0]))
    if load <= 0:
        raise InputError("capacity must be positive", "out-of-range", line=line, expected="more than 0", found=shown(tokens[1]))
    return longest or math.inf, load


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    present = refuse_inexpressible(instance, "cordeau", EXPRESSIBLE)
    sites, fleet, depots, xy = instance.sites, instance.fleet, instance.sites.depots.tolist(), points_of(instance, "cordeau")
    n, count = len(sites.customers), fleet[0].count
    windows, several = bool(present & {"time-windows", "depot-windows"}), instance.problem == "mdvrp"
    refuse_where(
        instance, "cordeau",
        ([(v.start, v.end) for v in fleet] != [(d, d) for d in depots] or len({v.count for v in fleet}) > 1 or count is None,
         "the format needs the same number of vehicles at each depot, where they return to"),
        (not all(0 < v.capacity < math.inf and v.max_duration > 0 for v in fleet),
         "each vehicle needs a capacity, and a limit above 0 if it has one"),
        (windows and not finite(sites.due), "every site needs a due date if one has it"),
        (not several and len(depots) > 1, f"several depots make it an mdvrp, not {an(instance.problem)}"),
        (not numbered(instance, int(several), range(n, n + len(depots)) if several else (0,)),
         "sites must be numbered in order, one depot before the customers or the depots of an mdvrp behind"),
    )  # fmt: skip
    combinations = [1 << k for k in range(len(depots))]
    out = [f"{(2 if several else 0) + 4 * windows} {count} {n} {len(depots)}"]
    out += [f"{plain(0.0 if math.isinf(v.max_duration) else v.max_duration)} {plain(v.capacity)}" for v in fleet]
    for k, site in enumerate(sites.ids):
        row = [site, *map(plain, (*xy[k], sites.service[k], sites.demand[k]))]
        row += ["0", "0"] if sites.depot[k] else ["1", str(len(depots)), *map(str, combinations)]
        row += [plain(sites.ready[k]), plain(sites.due[k])] if windows else []
        out.append(" ".join(row))
    return "\n".join(out) + "\n"


FORMATS.enter(
    Format(
        "cordeau", "Cordeau text (VRP, VRPTW, MDVRP, MDVRPTW)", recognises, read, write, (".mdvrp",),
        problems=("mdvrp", "cvrp", "vrptw", "min-cost-vrp"),
    )
)  # fmt: skip
