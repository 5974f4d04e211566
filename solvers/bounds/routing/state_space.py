"""Bound ``state-space``: prices of visits for the evidence of the same name, by ascent.

Where few vehicles drive, or several types, or sites may be left out, prices follow the visits of each type's best walk (a subgradient).
Where many vehicles of one type serve all, the best walk through each customer tells what the price of its visit lacks: prices rise, or
fall, by each customer's share of that, and follow the visits of all these walks at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ....formulations.checking.granularity import grain
from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import unknown_features
from ....formulations.routing.checking.stops_on_the_way import without_stops
from ....formulations.routing.checking.vehicle_moves import VehicleMoves, alike, needed_routes, terms_of
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .arcs import LIMITS, lacks_arc_costs, too_many_arcs
from .level_ascent import ascend

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.checking.relaxation import Resource
    from ....formulations.routing.problem import RoutingProblem

Floats = NDArray[np.float64]
Longs = NDArray[np.int64]
Cells = tuple[Floats, NDArray[np.int32], Floats]

STEPS = 10_000
"""Of the counted resource, at most."""

CELLS = 1e6
"""Nodes times levels that they can have, at most."""

WORK_PER_SECOND = 1.5e8
"""Moves times steps that are looked at in a second."""

ROUNDS = 200
"""For which there should be time at first; steps are coarser, and moves fewer, where there is not."""

CHECKED = 3e8
"""Moves times steps that the check may take."""

NEIGHBOURS = 12
"""Moves into a customer, the cheapest ones, that are always looked at."""

MANY_ROUTES = 4
"""From so many on prices are shared out among all walks."""

SHARE = 0.05
"""Of the bound: the length of the first steps."""

TOPS = 8
"""Limits of the resource at which the best walks through a customer are looked for."""

FIRST = 0.6
"""Part of the time for the moves that are looked at first, and coarse steps."""

FINER = 8.0
"""How many times fewer rounds finer steps leave time for."""

LEAST_ROUNDS = 6.0
"""For which there should be time where all moves are looked at."""

DECAY = 0.3
"""Part of their length that steps have when the time ends."""

LEVELS = 6
"""By which walks over a move that is not looked at are told apart."""

PATIENCE = 4
"""Steps without a rise after which they are halved."""

BUDGET = 0.8
"""Part of the time that is left, where other methods come later."""

LEAST_STEPS = 400
"""Where prices follow single walks, of which each has many visits."""


@dataclass(eq=False)
class _Walks:
    """The walks of one type of vehicle on a grid of levels; node 0 is the depot.

    Parameters
    ----------
    cost : array of shape (nodes, nodes)
    resource : Resource
    step : float
    kept : bool array of shape (nodes, nodes)
        Moves between customers that are looked at.
    floor : bool
        Weights lose parts of steps, as for the checker; otherwise, for coarse steps, they are rounded to the nearest.
    """

    cost: Floats
    resource: Resource
    step: float
    kept: NDArray[np.bool_]
    floor: bool = False

    def __post_init__(self) -> None:
        r, nodes = self.resource, len(self.cost)
        reached = np.isfinite(r.lower) & np.isfinite(r.upper)
        self.usable = usable = np.isfinite(self.cost) & reached[:, None] & reached
        weight = np.where(usable, r.weight, 0.0) / self.step
        weight = (np.floor(weight + 1e-9) if self.floor else np.rint(weight)).astype(np.int64)
        weight[1:, 1:] = np.maximum(weight[1:, 1:], 1)
        lower = np.floor(np.where(reached, r.lower - r.start, 0.0) / self.step + 1e-9).astype(np.int64)
        upper = np.floor(np.where(reached, r.upper - r.start, -2.0 * self.step) / self.step + 1e-6).astype(np.int64)
        self.top = int(upper[0])
        upper = np.minimum(upper, self.top)
        self.first, self.last = weight[0].copy(), weight[:, 0].copy()
        self.first_cost, self.last_cost = (np.where(usable[0], self.cost[0], math.inf), np.where(usable[:, 0], self.cost[:, 0], math.inf))
        self.grid, self.back_grid = _grid(lower, upper), _grid(self.top - upper, self.top - lower)
        inner = usable & self.kept & (upper >= lower) & (upper >= lower)[:, None]
        inner[0] = inner[:, 0] = False
        heads, tails = np.nonzero(inner.T)
        back_tails, back_heads = np.nonzero(inner)
        at = np.arange(nodes + 1)
        self.moves = np.searchsorted(heads, at), np.ascontiguousarray(tails), weight[tails, heads]
        self.back_moves = np.searchsorted(back_tails, at), np.ascontiguousarray(back_heads), weight[back_tails, back_heads]
        self.heads, self.ahead_cost, self.back_cost = heads, self.cost[tails, heads], self.cost[back_tails, back_heads]
        self.lower, self.ends = lower, np.minimum(upper, self.top - self.last)
        self.room = np.zeros(2 * self.top + 4, np.int64)

    def ahead(self, stop: Stop, price: Floats, heavy: Floats) -> Cells:
        from .state_space_kernels import walk_costs

        cost = self.ahead_cost - price[self.heads]
        return walk_costs(stop.flag, *self.moves, cost, self.first_cost - price, self.first, *self.grid, heavy)  # type: ignore[no-any-return]

    def back(self, stop: Stop, price: Floats, heavy: Floats) -> Cells:
        from .state_space_kernels import walk_costs

        cost = self.back_cost - price[self.back_moves[1]]
        return walk_costs(  # type: ignore[no-any-return]
            stop.flag, *self.back_moves, cost, self.last_cost, self.last, *self.back_grid, heavy
        )

    def best(self, values: Floats) -> tuple[float, int]:
        """Least cost of a walk, and the last node of it."""
        good = np.nonzero(self.ends >= self.lower)[0]
        good = good[good > 0]
        if not len(good):
            return math.inf, 0
        ends = values[self.grid[0][good] + self.ends[good] - self.lower[good], 0] + self.last_cost[good]
        at = int(np.argmin(ends))
        return float(ends[at]), int(good[at])

    def visits(self, before: NDArray[np.int32], node: int) -> Floats:
        """How often the best walk that ends at ``node`` visits each node."""
        from .state_space_kernels import walk_to

        count = walk_to(before, *self.moves, *self.grid, node, int(self.ends[node]), 0, self.room)
        return np.bincount(self.room[:count], minlength=len(self.cost)).astype(np.float64)

    def through(self, price: Floats, ahead: Floats, back: Floats) -> Floats:
        """At most what the best walk over each move costs, shape (nodes, nodes), from the best walks on the moves that are looked at."""
        made = np.full(self.cost.shape, math.inf)
        levels = np.linspace(0, self.top, LEVELS + 1).astype(np.int64)
        for low, high in zip(levels[:-1].tolist(), levels[1:].tolist(), strict=True):
            come, go = _at(ahead, self.grid, high), _at(back, self.back_grid, self.top - low)
            np.minimum(made, come[:, None] + go, out=made)
        return made + (self.cost - price)


def _at(values: Floats, grid: tuple[Longs, Longs, Longs], level: int) -> Floats:
    """Least cost at a level or below it, by node."""
    base, lower, upper = grid
    cell = base[:-1] + np.minimum(level, upper) - lower
    some = (upper >= lower) & (level >= lower)
    return np.where(some, values[np.where(some, cell, 0), 0], math.inf) if len(values) else np.full(len(lower), math.inf)


def _grid(lower: Longs, upper: Longs) -> tuple[Longs, Longs, Longs]:
    """Where the cells of each node begin, and their levels; the depot has none."""
    count = np.maximum(0, upper - lower + 1)
    count[0] = 0
    return np.append(0, np.cumsum(count)), lower, np.where(count > 0, upper, lower - 1)


@dataclass(eq=False)
class _Rows:
    """What prices of visits are worth, and how many routes there are."""

    required: NDArray[np.bool_]
    groups: list[tuple[NDArray[np.int64], bool]]
    counts: list[int]
    fewest: int

    def worth(self, prices: Floats) -> tuple[float, Floats]:
        """Value and slope."""
        slope = (self.required | (prices < 0)).astype(np.float64)
        for members, must in self.groups:
            least = members[int(np.argmin(prices[members]))]
            slope[members] = 0.0
            slope[least] = float(must or prices[least] < 0)
        return float(slope @ prices), slope

    def routes(self, least: list[float]) -> list[int]:
        """How many routes of each type are the cheapest."""
        made, left = [0] * len(least), len(self.required)
        for k in sorted(range(len(least)), key=least.__getitem__):
            used = sum(made)
            made[k] = min(self.counts[k], left - used if least[k] < 0 else max(0, self.fewest - used))
        return made


def state_space_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the best prices that an ascent finds.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        Less is used where the ascent stalls, or other methods come later.
    linear : unused
        No program is solved.

    Notes
    -----
    Source: Christofides, Mingozzi, Toth (1981); sharing by walks through each customer: Baldacci, Christofides, Mingozzi (2008).
    """
    if too_many_arcs(problem, stop.seconds_left):
        return None
    if not lacks_arc_costs(problem):
        if not problem.features() & LIMITS:  # trees and assignments see more
            return None
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
    step = max(_step(m, name, k, work, least) for m, k in zip(moves, kept, strict=True))
    fine = max(_step(m, name, np.isfinite(m.cost), CHECKED / len(moves), least) for m in moves)
    walks = [_Walks(m.cost, m.resources[name], step, k) for m, k in zip(moves, kept, strict=True)]
    most = 2.0 * (len(customers) + 1) * max(float(np.abs(m.cost[np.isfinite(m.cost)]).max(initial=0.0)) for m in moves)
    if many:
        prices, value = _shared_out(moves[0], name, walks[0], rows, _weights(relaxed), most, stop, fine)
    else:
        prices, value = _followed(walks, rows, most, stop)
    if value > most:  # than any answer costs: there is none, which others prove
        return None
    listed = np.zeros(len(sites))
    listed[customers] = prices
    return Evidence(
        "state-space", f"state-space relaxation over {name}", sign * value, {"prices": listed.tolist(), "resource": name, "step": fine}
    )


