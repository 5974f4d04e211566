"""Evidence ``all-routes``: every route of a few customers, by every type of vehicle, and every way to put them together.

There is nothing to state: the checker walks all of it, with several types of vehicle, optional customers, and the risk of each route.
Where orders are too many, sets of customers are looked at by the sums of moves alone, without waiting, windows and loads on the way, so
that routes cost no more and more of them are possible. Of two orders of a set with the same last customer the one with no more of any
sum stands for the other: whatever follows, it costs no more and keeps each limit that the other keeps.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.routing.instance import VehicleType
from ...stop import Stopped, current_stop
from ..objective import PEAKS
from ..problem import RoutingProblem
from .known_features import EPS, Flags, Floats, Integers, departure, own_moves, routing_evidence
from .no_answer import verdict
from .route_limits import Limits, able, allowed, limits_of, summable, walk_orders
from .vehicle_moves import Terms, terms_of

MOST = 12
"""Customers of which all sets are looked at."""

Front = Floats
"""Shape (routes, 2): worth, and what the route takes of the team's risk; in order of worth, and ever less of the risk."""


def fronts(problem: RoutingProblem, vehicle: VehicleType, limits: Limits, terms: Terms) -> tuple[dict[int, Front], float]:
    """Worth and risk of the routes of a vehicle through each set of customers, a mask, and by how much worths may be off."""
    sites = problem.sites
    at = np.concatenate([[vehicle.start], sites.customers, [vehicle.end]])
    far = own_moves(problem, vehicle)[0][np.ix_(at, at)]
    n, end = len(sites.customers), len(at) - 1
    sums = [far, limits.busy, *(w for w, _ in limits.budgets), *(w for chance in limits.chances for w in chance[:2])]
    along, where, fixed = list[Floats](), list[int](), list[Floats]()  # rows that depend on the order, and what each sum is read off
    for weight in sums:
        if weight is not far and bool((weight == weight[0]).all()):  # a load: the same in any order
            where.append(-1 - len(fixed))
            fixed.append(weight[0])
            continue
        known = next((k for k, other in enumerate(along) if np.array_equal(weight, other)), len(along))
        along += [weight] * (known == len(along))
        where.append(known)
    moves = np.array(along)
    good = able(problem, vehicle)
    demand, capacity = limits.demand, allowed(limits.capacity)
    latest = limits.latest(float(limits.due[-1]))
    labels: dict[tuple[int, int], Floats] = {}
    best: dict[int, Front] = {}
    size, stop = 0.0, current_stop()
    of_time = terms.cost * vehicle.unit_duration_cost + terms.duration
    team = problem.team_risk

    def read(total: Floats, k: int, members: Integers) -> Floats:
        """The k-th of all sums, shape (labels,)."""
        return total[:, where[k]] if where[k] >= 0 else np.full(len(total), math.fsum(fixed[-1 - where[k]][members]))

    def kept(total: Floats, members: Integers) -> Flags:
        busy = read(total, 1, members)
        fits: Flags = np.isfinite(total).all(axis=1) & (limits.ready[0] + busy <= latest)
        for rate, limit, _ in limits.spans:
            fits &= rate * busy <= limit
        for k, (_, limit) in enumerate(limits.budgets):
            fits &= read(total, 2 + k, members) <= limit
        for k, (_, _, deviations, limit) in enumerate(limits.chances):
            first = 2 + len(limits.budgets) + 2 * k
            fits &= read(total, first, members) + deviations * np.sqrt(read(total, first + 1, members)) <= limit
        return fits

    for mask in range(1, 1 << n):
        stop.check()
        members = np.nonzero((mask >> np.arange(n)) & 1)[0] + 1
        if not good[members - 1].all() or math.fsum(demand[members]) * (1.0 - 1e-13) > capacity:
            continue
        ended = []
        for last in members.tolist():
            rest = mask ^ (1 << (last - 1))
            come = [labels[rest, k] + moves[:, k, last] for k in members.tolist() if (rest, k) in labels]
            total = np.concatenate(come) if rest and come else moves[:, 0, last][None] if not rest else np.zeros((0, len(along)))
            total = total[kept(total, members)]
            if len(total):
                labels[mask, last] = _least(total)
                ended.append(labels[mask, last] + moves[:, last, end])
        if not ended:
            continue
        total = np.concatenate(ended)
        total = total[kept(total, members)]
        if not len(total):
            continue
        busy, visited = read(total, 1, members), at[members]
        gained = terms.reward * math.fsum(sites.reward[visited]) - terms.penalties * math.fsum(sites.penalty[visited])
        paid = terms.cost * (vehicle.fixed_cost + vehicle.unit_cost * total[:, 0]) + of_time * busy
        paid = paid + terms.cost * vehicle.unit_overtime_cost * np.maximum(0.0, busy - vehicle.regular_duration)
        size = max(size, float(np.abs(paid).max()) + abs(gained) + abs(terms.vehicles))
        risk = np.zeros(len(total))
        for k, (_, _, _, limit) in enumerate(limits.chances if team is not None else ()):
            first = 2 + len(limits.budgets) + 2 * k
            risk = np.maximum(
                risk, _overrun(read(total, first, members), read(total, first + 1, members), limit, _rate(vehicle, k, limits))
            )
        worth = np.column_stack([paid + gained + terms.vehicles, -np.log1p(-np.minimum(risk, 0.5)) * (1.0 - 1e-8)])
        best[mask] = _front(worth)
    by_time = (of_time + terms.cost * vehicle.unit_overtime_cost) * limits.rounding
    return best, 16.0 * (len(at) + 2) * EPS * size + by_time


