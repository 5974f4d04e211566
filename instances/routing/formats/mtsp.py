"""Text format of the min-max multiple travelling salesman files.

First line ``name type m``: type is one of TSPLIB's, m the number of salesmen; then ``id x y``, one city a line, the first of which is the
depot. At most m tours start and end there, and the longest of them is to be as short as can be. Sites keep the file's numbers; solution
files count cities from 1 without the depot. The instance is named for the file, for the name inside is the same for every m.

The literature measures these files by distances that are not rounded, whatever TSPLIB prescribes for the type: the convention is ``exact``.

Source: Necula, Breaban and Raschip (2015), HAIS, LNAI 9121; Mahmoudinazlou and Kwon (2024), Computers and Operations Research 162.
"""

from pathlib import Path

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import is_number, label, plain, shown, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import METRICS, Travel
from ._limits import numbered, refuse_inexpressible, refuse_where
from ._rows import Rows, head, refuse, widths

PROBLEMS = ("min-makespan-vrp", "min-cost-vrp")
TYPES = tuple(name for name, metric in METRICS.items() if metric.file_rounding is not None)


def recognises(text: str) -> bool:
    """True if a line of a name, a type and a number is followed by one of three numbers."""
    lines = head(text, 2)
    if len(lines) < 2 or len(lines[0]) != 3 or widths(lines[1:]) != [3]:
        return False
    _, metric, count = lines[0]
    return is_number(count) and metric.upper() in (*TYPES, "EXPLICIT", "EUC_3D", "XRAY1", "XRAY2", "SPECIAL")


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, tokens = rows.tokens("first line", "name, type and number of salesmen", 3)
    metric = tokens[1].upper()
    if metric not in TYPES:
        message = f"type {shown(tokens[1])} is not supported"
        raise InputError(message, "unsupported", line=line, expected=", ".join(TYPES), found=shown(tokens[1]))
    count = whole(tokens[2], line, "number of salesmen", least=1)
    table, at = rows.table("city", ("id", "x", "y"))
    for k, (where, number) in enumerate(zip(at, table[:, 0].tolist(), strict=True), start=1):
        if number != k:
            raise InputError("cities must be numbered 1, 2, 3, ...", line=where, expected=str(k), found=plain(number))
    if len(table) < 2:
        message = "ends early"
        raise InputError(message, "missing", line=rows.lines[-1][0], expected="a depot and at least one city", found=f"{len(table)} cities")
    own = table[:, 1:]
    if metric == "GEO":
        refuse((abs(own) > (90, 180)).any(axis=1), at, "latitude or longitude out of range", own, "within 90 and 180 degrees")
    sites = Sites.of(range(1, len(table) + 1), coordinates=own[:, ::-1] if metric == "GEO" else own)
    travel, fleet, name = Travel(metric, own, convention="exact"), (VehicleType(count),), label(path.stem)
    notes = (f"distances are not rounded, as is the custom of these files; {metric} by the rules of TSPLIB is --convention file",)
    return RoutingInstance(name, "mtsp", sites, travel, fleet, problem=PROBLEMS[0], problems=PROBLEMS, notes=notes)


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(instance, "mtsp", {"limited-fleet"})
    travel, vehicle = instance.travel, instance.fleet[0]
    refuse_where(
        instance, "mtsp",
        (travel.metric not in TYPES or travel.convention != "exact",
         f"its distances are {travel.metric} {travel.convention}, not one of {', '.join(TYPES)} and exact"),
        (instance.problem not in PROBLEMS or vehicle.count is None, "the format needs a number of salesmen, who visit all cities"),
        (not numbered(instance, 1), "cities must be numbered 1, 2, 3, ... from the depot"),
    )  # fmt: skip
    assert travel.coordinates is not None
    lines = [f"{k} {plain(x)} {plain(y)}" for k, (x, y) in enumerate(travel.coordinates.tolist(), start=1)]
    return "\n".join([f"{'-'.join(instance.name.split())} {travel.metric} {vehicle.count}", *lines]) + "\n"


FORMATS.enter(Format("mtsp", "min-max multiple travelling salesmen", recognises, read, write, (".mtsp",), PROBLEMS[0], PROBLEMS))
