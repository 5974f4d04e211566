"""Optima of small routing problems, by enumeration."""

import math

import numpy as np

from .....formulations.routing.objective import LongestRoute, Makespan, Reward, TotalCost
from .....formulations.routing.problem import RoutingProblem
from .....formulations.routing.routes import Routes
from .....instances.errors import CheckFailedError, UsageError
from .....instances.number_arrays import Floats, Integers
from ....ratios.optimum import OPTIMA, Optimum, attained, subsets

MOST_CUSTOMERS = 10
"""Customers up to which all ways to share them among routes are compared: 59049."""


@OPTIMA.register("routing")
def best_routes(problem: RoutingProblem) -> Optimum:
    """The best routes of vehicles of one type whose only limits are capacity and distance.

    The shortest tour of every set of customers (Held and Karp 1962), and the best way to share all customers among such sets, or some of
    them where rewards are collected. Raises UsageError for other limits or objectives and too many customers, CheckFailedError if there is
    no answer.
    """
    longest = problem.objective.is_only(LongestRoute) or problem.objective.is_only(Makespan)
    rewarded = problem.objective.is_only(Reward)
    known = {
        "objective:total-cost", "objective:longest-route", "objective:makespan", "capacity", "max-distance", "limited-fleet", "fixed-cost",
        "service-times", "separate-durations", *(("objective:reward", "optional-sites") if rewarded else ()),
    }  # fmt: skip
    limits = problem.features() - known
    if limits or not (longest or rewarded or problem.objective.is_only(TotalCost)):
        raise UsageError(f"no optimum is known of routes with {', '.join(sorted(limits)) or str(problem.objective)}")
    customers, vehicle, sites = problem.customers, problem.fleet[0], problem.sites
    n = len(customers)
    if n > MOST_CUSTOMERS:
        raise UsageError(f"{n} customers are too many to enumerate; at most {MOST_CUSTOMERS} are")
    stops = np.concatenate([[vehicle.start], customers])
    timed = problem.objective.is_only(Makespan)
    moves = (problem.travel.durations if timed else problem.travel.distances)[np.ix_(stops, stops)]
    every = 1 << n
    ends, before = _shortest_paths(moves)
    tour = (ends + moves[1:, 0]).min(axis=1)
    members = subsets(n)
    cost = tour + members @ sites.service[customers] if timed else tour if longest else vehicle.fixed_cost + vehicle.unit_cost * tour
    cost[members @ sites.demand[customers] > vehicle.capacity * (1 + 1e-12)] = math.inf
    cost[tour > vehicle.max_distance * (1 + 1e-12)] = math.inf
    most = n if problem.vehicle_limit is None else min(n, problem.vehicle_limit)
    best, first = np.full((most + 1, every), math.inf), np.zeros((most + 1, every), dtype=np.int64)
    best[:, 0] = 0.0
    for chosen in range(1, every):
        rest = chosen ^ (chosen & -chosen)
        part = rest
        while True:  # the sets with the first of the chosen, and any of the others
            route = chosen ^ part
            ways = np.maximum(best[:-1, part], cost[route]) if longest else best[:-1, part] + cost[route]
            better = ways < best[1:, chosen]
            best[1:, chosen][better], first[1:, chosen][better] = ways[better], route
            if part == 0:
                break
            part = (part - 1) & rest
    served = every - 1
    if rewarded:
        served = int(np.where(np.isfinite(best[most]), members @ sites.reward[customers], -math.inf).argmax())
    if not math.isfinite(best[most, served]):
        raise CheckFailedError(f"no {most} routes serve all customers of {problem.name}")
    routes, unserved, k = [], served, most
    while unserved:
        route = int(first[k, unserved])
        chosen, at, visits = route, int((ends[route] + moves[1:, 0]).argmin()), []
        while at >= 0:
            visits.append(int(customers[at]))
            chosen, at = chosen ^ 1 << at, int(before[chosen, at])
        routes.append(visits[::-1])
        unserved, k = unserved ^ route, k - 1
    return attained(problem, Routes.of(routes), "enumeration")


def _shortest_paths(moves: Floats) -> tuple[Floats, Integers]:
    """Lengths of shortest paths from stop 0 through every set of the others to each of them, and the stop before; shape (2^n, n)."""
    n = len(moves) - 1
    ends, before = np.full((1 << n, n), math.inf), np.full((1 << n, n), -1)
    for k in range(n):
        ends[1 << k, k] = moves[0, k + 1]
    for chosen in range(1, 1 << n):
        for k in range(n):
            if chosen >> k & 1 and chosen != 1 << k:
                ways = ends[chosen ^ 1 << k] + moves[1:, k + 1]
                before[chosen, k] = ways.argmin()
                ends[chosen, k] = ways.min()
    return ends, before