def _weights(problem: RoutingProblem) -> Floats:
    demand = problem.sites.demand[problem.customers]
    mean = float(demand.mean())
    return demand + 0.2 * mean if mean > 0 else np.ones(len(demand))


def _resource(problem: RoutingProblem, moves: list[VehicleMoves]) -> str:
    """The resource of which an answer needs the largest part of what all routes have."""
    found: dict[str, float] = {}
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
        found[name] = need * (1e-6 if name == "order" else 1.0)  # where nothing else is limited
    return max(found, key=found.__getitem__)


def _width(resource: Resource) -> float:
    """Mean part of the room of a resource that the levels of a customer span."""
    span, room = (resource.upper - resource.lower)[1:], float(resource.upper[0]) - resource.start
    span = span[np.isfinite(span)]
    return float(np.clip(span / room, 0.0, 1.0).mean()) if len(span) and room > 0 else 1.0


def _step(moves: VehicleMoves, name: str, kept: NDArray[np.bool_], work: float, least: int) -> float:
    """A step of which weights and limits are multiples, if the work that it takes allows; a coarser one if not."""
    resource = moves.resources[name]
    room = float(resource.upper[0]) - resource.start
    if not room > 0:
        return 1.0
    span = np.where(np.isfinite(resource.lower) & np.isfinite(resource.upper), resource.upper - resource.lower, 0.0)
    span = np.clip(span, 0.0, room)
    arcs = kept[1:, 1:].sum(axis=0)
    steps = room * min(work / max(1e-300, float(span[1:] @ arcs)), CELLS / max(1e-300, float(span.sum())))
    most = float(np.clip(steps, least, STEPS))
    finite = resource.weight[np.isfinite(resource.weight)]
    unit = grain(finite[:4000])
    size = 0.0 if unit is None else unit.size
    return size if size and room / size <= most else room / most