def _rate(vehicle: VehicleType, k: int, limits: Limits) -> float:
    """Energy that a unit of time draws, for the chance of the store, which comes last; 1 for durations."""
    store = vehicle.energy is not None and k == len(limits.chances) - 1 and math.isfinite(vehicle.energy.at_departure)
    return vehicle.energy.rate if store and vehicle.energy is not None else 1.0


def _overrun(mean: Floats, variance: Floats, limit: float, rate: float) -> Floats:
    """Lower bounds on the probabilities that a sum exceeds its limit."""
    deviation = rate * np.sqrt(variance)
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = np.where(deviation > 0.0, (limit - mean) / deviation, math.inf)
    return np.array([0.5 * math.erfc(z / math.sqrt(2.0)) if z < math.inf else 0.0 for z in beyond.tolist()])


def _least(rows: Floats) -> Floats:
    """The rows that are not dominated by another row; of equal ones one."""
    rows = np.unique(rows, axis=0)
    if rows.shape[1] == 1:
        return rows[:1]
    kept: list[Floats] = []
    while len(rows):  # the first in this order is above none
        kept.append(rows[0])
        rows = rows[(rows < rows[0]).any(axis=1)]
    return np.array(kept)


def _front(rows: Floats) -> Front:
    """Rows of least worth for ever less of the risk."""
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    before = np.minimum.accumulate(np.append(math.inf, rows[:-1, 1]))
    front: Front = rows[rows[:, 1] < before]
    return front


