"""Tsiligirides' text format of the orienteering problem, also used for the square and diamond sets of Chao, Golden and Wasil.

First line ``Tmax P``, the time budget and the number of paths; then ``x y score``, one point a line. Every path leads from the first point
to the second. Sites are numbered from "0" in the file's order; solution files count customers from 1, so that customer 1 is point 2.

The format does not say how many points there are; the names of the published files do, and what is cut off is noticed by them.

Source: Tsiligirides (1984), Journal of the Operational Research Society 35(9); Chao, Golden and Wasil (1996), European Journal of
Operational Research 88(3).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import label, plain, refuse, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel
from ._limits import cannot, numbered, refuse_inexpressible, refuse_no_paths
from ._rows import Rows, head, widths

PROBLEMS = ("orienteering", "team-orienteering")
PUBLISHED = ((r"tsiligirides_problem_1_", 32), (r"tsiligirides_problem_2_", 21), (r"tsiligirides_problem_3_", 33),
             (r"set_64_1_", 64), (r"set_66_1_", 66))  # fmt: skip
"""Beginnings of the names of published files, and how many points they have."""


def recognises(text: str) -> bool:
    """Whether a line of two numbers is followed by one of three."""
    return widths(head(text, 2)) == [2, 3]


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    line, (limit, paths) = rows.values("first line", ("Tmax", "number of paths"))
    if limit < 0:
        raise InputError("Tmax is negative", line=line, expected="0 or more", found=plain(limit))
    count = whole(plain(paths), line, "number of paths", least=1)
    table, at = rows.table("point", ("x", "y", "score"))
    name = label(path.stem)
    _refuse_cut(name, at, line)
    refuse(table[:, 2] < 0, at, "score is negative", table[:, 2], "0 or more")
    n = len(table)
    if n < 3:
        raise InputError("ends early", line=rows.lines[-1][0], expected="a start, an end and a point between", found=f"{n} points")
    sites = Sites.of(range(n), depot=np.arange(n) < 2, reward=table[:, 2], required=False, coordinates=table[:, :2])
    vehicle = VehicleType(count, start=0, end=1, max_duration=limit)
    problems = PROBLEMS if count == 1 else PROBLEMS[1:]
    return RoutingInstance(
        name, "tsiligirides", sites, Travel("euclidean", table[:, :2]), (vehicle,), problem=problems[0], problems=problems
    )


def _refuse_cut(name: str, at: list[int], first: int) -> None:
    for pattern, size in PUBLISHED:
        if re.match(pattern, name) and len(at) != size:
            raise InputError(
                f"ends early or is changed: the name {name} stands for another number of points; rename it if this is meant",
                line=at[-1] if at else first, expected=str(size), found=str(len(at)),
            )  # fmt: skip


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(
        instance, "tsiligirides", {"rewards", "optional-sites", "limited-fleet", "multiple-depots", "open-routes", "max-duration"}
    )
    sites, vehicle = instance.sites, instance.fleet[0]
    refuse_no_paths(instance, "tsiligirides", vehicle.max_duration)
    if sites.depots.tolist() != [0, 1] or (vehicle.start, vehicle.end) != (0, 1) or not numbered(instance, 0):
        raise cannot(instance, "tsiligirides", "sites must be numbered 0, 1, 2, ... and paths lead from the first to the second")
    assert instance.travel.coordinates is not None
    rows = zip(*instance.travel.coordinates.T, sites.reward, strict=True)
    lines = ["\t".join(plain(v) for v in row) for row in rows]
    return "\n".join([f"{plain(vehicle.max_duration)}\t{vehicle.count}", *lines]) + "\n"


FORMATS.add(
    "tsiligirides",
    Format(
        "tsiligirides", "Tsiligirides / Chao text (orienteering)", recognises, read, write, (".op",), "orienteering", PROBLEMS, "exact",
        sense="max",
    ),
)  # fmt: skip
