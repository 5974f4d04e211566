"""Bound ``state-space``: prices of visits for the evidence of the same name, by ascent.

Where few vehicles drive, or several types, or sites may be left out, prices follow the visits of each type's best walk (a subgradient).
Where many vehicles of one type serve all, the best walk through each customer tells what the price of its visit lacks: prices rise, or
fall, by each customer's share of that, and follow the visits of all these walks at once.
"""

import math
from dataclasses import dataclass

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.customer_sets import CUSTOMERS
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.relaxation import Resource
from ....formulations.routing.checking.vehicle_moves import VehicleMoves, alike, needed_routes, terms_of
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .arcs import LIMITS, Flags, Floats, Integers, by_site, lacks_arc_costs, too_many_arcs
from .price_sharing import NEIGHBOURS, ROUNDS, WORK_PER_SECOND, shared_prices
from .resource_walks import Walks, step_size
from .subgradient_ascent import ascend

CHECKED = 3e8
"""Moves times steps that the check may take."""

MANY_ROUTES = 4
"""Routes from which on prices are shared out among all walks."""

BUDGET = 0.8
"""Part of the time left that it uses where other methods come later."""

LEAST_STEPS = 400
"""Least number of steps where prices follow single walks, of which each has many visits."""


@dataclass(eq=False)
class _Rows:
    """The value of prices of visits, and how many routes there are."""

    required: Flags
    groups: list[tuple[Integers, bool]]
    counts: list[int]
    fewest: int

    def worth(self, prices: Floats) -> tuple[float, Floats]:
        """Value of prices, and its slope."""
        slope = (self.required | (prices < 0)).astype(np.float64)
        for members, must in self.groups:
            least = members[int(np.argmin(prices[members]))]
            slope[members] = 0.0
            slope[least] = float(must or prices[least] < 0)
        return float(slope @ prices), slope

    def routes(self, least: list[float]) -> list[int]:
        """How many routes of each type are cheapest, for the least cost of a route of each."""
        routes = [0] * len(least)
        for k in sorted(range(len(least)), key=least.__getitem__):
            used = sum(routes)
            routes[k] = min(self.counts[k], len(self.required) - used if least[k] < 0 else max(0, self.fewest - used))
        return routes


def _lacks(problem: RoutingProblem) -> frozenset[str]:
    """Features that the checker does not know, problems without customers, and objectives in which more of a cost is better."""
    missing = unknown_features(without_stops(problem))
    if not len(problem.customers):
        missing = missing | {"no customers"}
    return missing if terms_of(problem) is not None else missing | {"objective:weights"}


KERNELS = ("waybound.solvers.bounds.routing.state_space_kernels", "waybound.formulations.routing.checking.state_space_kernels")


