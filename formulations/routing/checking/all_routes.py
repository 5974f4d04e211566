"""Evidence ``all-routes``: every route of a few customers, by every type of vehicle, and every way to put them together.

There is nothing to state: the checker walks all of it. It knows what other evidence merges or leaves out, such as several types of vehicle,
customers that may be left out, and the risk of each route.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ...evidence import CHECKERS
from ...stop import Stopped
from .infeasible_site import verdict
from .known_features import departure, own_moves
from .round_trips import PEAKS
from .route_limits import Limits, allowed, limits_of, summable
from .route_sets import MOST, fronts, put_together
from .vehicle_moves import Terms, terms_of

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem

MOST_ORDERS = 20_000
"""Orders of some of the customers, times types of vehicle: 7 customers of one type, 6 of 10, 5 of 61."""

_EPS = float(np.finfo(np.float64).eps)


def orders(problem: RoutingProblem) -> float:
    """How many ways to visit some of the customers there are for all types together, or infinity where they are many."""
    n = len(problem.sites.customers)
    return math.inf if n > 10 else len(problem.fleet) * sum(math.perm(n, k) for k in range(1, n + 1))


@CHECKERS.register("all-routes")
def check_all_routes(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """The optimum of the first level, as far as rounding lets it be told, or that there is no answer; nothing of ``data`` is read.

    Up to 12 customers are looked at by sets of them where their orders are too many (``MOST_ORDERS``), which proves as much where all that
    counts adds up along a route, and where routes share a risk of the team. Nothing is proved of more, or where the objective mixes the
    largest of all routes with other terms, or has terms that are neither.
    """
    if problem.family != "routing":
        raise InputError("all routes are evidence for routing problems", found=problem.family)
    level = problem.objective.levels()[0].terms
    terms, peak = terms_of(problem), any(term.name in PEAKS for _, term in level)
    if not summable(problem) or terms is None or (peak and (len(level) > 1 or level[0][0] < 0)):
        return verdict(problem, proved=False)
    many = orders(problem) > MOST_ORDERS
    if not many and (peak or problem.team_risk is None):
        return _walked(problem, terms, peak)
    if peak or len(problem.sites.customers) > MOST:
        return verdict(problem, proved=False)
    found = _by_sets(problem, terms)
    if many:
        return found
    return (max if problem.sense == "min" else min)(found, _walked(problem, terms, peak))


def _walked(problem: RoutingProblem, terms: Terms, peak: bool) -> float:
    """The bound from every order of customers; each route may take all of the team's risk."""
    level, least = problem.objective.levels()[0].terms, problem.sense == "min"
    doubt, n = 0.0, len(problem.sites.customers)
    idle = min(departure(problem, v) for v in problem.fleet) if "latest-return" in terms.peaks else 0.0
    ways: dict[tuple[int, int], float] = {(0, 0): level[0][0] * idle if idle else 0.0}  # customers visited and number of routes
    for vehicle in problem.fleet:
        limits = limits_of(problem, vehicle)
        routes, off = _routes(problem, limits, vehicle)
        doubt = max(doubt, off)
        layer = dict(ways)
        for _ in range(n if vehicle.count is None else min(n, vehicle.count)):
            more: dict[tuple[int, int], float] = {}
            for (done, count), value in layer.items():
                for visits, worth in routes.items():
                    if not done & visits:
                        joined = max(value, worth) if peak else value + worth
                        _keep(more, (done | visits, count + 1), joined, least)
            for way, value in more.items():
                _keep(ways, way, value, least)
            layer = more
    must = sum(1 << k for k, required in enumerate(problem.sites.required[problem.sites.customers].tolist()) if required)
    found = [value for (done, count), value in ways.items() if done & must == must and count >= problem.min_vehicles]
    if not found:
        return verdict(problem, proved=True)
    weights = {name: math.fsum(weight for weight, term in level if term.name == name) for name in ("reward", "penalties")}
    sites = problem.sites
    fixed = weights["reward"] * math.fsum(sites.reward[sites.depots].tolist())
    fixed += weights["penalties"] * math.fsum(sites.penalty[~sites.depot].tolist())
    best = min(found) - n * doubt if least else max(found) + n * doubt
    return best + fixed - (1.0 if least else -1.0) * 8.0 * _EPS * (abs(best) + abs(fixed)) if fixed else best