def _kept(moves: VehicleMoves, name: str, work: float) -> NDArray[np.bool_]:
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


def _followed(walks: list[_Walks], rows: _Rows, most: float, stop: Stop) -> tuple[Floats, float]:
    """Prices that follow the best walk of each type."""
    n = len(rows.required)
    heavy = np.ones(n + 1)

    def look(prices: Floats) -> tuple[float, Floats]:
        value, slope = rows.worth(prices)
        price = np.append(0.0, prices)
        found = []
        for w in walks:
            values, before, _ = w.ahead(stop, price, heavy)
            found.append((*w.best(values), before))
        if stop.reached():
            return -math.inf, slope
        for k, w, (least, node, before) in zip(rows.routes([f[0] for f in found]), walks, found, strict=True):
            if k and math.isfinite(least):
                value, slope = value + k * least, slope - k * w.visits(before, node)[1:]
            elif k:
                return -math.inf, slope
        return value, slope

    usable = np.concatenate([w.cost[w.usable] for w in walks])
    dearest = float(np.abs(usable).max(initial=0.0))
    starts = _starts(walks, rows, dearest)
    begun = [(look(prices)[0], k) for k, prices in enumerate(starts)]
    value, k = max(begun)
    if not math.isfinite(value):
        return starts[0], value
    return ascend(look, starts[k], 1e-3 * dearest or 1.0, most, stop, patience=10)


