"""Customers that no vehicle can reach in time, found while a file is read."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..text import plain
from .instance import RoutingInstance, VehicleType
from .travel import METRICS, Travel

Floats = NDArray[np.float64]
Legs = Callable[[Travel, int, bool, bool], Floats]
"""(travel, depot, backwards, as durations) -> length of the way from the depot to every site, or back."""


def refuse_unreachable(instance: RoutingInstance, lines: Sequence[int] | None = None) -> None:
    """Raise InputError if a required customer lies beyond every vehicle, whatever the convention of distance.

    A customer is refused if even the shortest way from the start, through any sites and without service on the way,
    arrives after its window has closed; if the depot has closed when the shortest way back arrives; or if both ways and
    its service exceed the longest duration or distance of a route. Distances count rounded down to whole numbers, which
    no convention undercuts, so a file that makes sense under any of them is read.

    Parameters
    ----------
    instance : RoutingInstance
    lines : sequence of int, optional
        Line of each site, for the message.

    Raises
    ------
    InputError
        Naming the first such customer, the limit and what exceeds it.
    """
    sites = instance.sites
    bounded = any(math.isfinite(v.max_duration) or math.isfinite(v.max_distance) for v in instance.fleet)
    if not bounded and not np.isfinite(sites.due).any():
        return
    wanted, size = np.nonzero(sites.required)[0], float(np.abs(sites.ready).max())
    for legs in (_direct, _shortest):  # the direct way settles nearly all; only where it fails is a detour looked for
        verdicts = [_limits(instance, vehicle, legs) for vehicle in instance.fleet]
        served = np.any([np.all([_within(use, limit, size) for _, use, limit in verdict], axis=0) for verdict in verdicts], axis=0)
        if served[wanted].all():
            return
    site = int(wanted[np.argmin(served[wanted])])
    what, use, limit = next((w, u[site], lim[site]) for w, u, lim in verdicts[0] if not _within(u, lim, size)[site])
    raise InputError(
        f"no vehicle can reach customer {sites.ids[site]}: {what}", line=None if lines is None else int(lines[site]),
        expected=f"at most {plain(limit)}", found=f"at least {plain(use)}",
    )  # fmt: skip


def _within(use: Floats, limit: Floats, size: float) -> NDArray[np.bool_]:
    """Where ``use`` does not exceed ``limit``, rounding granted: more than any judge of routes lets pass."""
    return np.asarray(use <= limit + 1e-9 * np.maximum(np.where(np.isfinite(limit), np.abs(limit), 0.0), size))


def _limits(instance: RoutingInstance, vehicle: VehicleType, legs: Legs) -> list[tuple[str, Floats, Floats]]:
    """What a route to each site alone uses at least, and may use at most."""
    sites, travel, n = instance.sites, instance.travel, len(instance.sites)
    out, back = legs(travel, vehicle.start, False, True), legs(travel, vehicle.end, True, True)
    begin = np.maximum(sites.ready[vehicle.start] + out, sites.ready)
    found = [
        ("earliest arrival", begin, sites.due),
        ("earliest return to the depot", begin + sites.service + back, np.full(n, sites.due[vehicle.end])),
        ("shortest duration of its route", out + sites.service + back, np.full(n, vehicle.max_duration)),
    ]
    if math.isfinite(vehicle.max_distance):
        far = legs(travel, vehicle.start, False, False) + legs(travel, vehicle.end, True, False)
        found.append(("shortest length of its route", far, np.full(n, vehicle.max_distance)))
    return found


def _row(travel: Travel, site: int, backwards: bool, durations: bool) -> Floats:
    """Lengths of the moves from ``site`` to every site (or from every site to it), no larger than under any convention."""
    matrix = travel.duration_matrix if durations and travel.duration_matrix is not None else travel.matrix
    if matrix is not None:
        raw = matrix[:, site] if backwards else matrix[site]
        return np.array(raw) if matrix is travel.duration_matrix else np.floor(raw)
    assert travel.coordinates is not None
    row = np.floor(METRICS[travel.metric].distance(travel.coordinates[site], travel.coordinates))
    row[site] = 0.0
    return row


_direct: Legs = _row


def _shortest(travel: Travel, depot: int, backwards: bool, durations: bool) -> Floats:
    """Dijkstra's algorithm on the dense rows, each made when its site is settled."""
    n = len(travel)
    length, open_ = np.full(n, math.inf), np.ones(n, dtype=bool)
    length[depot] = 0.0
    for _ in range(n):
        nearest = int(np.argmin(np.where(open_, length, math.inf)))
        if not open_[nearest]:
            break
        open_[nearest] = False
        np.minimum(length, length[nearest] + _row(travel, nearest, backwards, durations), out=length)
    return length
