"""Evidence ``load-shares`` and ``nearest-moves``: what each customer pays of the routes at least, which adds up site by site.

``load-shares``: the loads on a route are no more than the vehicle holds, so that the load of each customer pays its part of the vehicle
and
of the way out to it and home. ``nearest-moves``: half of a move is paid by either end of it, so that a customer pays half of its two
least moves, from two sites or a depot, and the depots half of the least first and last moves of as many routes as loads need.
Formulas: docs/formulations/routing.md#load-shares.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .known_features import EPS, Floats, departure, routing_evidence
from .route_limits import allowed
from .vehicle_moves import Terms, needed_routes, relaxed_terms, worth_of_visits
from .ways_by_metric import least_moves_at, least_round_trips, rates

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


@routing_evidence("load-shares")
def check_load_shares(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective by loads alone; nothing of ``data`` is read, and maxima count as nothing.

    Source: Haimovich and Rinnooy Kan (1985), bounds for capacitated routing problems.
    """
    relaxed, terms = relaxed_terms(problem)
    if terms is None or terms.vehicles < 0:
        return -math.inf
    cheapest = min(_fixed(terms, v) for v in relaxed.fleet)
    with np.errstate(over="ignore", invalid="ignore"):
        shares = np.min([_shares(relaxed, terms, v, cheapest) for v in relaxed.fleet], axis=0)
        return summed(relaxed, terms, np.where(np.isfinite(shares), shares, 0.0), cheapest * fewest_routes(relaxed))


def _fixed(terms: Terms, vehicle: VehicleType) -> float:
    return terms.cost * vehicle.fixed_cost + terms.vehicles


def _shares(problem: RoutingProblem, terms: Terms, vehicle: VehicleType, cheapest: float) -> Floats:
    """What each customer pays of any route of a vehicle beyond the cheapest vehicle; infinite where it cannot be served."""
    sites, at = problem.sites, problem.sites.customers
    load, room = sites.demand[at], allowed(vehicle.capacity)
    part = load / room if 0.0 < room < math.inf else np.where((load > 0.0) & (room <= 0.0), math.inf, 0.0)
    trip, shortfall = least_round_trips(problem, terms, vehicle)
    paid = np.where(part > 0.0, part * np.maximum(0.0, trip - shortfall + _fixed(terms, vehicle) - cheapest), 0.0)
    able = np.array([not sites.skills or sites.skills[k] <= vehicle.skills for k in at.tolist()])
    return np.where(able, paid - shortfall + rates(terms, vehicle)[1] * sites.service[at], math.inf)


def fewest_routes(problem: RoutingProblem) -> int:
    """Number of routes that the loads of required sites need, or that are asked for."""
    return max(problem.min_vehicles, int(needed_routes(problem, np.ones(len(problem.customers), dtype=bool))))


def summed(problem: RoutingProblem, terms: Terms, paid: Floats, fixed: float) -> float:
    """Bound from what each visit pays of the costs, all routes together ``fixed`` besides; minus infinity where it is no number."""
    sites, at = problem.sites, problem.sites.customers
    worth = terms.reward * sites.reward[at] - terms.penalties * sites.penalty[at] + paid
    # No route is shorter than nothing, and none comes home before the first departure.
    start = min(departure(problem, v) for v in problem.fleet)
    parts = np.concatenate([
        worth_of_visits(problem, worth), terms.penalties * sites.penalty[at], terms.reward * sites.reward[sites.depots],
        [fixed, *(w * start for name, w in terms.peaks.items() if name == "latest-return")],
    ])  # fmt: skip
    size = float(np.abs(parts).sum() + np.abs(paid).sum() + (np.abs(worth) + np.abs(terms.penalties * sites.penalty[at])).sum())
    if not math.isfinite(size):
        return -math.inf
    return math.fsum(parts) - 8.0 * EPS * (len(at) + 16) * size


@routing_evidence("nearest-moves")
def check_nearest_moves(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective by the least moves at each site; nothing of ``data`` is read, and maxima count as
    nothing."""
    relaxed, terms = relaxed_terms(problem)
    if terms is None or terms.vehicles < 0:
        return -math.inf
    service, routes = relaxed.sites.service[relaxed.sites.customers], fewest_routes(relaxed)
    vehicle = min(terms.cost * v.fixed_cost + terms.vehicles for v in relaxed.fleet)
    with np.errstate(over="ignore", invalid="ignore"):
        moves, first, last = least_moves_at(relaxed, terms)
        paid = moves / 2.0 + min(rates(terms, v)[1] for v in relaxed.fleet) * service
        ends = np.concatenate([np.sort(side)[:routes] for side in (first, last)])
        return summed(relaxed, terms, paid, routes * vehicle + float(ends.sum()) / 2.0)
