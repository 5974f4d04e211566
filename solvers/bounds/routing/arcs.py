"""Arc costs for the bound methods: depots merged into node 0, vehicle types into the cheapest, hopeless arcs left out.

Which bound holds is for the checker to say, which draws up its own arcs; here they only steer the search for good multipliers.
"""

import math
from dataclasses import dataclass

import numpy as np

from ....formulations.routing.checking.known_features import unknown_features
from ....formulations.routing.preparation import Resource, every_move, limited_resources, tightened
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.reachability import minimum_vehicles
from ....formulations.stop import NEVER, Stop
from ....instances.memory import fits
from ....instances.number_arrays import Flags as Flags, Floats as Floats, Integers as Integers
from ....instances.routing.instance import VehicleType
from ....instances.routing.vehicle_type import ENERGY_CHARGES

MATRICES = 8
"""Matrices of one number per arc that stand in memory at once in the search for a bound, and again in its check."""

ARCS_PER_SECOND = 2e6
"""Arcs that are looked at in a second of the budget; the check takes about as long again."""

LIMITS = frozenset(
    {"capacity", "pickups", "time-windows", "depot-windows", "shifts", "max-distance", "max-duration"}
    | {f"energy:{charge}" for charge in ENERGY_CHARGES}
)
"""Features that limit single routes."""

ARC_TERMS = ("total-cost", "vehicles")


@dataclass(frozen=True, eq=False)
class Arcs:
    """Arcs between node 0, the depot, and ``customers``, site indices of the other nodes in their order.

    ``cost``, shape (nodes, nodes), is the cost in the first level of the objective, infinite for arcs that no route can use; ``fewest`` and
    ``most`` limit the number of routes; ``resources`` say what a route may use, over nodes of which the last one is the end of routes.
    """

    customers: Integers
    cost: Floats
    fewest: int
    most: int
    resources: dict[str, Resource]


def lacks_arc_costs(problem: RoutingProblem) -> frozenset[str]:
    """Optional sites, objectives that are not sums over arcs, and features that the checkers of arc bounds do not know."""
    missing = (problem.features() & {"optional-sites"}) | unknown_features(problem)
    for weight, term in problem.objective.levels()[0].terms:
        if term.name not in ARC_TERMS or weight < 0:
            missing = missing | {f"objective:{term.name}"}
    return missing


def by_site(problem: RoutingProblem, values: Floats) -> list[float]:
    """Values of the customers as the values of all sites, for evidence; those of depots are 0."""
    listed = np.zeros(len(problem.sites))
    listed[problem.customers] = values
    return [float(value) for value in listed]


def too_many_arcs(problem: RoutingProblem, seconds: float) -> bool:
    """Whether all arcs are more than the memory holds, or than can be looked at in the time."""
    arcs = (len(problem.customers) + 2) ** 2
    return arcs > ARCS_PER_SECOND * seconds or not fits(8 * MATRICES * arcs)


def arc_costs(problem: RoutingProblem, stop: Stop = NEVER) -> Arcs | None:
    """Arcs, costs and limits on the number of routes of a problem for which ``lacks_arc_costs`` is empty; None where they are too many."""
    if too_many_arcs(problem, stop.seconds_left):
        return None
    sites, fleet = problem.sites, problem.fleet
    own = list({id(t): t for t in map(problem.travel_of, range(len(fleet)))}.values())
    at = problem.customers
    weights = dict.fromkeys(ARC_TERMS, 0.0)
    for weight, term in problem.objective.levels()[0].terms:
        weights[term.name] += weight

    starts, ends, n = np.array([v.start for v in fleet]), np.array([v.end for v in fleet]), len(at)

    def between(matrix: Floats) -> Floats:
        """Moves from the depots (0), between customers, and to the depots (n + 1)."""
        moves = np.zeros((n + 2, n + 2))
        moves[1:-1, 1:-1] = matrix[np.ix_(at, at)]
        moves[0, 1:-1] = matrix[np.ix_(starts, at)].min(axis=0)
        moves[1:-1, -1] = matrix[np.ix_(at, ends)].min(axis=1)
        return moves

    def at_nodes(values: Floats, start: float = 0.0, end: float = 0.0) -> Floats:
        return np.concatenate([[start], values[at], [end]])

    lengths = own[0].distances if len(own) == 1 else np.minimum.reduce([t.distances for t in own])
    times = own[0].durations if len(own) == 1 else np.minimum.reduce([t.durations for t in own])
    distance, share = between(lengths), weights["total-cost"]
    duration = distance if times is lengths else between(times)
    cost = share * min(v.unit_cost for v in fleet) * distance[:-1, :-1]
    first = [share * (v.fixed_cost + v.unit_cost * lengths[v.start, at]) for v in fleet]
    cost[0, 1:] = np.min(first, axis=0) + weights["vehicles"]
    cost[1:, 0] = share * np.min([v.unit_cost * lengths[at, v.end] for v in fleet], axis=0)
    limits = {name: max(getattr(v, name) for v in fleet) for name in ("capacity", "max_duration", "max_distance")}
    opens = {max(float(sites.ready[v.start]), v.shift[0]) for v in fleet}
    best = VehicleType(**limits, energy=fleet[0].energy if len({v.energy for v in fleet}) == len(opens) == 1 else None)
    resources = limited_resources(
        best, at_nodes(sites.ready, min(opens)), at_nodes(sites.due, math.inf, float(sites.due[ends].max())),
        distance, duration, at_nodes(sites.service), at_nodes(sites.demand),
    )  # fmt: skip
    allowed = every_move(n + 2)
    resources = tightened(resources, allowed)
    cost[1:, 1:][~allowed[1:-1, 1:-1]] = math.inf
    cost[0, 1:][~allowed[0, 1:-1]] = cost[1:, 0][~allowed[1:-1, -1]] = cost[0, 0] = math.inf

    most = len(at) if problem.vehicle_limit is None else min(len(at), problem.vehicle_limit)
    return Arcs(at, cost, minimum_vehicles(problem), most, resources)