def _starts(walks: list[_Walks], rows: _Rows, dearest: float) -> list[Floats]:
    """Prices to begin with: shares of the cheapest moves for required customers; for the others what a visit gains less the worth of the
    resource that it takes at least, as in a knapsack."""
    cost = np.min([np.where(w.usable, w.cost, dearest) for w in walks], axis=0)
    closest = np.maximum(cost[:, 1:].min(axis=0), 0.0)
    gain = np.maximum(0.0, -np.min([np.where(w.usable, w.cost, 0.0)[:, 1:].min(axis=0) for w in walks], axis=0))
    need = np.min([_needs(w) for w in walks], axis=0)
    room = float(sum(c * float(w.top) for c, w in zip(rows.counts, walks, strict=True)))
    order = np.argsort(-gain / np.maximum(need, 1e-9), kind="stable")
    last = order[min(int(np.searchsorted(np.cumsum(need[order]), room)), len(order) - 1)]
    rate = float(gain[last] / max(need[last], 1e-9))
    made = [np.where(rows.required, share * closest, -np.maximum(0.0, gain - share * rate * need)) for share in (0.0, 0.6, 1.0, 1.4, 2.0)]
    return [np.where(rows.required, closest, -gain), *made]


def _needs(walks: _Walks) -> Floats:
    """Half of the two least weights of moves at each customer, in steps."""
    weight = np.where(walks.usable, walks.resource.weight, math.inf)
    ends = np.concatenate([weight[:, 1:], weight[1:].T])
    two = np.partition(np.minimum(ends[: len(weight)], ends[len(weight) :]), 1, axis=0)[:2]
    made: Floats = np.where(np.isfinite(two).all(axis=0), two.sum(axis=0), 0.0) / (2.0 * walks.step)
    return made


def _shared_out(
    moves: VehicleMoves, name: str, walks: _Walks, rows: _Rows, weights: Floats, most: float, stop: Stop, fine: float
) -> tuple[Floats, float]:
    """Prices on the moves that are looked at, then with those besides by which a walk may cost less than its visits are worth."""
    heavy = np.append(0.0, weights)
    price = _begun(walks, heavy, stop)
    share, part, rounds = SHARE, FIRST, ROUNDS
    best: _Ascent | None = None
    while True:
        inner = stop.within(part * stop.seconds_left)
        found = _shared(walks, rows, heavy, most, inner, price, share)
        best = found or best
        if best is None:
            return price[1:], -math.inf
        price = best.price
        if stop.reached() or found is None or best.value > most:
            return best.surely(rows.counts[0])
        rounds = max(LEAST_ROUNDS, rounds / FINER)
        work = WORK_PER_SECOND * min(stop.seconds_left, 10.0)
        whole = _step(moves, name, walks.usable, work / LEAST_ROUNDS, 20) <= max(fine, walks.step)
        kept = walks.usable if whole else walks.kept | best.worst(NEIGHBOURS * len(heavy))
        step = max(fine, min(walks.step, _step(moves, name, kept, work / rounds, 20)))
        if walks.floor and step == walks.step and not inner.reached() and (kept == walks.kept).all():
            return best.surely(rows.counts[0])
        walks, share, part = _Walks(walks.cost, walks.resource, step, kept, floor=True), 0.0, 1.0 if whole else 0.5


@dataclass(frozen=True, eq=False)
class _Ascent:
    """Where an ascent ended.

    Attributes
    ----------
    price : array of shape (nodes,)
    value : float
    lacking : array of shape (nodes, nodes)
        What walks over moves that were not looked at may cost less than their visits are worth; 0 for the others.
    routes : float
        How many walks share the visits.
    """

    price: Floats
    value: float
    lacking: Floats
    routes: float

    def worst(self, count: int) -> NDArray[np.bool_]:
        """The moves that lack most, so many at most."""
        count = min(count, int((self.lacking < 0.0).sum()))
        if not count:
            return np.zeros(self.lacking.shape, dtype=bool)
        made: NDArray[np.bool_] = self.lacking <= min(0.0, float(np.partition(self.lacking.ravel(), count - 1)[count - 1]))
        return made

    def surely(self, most: int) -> tuple[Floats, float]:
        """Prices of customers, lowered for moves that were not looked at where that costs less than as many routes as there may be."""
        least = float(self.lacking.min())
        lower = _lowered(self.price, self.routes, least)
        if float(lower.sum()) > self.value + most * least:
            return lower[1:], float(lower.sum())
        return self.price[1:], self.value


