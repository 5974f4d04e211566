"""Evidence ``load-shares``: of a route through a customer, its load pays the part that it takes of the vehicle.

A route goes to its farthest customer and comes back. The loads of its customers are no more than the vehicle holds, so that it costs::

    A + max over its sites of r_i  >=  A + sum over its sites of (q_i / Q) r_i

with the cost A of a vehicle, and the cost r_i of the way out to i and home. What is proved adds up, site by site.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS
from .known_features import departure, unknown_features
from .route_limits import allowed
from .stops_on_the_way import without_stops
from .vehicle_moves import Terms, needed_routes, terms_of, worth_of_visits
from .ways_by_metric import least_round_trips, rates

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem

Floats = NDArray[np.float64]

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("load-shares")
def check_load_shares(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective by loads alone; nothing of ``data`` is read.

    Parameters
    ----------
    problem : RoutingProblem
        Objective: cost, duration and vehicles, rewards and penalties; maxima beside them count as nothing.

    Notes
    -----
    Source: Haimovich and Rinnooy Kan (1985), bounds for capacitated routing problems; docs/formulations/routing.md#load-shares.
    """
    if problem.family != "routing":
        raise InputError("load-shares is evidence for routing problems", found=problem.family)
    sign, terms, relaxed = 1.0 if problem.sense == "min" else -1.0, terms_of(problem), without_stops(problem)
    if terms is None or terms.vehicles < 0 or unknown_features(relaxed) or not len(problem.customers):
        return -sign * math.inf
    cheapest = min(_fixed(terms, v) for v in relaxed.fleet)
    with np.errstate(over="ignore", invalid="ignore"):
        shares = np.min([_shares(relaxed, terms, v, cheapest) for v in relaxed.fleet], axis=0)
        return sign * summed(relaxed, terms, np.where(np.isfinite(shares), shares, 0.0), cheapest * fewest_routes(relaxed))


def _fixed(terms: Terms, vehicle: VehicleType) -> float:
    return terms.cost * vehicle.fixed_cost + terms.vehicles


def _shares(problem: RoutingProblem, terms: Terms, vehicle: VehicleType, cheapest: float) -> Floats:
    """What each customer pays of any route of a vehicle beyond the cost of the cheapest vehicle; infinite where it cannot serve it."""
    sites, at = problem.sites, problem.sites.customers
    load, room = sites.demand[at], allowed(vehicle.capacity)
    part = load / room if 0.0 < room < math.inf else np.where((load > 0.0) & (room <= 0.0), math.inf, 0.0)
    trip, shortfall = least_round_trips(problem, terms, vehicle)
    made = np.where(part > 0.0, part * np.maximum(0.0, trip - shortfall + _fixed(terms, vehicle) - cheapest), 0.0)
    able = np.array([not sites.skills or sites.skills[k] <= vehicle.skills for k in at.tolist()])
    return np.where(able, made - shortfall + rates(terms, vehicle)[1] * sites.service[at], math.inf)


def fewest_routes(problem: RoutingProblem) -> int:
    """Routes that the loads of required sites need, or that are asked for."""
    return max(problem.min_vehicles, int(needed_routes(problem, np.ones(len(problem.customers), dtype=bool))))


def summed(problem: RoutingProblem, terms: Terms, paid: Floats, fixed: float) -> float:
    """A bound from what each visit pays of the costs, all routes together ``fixed`` besides; minus infinity where it is no number."""
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
    return math.fsum(parts) - 8.0 * _EPS * (len(at) + 16) * size