@bound_method("state-space", of_family("routing", _lacks), order=1, kernels=KERNELS)
def state_space_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the best prices that an ascent finds.

    None where the time does not suffice for one round: first prices, from walks that were cut short, prove next to nothing. Source:
    Christofides, Mingozzi, Toth (1981); sharing by walks through each customer: Baldacci, Christofides, Mingozzi (2008).
    """
    if too_many_arcs(problem, stop.seconds_left):
        return None
    summed = not lacks_arc_costs(problem)
    if summed and not problem.features() & LIMITS:  # trees and assignments see more
        return None
    if summed or len(problem.customers) <= CUSTOMERS:  # column generation, or sets of customers, may see more
        stop = stop.within(BUDGET * stop.seconds_left)
    sites, customers, relaxed = problem.sites, problem.sites.customers, without_stops(problem)
    terms = terms_of(problem)
    assert terms is not None
    sign = 1.0 if problem.sense == "min" else -1.0
    types = alike(relaxed)
    moves = [VehicleMoves.of(relaxed, v, terms, np.zeros(len(customers)), {}) for v in types]
    name = _resource(problem, moves)
    work = WORK_PER_SECOND * min(stop.seconds_left, 10.0) / ROUNDS / len(moves)
    kept = [_kept(m, name, work) for m in moves]
    node = {site: k for k, site in enumerate(customers.tolist())}
    required = sites.required[customers]
    rows = _Rows(
        required,
        [(np.array([node[s] for s in g.sites]), g.required) for g in sites.groups],
        [min(len(customers), count) for count in types.values()],
        max(problem.min_vehicles, int(needed_routes(relaxed, required))),
    )
    many = len(moves) == 1 and bool(required.all()) and rows.counts[0] >= MANY_ROUTES
    least = 20 if many else LEAST_STEPS
    step = max(step_size(m, name, k, work, least) for m, k in zip(moves, kept, strict=True))
    fine = max(step_size(m, name, np.isfinite(m.cost), CHECKED / len(moves), least) for m in moves)
    walks = [Walks(m.cost, m.resources[name], step, k) for m, k in zip(moves, kept, strict=True)]
    most = 2.0 * (len(customers) + 1) * max(float(np.abs(m.cost[np.isfinite(m.cost)]).max(initial=0.0)) for m in moves)
    if many:
        limits = rows.fewest, rows.counts[0]
        prices, value = shared_prices(moves[0], name, walks[0], limits, np.append(0.0, _weights(relaxed)), most, stop, fine)
    else:
        prices, value = _followed(walks, rows, most, stop)
    if value > most or value == -math.inf:  # more than any answer costs: there is none, which others prove; or no time for one round
        return None
    data = {"prices": by_site(problem, prices), "resource": name, "step": fine}
    return Evidence("state-space", f"state-space relaxation over {name}", sign * value, data)


def _weights(problem: RoutingProblem) -> Floats:
    demand = problem.sites.demand[problem.customers]
    mean = float(demand.mean())
    return demand + 0.2 * mean if mean > 0 else np.ones(len(demand))


def _resource(problem: RoutingProblem, moves: list[VehicleMoves]) -> str:
    """The resource of which an answer needs the largest part of what all routes have."""
    needs: dict[str, float] = {}
    for name in moves[0].resources:
        need = math.inf
        for m in moves:
            if name not in m.resources:
                need = -1.0
                break
            r = m.resources[name]
            weight = np.where(np.isfinite(m.cost), r.weight, math.inf)[:, 1:]
            least = weight.min(axis=0)
            least = least[np.isfinite(least)]
            room = float(r.upper[0]) - r.start
            need = min(need, float(least.sum()) / room if room > 0 else 0.0)
        if name == "time" and np.isfinite(problem.sites.due[problem.customers]).any():
            need /= max(1e-6, max(_width(m.resources[name]) for m in moves))
        needs[name] = need * (1e-6 if name == "order" else 1.0)  # where nothing else is limited
    return max(needs, key=needs.__getitem__)


def _width(resource: Resource) -> float:
    """Mean part of the room of a resource that the levels of a customer span."""
    span, room = (resource.upper - resource.lower)[1:], float(resource.upper[0]) - resource.start
    span = span[np.isfinite(span)]
    return float(np.clip(span / room, 0.0, 1.0).mean()) if len(span) and room > 0 else 1.0


def _kept(moves: VehicleMoves, name: str, work: float) -> Flags:
    """The cheapest and shortest moves into and out of each customer, as many as there is time for."""
    usable = np.isfinite(moves.cost)
    n = len(usable)
    near = int(np.clip(work / (300.0 * n), NEIGHBOURS, n))
    if near >= n - 2:
        return usable
    finite = np.where(usable, moves.cost, 0.0)
    dear = np.where(usable, moves.cost - np.where(usable, moves.cost, math.inf).min(axis=0, initial=np.abs(finite).max()), math.inf)
    r = moves.resources[name]
    idle = np.maximum(0.0, np.where(usable, r.lower[None, :], 0.0) - np.where(usable, r.upper[:, None] + r.weight, 0.0))
    weight = np.where(usable, r.weight + idle, math.inf)
    far = sum(part / max(float(part[usable].max(initial=0.0)), 1e-300) for part in (dear, weight))
    kept = np.zeros_like(usable)
    np.put_along_axis(kept, np.argpartition(far, near, axis=1)[:, :near], True, axis=1)
    np.put_along_axis(kept, np.argpartition(far, near, axis=0)[:near], True, axis=0)
    return kept & usable


def _followed(walks: list[Walks], rows: _Rows, most: float, stop: Stop) -> tuple[Floats, float]:
    """Prices that follow the best walk of each type, and their value."""
    n = len(rows.required)
    heavy = np.ones(n + 1)

    def look(prices: Floats) -> tuple[float, Floats]:
        value, slope = rows.worth(prices)
        price = np.append(0.0, prices)
        best = []
        for w in walks:
            values, before, _ = w.ahead(stop, price, heavy)
            best.append((*w.best(values), before))
        if stop.reached():
            return -math.inf, slope
        for k, w, (least, node, before) in zip(rows.routes([b[0] for b in best]), walks, best, strict=True):
            if k and math.isfinite(least):
                value, slope = value + k * least, slope - k * w.visits(before, node)[1:]
            elif k:
                return -math.inf, slope
        return value, slope

    usable = np.concatenate([w.cost[w.usable] for w in walks])
    dearest = float(np.abs(usable).max(initial=0.0))
    starts = _starts(walks, rows, dearest)
    value, k = max((look(prices)[0], k) for k, prices in enumerate(starts))
    if not math.isfinite(value):
        return starts[0], value
    return ascend(look, starts[k], 1e-3 * dearest or 1.0, most, stop, patience=10)


def _starts(walks: list[Walks], rows: _Rows, dearest: float) -> list[Floats]:
    """First prices: shares of the cheapest moves for required customers; for others the gain of a visit less the worth of the resource
    that it takes at least, as in a knapsack."""
    cost = np.min([np.where(w.usable, w.cost, dearest) for w in walks], axis=0)
    closest = np.maximum(cost[:, 1:].min(axis=0), 0.0)
    gain = np.maximum(0.0, -np.min([np.where(w.usable, w.cost, 0.0)[:, 1:].min(axis=0) for w in walks], axis=0))
    need = np.min([_needs(w) for w in walks], axis=0)
    room = float(sum(c * float(w.top) for c, w in zip(rows.counts, walks, strict=True)))
    order = np.argsort(-gain / np.maximum(need, 1e-9), kind="stable")
    last = order[min(int(np.searchsorted(np.cumsum(need[order]), room)), len(order) - 1)]
    rate = float(gain[last] / max(need[last], 1e-9))
    starts = [np.where(rows.required, closest, -gain)]
    for share in (0.0, 0.6, 1.0, 1.4, 2.0):
        starts.append(np.where(rows.required, share * closest, -np.maximum(0.0, gain - share * rate * need)))
    return starts


def _needs(walks: Walks) -> Floats:
    """Half of the two least weights of moves at each customer, in steps."""
    weight = np.where(walks.usable, walks.resource.weight, math.inf)
    ends = np.concatenate([weight[:, 1:], weight[1:].T])
    two = np.partition(np.minimum(ends[: len(weight)], ends[len(weight) :]), 1, axis=0)[:2]
    needs: Floats = np.where(np.isfinite(two).all(axis=0), two.sum(axis=0), 0.0) / (2.0 * walks.step)
    return needs