def _shared(walks: _Walks, rows: _Rows, heavy: Floats, most: float, stop: Stop, price: Floats, share: float) -> _Ascent | None:
    """Prices that follow the best walks through all customers, from ``price`` on, by steps of a ``share`` of the bound to begin with; None
    where there is no time for any."""
    from .state_space_kernels import best_through, share_out

    n = len(rows.required)
    best, best_price = -math.inf, price
    rate, how = np.full(n + 1, math.inf), np.zeros((n + 1, 4), np.int64)
    waited, whole, routes = 0, stop.seconds_left, float(rows.fewest)
    average = np.zeros(n + 1)
    tops = np.unique(np.linspace(0, walks.top, TOPS + 1)[1:].astype(np.int64))
    while not stop.reached() and best <= most:
        ahead, before, load = walks.ahead(stop, price, heavy)
        back, after, rest = walks.back(stop, price, heavy)
        if stop.reached():
            break
        least, _ = walks.best(ahead)
        worth = float(price.sum())
        value, lower = worth + (rows.fewest if least > 0 else rows.counts[0]) * least, _lowered(price, routes, least)
        if float(lower.sum()) > value:
            value = float(lower.sum())
        else:
            lower = price
        if value > best:
            waited = 0 if value > best + 1e-4 * abs(best) else waited + 1
            best, best_price, best_cells = value, lower, (ahead, back)
        else:
            waited += 1
        best_through(ahead, before, load, *walks.grid, back, after, rest, *walks.back_grid, heavy, tops, rate, how)
        visits = np.zeros(n + 1)
        routes = share_out(
            before, *walks.moves, *walks.grid, after, *walks.back_moves, *walks.back_grid, rate, how, heavy, walks.room, visits
        )
        slope = 1.0 - visits
        slope[0] = 0.0
        average = 0.5 * average + slope
        length = float(average @ average)
        if waited > PATIENCE:
            if share == 0.0:
                break
            share, waited = share / 2.0, 0
            if share < 1e-4:
                share, price = 0.0, best_price
                continue
        price = price + heavy * np.where(np.isfinite(rate), rate, 0.0)
        now = share * DECAY ** (1.0 - stop.seconds_left / whole) if whole < math.inf else share
        if length > 0:
            price = price + now * abs(float(price.sum())) / length * average
    if best == -math.inf:
        return None
    lacking = np.where(walks.usable & ~walks.kept, np.minimum(0.0, walks.through(best_price, *best_cells)), 0.0)
    return _Ascent(best_price, best, lacking, routes)


def _lowered(price: Floats, routes: float, least: float) -> Floats:
    """Prices in parts of which no walk is worth more than it costs, if some cost ``least`` less now, and are worth as much as all."""
    worth = float(price.sum())
    return price * max(0.0, 1.0 + min(0.0, least) * routes / worth) if worth > 0 else price


def _begun(walks: _Walks, heavy: Floats, stop: Stop) -> Floats:
    """To each customer his share of a walk through him that is as full as can be: prices that no walk beats."""
    free = np.zeros(len(heavy))
    ahead, back = walks.ahead(stop, free, heavy)[0], walks.back(stop, free, heavy)[0]
    least = _at(ahead, walks.grid, walks.top) + _at(back, walks.back_grid, walks.top)
    full = max(float(heavy.max()), walks.top * float(heavy[1:].sum()) / max(1.0, float(np.minimum(walks.first[1:], walks.top).sum())))
    return np.where(np.isfinite(least), least, 0.0) * heavy / full


def _lacks(problem: Problem) -> frozenset[str]:
    """Other families, objectives in which more of a cost is better, and features that nothing is known of."""
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    unknown = unknown_features(without_stops(problem))  # type: ignore[arg-type]
    if not len(problem.customers):  # type: ignore[attr-defined]
        unknown = unknown | {"no customers"}
    return unknown if terms_of(problem) is not None else unknown | {"objective:weights"}  # type: ignore[arg-type]


def _prepare() -> None:
    from . import state_space_kernels as state_space_kernels  # compiles, or loads what was compiled before


BOUNDS.add("state-space", BoundMethod("state-space", _lacks, state_space_bound, order=1, prepare=_prepare))
