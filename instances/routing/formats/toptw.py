"""Team orienteering with time windows: files made of Solomon's and Cordeau's by Righini and Salani, Montemanni and Gambardella.

First line ``k v N t``, of which N alone counts, the number of points; a second line ``D Q`` without a meaning; row 0, the depot, whose due
date is the longest duration of a tour; N rows ``i x y service profit f a list ready due``. Sites keep the file's numbers, by which solution
files name customers too.

The number of tours is left open: it is 1 unless ``vehicles`` is set. The literature rounds distances down, to one decimal for Solomon's
files and to two for Cordeau's; a note says so, and the convention of distance is to be given.

Source: Righini and Salani (2009), Computers and Operations Research 36(4); Vansteenwegen, Souffriau, Vanden Berghe and Van Oudheusden
(2009), Computers and Operations Research 36(12).
"""

import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import label, numbers, plain, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel
from ._limits import ORIENTEERING, finite, numbered, points_of, refuse_inexpressible, refuse_where
from ._rows import Rows, head, refuse, widths
from .cordeau import Table

PROBLEMS = ("team-orienteering", "orienteering")
EXPRESSIBLE = frozenset({"rewards", "optional-sites", "limited-fleet", "time-windows", "depot-windows", "service-times"})
_CORDEAU = re.compile(r"pr\d+", re.I)
_OPEN = "the file leaves the number of tours open, and one is meant: set vehicles=4 for four"


def recognises(text: str) -> bool:
    """True if four numbers, two numbers and a row 0 with windows follow each other."""
    lines = head(text, 3)
    sizes = widths(lines)
    return sizes[:2] == [4, 2] and len(sizes) == 3 and sizes[2] >= 9 and lines[2][0] == "0"


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, header = rows.values("first line", ("k", "v", "N", "t"))
    n = whole(plain(header[2]), line, "number of points", least=1)
    line, unused = rows.next("a second line of two numbers")
    if len(numbers(unused, line, "second line")) != 2:
        raise InputError("second line has a wrong length", "wrong-shape", line=line, expected="D Q", found=f"{len(unused.split())} values")
    table = Table()
    table.read(rows, "depot", 0, 1, windows=True)
    table.read(rows, "point", 1, n, windows=True)
    rows.end()
    table.check("profit")
    columns, at = table.columns, table.at
    at_depot = (np.arange(n + 1) == 0) & (columns[:, 3:5] != 0).any(axis=1)
    refuse(at_depot, at, "the depot has a profit or a service time", columns[:, 3:5], "0", "contradiction")
    sites = Sites.of(
        range(n + 1), service=columns[:, 3], reward=columns[:, 4], ready=columns[:, 5], due=columns[:, 6], required=False,
        coordinates=columns[:, 1:3],
    )  # fmt: skip
    name = label(path.stem)
    digits, convention = ("two decimals", "trunc2") if _CORDEAU.match(name) else ("one decimal", "trunc1")
    notes = (_OPEN, f"published values are for distances rounded down to {digits}: --convention {convention}")
    travel = Travel("euclidean", columns[:, 1:3])
    return RoutingInstance(name, "toptw", sites, travel, (VehicleType(1),), problem=PROBLEMS[0], problems=PROBLEMS, notes=notes)


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(instance, "toptw", EXPRESSIBLE)
    sites, xy = instance.sites, points_of(instance, "toptw")
    refuse_where(
        instance, "toptw",
        (instance.problem not in ORIENTEERING or sites.required.any(), "it has sites that must be visited, or is no orienteering problem"),
        (instance.fleet[0].count != 1, "the format does not say how many tours there are, so that one is meant"),
        (not finite(sites.due) or sites.service[0] or sites.reward[0],
         "every site needs a due date, and the depot neither profit nor service"),
        (not numbered(instance, 0), "sites must be numbered 0, 1, 2, ... from the depot"),
    )  # fmt: skip
    out = [f"0 1 {len(sites) - 1} 1", "0 0"]
    for k, site in enumerate(sites.ids):
        row = [site, *map(plain, (*xy[k], sites.service[k], sites.reward[k]))]
        row += ["1", "1", "1"] if k else ["0", "0"]
        out.append(" ".join([*row, plain(sites.ready[k]), plain(sites.due[k])]))
    return "\n".join(out) + "\n"


FORMATS.enter(
    Format(
        "toptw", "team orienteering with time windows, made of Solomon's and Cordeau's files", recognises, read, write, (".toptw",),
        PROBLEMS[0], PROBLEMS, sense="max",
    )
)  # fmt: skip
