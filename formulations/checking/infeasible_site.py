"""Evidence that there is no answer: ``infeasible-site`` (no vehicle can serve a required site) and ``too-few-vehicles``.

Both redo the arithmetic from the data for every vehicle type and widen each limit by what ``evaluate`` lets pass. The bound that proves
infeasibility is infinity for ``min`` and minus infinity for ``max``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...instances.errors import InputError
from ..evidence import CHECKERS
from ..tolerance import widening

if TYPE_CHECKING:
    from ...instances.instance import VehicleType
    from ..problems.routing import RoutingProblem

Floats = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("infeasible-site")
def check_infeasible_site(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity (``min``) or minus infinity (``max``) if no route of any vehicle can visit a required site; else nothing is proved.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``site``: the id of the site, as the file names it.

    Raises
    ------
    InputError
        If there is no such site.
    """
    if problem.family != "routing":
        raise InputError("an unreachable site is evidence for routing problems", found=problem.family)
    name = data.get("site")
    index = problem.sites.index()
    if not isinstance(name, str) or name not in index:
        raise InputError("evidence names an unknown site", expected="the id of a site", found=str(name)[:80])
    site = index[name]
    proved = bool(problem.sites.required[site]) and not any(_can_serve(problem, v, site) for v in problem.fleet)
    return _verdict(problem, proved)


@CHECKERS.register("too-few-vehicles")
def check_too_few_vehicles(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity (``min``) or minus infinity (``max``) if all vehicles together cannot carry the demand of the required sites.

    ``data`` holds nothing that is read: the totals are added up from the problem.
    """
    if problem.family != "routing":
        raise InputError("fleet capacity is evidence for routing problems", found=problem.family)
    customers = problem.sites.customers
    total = math.fsum(problem.sites.demand[problem.sites.required])
    rooms = []
    for vehicle in problem.fleet:
        count = len(customers) if vehicle.count is None else min(vehicle.count, len(customers))
        rooms.append(count * (vehicle.capacity + float(widening(vehicle.capacity))))
    return _verdict(problem, total * (1 - 8 * _EPS) > math.fsum(rooms))


def _verdict(problem: RoutingProblem, proved: bool) -> float:
    return math.inf if proved == (problem.sense == "min") else -math.inf


def _can_serve(problem: RoutingProblem, vehicle: VehicleType, site: int) -> bool:
    """Whether nothing shown here keeps ``vehicle`` from visiting ``site``; detours over other customers are free to be taken."""
    sites = problem.sites
    at = sites.customers
    here = int(np.nonzero(at == site)[0][0])
    if sites.demand[site] > vehicle.capacity + float(widening(vehicle.capacity)):
        return False
    inner = np.ix_(at, at)
    moves = {name: (m[vehicle.start, at], m[inner], m[at, vehicle.end]) for name, m in _matrices(problem).items()}
    service, ready, due = sites.service[at], sites.ready[at], sites.due[at]
    opening = float(sites.ready[vehicle.start])

    first, between, last = moves["duration"]
    busy = (first, service[:, None] + between, service + last)
    closing = float(sites.due[vehicle.end])
    budgets = [("distance", moves["distance"], vehicle.max_distance), ("duration", busy, vehicle.max_duration)]
    if vehicle.energy is not None:
        store, rate, charge = vehicle.energy.capacity, vehicle.energy.rate, vehicle.energy.charge
        drawn = moves["duration"] if charge == "travel" else busy
        if charge == "elapsed-fixed-start":
            closing = min(closing, opening + (store + float(widening(store))) / rate)
        if charge == "windows":
            drawn = (np.maximum(busy[0], ready - opening), np.maximum(busy[1], ready[None, :] - ready[:, None]), busy[2])
        budgets.append((charge, (rate * drawn[0], rate * drawn[1], rate * drawn[2]), store))

    rounding = 8 * (len(at) + 2) * _EPS
    for _, (out, mid, back), limit in budgets:
        need = _shortest(out, mid)[here] + _shortest(back, mid.T)[here]
        if need * (1.0 - rounding) > limit + float(widening(limit)):
            return False
    slack = widening(due, abs(opening)) + rounding * np.maximum(np.abs(due), abs(opening), where=np.isfinite(due), out=np.zeros(len(due)))
    reached = _earliest(opening, busy[0], busy[1], ready, due + slack)[here]
    homeward = _shortest(busy[2], busy[1].T)[here]
    if reached > due[here] + slack[here]:
        return False
    back = reached + homeward
    late = max(abs(opening), abs(reached), homeward)
    return bool(back <= closing + float(widening(closing, abs(opening))) + rounding * late)


def _matrices(problem: RoutingProblem) -> dict[str, Floats]:
    return {"distance": problem.travel.distances, "duration": problem.travel.durations}


def _shortest(first: Floats, between: Floats) -> Floats:
    """Length of the shortest way to each customer that begins with a move of ``first`` (Bellman-Ford)."""
    length = first.copy()
    for _ in range(len(first)):
        better = np.minimum(length, (length[:, None] + between).min(axis=0))
        if (better >= length).all():
            break
        length = better
    return length


def _earliest(start: float, first: Floats, between: Floats, ready: Floats, due: Floats) -> Floats:
    """Earliest begin of service at each customer over all ways that meet every window on them."""
    begin = np.maximum(start + first, ready)
    begin[begin > due] = math.inf
    for _ in range(len(first)):
        better = np.minimum(begin, np.maximum((begin[:, None] + between).min(axis=0), ready))
        better[better > due] = math.inf
        if (better >= begin).all():
            break
        begin = better
    return begin
