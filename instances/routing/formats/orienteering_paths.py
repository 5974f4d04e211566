"""Text formats of orienteering along paths: of the team problem, after Chao, Golden and Wasil, and Tsiligirides' of the single one.

``chao``: ``n``, ``m`` and ``tmax`` on a line each: number of points, of paths, and the time budget of a path; then ``x y score``, one point
a line. Every path leads from the first point to the last. Sites are numbered from "0" in the file's order, which is how solution files
count.

``tsiligirides``, also used for the square and diamond sets of Chao, Golden and Wasil: first line ``Tmax P``, the time budget and the number
of paths; then points as above. Every path leads from the first point to the second. Solution files count customers from 1, so that customer
1 is point 2. The format does not say how many points there are; the names of the published files do, and a file that is cut off is noticed
by them.

Source: Chao, Golden and Wasil (1996), European Journal of Operational Research 88(3); Tsiligirides (1984), Journal of the Operational
Research Society 35(9).
"""

import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...number_arrays import Floats
from ...text import label, number, plain, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel
from ._limits import ORIENTEERING, numbered, points_of, refuse_inexpressible, refuse_where
from ._rows import Rows, head, refuse_negative, refuse_other_size, widths

POINT = ("x", "y", "score")
EXPRESSIBLE = frozenset({"rewards", "optional-sites", "limited-fleet", "multiple-depots", "open-routes", "max-duration"})
PUBLISHED = ((r"tsiligirides_problem_1_", 32), (r"tsiligirides_problem_2_", 21), (r"tsiligirides_problem_3_", 33),
             (r"set_64_1_", 64), (r"set_66_1_", 66))  # fmt: skip
"""Beginnings of the names of published files, and how many points they have."""


def recognises_chao(text: str) -> bool:
    """True if the first lines give ``n``, ``m`` and ``tmax``, or two of them."""
    keys = [line[0].lower() if len(line) == 2 else "" for line in head(text, 3)]
    return sum(map(str.__eq__, keys, ("n", "m", "tmax"))) >= 2


def recognises_tsiligirides(text: str) -> bool:
    """True if a line of two numbers is followed by one of three."""
    return widths(head(text, 2)) == [2, 3]


def read_chao(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    (at_n, n_token), (at_m, m_token), (at_t, t_token) = (rows.keyed(key) for key in ("n", "m", "tmax"))
    n = whole(n_token, at_n, "number of points", least=3)
    count = whole(m_token, at_m, "number of paths", least=1)
    limit = number(t_token, at_t, "tmax")
    if limit < 0:
        raise InputError("tmax is negative", "out-of-range", line=at_t, expected="0 or more", found=t_token)
    points, lines = rows.table("point", POINT, n)
    refuse_negative(lines, score=points[:, 2])
    return _instance(label(path.stem), "chao", points, n - 1, count, limit, ("team-orienteering", "orienteering")[: 2 if count == 1 else 1])


def read_tsiligirides(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, (limit, paths) = rows.values("first line", ("Tmax", "number of paths"))
    if limit < 0:
        raise InputError("Tmax is negative", "out-of-range", line=line, expected="0 or more", found=plain(limit))
    count = whole(plain(paths), line, "number of paths", least=1)
    points, lines = rows.table("point", POINT)
    name = label(path.stem)
    size = next((size for pattern, size in PUBLISHED if re.match(pattern, name)), len(points))
    refuse_other_size(name, "points", (size,), len(points), lines[-1] if lines else line)
    refuse_negative(lines, score=points[:, 2])
    if (n := len(points)) < 3:
        message = "ends early"
        raise InputError(message, "missing", line=rows.lines[-1][0], expected="a start, an end and a point between", found=f"{n} points")
    return _instance(name, "tsiligirides", points, 1, count, limit, ORIENTEERING if count == 1 else ORIENTEERING[1:])


def _instance(
    name: str, format_name: str, points: Floats, end: int, count: int, limit: float, problems: tuple[str, ...]
) -> RoutingInstance:  # fmt: skip
    """``count`` paths of length ``limit`` at most from the first point to the one with the index ``end``."""
    depots = np.isin(np.arange(len(points)), (0, end))
    sites = Sites.of(range(len(points)), depot=depots, reward=points[:, 2], required=False, coordinates=points[:, :2])
    fleet = (VehicleType(count, start=0, end=end, max_duration=limit),)
    return RoutingInstance(name, format_name, sites, Travel("euclidean", points[:, :2]), fleet, problem=problems[0], problems=problems)


def write_chao(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    points, vehicle = _points(instance, "chao", -1, "the last"), instance.fleet[0]
    return "\n".join([f"n {len(points)}", f"m {vehicle.count}", f"tmax {plain(vehicle.max_duration)}", *points]) + "\n"


def write_tsiligirides(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    points, vehicle = _points(instance, "tsiligirides", 1, "the second"), instance.fleet[0]
    return "\n".join([f"{plain(vehicle.max_duration)}\t{vehicle.count}", *points]) + "\n"


def _points(instance: RoutingInstance, format_name: str, end: int, last: str) -> list[str]:
    """Lines of the points; UsageError unless optional ones are visited by a number of paths of limited length from the first
    to the one with the index ``end``."""
    refuse_inexpressible(instance, format_name, EXPRESSIBLE)
    sites, vehicle = instance.sites, instance.fleet[0]
    end %= len(sites)
    xy = points_of(instance, format_name)
    refuse_where(
        instance, format_name,
        (not np.isfinite(vehicle.max_duration) or vehicle.count is None, "the format needs a number of paths and their limit"),
        (sites.required.any(), "it has sites that must be visited"),
        (instance.problem not in ORIENTEERING, f"it is no orienteering problem but {instance.problem}"),
        ((vehicle.start, vehicle.end) != (0, end) or not numbered(instance, 0, (0, end)),
         f"sites must be numbered 0, 1, 2, ... and paths lead from the first to {last}"),
    )  # fmt: skip
    return ["\t".join(map(plain, row)) for row in zip(*xy.T, sites.reward, strict=True)]


FORMATS.enter(
    Format(
        "chao", "Chao / Golden / Wasil text (team orienteering)", recognises_chao, read_chao, write_chao, (".top",), "team-orienteering",
        ("team-orienteering", "orienteering"), sense="max",
    )
)  # fmt: skip
FORMATS.enter(
    Format(
        "tsiligirides", "Tsiligirides / Chao text (orienteering)", recognises_tsiligirides, read_tsiligirides, write_tsiligirides, (".op",),
        "orienteering", ORIENTEERING, sense="max",
    )
)  # fmt: skip
