"""Evidence on the largest of all routes: ``farthest-round-trip`` and ``averaged-tour``.

Whoever serves the farthest required site goes there and comes back; and the largest of all routes is at least their mean, which a bound of
their sum bounds. Where a statement says that it is more than a number, that is a bound, too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ...checking.granularity import Grain, grain, lift
from ...evidence import CHECKERS
from ..objective import PEAKS, Objective, TotalCost
from .known_features import (
    EPS,
    Floats,
    departure,
    earliest_levels,
    explicit,
    last_return,
    own_moves,
    routing_evidence,
    unknown_features,
    with_fleet,
    without_stops,
)
from .route_limits import allowed, limits_of

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


@routing_evidence("farthest-round-trip")
def check_farthest_round_trip(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on a minimised first level of maxima (makespan, longest route, latest return); nothing of ``data`` is read.

    Where a statement says that one of them is more than a number, the bound is that, or the next multiple of what all lengths and times
    are multiples of.

    Source: Frederickson, Hecht, Kim (1978), "Approximation algorithms for some routing problems"; ways lead over other sites and depots,
    so that no triangle inequality is assumed; docs/formulations/routing.md#makespan.
    """
    level = problem.objective.levels()[0].terms
    relaxed = without_stops(problem)
    if problem.sense != "min" or unknown_features(relaxed) or any(t.name not in PEAKS or w < 0 for w, t in level):
        return -math.inf
    bound = math.fsum(w * least_peak(relaxed, t.name) for w, t in level) * (1.0 - 4.0 * EPS * len(level))
    return lift(bound, "min", peak_grain(problem)) if problem.exceeded else bound


def peak_grain(problem: RoutingProblem) -> Grain | None:
    """A number of which the first level, a sum of maxima, is a multiple in some best answer: vehicles depart, wait and return at sums and
    differences of the data. None where they stop on the way."""
    if any(v.reloads or v.stations for v in problem.fleet):
        return None
    sites, ways = problem.sites, {(id(v.travel), v.speed): own_moves(problem, v) for v in problem.fleet}
    closing = [travel.closing for travel in (problem.travel, *(v.travel for v in problem.fleet)) if travel is not None]
    times = [sites.service, sites.ready, sites.due, *(move for _, move in ways.values()), *(c for c in closing if c is not None)]
    times += [np.array(pairs) for pairs in (*sites.windows, [v.shift for v in problem.fleet])]
    parts = list[Floats]()
    for weight, term in problem.objective.levels()[0].terms:
        counted = [far for far, _ in ways.values()] if term.name == "longest-route" else times
        parts += [weight * values[np.isfinite(values)] for values in counted]
    return grain(np.concatenate(parts))


def least_peak(problem: RoutingProblem, name: str) -> float:
    """Bound on the term ``name`` of any answer of a problem without stops on the way."""
    return max(_farthest(problem, name), problem.exceeded.get(name, -math.inf))


def _farthest(problem: RoutingProblem, name: str) -> float:
    """The farthest of the round trips to all required sites."""
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
    return max(start, farthest - 16.0 * (len(customers) + 2) * EPS * size)


def _round_trips(problem: RoutingProblem, vehicle: VehicleType, name: str) -> Floats:
    """Least length, duration or return of a route through each customer; shape (customers,)."""
    sites, at = problem.sites, problem.sites.customers
    far, move = own_moves(problem, vehicle)
    if name == "longest-route":
        return earliest_levels(far[vehicle.start, at], far[np.ix_(at, at)]) + earliest_levels(far[at, vehicle.end], far[np.ix_(at, at)].T)
    busy = sites.service[at][:, None] + move[np.ix_(at, at)]
    home = earliest_levels(sites.service[at] + move[at, vehicle.end], busy.T)
    if name == "makespan":
        return earliest_levels(move[vehicle.start, at], busy) + home
    return earliest_levels(departure(problem, vehicle) + move[vehicle.start, at], busy, sites.ready[at]) + home


SUMS = ("spanning-tree", "arc-multipliers", "set-partitioning-duals", "state-space")
"""Evidence that bounds sums over routes."""


def totals(problem: RoutingProblem) -> RoutingProblem | None:
    """The problem whose total cost is the sum of what the first level is the largest of; None where that is no single maximum.

    A service counts half on the move into its site and half on the move out, so that a symmetric problem stays one.
    """
    relaxed, level = without_stops(problem), problem.objective.levels()[0].terms
    if problem.sense != "min" or len(level) != 1 or level[0][1].name not in PEAKS or unknown_features(relaxed):
        return None
    long, fleet = level[0][1].name == "longest-route", []
    half = np.where(problem.sites.depot, 0.0, problem.sites.service / 2.0)
    for v in relaxed.fleet:
        far, move = own_moves(relaxed, v)
        free = {"fixed_cost": 0.0, "unit_cost": 1.0, "unit_duration_cost": 0.0, "unit_overtime_cost": 0.0, "regular_duration": math.inf}
        if long and v.travel is None and v.speed == 1.0:
            fleet.append(replace(v, **free))  # type: ignore[arg-type]
            continue
        counted = far if long else move + half[:, None] + half[None, :]
        # Only what is counted can be limited as a distance.
        limits = {} if long else {"max_distance": math.inf}
        common = v.travel is None and v.speed == 1.0
        fleet.append(replace(v, travel=None if common else explicit(counted, move), speed=1.0, **free, **limits))  # type: ignore[arg-type]
    move = relaxed.travel.durations
    travel = relaxed.travel if long else explicit(move + half[:, None] + half[None, :], move)
    return with_fleet(relaxed, fleet, travel).altered(objective=Objective.of(TotalCost()))


@routing_evidence("averaged-tour")
def check_averaged_tour(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the makespan, the longest route or the latest return; ``data``: ``kind`` and ``data`` of evidence of ``SUMS``.

    Where the mean route is longer than any vehicle may drive there is no answer, and the bound is infinite.

    Source: Frederickson, Hecht, Kim (1978); docs/formulations/routing.md#makespan.
    """
    kind, inner = data.get("kind"), data.get("data")
    if kind not in SUMS or not isinstance(inner, Mapping):
        raise InputError("evidence of an averaged tour lacks that of its sum", "missing", expected=", ".join(SUMS), found=str(kind)[:80])
    summed = totals(problem)
    if summed is None:
        return -math.inf
    total = CHECKERS[kind](summed, inner)
    if math.isinf(total):
        return total
    counts = [len(problem.customers) if v.count is None else v.count for v in problem.fleet]
    (weight, term), routes = problem.objective.levels()[0].terms[0], min(len(problem.customers), sum(counts))
    start = min(departure(problem, v) for v in problem.fleet) if term.name == "latest-return" else 0.0
    mean = max(0.0, total) / routes
    bound = start + mean - 8.0 * EPS * (abs(start) + mean)
    return math.inf if total > 0.0 and bound > longest(without_stops(problem), term.name) else weight * bound


def longest(problem: RoutingProblem, name: str) -> float:
    """The largest value of a term that no limit of a single route rules out."""
    most = {"makespan": "max_duration", "longest-route": "max_distance"}
    limits = [last_return(problem, v) if name == "latest-return" else getattr(v, most[name]) for v in problem.fleet]
    if not math.isfinite(max(limits)):
        return math.inf
    wide = [limits_of(problem, v).rounding for v in problem.fleet]
    return max(allowed(limit, abs(departure(problem, v)), r) for limit, v, r in zip(limits, problem.fleet, wide, strict=True))
