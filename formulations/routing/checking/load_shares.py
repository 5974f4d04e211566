"""Evidence ``load-shares`` and ``nearest-moves``: what each customer pays of the routes at least, which adds up site by site.

``load-shares``: the loads on a route are no more than the vehicle holds, so that the load of each customer pays its part of the vehicle
and of the way out to it and home. ``nearest-moves``: half of a move is paid by either end of it, so that a customer pays half of its two
least moves, from two sites or a depot, and the depots half of the least first and last moves of as many routes as loads need. Formulas:
docs/formulations/routing.md#load-shares.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.routing.instance import VehicleType
from ....instances.routing.travel import EARTH, GEOGRAPHIC, UNITS_OF_DISTANCE, Travel
from ...stop import off_the_clock
from ..problem import RoutingProblem
from .known_features import EPS, Floats, Integers, departure, earliest_levels, own_moves, routing_evidence
from .route_limits import allowed
from .vehicle_moves import Terms, needed_routes, relaxed_terms, worth_of_visits

POWERS = {"euclidean": 2.0, "EUC_2D": 2.0, "CEIL_2D": 2.0, "ATT": 2.0, "manhattan": 1.0, "MAN_2D": 1.0}
"""Norms of the plane that distances grow with. Those on the globe grow with the straight line through it."""

SHORTFALL = {"exact": 0.0, "trunc1": 0.1, "trunc2": 0.01, "round": 0.5, "ceil": 1e-9}
"""Largest amount by which each rounding convention lowers a distance."""

SHORTFALL_IN_FILES = {"EUC_2D": 0.5, "MAN_2D": 0.5, "CEIL_2D": 0.0, "ATT": 0.0}

_NEARLY = 1e-12
"""Part of a distance by which the tree that finds the nearest may be mistaken, and more."""

_BLUR = 1e-7
"""Largest error of a distance on the globe, as a part of the Earth's radius; it is met between sites nearly opposite each other."""


def by_coordinates(problem: RoutingProblem) -> bool:
    """Whether all moves follow from coordinates by a metric that obeys the triangle inequality."""
    return all(_metric(_travel(problem, v)) for v in problem.fleet)


def rates(terms: Terms, vehicle: VehicleType) -> tuple[float, float]:
    """Cost of a unit of distance, and of one of time, of a vehicle in the first level of the objective."""
    return terms.cost * vehicle.unit_cost, terms.cost * vehicle.unit_duration_cost + terms.duration


def least_round_trips(problem: RoutingProblem, terms: Terms, vehicle: VehicleType) -> tuple[Floats, float]:
    """Least cost of the moves of a route through each customer, shape (customers,), and what roundings take off it at most."""
    travel, at = _travel(problem, vehicle), problem.sites.customers
    of_distance, of_time = rates(terms, vehicle)
    if _metric(travel):
        rate = of_distance + of_time * travel.pace / vehicle.speed
        plain = travel.with_convention("exact")
        return rate * (plain.distance(vehicle.start, at) + plain.distance(at, vehicle.end)), rate * _shortfall(travel)
    cost = _costs(problem, terms, vehicle)
    inner = cost[np.ix_(at, at)]
    return earliest_levels(cost[vehicle.start, at], inner) + earliest_levels(cost[at, vehicle.end], inner.T), 0.0


