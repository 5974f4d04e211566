"""The text format of the team orienteering problem of Chao, Golden and Wasil.

``n``, ``m`` and ``tmax`` on a line each: number of points, of paths, and the time budget of a path; then ``x y score``, one point a line.
Every path leads from the first point to the last. Sites are numbered from "0" in the file's order, which is how solution files count.

Source: Chao, Golden and Wasil (1996), European Journal of Operational Research 88(3).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...errors import InputError
from ...formats import FORMATS, Format
from ...text import label, number, plain, refuse, whole
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel
from ._limits import cannot, numbered, refuse_inexpressible, refuse_no_paths
from ._rows import Rows, head

PROBLEMS = ("team-orienteering", "orienteering")


def recognises(text: str) -> bool:
    """Whether the first lines give ``n``, ``m`` and ``tmax``, or two of them."""
    keys = [line[0].lower() if len(line) == 2 else "" for line in head(text, 3)]
    return sum(map(str.__eq__, keys, ("n", "m", "tmax"))) >= 2


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    rows = Rows.of(text)
    (at_n, n_token), (at_m, m_token), (at_t, t_token) = (rows.keyed(key) for key in ("n", "m", "tmax"))
    n = whole(n_token, at_n, "number of points", least=3)
    count = whole(m_token, at_m, "number of paths", least=1)
    limit = number(t_token, at_t, "tmax")
    if limit < 0:
        raise InputError("tmax is negative", line=at_t, expected="0 or more", found=t_token)
    table, at = rows.table("point", ("x", "y", "score"), n)
    refuse(table[:, 2] < 0, at, "score is negative", table[:, 2], "0 or more")
    ends = np.isin(np.arange(n), (0, n - 1))
    sites = Sites.of(range(n), depot=ends, reward=table[:, 2], required=False, coordinates=table[:, :2])
    vehicle = VehicleType(count, start=0, end=n - 1, max_duration=limit)
    return RoutingInstance(
        label(path.stem), "chao", sites, Travel("euclidean", table[:, :2]), (vehicle,), problem=PROBLEMS[0],
        problems=PROBLEMS if count == 1 else PROBLEMS[:1],
    )  # fmt: skip


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    refuse_inexpressible(instance, "chao", {"rewards", "optional-sites", "limited-fleet", "multiple-depots", "open-routes", "max-duration"})
    sites, vehicle, last = instance.sites, instance.fleet[0], len(instance.sites) - 1
    refuse_no_paths(instance, "chao", vehicle.max_duration)
    if sites.depots.tolist() != [0, last] or (vehicle.start, vehicle.end) != (0, last) or not numbered(instance, 0):
        raise cannot(instance, "chao", "sites must be numbered 0, 1, 2, ... and paths lead from the first to the last")
    assert instance.travel.coordinates is not None
    rows = zip(*instance.travel.coordinates.T, sites.reward, strict=True)
    lines = ["\t".join(plain(v) for v in row) for row in rows]
    return "\n".join([f"n {len(sites)}", f"m {vehicle.count}", f"tmax {plain(vehicle.max_duration)}", *lines]) + "\n"


FORMATS.add(
    "chao",
    Format(
        "chao", "Chao / Golden / Wasil text (team orienteering)", recognises, read, write, (".top",), "team-orienteering", PROBLEMS,
        sense="max",
    ),
)  # fmt: skip