def _by_sets(problem: RoutingProblem, terms: Terms) -> float:
    """The same of more customers, by sets of them: less than the optimum where somebody waits or loads on the way."""
    sites, n = problem.sites, len(problem.sites.customers)
    most = min(n, sum(n if v.count is None else v.count for v in problem.fleet))
    risk = math.inf if problem.team_risk is None else -math.log1p(-problem.team_risk) * (1.0 + 1e-8)
    try:
        every = [fronts(problem, vehicle, limits_of(problem, vehicle), terms) for vehicle in problem.fleet]
        ways = put_together([found for found, _ in every], n, problem.min_vehicles, most, risk)
    except Stopped:
        return verdict(problem, proved=False)
    doubt = max(off for _, off in every)
    must = sum(1 << k for k, required in enumerate(sites.required[sites.customers].tolist()) if required)
    values = [value for (done, count), value in ways.items() if done & must == must and count >= problem.min_vehicles]
    if not values:
        return verdict(problem, proved=True)
    fixed = terms.reward * math.fsum(sites.reward[sites.depots].tolist()) + terms.penalties * math.fsum(
        sites.penalty[~sites.depot].tolist()
    )
    best = min(values)
    bound = best + fixed - n * doubt - 16.0 * _EPS * (abs(best) + abs(fixed))
    return bound if problem.sense == "min" else -bound


def _keep(ways: dict[Any, float], way: Any, value: float, least: bool) -> None:
    known = ways.get(way)
    if known is None or (value < known if least else value > known):
        ways[way] = value


def _routes(problem: RoutingProblem, limits: Limits, vehicle: VehicleType) -> tuple[dict[int, float], float]:
    """By set of customers, a mask, what the best route through it adds to the objective, and by how much that may be off."""
    sites, terms = problem.sites, {term.name: weight for weight, term in problem.objective.levels()[0].terms}
    at = np.concatenate([[vehicle.start], sites.customers, [vehicle.end]])
    far, busy = own_moves(problem, vehicle)[0][np.ix_(at, at)].tolist(), limits.busy.tolist()
    ready, demand, reward = limits.ready.tolist(), limits.demand.tolist(), sites.reward[at].tolist()
    penalty = sites.penalty[at].tolist()
    due, budgets = [limits.latest(d) for d in limits.due.tolist()], [(way.tolist(), limit) for way, limit in limits.sums()]
    opening, capacity, end, least = ready[0], allowed(limits.capacity), len(at) - 1, problem.sense == "min"
    found: dict[int, float] = {}
    size = 0.0

    def ended(mask: int, clock: float, spent: float, latest: float, length: float, won: float) -> None:
        nonlocal size
        lasts = max(spent, clock - latest)
        paid = vehicle.unit_duration_cost * lasts + vehicle.unit_overtime_cost * max(0.0, lasts - vehicle.regular_duration)
        saved = math.fsum(penalty[k] for k in range(1, end) if mask >> k & 1)
        parts = {
            "total-cost": vehicle.fixed_cost + vehicle.unit_cost * length + paid, "reward": won, "vehicles": 1.0, "penalties": -saved,
            "longest-route": length, "makespan": lasts, "total-duration": lasts, "latest-return": clock,
        }  # fmt: skip
        weighted = [weight * parts[name] for name, weight in terms.items()]
        size = max(size, math.fsum(map(abs, weighted)))
        _keep(found, mask >> 1, math.fsum(weighted), least)

    def extend(
        last: int, mask: int, clock: float, spent: float, latest: float, load: float, length: float, won: float, sums: list[float]
    ) -> None:
        for node in range(1, end + 1):
            if (mask >> node) & 1 or (node == end and not mask):
                continue
            arrival, total = clock + busy[last][node], spent + busy[last][node]
            if arrival == math.inf or arrival > due[node] or (load + demand[node]) * (1.0 - 1e-13) > capacity:
                continue
            begin, leave = max(arrival, ready[node]), min(latest, due[node] - total)
            used = [s + way[last][node] for s, (way, _) in zip(sums, budgets, strict=True)]
            if any(u > limit for u, (_, limit) in zip(used, budgets, strict=True)):
                continue
            if any(rate * (begin - (opening if fixed else leave)) > limit for rate, limit, fixed in limits.spans):
                continue
            if limits.uncertain(used):
                continue
            if node == end:
                ended(mask, begin, total, leave, length + far[last][node], won)
            else:
                extend(node, mask | 1 << node, begin, total, leave, load + demand[node], length + far[last][node], won + reward[node], used)

    extend(0, 0, opening, 0.0, due[0], 0.0, 0.0, 0.0, [0.0] * len(budgets))
    by_time = math.fsum(abs(terms.get(name, 0.0)) for name in ("makespan", "total-duration", "latest-return"))
    by_time += abs(terms.get("total-cost", 0.0)) * (vehicle.unit_duration_cost + vehicle.unit_overtime_cost)
    return found, 16.0 * (len(at) + 2) * _EPS * size + by_time * limits.rounding