def least_moves_at(problem: RoutingProblem, terms: Terms) -> tuple[Floats, Floats, Floats]:
    """Least cost of the two moves at each customer together, and the least move from a depot to it and from it to a depot."""
    at, fleet = problem.sites.customers, problem.fleet
    none = np.full(len(at), np.inf)
    into, out, other, first, last = none, none, none, none, none
    if by_coordinates(problem):
        near: dict[int, tuple[Floats, Floats]] = {}
        for v in fleet:
            travel, (of_distance, of_time) = _travel(problem, v), rates(terms, v)
            rate = of_distance + of_time * travel.pace / v.speed
            first = np.minimum(first, rate * travel.distance(v.start, at))
            last = np.minimum(last, rate * travel.distance(at, v.end))
            if id(travel) not in near:
                near[id(travel)] = _two_nearest(travel, at)
            nearest, second = near[id(travel)]
            into, other = np.minimum(into, _times(rate, nearest)), np.minimum(other, _times(rate, second))
        out = into
    else:
        for v in fleet:
            cost = _costs(problem, terms, v)
            inner = cost[np.ix_(at, at)]
            np.fill_diagonal(inner, np.inf)
            first, last = np.minimum(first, cost[v.start, at]), np.minimum(last, cost[at, v.end])
            into, out = np.minimum(into, inner.min(axis=0)), np.minimum(out, inner.min(axis=1))
            # Before and after a customer are two sites; where costs differ by direction, the two least moves may be of one.
            other = np.minimum(other, _second(inner) if (inner == inner.T).all() else inner.min(axis=1))
    return np.min([into + other, first + out, into + last, first + last], axis=0), first, last


def _times(rate: float, distances: Floats) -> Floats:
    return np.where(np.isfinite(distances), rate * np.where(np.isfinite(distances), distances, 0.0), np.inf)


def _second(inner: Floats) -> Floats:
    """The second least entry of each row."""
    second: Floats = np.partition(inner, 1, axis=1)[:, 1] if len(inner) > 1 else np.full(len(inner), np.inf)
    return second


def _two_nearest(travel: Travel, at: Integers) -> tuple[Floats, Floats]:
    """Distances from each customer to the nearest and the second nearest of the others, infinite where there is none."""
    with off_the_clock():  # half a second, once a process
        from scipy.spatial import cKDTree

    assert travel.coordinates is not None
    points, every = travel.coordinates[at], np.arange(len(at))
    if travel.metric in GEOGRAPHIC:
        longitude, latitude = np.radians(points).T
        points = np.column_stack([np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)])
    count = min(3, len(at))
    nearest = cKDTree(points).query(points, k=list(range(1, count + 1)), p=POWERS.get(travel.metric, 2.0))[1]
    raw = travel.with_convention("exact").distance(at[:, None], at[nearest]) * (1.0 - _NEARLY) - _blur(travel)
    # A customer whom the tree does not list for himself has that many others in the same place.
    away = np.sort(np.where(nearest == every[:, None], np.inf, np.maximum(0.0, travel.rounded(raw))), axis=1)
    away = np.column_stack([away, np.full((len(at), 2), np.inf)])
    return away[:, 0], away[:, 1]


def _costs(problem: RoutingProblem, terms: Terms, vehicle: VehicleType) -> Floats:
    of_distance, of_time = rates(terms, vehicle)
    far, move = own_moves(problem, vehicle)
    return of_distance * far + of_time * move if of_time else of_distance * far


def _travel(problem: RoutingProblem, vehicle: VehicleType) -> Travel:
    return problem.travel if vehicle.travel is None else vehicle.travel


def _metric(travel: Travel) -> bool:
    return travel.duration_matrix is None and (travel.metric in POWERS or travel.metric in GEOGRAPHIC)


def _shortfall(travel: Travel) -> float:
    """Largest amount by which a rounded distance lies below that of the metric: at most 1, for any other convention."""
    rounding = SHORTFALL_IN_FILES if travel.convention == "file" else SHORTFALL
    return rounding.get(travel.metric if travel.convention == "file" else travel.convention, 1.0) + _blur(travel)


def _blur(travel: Travel) -> float:
    if travel.metric not in GEOGRAPHIC:
        return 0.0
    return _BLUR * EARTH * UNITS_OF_DISTANCE.get(travel.metric.partition("-")[2] or "km", 1.0)


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
    """Each customer's share of the cost of any route of this vehicle type, less the fixed cost of the cheapest type.

    Shares are in proportion to loads: those of a full route add up to a round trip. Infinite where the type cannot serve the customer.
    """
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
