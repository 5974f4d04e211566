"""Column generation: the linear program that chooses routes for one node of a tree, its cuts, and the routes that it still lacks.

Routes of negative reduced cost are found by labels, and added until there are none (Desrochers, Desrosiers, Solomon 1992), at prices that
``stabilisation`` chooses. Where a solution visits a customer twice on one route, he is remembered
in between (Roberti, Mingozzi 2014).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from .arcs import Flags, Floats, Integers
from .load_cuts import LoadCut, overloaded
from .memory_shares import MemoryShares
from .move_rows import MoveRow
from .pricing import Pricer
from .restricted_master import Cut, Drive, Master, Point, Pool, Prices, coefficients
from .route_levels import DONE, EXACT, SINGLE, STOPPED
from .set_partition import SetPartition
from .stabilisation import BOXED, KINDS, Smoothing, Stabilisation, stabilised
from .subset_rows import SubsetRow, violated
from .window_cuts import WindowCuts

LABELS = 2_000_000
"""Most labels from one end in one search for routes, of all types of vehicle together, some 120 bytes each."""

FOUND, COLUMNS, EACH = 300, 50, 5
"""Most routes that are looked at and added at once, and those of one customer among them."""

MOST_COLUMNS = 100_000
"""Most routes in all; then the tree is handed over as it is."""

MEMORY, MOST_MEMORY = 8, 20
"""Neighbours that are remembered at a customer to begin with, and in the end."""

FEW, CROWDED = 1000, 4000
"""With more routes those that cost too much are dropped between two solutions, and with so many more all but the cheapest half of that
number while others are still looked for."""

SMALLEST_BOX = 1e-3
"""Part of the largest cost of a move that prices of visits count as on the mean at least, where they are boxed."""

SLACK = 0.05
"""Cuts further from being met are dropped."""

LATE = 0.4
"""Share of the time with which, without a bound so far, searches are no longer quick ones."""

QUICK = 5
"""Quick searches for routes with which a branching is tried."""

REDUCED = 1e-7
"""Part of the largest cost of a move by which a reduced cost must be below 0 to count."""

WHOLE = 1e-6
"""Distance to a whole number up to which a value counts as one."""


@dataclass(frozen=True, eq=False)
class Part:
    """Costs of the moves that a node of a tree allows, shape (types, nodes, nodes), its limits on the number of routes, the visits, shape
    (1 + rows,), that may be ``left_out``, and ``rows`` of moves of which some are made."""

    cost: Floats
    fewest: int
    most: int
    left_out: Flags
    rows: Sequence[MoveRow] = ()


@dataclass(eq=False)
class Solved:
    """The end of column generation, its ``status``: ``done``, ``enough`` (the prices prove enough), ``stopped``, ``full`` of routes, or
    ``flooded`` by labels.

    ``bound`` and ``prices`` are the best Lagrangian bound by the labels here, ``least`` the least reduced cost of each type there;
    ``routes`` are those that the linear program uses, and ``values`` how much of each; ``lacking`` is how many visits no route makes, and
    ``near``, shape (nodes, nodes), who was remembered where.
    """

    status: str
    bound: float = -math.inf
    prices: Prices | None = None
    least: Floats = field(default_factory=lambda: np.zeros(0))
    routes: Pool = field(default_factory=Pool)
    values: Floats = field(default_factory=lambda: np.zeros(0))
    lacking: float = 0.0
    near: Flags = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))


class ColumnGeneration:
    """The routes at hand, the cuts, and the linear program over them, for all nodes of one tree.

    Costs of the ``partition`` are counted in ``unit`` of them from here on, so that they are about a thousand, as tolerances of linear
    programs ask for. ``enough`` says whether a bound, in ``unit``, is all that is asked for; ``most`` has ``columns``, ``labels``,
    ``memory``, ``memory_limit`` and ``stabilisation`` other than the usual ones.
    """

    def __init__(
        self, problem: RoutingProblem, partition: SetPartition, stop: Stop, enough: Callable[[float], bool], seed: int,
        most: Mapping[str, Any] | None = None,
    ) -> None:  # fmt: skip
        most = most or {}
        self.problem, self.stop, self.enough, self.seed = problem, stop, enough, seed
        self.most_columns = most.get("columns", MOST_COLUMNS)
        cost = partition.cost
        self.usable = np.isfinite(cost)
        self.unit = 2.0 ** (math.frexp(float(np.abs(cost[self.usable]).max(initial=1e-300)))[1] - 10)
        self.partition, self.cost, self.constant = partition, cost / self.unit, partition.constant / self.unit
        self.dearest = float(np.abs(self.cost[self.usable]).max(initial=0.0))
        self.step = REDUCED * self.dearest
        far = problem.travel.distances[np.ix_(partition.customers, partition.customers)]
        self.far, self.memory, self.most_memory = np.minimum(far, far.T), most.get("memory", MEMORY), MOST_MEMORY
        self.near = self._nearest(self.memory)
        self.shares = MemoryShares.of(most.get("memory_limit"), len(partition.row), len(partition.types))
        room, share = max(2, most.get("labels", LABELS) // len(partition.types)), self.shares.labels / len(partition.types)
        pairs, way = zip(partition.types, self.usable, strict=True), np.pad(self.far, (1, 0))
        self.pricers = [Pricer(one.levels, usable, way, self.dearest, room, share) for one, usable in pairs]
        self.counts = np.array([one.most for one in partition.types])
        self.row_cuts: Sequence[SubsetRow] = ()
        self.pool, self.cuts, self.loads = Pool(), dict[tuple[int, ...], SubsetRow](), set[bytes]()
        level = partition.types[0].levels[0]
        self.windows = WindowCuts(level, self.usable[0]) if level.due and partition.merged and not partition.symmetric else None
        self.finite = np.where(self.usable, self.cost, self.dearest)
        _, self.one_each = np.unique(partition.row, return_index=True)  # a node of each row
        self.dear = 1.0
        there_and_back = np.abs(self.finite[:, 0, :]).max(axis=0) + np.abs(self.finite[:, :, 0]).max(axis=0)
        self.there_and_back = Prices(np.zeros(len(self.counts)), there_and_back, {})
        self.stabilisation = most.get("stabilisation", KINDS[0])
        self.master = self._new_master([])
        self.phase_one: Master | None = None
        self.point = Point("unknown")  # where the linear program stood last
        self.limit = ""  # that ended a search last: time or memory
        self.newest: Sequence[SubsetRow] = ()
        self.given_up = 0  # times that the relaxation was made weaker

    @property
    def labels(self) -> int:
        """Labels so far."""
        return sum(pricer.labels for pricer in self.pricers)

    def _nearest(self, memory: int) -> Flags:
        """The customers who are remembered at each node to begin with, each at his own too."""
        inner = np.logical_or.reduce(self.usable)[1:, 1:]
        far = np.where(inner | inner.T, self.far, math.inf)
        np.fill_diagonal(far, -math.inf)
        near = np.zeros(self.usable.shape[1:], dtype=bool)
        np.put_along_axis(near[1:, 1:], np.argsort(far, axis=1, kind="stable")[:, : memory + 1], True, axis=1)
        return near

    def _new_master(self, cuts: Sequence[Cut]) -> Master:
        lacking = self.dear * np.append(self.dearest, self.there_and_back.visits[self.one_each[1:]])
        return self._master(self.finite, np.maximum(lacking, 1e-3 * self.dear * self.dearest), cuts)

    def _master(self, cost: Floats, lacking: Floats, cuts: Sequence[Cut] = ()) -> Master:
        boxed = self.stabilisation == BOXED
        return Master(self.pool, cost, self.partition.row, lacking, self.counts.tolist(), self.seed, cuts, boxed=boxed)

    def add(self, answer: Routes) -> None:
        """Take the routes of an answer."""
        node = {site: node for node, site in enumerate(self.partition.customers.tolist(), start=1)}
        kind = {vehicle: k for k, one in enumerate(self.partition.types) for vehicle, _ in one.vehicles}
        walks = [(kind[route.vehicle], np.array([node[site] for site in route.visits], dtype=np.int64)) for route in answer if route.visits]
        self.pool.add(self.pool.new([self._turned(*walk) for walk in walks]))

    def _turned(self, kind: int, route: Integers) -> Drive:
        """A route, or, where it may be driven in either direction, always in the same one."""
        turned = self.partition.symmetric and route[0] > route[-1] and len(np.unique(route)) == len(route)
        return kind, route[::-1].copy() if turned else route

    # -- the linear program of a node --------------------------------------------------------------------------------

    def solve(self, part: Part, centre: Prices | None, on_done: Callable[[Solved], None] = lambda solved: None) -> Solved:
        """The linear program of a node, which begins at the prices ``centre``, with all routes and memories that it takes; where no routes
        make up a solution, prices that prove it, and an infinite bound. ``on_done`` hears of each solution before more are remembered."""
        best = Solved("stopped")
        while True:
            solved = self._generated(self.master, part, centre)
            solved.near = self.near.copy()
            if solved.status == "flooded" and best.prices is not None:  # too many are remembered
                self.near, self.most_memory = best.near.copy(), 0
                self.given_up += 1
            if solved.status != "done":
                return solved if solved.status == "enough" or best.prices is None else best
            if solved.lacking > WHOLE:
                zero = np.where(np.isfinite(part.cost), 0.0, math.inf)
                if self.phase_one is None:
                    self.phase_one = self._master(np.zeros(self.usable.shape), np.ones(1 + int(self.partition.row.max())))
                ray = self._generated(self.phase_one, replace(part, cost=zero), None)
                if ray.bound > WHOLE:
                    return Solved("enough", math.inf, ray.prices, near=solved.near)
                if ray.status == "stopped":
                    return best
                if ray.status in ("full", "flooded") or self.dear > 1e6:
                    return solved
                self.dear *= 10.0
                self.master = self._new_master([cut for cut in self.master.cuts if not isinstance(cut, MoveRow)])
                continue
            best = solved if solved.bound >= best.bound else best
            on_done(solved)
            if not self._remember(solved):
                return solved
            centre = solved.prices

    def _remember(self, solved: Solved) -> bool:
        """Have customers remembered on routes that visit them twice; whether there were any."""
        grown = False
        for k in np.nonzero(solved.routes.twice)[0].tolist():
            route, last = solved.routes.routes[k].tolist(), dict[int, int]()
            for place, node in enumerate(route):
                between = route[last[node] + 1 : place] if node in last else []
                if between and all(self.near[other, node] or self.near[other].sum() <= self.most_memory for other in between):
                    self.near[between, node] = grown = True
                last[node] = place
        return grown

    def _generated(self, master: Master, part: Part, centre: Prices | None) -> Solved:
        """Add routes until there are none of negative reduced cost, or enough is proved."""
        self._restrict(master, part)
        self._restrict_pricers(master, part)
        best, how, began = Solved("stopped"), SINGLE, self.stop.seconds_left
        step, near = (self.step, self._near(centre)) if master is self.master else (REDUCED, Smoothing())
        while True:
            if best.prices is None and self.stop.seconds_left < LATE * began:
                how = EXACT  # while there is time for a bound
            if math.isfinite(near.radius) and near.centre is not None:
                master.box(near.centre, near.radius)
            point = master.solve(self.stop)
            if point.status != "optimal" or len(self.pool) > self.most_columns or self.pool.bytes > self.shares.routes:
                return self._ended(best, "stopped" if self.stop.reached() else "full")
            prices = point.prices
            assert prices is not None
            if master is self.master:
                self.point = point
                if len(self.pool) > CROWDED or self.pool.bytes > self.shares.routes / 2:
                    half = min(CROWDED, len(self.pool)) // 2
                    self._keep(float(np.partition(point.reduced, half)[half]))
                    point = self.point
            fresh: list[Drive] = []
            constant = self.constant if master is self.master else 0.0
            for at in near.places(prices, master.cuts):
                status, least, routes = self._priced(part, at, how, step)
                if status != 0:
                    return self._ended(best, "stopped" if status == STOPPED else "flooded")
                bound = self._lagrangian(at, least, part, constant)
                near.told(at, bound, point.value + constant, how)
                if how == EXACT:
                    if best.prices is None or bound > best.bound:
                        best.bound, best.prices, best.least = bound, at, least
                    if best.bound > WHOLE if master is not self.master else self.enough(best.bound):
                        best.status = "enough"
                        return best
                fresh = self._chosen(part, prices, routes, step)
                if fresh:
                    break
            if fresh:
                self.pool.add(fresh)
                master.refresh()
                how = SINGLE if how != EXACT else how
            elif point.held > WHOLE:
                near.held(prices)
            elif how != EXACT:
                how = how - 1 if how > EXACT else EXACT
            else:
                used = np.nonzero(point.values > WHOLE)[0]
                best.routes.add(self.pool.drives(used))
                best.status, best.values, best.lacking = "done", point.values[used], point.lacking
                return best

    def _near(self, centre: Prices | None) -> Stabilisation:
        """A stabilisation that begins at ``centre``; the box by default at the last prices, or at first at those of round trips."""
        if self.stabilisation == BOXED:
            centre = centre or self.point.prices or self.there_and_back
        size = 0.0 if centre is None else float(np.abs(centre.visits).mean())
        near = stabilised(self.stabilisation, max(size, SMALLEST_BOX * self.dearest) or 1.0)
        near.begin(centre)
        return near

    def _ended(self, best: Solved, status: str) -> Solved:
        """The best that was found before a limit."""
        best.status, self.limit = status, "time" if status == "stopped" else "memory"
        return best

    def _restrict_pricers(self, master: Master, part: Part) -> None:
        self.row_cuts = [cut for cut in master.cuts if isinstance(cut, SubsetRow)]
        for pricer, cost in zip(self.pricers, part.cost, strict=True):
            pricer.restrict(np.isfinite(cost), self.near, self.row_cuts)

    def _priced(self, part: Part, at: Prices, how: int, step: float) -> tuple[int, Floats, list[Drive]]:
        """Status, least reduced costs, and routes of all types."""
        reduced, fines = self.reduced_costs(part, at), at.of(self.row_cuts)
        least, drives = np.full(len(reduced), math.inf), list[Drive]()
        for kind, (pricer, costs, price) in enumerate(zip(self.pricers, reduced, at.routes.tolist(), strict=True)):
            # Each route pays for being one of so many.
            status, least[kind], _, routes = pricer.search(self.stop, costs, fines, how, FOUND, price - step)
            if status != 0:
                return status, least, []
            drives += [self._turned(kind, route) for route in routes]
        return 0, least, drives

    def reduced_costs(self, part: Part, at: Prices) -> Floats:
        """Reduced costs of moves, but for the prices of subset rows."""
        reduced = part.cost.copy()
        reduced[:, :, 1:] -= at.visits[1:]
        for cut, price in at.cuts.items():
            if isinstance(cut, LoadCut | MoveRow):
                reduced[:, cut.moves] -= price
        return reduced

    def _chosen(self, part: Part, prices: Prices, drives: Sequence[Drive], step: float) -> list[Drive]:
        """New routes of negative reduced cost, the cheapest first, of each customer a few."""
        fresh = self.pool.new(drives)
        if not fresh:
            return []
        some = Pool()
        some.add(fresh)
        cost = some.sums(self.reduced_costs(part, prices)) - prices.routes[some.kind]
        cost -= coefficients(self.row_cuts, some, 0) @ prices.of(self.row_cuts)
        chosen, counts = list[Drive](), np.zeros(part.cost.shape[1], np.int64)
        for k in np.argsort(cost, kind="stable").tolist():
            if cost[k] > -step or len(chosen) == COLUMNS:
                break
            route = fresh[k][1]
            if counts[route].min() < EACH:
                counts[route] += 1
                chosen.append(fresh[k])
        return chosen

    def _lagrangian(self, at: Prices, least: Floats, part: Part, constant: float) -> float:
        visits = at.visits[self.one_each]
        visits = np.where(part.left_out, np.minimum(visits, 0.0), visits)
        cuts = (price * cut.right for cut, price in at.cuts.items())
        return math.fsum([constant, *visits[1:], *cuts]) + self._of_fleet(least, part)

    def _of_fleet(self, least: Floats, part: Part) -> float:
        """The least sum of as many of the least reduced costs as there may be routes."""
        total, count = 0.0, 0
        for kind in np.argsort(least, kind="stable").tolist():
            room = part.most if least[kind] < 0.0 else part.fewest
            taken = max(0, min(int(self.counts[kind]), room - count))
            total, count = total + (taken * float(least[kind]) if taken else 0.0), count + taken
        return total if count >= part.fewest else math.inf

    def _restrict(self, master: Master, part: Part) -> None:
        """Have a master program choose among the routes that a node allows."""
        shut = self.pool.sums(np.where(np.isfinite(part.cost), 0.0, 1.0)) > 0
        master.refresh()
        twice = np.nonzero(self.pool.twice & ~shut)[0]
        shut[twice] = [_comes_back(self.pool.routes[k], self.near) for k in twice.tolist()]
        master.restrict(shut, part.fewest, part.most, part.left_out)
        master.hold(part.rows)

    # -- between two solutions ---------------------------------------------------------------------------------------

    def cut(self, solved: Solved, *, rows: bool) -> bool:
        """Add cuts that the solution violates, subset rows too or capacities alone, and drop those that it is far from; whether there were
        any."""
        some, values = solved.routes, solved.values
        sums = values @ coefficients(self.master.cuts, some, 0)
        far = [cut for cut, total in zip(self.master.cuts, sums.tolist(), strict=True) if abs(total - cut.right) > SLACK]
        idle = [cut for cut in far if not isinstance(cut, MoveRow)]
        flow = some.flow(values, self.usable.shape).sum(axis=0)
        cuts: list[Cut] = list(overloaded(self.problem, flow, self.loads, self.stop))
        if self.windows is not None:
            cuts += self.windows.violated(flow, self.loads, self.stop)
        triples = violated(some, values, len(self.near), self.cuts) if rows and not self.given_up else []
        replaced = [self.cuts[cut.customers] for cut in triples if cut.customers in self.cuts]
        self._drop(list({id(cut): cut for cut in [*idle, *replaced]}.values()))
        self.cuts.update((cut.customers, cut) for cut in triples)
        self.master.cut([*cuts, *triples])
        self.newest = triples
        return bool(cuts or triples)

    def weaken(self) -> bool:
        """Make the relaxation weaker, after a search that had too many labels.

        The newest subset rows are dropped, the next time all that are left, and from then on each time half of the neighbours who remember
        a customer. None of it comes back. False where nothing was left to give up.
        """
        rows = self.newest or [cut for cut in self.master.cuts if isinstance(cut, SubsetRow)]
        if rows:
            self._drop(rows)
        elif self.memory > 1:
            self.memory //= 2
            self.near, self.most_memory = self._nearest(self.memory), 0
        else:
            return False
        self.newest, self.phase_one = (), None
        self.given_up += 1
        return True

    def _drop(self, cuts: Sequence[Cut]) -> None:
        self.master.drop(cuts)
        for cut in cuts:
            if isinstance(cut, LoadCut):
                self.loads.discard(cut.inside.tobytes())
            elif isinstance(cut, SubsetRow):
                self.cuts.pop(cut.customers, None)

    def purge(self, gap: float) -> None:
        """Drop routes that no answer drives whose value is less than ``gap`` above the bound, where they are many."""
        if len(self.pool) > FEW and math.isfinite(gap):
            self._keep(max(gap + self.step, 0.0), unless=0.8)

    def _keep(self, most: float, unless: float = 1.0) -> None:
        """Drop routes that are not used and whose reduced cost is above ``most``, unless that leaves so large a part of all."""
        kept = np.ones(len(self.pool), dtype=bool)  # of routes that are newer nothing is known
        known = kept[: len(self.point.reduced)]
        known[:] = (self.point.reduced <= most) | (self.point.values > 0.0)
        if kept.mean() >= unless:
            return
        self.point = replace(self.point, values=self.point.values[known], reduced=self.point.reduced[known])
        self.master.keep(kept)
        self.phase_one = None

    def hopeless(self, part: Part, solved: Solved, gap: float) -> Flags | None:
        """Moves that no route makes whose reduced cost is less than ``gap`` above the least of its type, shape (nodes, nodes); None where
        there was no time or no room."""
        assert solved.prices is not None
        reduced, fines = self.reduced_costs(part, solved.prices), solved.prices.of(self.row_cuts)
        usable = np.isfinite(part.cost)
        needed = np.zeros(usable.shape[1:], dtype=bool)
        for kind, (pricer, costs, least) in enumerate(zip(self.pricers, reduced, solved.least.tolist(), strict=True)):
            if not math.isfinite(least):  # no route at all
                continue
            over = pricer.arc_costs(self.stop, costs, fines, least + gap + self.step)
            if over is None:
                return None
            needed |= usable[kind] & (over < least + gap + self.step - 1e-9 * self.dearest)
        hopeless = usable.any(axis=0) & ~needed
        np.fill_diagonal(hopeless, False)
        return hopeless

    def value(self, part: Part, *, priced: bool = False) -> float:
        """The value of the linear program of a node over the routes at hand, or (``priced``) with those that quick searches find; no number
        where it has none."""
        self._restrict(self.master, part)
        point = self.master.solve(self.stop)
        if priced:
            self._restrict_pricers(self.master, part)
        for _ in range(QUICK if priced else 0):
            if point.prices is None:
                break
            status, _, routes = self._priced(part, point.prices, SINGLE, self.step)
            fresh = self._chosen(part, point.prices, routes, self.step) if status == DONE else []
            if not fresh:
                break
            self.pool.add(fresh)
            self.master.refresh()
            point = self.master.solve(self.stop)
        return point.value + self.constant if point.status == "optimal" else math.nan


def _comes_back(route: Integers, near: Flags) -> bool:
    """Whether a route comes back to a customer who is still remembered."""
    kept: set[int] = set()
    for node in route.tolist():
        if node in kept:
            return True
        kept = {other for other in kept if near[node, other]} | {node}
    return False
