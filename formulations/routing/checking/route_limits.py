"""Which sites one vehicle can serve on one route at most: the arithmetic that every proof of infeasibility in routing rests on.

Whatever is not shown to be impossible counts as possible. Visits that a proof does not name are free detours, so that the triangle
inequality is never assumed, and every limit is widened by what ``evaluate`` lets pass. Shortest ways and earliest times are worked out
here once more, apart from ``reachability`` and ``instances.routing.reach``, which only suspect: what is wrong there must not be confirmed
here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from ....instances.errors import InputError
from ...tolerance import widening
from .known_features import Flags, Floats, Integers, departure, earliest_levels, last_return, own_moves, own_variances, unknown_features

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


LARGEST_RATE = 1e100
"""With a larger rate of energy sums may overflow, and nothing is proved."""


def allowed(limit: float, size: float = 0.0, rounding: float = 0.0) -> float:
    """The largest computed value that may still be one within ``limit``, relative to ``size`` where that is larger."""
    return limit + float(widening(limit, abs(size))) + rounding


def summable(problem: RoutingProblem) -> bool:
    """Whether all features are known, and no sum along a route can overflow: an instance bounds all numbers but rates of energy."""
    return not unknown_features(problem) and all(v.energy is None or v.energy.rate <= LARGEST_RATE for v in problem.fleet)


@dataclass(frozen=True)
class Limits:
    """Limits of one vehicle type, all widened, over the nodes start (0), customers in site order (1 to n) and end (n + 1).

    ``busy`` is the service at the tail and the move, shape (nodes, nodes). ``budgets`` are weights of moves of which the sum along a
    route is limited, ``spans`` (rate, limit, fixed) limits on ``rate`` times the time to the return, from the opening of the depot
    (``fixed``) or from the latest departure, ``chances`` (means, variances, deviations, limit) limits on a sum of means and so many times
    the root of one of variances. No earliest schedule runs longer than ``horizon``; sums of times along any route may be wrong by
    ``rounding``.
    """

    ready: Floats
    due: Floats
    demand: Floats
    busy: Floats
    budgets: list[tuple[Floats, float]]
    spans: list[tuple[float, float, bool]]
    chances: list[tuple[Floats, Floats, float, float]]
    capacity: float
    horizon: float
    rounding: float

    def latest(self, due: float) -> float:
        """The latest arrival that may count as one by ``due``."""
        return allowed(due, float(self.ready[0]), self.rounding)

    def sums(self) -> list[tuple[Floats, float]]:
        """Weights of moves that are to be added up, each with the limit of its sum: ``budgets``, and what ``uncertain`` looks at."""
        return [*self.budgets, *((weights, math.inf) for chance in self.chances for weights in chance[:2])]

    def uncertain(self, sums: Sequence[float]) -> bool:
        """Whether a route that adds up to this breaks one of ``chances``."""
        return any(
            sums[at] + deviations * math.sqrt(sums[at + 1]) > limit
            for at, (_, _, deviations, limit) in zip(range(len(self.budgets), len(sums), 2), self.chances, strict=True)
        )


def limits_of(problem: RoutingProblem, vehicle: VehicleType) -> Limits:
    """The limits that ``vehicle`` must keep to."""
    sites = problem.sites
    at = np.concatenate([[vehicle.start], sites.customers, [vehicle.end]])
    grid = np.ix_(at, at)
    far, move = (matrix[grid] for matrix in own_moves(problem, vehicle))
    ready, due = sites.ready[at].astype(np.float64), sites.due[at].astype(np.float64)
    ready[0], due[-1] = departure(problem, vehicle), last_return(problem, vehicle)
    service, demand = sites.service[at].copy(), sites.demand[at].copy()
    service[[0, -1]] = demand[[0, -1]] = 0.0
    busy = service[:, None] + move
    ready[-1] = -math.inf  # nobody waits for a depot to open
    horizon = float(np.abs(ready[:-1]).max()) + float(busy.max(axis=0).sum())
    ulps = 8.0 * (len(at) + 2) * float(np.finfo(np.float64).eps)
    rounding = ulps * horizon
    budgets = [(busy, vehicle.max_duration, rounding), (far, vehicle.max_distance, ulps * float(far.max(axis=0).sum()))]
    spans = [(1.0, vehicle.max_duration, False, rounding)]
    if vehicle.energy is not None:
        store, rate, charge = vehicle.energy.at_departure, vehicle.energy.rate, vehicle.energy.charge
        if charge == "windows":
            drawn = rate * np.maximum(busy, ready[None, :] - np.append(ready[:-1], 0.0)[:, None])
        else:
            drawn = rate * (move if charge == "travel" else busy)
        budgets.append((drawn, store, rate * rounding + ulps * float(drawn.max(axis=0).sum())))
        if charge in ("elapsed", "elapsed-fixed-start"):
            spans.append((rate, store, charge == "elapsed-fixed-start", rate * rounding))
    further = zip(vehicle.further_capacity, sites.further_demand.T, sites.further_pickup.T, strict=False)
    carried = [(vehicle.capacity, sites.pickup), *((limit, loads) for limit, *both in further for loads in both)]
    for limit, loads in carried if not vehicle.reloads else ():
        amounts = loads[at].copy()
        amounts[[0, -1]] = 0.0
        if amounts.any():  # all that is delivered is on board at the start, all that is collected at the end
            budgets.append((np.broadcast_to(amounts, far.shape), limit, ulps * float(amounts.sum())))
    if problem.forbidden is not None:  # what lies beyond every limit is on no route
        shut = problem.forbidden[grid]
        busy, budgets = np.where(shut, math.inf, busy), [(np.where(shut, math.inf, w), x, wide) for w, x, wide in budgets]
    return Limits(
        ready, due, demand, busy, [(w, allowed(x, 0.0, wide)) for w, x, wide in budgets if math.isfinite(x)],
        [(r, allowed(x, 0.0, wide), fixed) for r, x, fixed, wide in spans if math.isfinite(x)],
        _chances(problem, vehicle, at, (move, service[:, None] + move), rounding), vehicle.capacity, horizon, rounding,
    )  # fmt: skip


def _chances(
    problem: RoutingProblem, vehicle: VehicleType, at: Integers, moves: tuple[Floats, Floats], rounding: float
) -> list[tuple[Floats, Floats, float, float]]:
    """Limits on uncertain durations of ``moves``, without and with service. A risk of the team is one of each route, which forbids less."""
    risks = [risk for risk in (vehicle.risk, problem.team_risk) if risk is not None]
    if not risks or not (vehicle.travel or problem.travel).uncertain:
        return []
    deviations = -NormalDist().inv_cdf(min(0.5, min(risks) * (1.0 + 1e-8))) * (1.0 - 1e-9)  # the quantile may be off by less
    spread, (move, busy), energy = own_variances(problem, vehicle)[np.ix_(at, at)], moves, vehicle.energy
    chances = [(busy, spread, deviations, allowed(vehicle.max_duration, 0.0, rounding))]
    if energy is not None:
        drawn = energy.rate * (move if energy.charge == "travel" else busy)
        chances.append((drawn, spread, energy.rate * deviations, allowed(energy.at_departure, 0.0, energy.rate * rounding)))
    return [chance for chance in chances if math.isfinite(chance[-1])]


def able(problem: RoutingProblem, vehicle: VehicleType) -> Flags:
    """Customers for which it has the skills, room for what is delivered and collected there, and for each shipment; shape (n,)."""
    sites = problem.sites
    good = np.array([needs <= vehicle.skills for needs in sites.skills] if sites.skills else [True] * len(sites))
    for shipment in sites.shipments:
        if any(load > allowed(capacity) for load, capacity in zip(shipment.load, vehicle.capacities, strict=False)):
            good[[shipment.pickup, shipment.delivery]] = False
    carried = np.column_stack([sites.demand, sites.further_demand]), np.column_stack([sites.pickup, sites.further_pickup])
    for loads in carried:
        for load, capacity in zip(loads.T, vehicle.capacities, strict=False):
            good &= load <= allowed(capacity)
    return good[sites.customers]


def within_stores(problem: RoutingProblem, vehicle: VehicleType) -> Flags:
    """Customers that lie on some way from start or station to station or end that one store lasts for; all without stations."""
    customers, energy = problem.sites.customers, vehicle.energy
    if energy is None or not energy.stations or energy.rate > LARGEST_RATE:
        return np.ones(len(customers), dtype=bool)
    draws = energy.rate * own_moves(problem, vehicle)[1]
    between, stations = draws[np.ix_(customers, customers)], np.array(energy.stations)
    rounding = 8.0 * (len(customers) + 2) * float(np.finfo(np.float64).eps) * 2.0 * float(draws.max(axis=0).sum())
    begins = [(energy.at_departure, earliest_levels(draws[vehicle.start, customers], between))]
    begins.append((energy.capacity, earliest_levels(draws[np.ix_(stations, customers)].min(axis=0), between)))
    last = earliest_levels(draws[np.ix_(customers, np.append(stations, vehicle.end))].min(axis=1), between.T)
    near: Flags = np.any([there + last <= allowed(store, 0.0, rounding) for store, there in begins], axis=0)
    return near


def within_reach(limits: Limits) -> Flags:
    """Customers that the vehicle may be able to visit, by any detours over other customers; shape (n,)."""
    inner = slice(1, -1)
    good = limits.demand[inner] <= allowed(limits.capacity)
    for weight, limit in limits.budgets:
        mid = weight[inner, inner]
        need = earliest_levels(weight[0, inner], mid) + earliest_levels(weight[inner, -1], mid.T)
        good &= need <= limit
    for means, variances, deviations, limit in limits.chances:
        mean, variance = (
            earliest_levels(w[0, inner], w[inner, inner]) + earliest_levels(w[inner, -1], w[inner, inner].T) for w in (means, variances)
        )
        good &= mean + deviations * np.sqrt(variance) <= limit
    reached, home = clocks(limits)
    finish = reached + home
    good &= np.isfinite(reached) & (finish <= limits.latest(float(limits.due[-1])))
    for rate, limit, fixed in limits.spans:
        if fixed:
            good &= rate * (finish - limits.ready[0]) <= limit
    return good


def clocks(limits: Limits) -> tuple[Floats, Floats]:
    """Earliest begin of service at each customer, infinite where its window is missed, and the least time from there to the return."""
    busy, inner = limits.busy, slice(1, -1)
    due = np.array([limits.latest(d) for d in limits.due.tolist()])
    reached = earliest_levels(limits.ready[0] + busy[0, inner], busy[inner, inner], limits.ready[inner], due[inner])
    return reached, earliest_levels(busy[inner, -1], busy[inner, inner].T)


def servable_sets(limits: Limits, named: Integers, through: Integers, most: int) -> set[int]:
    """Subsets of the customers ``named``, as bit masks, that may be all of them on one route; it may visit those ``through`` besides.

    The time taken grows as the factorial of ``most``, the largest size of a set.
    """
    sets: set[int] = set()
    walk_orders(limits, named, through, most, lambda mask, *_: sets.add(mask))
    return sets


def walk_orders(
    limits: Limits, named: Integers, through: Integers, most: int, ended: Callable[..., None], counted: Sequence[Floats] = ()
) -> None:
    """Call ``ended`` with each order of at most ``most`` of the customers ``named`` that keeps to the limits.

    It is given the set as a mask, the earliest return, the time without waiting, the latest departure that delays nothing, and the sums of
    the weights of moves ``counted``.
    """
    nodes = np.concatenate([[0], named, [len(limits.ready) - 1]]).astype(np.int64)
    end = len(nodes) - 1
    busy = _ways(limits.busy, nodes, through).tolist()
    budgets = [(_ways(weight, nodes, through).tolist(), limit) for weight, limit in limits.sums()]
    tallies = [weight[np.ix_(nodes, nodes)].tolist() for weight in counted]
    ready, demand = limits.ready[nodes].tolist(), limits.demand[nodes].tolist()
    due = [limits.latest(d) for d in limits.due[nodes].tolist()]
    opening, capacity = float(limits.ready[0]), allowed(limits.capacity)

    def spends(clock: float, latest: float) -> bool:
        return all(rate * (clock - (opening if fixed else latest)) <= limit for rate, limit, fixed in limits.spans)

    def extend(
        last: int, mask: int, size: int, clock: float, spent: float, latest: float, load: float, sums: list[float], counts: list[float]
    ) -> None:
        for node in range(1, end + 1):
            if (mask >> node) & 1 or (node == end and not mask) or (node < end and size == most):
                continue
            arrival, total = clock + busy[last][node], spent + busy[last][node]
            if arrival == math.inf or arrival > due[node] or (load + demand[node]) * (1.0 - 1e-13) > capacity:
                continue
            begin = max(arrival, ready[node])
            leave = min(latest, due[node] - total)
            used = [s + way[last][node] for s, (way, _) in zip(sums, budgets, strict=True)]
            if any(u > limit for u, (_, limit) in zip(used, budgets, strict=True)) or not spends(begin, leave):
                continue
            if limits.uncertain(used):
                continue
            counts_there = [c + tally[last][node] for c, tally in zip(counts, tallies, strict=True)]
            if node == end:
                ended(mask >> 1, begin, total, leave, *counts_there)
            else:
                extend(node, mask | 1 << node, size + 1, begin, total, leave, load + demand[node], used, counts_there)

    extend(0, 0, 0, opening, 0.0, due[0], 0.0, [0.0] * len(budgets), [0.0] * len(tallies))


def _ways(weight: Floats, nodes: Integers, through: Integers) -> Floats:
    """Weights of the shortest ways between ``nodes`` over nodes of ``through``, shape (nodes, nodes)."""
    lengths = weight[np.ix_(nodes, nodes)].copy()
    if len(through):
        inner, last = weight[np.ix_(through, through)], weight[np.ix_(through, nodes)]
        for k, node in enumerate(nodes[:-1].tolist()):
            lengths[k] = np.minimum(lengths[k], (earliest_levels(weight[node, through], inner)[:, None] + last).min(axis=0))
    return lengths


def named_customers(problem: RoutingProblem, names: object) -> list[int]:
    """Integers of the customers that evidence names; raises InputError if ``names`` is no list of different ids of customers."""
    index = problem.sites.index()
    if not isinstance(names, Sequence) or isinstance(names, str) or not names or not all(isinstance(x, str) and x in index for x in names):
        raise InputError("evidence names unknown sites", "unknown-name", expected="a list of ids of sites", found=str(names)[:80])
    node = {site: k for k, site in enumerate(problem.sites.customers.tolist(), start=1)}
    at = [index[x] for x in names]
    if len(set(at)) < len(at) or any(i not in node for i in at):
        raise InputError("evidence names a depot, or a site twice", found=str(names)[:80])
    return [node[i] for i in at]
