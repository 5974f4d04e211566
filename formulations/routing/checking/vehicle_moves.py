"""Moves, costs and resources of each type of vehicle, for checkers that keep types apart and let sites be left out."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...checking.granularity import Grain, grain
from ..objective import PEAKS
from .known_features import EPS, Flags, Floats, Integers, own_moves, unknown_features, with_fleet, without_stops
from .relaxation import Resource, limited_resources, moves_left, narrowed, order_resource, with_depot
from .round_trips import least_peak
from .route_limits import allowed

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


@dataclass(frozen=True)
class Terms:
    """Weights of the first level of the objective, of a minimisation."""

    cost: float
    duration: float
    vehicles: float
    reward: float
    penalties: float
    peaks: dict[str, float]


def terms_of(problem: RoutingProblem) -> Terms | None:
    """Weights of the first level; None where less cost, duration or a smaller maximum would be worse: no bound of these is known."""
    sign = 1.0 if problem.sense == "min" else -1.0
    weights: dict[str, float] = {}
    for weight, term in problem.objective.levels()[0].terms:
        weights[term.name] = weights.get(term.name, 0.0) + sign * weight
    peaks = {name: weights[name] for name in PEAKS if weights.get(name)}
    cost, duration, vehicles, reward, penalties = (
        weights.get(name, 0.0) for name in ("total-cost", "total-duration", "vehicles", "reward", "penalties")
    )
    terms = Terms(cost, duration, vehicles, reward, penalties, peaks)
    known = {"total-cost", "total-duration", "vehicles", "reward", "penalties", *PEAKS}
    return terms if set(weights) <= known and min(terms.cost, terms.duration, *peaks.values(), 0.0) >= 0 else None


def relaxed_terms(problem: RoutingProblem) -> tuple[RoutingProblem, Terms | None]:
    """The problem without stops on the way, and its terms; None where nothing is proved of it."""
    relaxed = without_stops(problem)
    return relaxed, None if unknown_features(relaxed) or not len(problem.sites.customers) else terms_of(problem)


def alike(problem: RoutingProblem) -> dict[VehicleType, int]:
    """Types of vehicle, and how many of each can be on a route at once."""
    n = len(problem.sites.customers)
    types: dict[VehicleType, int] = {}
    for v in problem.fleet:
        kind = replace(v, count=1, name="")
        types[kind] = types.get(kind, 0) + (n if v.count is None else v.count)
    return types


def constants(problem: RoutingProblem, terms: Terms) -> list[float]:
    """Numbers that add up to no more than the part of the objective that routes and visits do not change."""
    sites, customers = problem.sites, problem.sites.customers
    parts = [w * least_peak(problem, peak) for peak, w in terms.peaks.items()]
    parts += (terms.penalties * sites.penalty[customers]).tolist()  # visits take it back, also those that must be
    return parts + (terms.reward * sites.reward[sites.depots]).tolist()  # type: ignore[no-any-return]


def worth_of_visits(problem: RoutingProblem, prices: Floats, surely: Flags | None = None, never: Flags | None = None) -> Floats:
    """Least sum of the prices of an answer's visits, site by site; of a group with one visit the least price, at its first site.

    More may be known of who is visited in each answer, or in none, as of ``told_visits``.
    """
    sites = problem.sites
    if surely is None or never is None:
        surely, never = sites.required[sites.customers], np.zeros(len(prices), dtype=bool)
    worth = np.where(surely, prices, np.where(never, 0.0, np.minimum(prices, 0.0)))
    node = {site: k for k, site in enumerate(sites.customers.tolist())}
    for group in sites.groups:
        members = [k for site in group.sites if not never[k := node[site]]]
        if members and not surely[members].any():
            least = float(prices[members].min())
            worth[members] = 0.0
            worth[members[0]] = least if group.required else min(0.0, least)
    return worth


def needed_routes(problem: RoutingProblem, members: Flags) -> Integers:
    """Least number of routes for the required customers among ``members``, of shape (..., customers): as many as their loads take."""
    sites, customers = problem.sites, problem.sites.customers
    required = sites.required[customers]
    loads = members @ np.where(required, sites.demand[customers], 0.0) * (1.0 - 4.0 * (len(customers) + 2) * EPS)
    largest = max(allowed(v.capacity) for v in problem.fleet)
    by_load = np.ceil(loads / largest) if 0.0 < largest < math.inf else np.zeros(loads.shape)
    routes: Integers = np.maximum((members & required).any(axis=-1), by_load).astype(np.int64)
    return routes


def value_grain(problem: RoutingProblem, terms: Terms) -> Grain | None:
    """The number of which every value of the objective is a multiple."""
    timed = {"duration-cost", "overtime", "vehicle-travel", "vehicle-speeds", "committed-vehicles"}
    if terms.peaks or terms.duration or (terms.cost and problem.features() & timed):
        return None
    sites = problem.sites
    parts = [terms.cost * v.unit_cost * problem.travel.distances.ravel() for v in problem.fleet] if terms.cost else []
    parts += [terms.cost * np.array([v.fixed_cost for v in problem.fleet]), np.array([terms.vehicles])]
    return grain(np.concatenate([*parts, terms.reward * sites.reward, terms.penalties * sites.penalty]))


@dataclass(frozen=True, eq=False)
class VehicleMoves:
    """Moves of a type of vehicle over its depot (0: start and end) and the customers.

    ``cost`` of shape (nodes, nodes) is less the prices of the sites that moves enter, infinite where there is no move; ``size`` is the
    sum of the sizes of what costs were added up from.
    """

    cost: Floats
    resources: dict[str, Resource]
    size: float

    @classmethod
    def of(cls, problem: RoutingProblem, vehicle: VehicleType, terms: Terms, prices: Floats, shares: dict[str, float]) -> VehicleMoves:
        sites, at = problem.sites, problem.sites.customers
        alone = with_fleet(problem, (vehicle,))
        resources = limited_resources(alone) | {"order": order_resource(len(at))}
        allowed = moves_left(alone)
        able = np.array([not sites.skills or sites.skills[k] <= vehicle.skills for k in at.tolist()])
        allowed[1:] &= able[:, None]
        allowed[:, 1:] &= able
        resources = narrowed(resources, allowed)
        far, move = own_moves(problem, vehicle)
        zeros, service = np.zeros(len(at) + 1), np.concatenate([[0.0], sites.service[at]])
        of_time = terms.cost * vehicle.unit_duration_cost + terms.duration
        first = terms.cost * vehicle.fixed_cost + terms.vehicles
        worth = terms.reward * sites.reward[at] - terms.penalties * sites.penalty[at] - prices
        cost = terms.cost * vehicle.unit_cost * with_depot(alone, far, zeros)
        if of_time:
            cost += of_time * with_depot(alone, move, service)
        for name, share in shares.items():
            if name in resources and share:
                r = resources[name]
                room = float(r.upper[0]) - r.start + r.slack
                cost += share * np.where(allowed, r.weight, 0.0)
                first -= share * room
        size = float(np.abs(cost[allowed]).max(initial=0.0)) + abs(first) + float(np.abs(worth).max())
        cost[:, 1:] += worth
        cost[0] += first
        return cls(np.where(allowed, cost, math.inf), resources, size)
