"""Evidence ``farthest-round-trip``: whoever serves the farthest required site goes there and comes back."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS
from .known_features import departure, own_moves, unknown_features
from .stops_on_the_way import without_stops

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem

Floats = NDArray[np.float64]

PEAKS = ("makespan", "longest-route", "latest-return")
"""Terms that are the largest of all routes."""

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("farthest-round-trip")
def check_farthest_round_trip(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on a first level of maxima (makespan, longest route, latest return) that should be small; nothing of ``data`` is read.

    Returns
    -------
    float
        Minus infinity where the level holds anything else.

    Notes
    -----
    Source: Frederickson, Hecht, Kim (1978), "Approximation algorithms for some routing problems"; ways lead over other sites and depots,
    so that no triangle inequality is assumed; docs/formulations/routing.md#makespan.
    """
    if problem.family != "routing":
        raise InputError("farthest-round-trip is evidence for routing problems", found=problem.family)
    level = problem.objective.levels()[0].terms
    relaxed = without_stops(problem)
    if problem.sense != "min" or unknown_features(relaxed) or any(t.name not in PEAKS or w < 0 for w, t in level):
        return -math.inf if problem.sense == "min" else math.inf
    return math.fsum(w * least_peak(relaxed, t.name) for w, t in level) * (1.0 - 4.0 * _EPS * len(level))


def least_peak(problem: RoutingProblem, name: str) -> float:
    """A bound on the term ``name`` of any answer of a problem without stops on the way."""
    sites, customers = problem.sites, problem.sites.customers
    clock = name == "latest-return"
    start = min(departure(problem, v) for v in problem.fleet) if clock else 0.0
    must = np.nonzero(sites.required[customers])[0]
    if not len(must):
        return start
    trips = np.full(len(must), math.inf)
    for v in problem.fleet:
        able = np.array([not sites.skills or sites.skills[k] <= v.skills for k in customers[must].tolist()])
        trips[able] = np.minimum(trips[able], _round_trips(problem, v, name)[must][able])
    if not np.isfinite(trips).all():
        return start  # no vehicle serves a required site: that is for another proof
    farthest = float(trips.max())
    size = farthest + (max(abs(departure(problem, v)) for v in problem.fleet) + float(np.abs(sites.ready[customers]).max()) if clock else 0)
    return max(start, farthest - 16.0 * (len(customers) + 2) * _EPS * size)


def _round_trips(problem: RoutingProblem, vehicle: VehicleType, name: str) -> Floats:
    """Least length, duration or return of a route through each customer; shape (customers,)."""
    sites, at = problem.sites, problem.sites.customers
    far, move = own_moves(problem, vehicle)
    if name == "longest-route":
        return ways(far[vehicle.start, at], far[np.ix_(at, at)]) + ways(far[at, vehicle.end], far[np.ix_(at, at)].T)
    busy = sites.service[at][:, None] + move[np.ix_(at, at)]
    home = ways(sites.service[at] + move[at, vehicle.end], busy.T)
    if name == "makespan":
        return ways(move[vehicle.start, at], busy) + home
    return ways(departure(problem, vehicle) + move[vehicle.start, at], busy, sites.ready[at]) + home


def ways(first: Floats, between: Floats, ready: Floats | float = -math.inf) -> Floats:
    """Least level at each node of all ways that begin with a move of ``first`` and wait for each node to be ready (Bellman-Ford)."""
    level = np.maximum(first, ready)
    for _ in range(len(first)):
        better = np.minimum(level, np.maximum((level[:, None] + between).min(axis=0), ready))
        if (better >= level).all():
            break
        level = better
    return level