def put_together(routes: list[dict[int, Front]], customers: int, fewest: int, most: int, risk: float) -> dict[tuple[int, int], float]:
    """Least worth of routes that serve each set, by set and number of routes, all together within ``risk``.

    Numbers of routes are told apart where they count; 1 stands for any number where any will do.
    """
    any_number = fewest <= 1 and most >= customers
    ways: dict[tuple[int, int], Front] = {(0, 0): np.zeros((1, 2))}
    of_set: dict[int, Front] = {}
    for one in routes:
        for mask, front in one.items():
            of_set[mask] = _front(np.concatenate([of_set[mask], front])) if mask in of_set else front
    if risk == math.inf:
        return _cheapest(of_set, customers, most, any_number)
    stop = current_stop()
    for mask in range(1, 1 << customers):
        stop.check()
        low, sub, new = mask & -mask, mask, dict[int, list[Floats]]()
        while sub:
            if sub & low and sub in of_set:
                for count in range(2 if any_number else most):
                    before = ways.get((mask ^ sub, count))
                    if before is not None:
                        joined = (before[:, None] + of_set[sub][None]).reshape(-1, 2)
                        new.setdefault(1 if any_number else count + 1, []).append(joined)
            sub = (sub - 1) & mask
        for count, parts in new.items():
            every = np.concatenate(parts)
            every = every[every[:, 1] <= risk]
            if len(every):
                ways[mask, count] = _front(every)
    return {way: float(front[0, 0]) for way, front in ways.items()}


def _cheapest(of_set: dict[int, Front], customers: int, most: int, any_number: bool) -> dict[tuple[int, int], float]:
    """``put_together`` without a risk of the team, by arrays over all parts of a set."""
    best = np.full(1 << customers, math.inf)
    for mask, front in of_set.items():
        best[mask] = front[0, 0]
    least = np.full((2 if any_number else most + 1, 1 << customers), math.inf)
    least[0, 0] = 0.0
    parts, stop = {0: np.zeros(1, np.int64)}, current_stop()
    for mask in range(1, 1 << customers):
        stop.check()
        low, top = mask & -mask, 1 << (mask.bit_length() - 1)
        fewer = parts[mask ^ top]
        parts[mask] = np.concatenate([fewer, fewer | top])
        others = parts[mask ^ low]
        values = (best[others | low] + least[:, (mask ^ low) ^ others]).min(axis=1)
        least[1:, mask] = values[:-1]
        if any_number:
            least[1, mask] = min(values)
    return {(mask, count): float(least[count, mask]) for count, mask in np.argwhere(np.isfinite(least)).tolist()}


MOST_ORDERS = 20_000
"""Orders of some of the customers, times types of vehicle: 7 customers of one type, 6 of 10, 5 of 61."""


def orders(problem: RoutingProblem) -> float:
    """Number of ways to visit some of the customers, for all types together; infinity where they are many."""
    n = len(problem.sites.customers)
    return math.inf if n > 10 else len(problem.fleet) * sum(math.perm(n, k) for k in range(1, n + 1))


