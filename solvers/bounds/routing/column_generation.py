"""Column generation: the linear program that chooses routes for one node of a tree, its cuts, and the routes that it still lacks.

Routes of negative reduced cost are found by labels, and added until there are none (Desrochers, Desrosiers, Solomon 1992), at prices
smoothed towards those of the best Lagrangian bound (Wentges 1997). Where a solution visits a customer twice on one route, he is remembered
in between (Roberti, Mingozzi 2014).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from .arcs import Arcs, Flags, Floats, Longs
from .load_cuts import LoadCut, overloaded
from .pricing import Pricer
from .restricted_master import Cut, Master, Pool, Prices, coefficients
from .route_levels import route_levels
from .subset_rows import SubsetRow, violated

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

LABELS = 2_000_000
"""Most labels from one end in one search for routes, some 120 bytes each."""

FOUND, COLUMNS, EACH = 300, 50, 5
"""Most routes that are looked at and added at once, and those of one customer among them."""

MOST_COLUMNS = 100_000
"""Most routes in all; then the tree is handed over as it is."""

MEMORY, MOST_MEMORY = 8, 20
"""Neighbours that are remembered at a customer to begin with, and in the end."""

SMOOTHING = 0.6
"""Weight of the best prices so far."""

FEW, MANY_COLUMNS = 1000, 20_000
"""With more routes those that cost too much are dropped, and with very many all but the cheapest half of that number."""

SLACK = 0.05
"""Cuts further from being met are dropped."""

QUICK = 5
"""Quick searches for routes with which a branching is tried."""

REDUCED = 1e-7
"""Part of the largest cost of a move by which a reduced cost must be below 0 to count."""

WHOLE = 1e-6
"""Distance to a whole number up to which a value counts as one."""


@dataclass(frozen=True, eq=False)
class Part:
    """Costs of the moves that a node of a tree allows, and its limits on the number of routes."""

    cost: Floats
    fewest: int
    most: int


@dataclass(eq=False)
class Solved:
    """The end of column generation, its ``status``: ``done``, ``enough`` (the prices prove enough), ``stopped`` or
    ``full``, of labels or of routes.

    ``bound`` and ``prices`` are the best Lagrangian bound by the labels here, ``least`` the least reduced cost there; ``values`` and
    ``reduced`` costs are those of the routes in the linear program; ``lacking`` is how many visits no route makes.
    """

    status: str
    bound: float = -math.inf
    prices: Prices | None = None
    least: float = 0.0
    values: Floats = field(default_factory=lambda: np.zeros(0))
    lacking: float = 0.0
    reduced: Floats = field(default_factory=lambda: np.zeros(0))


class ColumnGeneration:
    """The routes at hand, the cuts, and the linear program over them, for all nodes of one tree.

    Parameters
    ----------
    problem : RoutingProblem
    arcs : Arcs
        Costs are counted in ``unit`` of them from here on, so that they are about a thousand, as tolerances of linear programs ask for.
    stop : Stop
    enough : callable
        Whether a bound, in ``unit``, is all that is asked for.
    seed : int
    most : mapping, optional
        ``columns``, ``labels`` and ``memory`` other than the usual ones.
    """

    def __init__(
        self, problem: RoutingProblem, arcs: Arcs, stop: Stop, enough: Callable[[float], bool], seed: int,
        most: Mapping[str, int] | None = None,
    ) -> None:  # fmt: skip
        most = most or {}
        self.problem, self.stop, self.enough, self.seed = problem, stop, enough, seed
        self.most_columns = most.get("columns", MOST_COLUMNS)
        self.usable = np.isfinite(arcs.cost)
        self.unit = 2.0 ** (math.frexp(float(np.abs(arcs.cost[self.usable]).max(initial=1e-300)))[1] - 10)
        self.arcs = arcs = replace(arcs, cost=arcs.cost / self.unit)
        self.dearest = float(np.abs(arcs.cost[self.usable]).max(initial=0.0))
        self.step = REDUCED * self.dearest
        far = problem.travel.distances[np.ix_(arcs.customers, arcs.customers)]
        self.near = self._nearest(np.minimum(far, far.T), most.get("memory", MEMORY))
        levels = route_levels(problem, arcs, self.usable)
        weight, start, lower, upper = (np.array([getattr(one, name) for one in levels]) for name in ("weight", "start", "lower", "upper"))
        self.pricer = Pricer(weight, start, lower, upper, self.usable, self.dearest, most.get("labels", LABELS))
        self.pool, self.cuts, self.loads = Pool(), dict[tuple[int, ...], SubsetRow](), set[bytes]()
        self.finite = np.where(self.usable, arcs.cost, self.dearest)
        self.dear = 1.0
        self.master = self._new_master([])
        self.phase_one: Master | None = None
        self.full = False  # whether labels or routes ever were too many

    def _nearest(self, far: Floats, memory: int) -> Flags:
        """The customers who are remembered at each node to begin with, each at his own too."""
        inner = self.usable[1:, 1:]
        far = np.where(inner | inner.T, far, math.inf)
        np.fill_diagonal(far, -math.inf)
        near = np.zeros(self.usable.shape, dtype=bool)
        np.put_along_axis(near[1:, 1:], np.argsort(far, axis=1, kind="stable")[:, : memory + 1], True, axis=1)
        return near

    def _new_master(self, cuts: Sequence[Cut]) -> Master:
        lacking = self.dear * np.append(self.dearest, self.finite[0, 1:] + self.finite[1:, 0])
        return Master(self.pool, self.finite, np.maximum(lacking, 1e-3 * self.dear * self.dearest), self.seed, cuts)

    def add(self, answer: Routes) -> None:
        """Take the routes of an answer."""
        node = {site: node for node, site in enumerate(self.arcs.customers.tolist(), start=1)}
        routes = [np.array([node[site] for site in route.visits], dtype=np.int64) for route in answer if route.visits]
        self.pool.add(self.pool.new(routes))

    # -- the linear program of a node --------------------------------------------------------------------------------

    def solve(self, part: Part, centre: Prices | None) -> Solved:
        """The linear program of a node, which begins at the prices ``centre``, with all routes and memories that it takes; where no routes
        make up a solution, prices that prove it, and an infinite bound."""
        best = Solved("stopped")
        while True:
            solved = self._generated(self.master, part, centre)
            if solved.status != "done":
                return solved if solved.status == "enough" or best.prices is None else best
            if solved.lacking > WHOLE:
                zero = np.where(np.isfinite(part.cost), 0.0, math.inf)
                if self.phase_one is None:
                    self.phase_one = Master(self.pool, np.zeros(self.usable.shape), np.ones(len(self.usable)), self.seed)
                ray = self._generated(self.phase_one, replace(part, cost=zero), None)
                if ray.bound > WHOLE:
                    return Solved("enough", math.inf, ray.prices)
                if ray.status == "stopped":
                    return best
                if ray.status == "full" or self.dear > 1e6:
                    return solved
                self.dear *= 10.0
                self.master = self._new_master(self.master.cuts)
                continue
            best = solved if solved.bound >= best.bound else best
            if not self._remember(solved.values):
                return solved
            centre = solved.prices

    def _remember(self, values: Floats) -> bool:
        """Have customers remembered on routes that visit them twice; whether there were any."""
        grown = False
        for k in np.nonzero(self.pool.twice[: len(values)] & (values > WHOLE))[0].tolist():
            route, last = self.pool.routes[k].tolist(), dict[int, int]()
            for place, node in enumerate(route):
                between = route[last[node] + 1 : place] if node in last else []
                if between and all(self.near[other, node] or self.near[other].sum() <= MOST_MEMORY for other in between):
                    self.near[between, node] = grown = True
                last[node] = place
        return grown

    def _generated(self, master: Master, part: Part, centre: Prices | None) -> Solved:
        """Add routes until there are none of negative reduced cost, or enough is proved."""
        from .label_kernels import EXACT, SINGLE, STOPPED

        rows = [cut for cut in master.cuts if isinstance(cut, SubsetRow)]
        self._restrict(master, part)
        self.pricer.restrict(np.isfinite(part.cost), self.near, rows)
        best, how, guess = Solved("stopped"), SINGLE, -math.inf
        step = self.step if master is self.master else REDUCED
        while True:
            point = master.solve(self.stop)
            if point.status != "optimal" or len(self.pool) > self.most_columns:
                best.status = "stopped" if self.stop.reached() else "full"
                self.full = self.full or best.status == "full"
                return best
            prices = point.prices
            assert prices is not None
            fresh: list[Longs] = []
            for mixed in (True, False) if centre is not None else (False,):
                at = prices.mixed(centre, SMOOTHING, master.cuts) if mixed and centre is not None else prices
                status, least, routes = self._priced(part, at, how, step)
                if status != 0:
                    best.status = "stopped" if status == STOPPED else "full"
                    self.full = self.full or best.status == "full"
                    return best
                bound = self._lagrangian(at, least, part)
                if how != EXACT and bound > guess:  # no bound, but a good place to be near to
                    guess, centre = bound, at
                elif how == EXACT:
                    if best.prices is None or bound > best.bound:
                        best.bound, best.prices, best.least, centre = bound, at, least, at
                    if best.bound > WHOLE if master is not self.master else self.enough(best.bound):
                        best.status = "enough"
                        if master is not self.master:
                            best.values = np.zeros(0)
                        return best
                fresh = self._chosen(part, prices, routes, step)
                if fresh:
                    break
            if fresh:
                self.pool.add(fresh)
                master.refresh()
                how = SINGLE if how != EXACT else how
            elif how != EXACT:
                how = how - 1 if how > EXACT else EXACT
            else:
                best.status, best.values, best.reduced, best.lacking = "done", point.values, point.reduced, point.lacking
                return best

    def _priced(self, part: Part, at: Prices, how: int, step: float) -> tuple[int, float, list[Longs]]:
        reduced, fines = self._reduced(part, at)
        # Each route pays for being one of so many.
        status, least, _, routes = self.pricer.search(self.stop, reduced, fines, how, FOUND, at.routes - step)
        return status, least, routes

    def _reduced(self, part: Part, at: Prices) -> tuple[Floats, Floats]:
        """Reduced costs of moves, and the prices of the cuts that they do not tell."""
        reduced = part.cost.copy()
        reduced[:, 1:] -= at.visits[1:]
        for cut, price in at.cuts.items():
            if isinstance(cut, LoadCut):
                reduced[cut.entering] -= price
        return reduced, at.of(self.pricer.cuts)

    def _chosen(self, part: Part, prices: Prices, routes: Sequence[Longs], step: float) -> list[Longs]:
        """New routes of negative reduced cost, the cheapest first, of each customer a few."""
        fresh = self.pool.new(routes)
        if not fresh:
            return []
        some = Pool()
        some.add(fresh)
        reduced, fines = self._reduced(part, prices)
        cost = some.sums(reduced) - prices.routes - coefficients(self.pricer.cuts, some, 0) @ fines
        chosen, counts = list[Longs](), np.zeros(len(part.cost), np.int64)
        for k in np.argsort(cost, kind="stable").tolist():
            if cost[k] > -step or len(chosen) == COLUMNS:
                break
            if counts[fresh[k]].min() < EACH:
                counts[fresh[k]] += 1
                chosen.append(fresh[k])
        return chosen

    def _lagrangian(self, at: Prices, least: float, part: Part) -> float:
        return math.fsum([*at.visits[1:], *(price * cut.right for cut, price in at.cuts.items())]) + min(
            part.fewest * least, part.most * least
        )

    def _restrict(self, master: Master, part: Part) -> None:
        """Have a master program choose among the routes that a node allows."""
        shut = self.pool.sums(np.where(np.isfinite(part.cost), 0.0, 1.0)) > 0
        master.refresh()
        twice = np.nonzero(self.pool.twice & ~shut)[0]
        shut[twice] = [_comes_back(self.pool.routes[k], self.near) for k in twice.tolist()]
        master.restrict(shut, part.fewest, part.most)

    # -- between two solutions ---------------------------------------------------------------------------------------

    def cut(self, solved: Solved, *, rows: bool) -> bool:
        """Add cuts that the solution violates, subset rows too or capacities alone, and drop those that it is far from; whether there were
        any."""
        used = np.nonzero(solved.values > WHOLE)[0]
        some = Pool()
        some.add([self.pool.routes[k] for k in used.tolist()])
        sums = solved.values[used] @ coefficients(self.master.cuts, some, 0)
        idle = [cut for cut, total in zip(self.master.cuts, sums.tolist(), strict=True) if abs(total - cut.right) > SLACK]
        cuts: list[Cut] = list(overloaded(self.problem, self.pool.flow(solved.values, len(self.usable)), self.loads, self.stop))
        triples = violated(self.pool, solved.values, len(self.usable), self.cuts) if rows else []
        replaced = [self.cuts[cut.customers] for cut in triples if cut.customers in self.cuts]
        gone = list({id(cut): cut for cut in [*idle, *replaced]}.values())
        self.master.drop(gone)
        for cut in gone:
            if isinstance(cut, LoadCut):
                self.loads.discard(cut.inside.tobytes())
            elif isinstance(cut, SubsetRow):
                self.cuts.pop(cut.customers, None)
        self.cuts.update((cut.customers, cut) for cut in triples)
        self.master.cut([*cuts, *triples])
        return bool(cuts or triples)

    def purge(self, solved: Solved, best: Solved, gap: float) -> None:
        """Drop routes that no answer drives whose value is less than ``gap`` above the bound, and the dearest of very many; ``values`` of
        both solutions follow."""
        if len(self.pool) <= FEW:
            return
        most = max(gap + self.step, 0.0) if math.isfinite(gap) else math.inf
        if len(self.pool) > MANY_COLUMNS:
            most = min(most, float(np.partition(solved.reduced, MANY_COLUMNS // 2)[MANY_COLUMNS // 2]))
        kept = (solved.reduced <= most) | (solved.values > 0.0)
        kept[: len(best.values)] |= best.values > 0.0
        if kept.sum() < 0.8 * len(kept):
            self.master.keep(kept)
            self.phase_one = None
            for one in {id(one): one for one in (solved, best)}.values():
                one.values = one.values[kept[: len(one.values)]]
            solved.reduced = solved.reduced[kept]

    def hopeless(self, part: Part, solved: Solved, gap: float) -> Flags | None:
        """Moves that no route makes whose reduced cost is less than ``gap`` above the least; None where there was no time or no room."""
        assert solved.prices is not None
        reduced, fines = self._reduced(part, solved.prices)
        least = solved.least + gap + self.step
        costs = self.pricer.arc_costs(self.stop, reduced, fines, least)
        if costs is None:
            return None
        hopeless = np.isfinite(part.cost) & (costs >= least - 1e-9 * self.dearest)
        np.fill_diagonal(hopeless, False)
        return hopeless

    def value(self, part: Part, *, priced: bool = False) -> float:
        """The value of the linear program of a node over the routes at hand, or (``priced``) with those that quick searches find; no number
        where it has none."""
        from .label_kernels import DONE, SINGLE

        self._restrict(self.master, part)
        point = self.master.solve(self.stop)
        if priced:
            self.pricer.restrict(np.isfinite(part.cost), self.near, [cut for cut in self.master.cuts if isinstance(cut, SubsetRow)])
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
        return point.value if point.status == "optimal" else math.nan


def _comes_back(route: Longs, near: Flags) -> bool:
    """Whether a route comes back to a customer who is still remembered."""
    kept: set[int] = set()
    for node in route.tolist():
        if node in kept:
            return True
        kept = {other for other in kept if near[node, other]} | {node}
    return False