@routing_evidence("all-routes", "all routes are")
def check_all_routes(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """The optimum of the first level, up to rounding, or infinity where there is no answer; nothing of ``data`` is read.

    Nothing is proved of more than 12 customers, or where the objective mixes the largest of all routes with other terms.
    """
    level, sign = problem.objective.levels()[0].terms, 1.0 if problem.sense == "min" else -1.0
    terms, peak = terms_of(problem), any(term.name in PEAKS for _, term in level)
    if not summable(problem) or terms is None or (peak and (len(level) > 1 or level[0][0] < 0)):
        return verdict(proved=False)
    many = orders(problem) > MOST_ORDERS
    if not many and (peak or problem.team_risk is None):
        return sign * _walked(problem, terms, peak)
    if peak or len(problem.sites.customers) > MOST:
        return verdict(proved=False)
    bound = _by_sets(problem, terms)
    return bound if many else max(bound, sign * _walked(problem, terms, peak))


def _walked(problem: RoutingProblem, terms: Terms, peak: bool) -> float:
    """The bound from every order of customers, in the sense of the problem; each route may take all of the team's risk."""
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
    values = [value for (done, count), value in ways.items() if done & must == must and count >= problem.min_vehicles]
    if not values:
        return math.inf if least else -math.inf
    weights = {name: math.fsum(weight for weight, term in level if term.name == name) for name in ("reward", "penalties")}
    sites = problem.sites
    fixed = weights["reward"] * math.fsum(sites.reward[sites.depots].tolist())
    fixed += weights["penalties"] * math.fsum(sites.penalty[~sites.depot].tolist())
    best = min(values) - n * doubt if least else max(values) + n * doubt
    return best + fixed - (1.0 if least else -1.0) * 8.0 * EPS * (abs(best) + abs(fixed)) if fixed else best


def _by_sets(problem: RoutingProblem, terms: Terms) -> float:
    """The bound from sets of customers: less than the optimum where somebody waits or loads on the way."""
    sites, n = problem.sites, len(problem.sites.customers)
    most = min(n, sum(n if v.count is None else v.count for v in problem.fleet))
    risk = math.inf if problem.team_risk is None else -math.log1p(-problem.team_risk) * (1.0 + 1e-8)
    try:
        every = [fronts(problem, vehicle, limits_of(problem, vehicle), terms) for vehicle in problem.fleet]
        ways = put_together([sets for sets, _ in every], n, problem.min_vehicles, most, risk)
    except Stopped:
        return verdict(proved=False)
    doubt = max(off for _, off in every)
    must = sum(1 << k for k, required in enumerate(sites.required[sites.customers].tolist()) if required)
    values = [value for (done, count), value in ways.items() if done & must == must and count >= problem.min_vehicles]
    if not values:
        return verdict(proved=True)
    fixed = terms.reward * math.fsum(sites.reward[sites.depots].tolist()) + terms.penalties * math.fsum(
        sites.penalty[~sites.depot].tolist()
    )
    best = min(values)
    return best + fixed - n * doubt - 16.0 * EPS * (abs(best) + abs(fixed))


def _keep(ways: dict[Any, float], way: Any, value: float, least: bool) -> None:
    known = ways.get(way)
    if known is None or (value < known if least else value > known):
        ways[way] = value


def _routes(problem: RoutingProblem, limits: Limits, vehicle: VehicleType) -> tuple[dict[int, float], float]:
    """Value in the objective of the best route through each set of customers, a mask, and by how much that may be off."""
    sites, terms = problem.sites, {term.name: weight for weight, term in problem.objective.levels()[0].terms}
    at = np.concatenate([[vehicle.start], sites.customers, [vehicle.end]])
    far, reward, penalty = own_moves(problem, vehicle)[0][np.ix_(at, at)], sites.reward[at].copy(), sites.penalty[at].tolist()
    reward[-1], least = 0.0, problem.sense == "min"
    best: dict[int, float] = {}
    size = 0.0

    def ended(mask: int, clock: float, spent: float, latest: float, length: float, won: float) -> None:
        nonlocal size
        lasts = max(spent, clock - latest)
        paid = vehicle.unit_duration_cost * lasts + vehicle.unit_overtime_cost * max(0.0, lasts - vehicle.regular_duration)
        saved = math.fsum(penalty[k] for k in range(1, len(at) - 1) if mask >> (k - 1) & 1)
        parts = {
            "total-cost": vehicle.fixed_cost + vehicle.unit_cost * length + paid, "reward": won, "vehicles": 1.0, "penalties": -saved,
            "longest-route": length, "makespan": lasts, "total-duration": lasts, "latest-return": clock,
        }  # fmt: skip
        weighted = [weight * parts[name] for name, weight in terms.items()]
        size = max(size, math.fsum(map(abs, weighted)))
        _keep(best, mask, math.fsum(weighted), least)

    every = np.arange(1, len(at) - 1)
    walk_orders(limits, every, every[:0], len(every), ended, (far, np.broadcast_to(reward, far.shape)))
    by_time = math.fsum(abs(terms.get(name, 0.0)) for name in ("makespan", "total-duration", "latest-return"))
    by_time += abs(terms.get("total-cost", 0.0)) * (vehicle.unit_duration_cost + vehicle.unit_overtime_cost)
    return best, 16.0 * (len(at) + 2) * EPS * size + by_time * limits.rounding
