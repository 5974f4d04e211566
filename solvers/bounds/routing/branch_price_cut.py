"""Bound ``branch-price-cut``: branch and price with cuts, for routes whose limits and costs add up along them.

Each node's linear program chooses routes so that each customer is visited once; routes of negative reduced cost are found by labels, and
added until there are none (Desrochers, Desrosiers, Solomon 1992). Prices are smoothed towards those of the best Lagrangian bound (Wentges
1997), which are the node's evidence; the checker goes through them with labels of its own. Where a solution visits a customer twice on one
route, he is remembered in between (Roberti, Mingozzi 2014); subset-row and capacity cuts are added while they help. Moves that no better
answer can make are left out by a branching of their own. Else branchings are on the number of routes, then on single moves.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.checking.granularity import grain, lift
from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.routing.routes import Routes
from ....formulations.stop import NEVER, Stop
from ....formulations.tolerance import same
from ....instances.errors import InputError
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod, of_family
from ..proof_tree import Node, ProofTree
from .arcs import Arcs, Flags, Floats, Longs, arc_costs, by_site, lacks_arc_costs
from .load_cuts import LoadCut, overloaded
from .pricing import Pricer
from .restricted_master import Master, Pool, Prices, coefficients
from .subset_rows import SubsetRow, violated

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

RUINS, OPENING = 1000, 0.1
"""Ruins for each customer of the search for a first answer, where none is given, and its part of the time at most."""

MERGED = 0.4
"""Share of the time for several types of vehicle, after which other methods have their turn."""

SPEED = 60_000
"""Ruins a second that it can be relied on for."""

AGAIN, DOUBTFUL = 10, 0.006
"""How many times as many for another search where so large a part of the answer is still open after some rounds of cuts."""

CUSTOMERS = 400
"""Most customers that the checker looks at."""

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

ROUNDS, WORTH = 4, 0.03
"""Cuts are added until so many rounds together bring less than this share of the gap."""

SMALLER, MANY = 0.85, 0.02
"""Moves that no better answer makes are looked for each time the gap has become so much smaller, and left out where they are more than a
share of all."""

CANDIDATES, PRICED, QUICK = 20, 3, 5
"""Moves that are tried over the routes at hand before one is branched on, those that are tried with further routes too, and how many quick
searches for such."""

LEAST_GAIN = 1e-6
"""Least gain of a branching in a product of two gains, as a part of the largest cost of a move."""

REDUCED = 1e-7
"""Part of the largest cost of a move by which a reduced cost must be below 0 to count."""

WHOLE = 1e-6
"""Distance to a whole number up to which a value counts as one."""


@dataclass(eq=False)
class _Node(Node):
    """A node and its linear relaxation: ``prices`` of its best bound, where its children begin; ``flow``, shape (nodes, nodes), how often
    its linear program makes each move, and its ``value``; the ``gap`` at which hopeless moves were last looked for."""

    prices: Prices | None = None
    flow: Floats | None = None
    value: float = -math.inf
    gap: float = math.inf

    @property
    def first(self) -> bool:
        """Whether it is the root, but for hopeless moves."""
        return all("moves" in statement for statement, _ in self.decisions())


@dataclass(frozen=True, eq=False)
class _Part:
    """Costs of the moves that a node allows, and its limits on the number of routes."""

    cost: Floats
    fewest: int
    most: int


@dataclass(frozen=True, eq=False)
class _Level:
    """Something that grows along a route: what moves add, the level on leaving the depot, and the range at each node."""

    weight: Floats
    start: float
    lower: Floats
    upper: Floats

    def grows(self, usable: Flags) -> bool:
        """Whether no walk has moves that add nothing and come back to where they began."""
        idle = usable[1:, 1:] & (self.weight[1:, 1:] <= 0.0)
        for _ in range(len(idle)):  # who has no such move out is on no such way
            left = idle & np.atleast_1d(idle.any(axis=1))[None, :]
            if (left == idle).all():
                break
            idle = left
        return not idle.any()

    def finite(self, usable: Flags) -> tuple[Floats, float, Floats, Floats]:
        """The same with ends of all ranges, none of which limits anything that was not limited."""
        lower = np.where(np.isfinite(self.lower), self.lower, self.start)
        largest = float(self.weight[usable].max(initial=0.0))
        known = np.concatenate([lower, self.upper[np.isfinite(self.upper)], [self.start]])
        open_end = float(known.max()) + len(lower) * largest
        return self.weight, self.start, lower, np.where(np.isfinite(self.upper), self.upper, open_end)


@dataclass(eq=False)
class _Solved:
    """The end of column generation, its ``status``: ``done``, ``enough`` (the prices prove enough), ``stopped``, ``full``, or ``fixed``
    (no better answer makes any of the moves ``hopeless``).

    ``bound`` and ``prices`` are the best Lagrangian bound by our own labels, ``least`` the least reduced cost there; ``values`` those of
    the routes in the linear program; ``lacking`` is how much of it no route makes up for.
    """

    status: str
    bound: float = -math.inf
    prices: Prices | None = None
    least: float = 0.0
    values: Floats = field(default_factory=lambda: np.zeros(0))
    lacking: float = 0.0
    reduced: Floats = field(default_factory=lambda: np.zeros(0))
    hopeless: Flags | None = None


class Tree(ProofTree[_Node]):
    """A tree over moves and numbers of routes."""

    def __init__(
        self, problem: RoutingProblem, arcs: Arcs, target: float | None, stop: Stop, seed: int, *, answer: Routes | None = None,
        most: Mapping[str, int] | None = None, on_answer: Callable[[Routes, float], None] = lambda answer, value: None,
    ) -> None:  # fmt: skip
        nodes, most = len(arcs.cost), most or {}
        self.answer, self.on_answer, self.most_columns = answer, on_answer, most.get("columns", MOST_COLUMNS)
        super().__init__(problem, _Node(None), target, stop)
        self.usable, self.seed = np.isfinite(arcs.cost), seed
        # Costs of about a thousand, as tolerances of linear programs ask for.
        self.unit = 2.0 ** (math.frexp(float(np.abs(arcs.cost[self.usable]).max(initial=1e-300)))[1] - 10)
        self.arcs = arcs = replace(arcs, cost=arcs.cost / self.unit)
        self.grain = grain(arcs.cost[self.usable] * self.unit)
        self.dearest = float(np.abs(arcs.cost[self.usable]).max(initial=0.0))
        self.step = REDUCED * self.dearest
        self.index = {problem.sites.ids[site]: k for k, site in enumerate(arcs.customers.tolist(), start=1)}
        starts, ends = {v.start for v in problem.fleet}, {v.end for v in problem.fleet}
        self.ends = (problem.sites.ids[min(starts)], problem.sites.ids[min(ends)]) if len(starts) == len(ends) == 1 else None
        far = problem.travel.distances[np.ix_(arcs.customers, arcs.customers)]
        self.near = self._nearest(np.minimum(far, far.T), most.get("memory", MEMORY))
        # Where nothing limits time, levels of it only keep labels apart that are alike.
        timed = np.isfinite(problem.sites.due[[*arcs.customers, *ends]]).any()
        kept = [r for name, r in arcs.resources.items() if name != "time" or timed] or [arcs.resources["time"]]

        def grid(weight: Floats) -> Floats:
            square = weight[:-1, :-1].copy()
            square[:, 0] = weight[:-1, -1]
            return np.where(self.usable, square, 0.0)

        kept.sort(key=lambda r: r is not arcs.resources["time"])
        levels = [
            _Level(grid(r.weight), r.lower[0], r.lower[:-1], np.append(r.upper[-1], r.upper[1:-1]) + r.tolerance)
            for r in kept
            if np.isfinite(r.upper).any()
        ]
        if not any(level.grows(self.usable) for level in levels):  # then visits are counted, for walks to have an end
            levels.append(_Level(self.usable * 1.0, 0.0, np.zeros(nodes), np.full(nodes, nodes)))
        weight, start, lower, upper = (np.array(part) for part in zip(*(level.finite(self.usable) for level in levels), strict=True))
        self.pricer = Pricer(weight, start, lower, upper, self.usable, self.dearest, most.get("labels", LABELS))
        self.pool, self.cuts, self.loads = Pool(), dict[tuple[int, ...], SubsetRow](), set[bytes]()
        self.finite = np.where(self.usable, arcs.cost, self.dearest)
        self.rounds = 0
        if answer is not None:
            self._learn(answer, self.target)
        self.dear = 1.0
        self.master = self._new_master()
        self.phase_one: Master | None = None
        self.whole, self.fixing = stop, True

    def _nearest(self, far: Floats, memory: int) -> Flags:
        """The customers who are remembered at each node to begin with, each at his own too."""
        inner = self.usable[1:, 1:]
        far = np.where(inner | inner.T, far, math.inf)
        np.fill_diagonal(far, -math.inf)
        near = np.zeros(self.usable.shape, dtype=bool)
        np.put_along_axis(near[1:, 1:], np.argsort(far, axis=1, kind="stable")[:, : memory + 1], True, axis=1)
        return near

    def _new_master(self) -> Master:
        lacking = self.dear * np.append(self.dearest, self.finite[0, 1:] + self.finite[1:, 0])
        cuts = self.master.cuts if self.loads or self.cuts else ()
        return Master(self.pool, self.finite, np.maximum(lacking, 1e-3 * self.dear * self.dearest), self.seed, cuts)

    # -- nodes -------------------------------------------------------------------------------------------------------

    def _part(self, node: _Node) -> _Part:
        cost, fewest, most = self.arcs.cost.copy(), self.arcs.fewest, self.arcs.most
        for statement, holds in node.decisions():
            if "routes" in statement:
                fewest, most = (fewest, min(most, statement["routes"])) if holds else (max(fewest, statement["routes"] + 1), most)
                continue
            if "moves" in statement:
                for tail, heads in statement["moves"].items():
                    cost[self.index.get(tail, 0), [self.index.get(head, 0) for head in heads]] = math.inf
                continue
            i, j = (self.index.get(site, 0) for site in statement["arc"])
            if not holds:
                cost[i, j] = math.inf
                continue
            kept = cost[i, j]
            if i:
                cost[i] = math.inf
            if j:
                cost[:, j] = math.inf
            cost[i, j] = kept
        return _Part(cost, fewest, most)

    def look(self, node: _Node) -> bool:
        part, parent = self._part(node), node.parent
        first = node.first
        if isinstance(parent, _Node):
            node.prices, node.gap = parent.prices, parent.gap
        problem = self.restricted(node)
        solved = self._solved(node, part)
        if solved.status == "stopped" and (not first or solved.prices is None):
            return False
        self.begin(node)
        if part.fewest > part.most or len(self.usable) < 2:
            solved.prices = Prices(0.0, np.zeros(len(self.usable)), {})
        if solved.prices is not None:
            node.prices = solved.prices
        if solved.status == "fixed":
            if node is self.root:
                self._prove(node, problem, solved)
            left_out = self._without(node, solved)
            if left_out or (left_out is None and not first):
                return bool(left_out)
            # The checker did not follow, or there was no time for the rest: then what was proved of all moves counts.
            self.fixing = False
            again = self._solved(node, part)
            if again.prices is None and not first:
                return False
            solved = solved if again.prices is None else again
            node.prices = solved.prices
        if solved.prices is not None:
            self._prove(node, problem, solved)
        if self.reached(node.bound) or solved.status in ("full", "stopped"):
            self.close(node)
        else:
            self._keep(node, part, solved)
        return True

    def _without(self, node: _Node, solved: _Solved) -> bool | None:
        """Leave hopeless moves out: a branching of which one side is proved at once; whether it was, None where there was no time for the
        other one."""
        assert solved.hopeless is not None
        names = self._names()
        moves = {names[i][0]: [names[j][1] for j in np.nonzero(row)[0]] for i, row in enumerate(solved.hopeless) if row.any()}
        used, rest = _Node(node, ({"moves": moves}, True)), _Node(node, ({"moves": moves}, False))
        self.begin(used)
        self._prove(used, self.restricted(used), solved)
        if not self.reached(used.bound):
            self.nodes.remove(used)
            return False
        rest.prices = node.prices
        if not self.look(rest):
            return None
        self.close(used)
        node.children = used, rest
        return True

    def _prove(self, node: _Node, problem: Problem, solved: _Solved) -> None:
        """Prove a node by the prices of its best bound, in what is left of all the time."""
        assert solved.prices is not None
        stop, self.stop = self.stop, self.whole
        self.prove(node, problem, [self._evidence(solved)])
        self.stop = stop

    def counts(self) -> dict[str, int]:
        """Routes, cuts and labels, for statistics."""
        return {"columns": len(self.pool), "cuts": len(self.master.cuts), "labels": self.pricer.labels}

    def _names(self) -> list[tuple[str, str]]:
        """Sites of all nodes where a move begins and where it ends."""
        ids = self.problem.sites.ids  # type: ignore[attr-defined]
        return [self.ends or ("", ""), *((ids[site], ids[site]) for site in self.arcs.customers.tolist())]

    def _keep(self, node: _Node, part: _Part, solved: _Solved) -> None:
        """Let a node wait for its branching, unless an answer proves it or nothing is left to branch on."""
        node.flow, node.value = self.pool.flow(solved.values, len(self.usable)), solved.bound
        whole = np.abs(solved.values - np.round(solved.values)) <= WHOLE
        if (whole.all() and self._is_best(node, solved.values)) or self._statement(node, part) is None:
            self.close(node)
        else:
            self.wait(node)

    def _is_best(self, node: _Node, values: Floats) -> bool:
        """Whether whole routes are an answer that meets the node's bound; an answer better than known moves the target."""
        chosen = [self.arcs.customers[self.pool.routes[k] - 1].tolist() for k in np.nonzero(values > 0.5)[0]]
        if len(self.problem.fleet) > 1:  # type: ignore[attr-defined]
            return False
        try:
            judged = self.problem.evaluate(Routes.of(chosen))
        except InputError:
            return False
        if not judged.feasible:
            return False
        if judged.values[0] < self.target:
            self._learn(Routes.of(chosen), judged.values[0])
        return same(node.bound, judged.values[0], judged.size, judged.precision)

    def _evidence(self, solved: _Solved) -> Evidence:
        problem: Any = self.problem
        prices, ray = solved.prices, solved.bound == math.inf
        assert prices is not None
        sites = self.arcs.customers
        remembered: list[list[int]] = [[] for _ in problem.sites.ids]
        for node, site in enumerate(sites.tolist(), start=1):
            remembered[site] = sites[np.nonzero(self.near[node, 1:])[0]].tolist()
        data: dict[str, Any] = {"visits": by_site(problem, prices.visits[1:] * self.unit), "remembered": remembered}
        for cut, price in prices.cuts.items():
            if isinstance(cut, SubsetRow) and price < 0.0:
                memory = sites[np.nonzero(cut.memory[1:])[0]].tolist()
                row = {"sites": [int(sites[c - 1]) for c in cut.customers], "memory": memory, "price": price * self.unit}
                data.setdefault("rows", []).append(row)
            elif isinstance(cut, LoadCut) and price > 0.0:
                data.setdefault("loads", []).append({"sites": sites[np.nonzero(cut.inside[1:])[0]].tolist(), "price": price * self.unit})
        source = f"column generation, {len(data.get('rows', ())) + len(data.get('loads', ()))} cuts"
        return Evidence(
            "set-partitioning-duals", source, math.inf if ray else solved.bound * self.unit, {**data, "ray": True} if ray else data
        )

    # -- column generation -------------------------------------------------------------------------------------------

    def _solved(self, node: _Node, part: _Part) -> _Solved:
        """The linear program of a node; where no routes make up a solution, prices that prove it, and an infinite bound."""
        if part.fewest > part.most or len(part.cost) < 2:
            return _Solved("enough", math.inf)
        best, bounds, rows = _Solved("stopped"), list[float](), not node.first
        while True:
            solved = self._generated(self.master, node, part)
            if solved.status != "done":
                return solved if solved.status == "enough" or best.prices is None else best
            if solved.lacking > WHOLE:
                zero = np.where(np.isfinite(part.cost), 0.0, math.inf)
                if self.phase_one is None:
                    self.phase_one = Master(self.pool, np.zeros(self.usable.shape), np.ones(len(self.usable)), self.seed)
                ray = self._generated(self.phase_one, node, _Part(zero, part.fewest, part.most))
                if ray.status == "stopped" or ray.bound > WHOLE:
                    return _Solved(ray.status, math.inf, ray.prices)
                if ray.status == "full" or self.dear > 1e6:
                    return solved
                self.dear *= 10.0
                self.master = self._new_master()
                continue
            node.prices = solved.prices
            best = solved if solved.bound >= best.bound else best
            if self._remember(solved.values):
                continue
            solved.hopeless = self._hopeless(node, part, solved)
            if solved.hopeless is not None:
                return replace(solved, status="fixed")
            self._purge(solved, best)
            bounds.append(solved.bound)
            self.rounds += node.first
            if self.rounds == ROUNDS and node.first:
                self._look_again(solved.bound)
            goal = self.target / self.unit if math.isfinite(self.target) else 2.0 * bounds[-1] - bounds[0]
            rounds = ROUNDS if node.first else 1
            slow = len(bounds) > rounds and bounds[-1] - bounds[-1 - rounds] < WORTH * (goal - bounds[-1])
            if slow and rows:
                return solved
            if slow:  # capacities are done with
                rows, bounds = True, bounds[-1:]
            found = self._cut(solved, rows=rows)
            if not found and rows:
                return solved
            rows = rows or not found
            node.prices = solved.prices

    def _purge(self, solved: _Solved, best: _Solved) -> None:
        """Drop routes that no better answer drives at these prices, and the dearest of very many."""
        gap = self.target / self.unit - solved.bound
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

    def _hopeless(self, node: _Node, part: _Part, solved: _Solved) -> Flags | None:
        """Moves that no better answer makes, if there are many since the gap was last so much larger."""
        gap = self.target / self.unit - solved.bound
        if not self.fixing or self.ends is None or not gap < SMALLER * node.gap or solved.prices is None:
            return None
        node.gap = gap
        if self.grain is not None:  # what is above the last multiple before the target is lifted to it
            gap -= self.grain.size / self.unit * (1.0 - 1e-4)
        reduced, fines = self._reduced(part, solved.prices)
        least = solved.least + gap + self.step
        costs = self.pricer.arc_costs(self.stop, reduced, fines, least)
        if costs is None:
            return None
        hopeless = np.isfinite(part.cost) & (costs >= least - 1e-9 * self.dearest)
        np.fill_diagonal(hopeless, False)
        return hopeless if hopeless.sum() > MANY * np.isfinite(part.cost).sum() else None

    def _look_again(self, bound: float) -> None:
        """Look for a better answer where the one at hand is far from a bound."""
        problem: Any = self.problem
        doubtful = self.target / self.unit - bound > DOUBTFUL * abs(self.target / self.unit)
        if self.answer is None or not doubtful:
            return
        answer = first_answer(problem, 2.0 * OPENING * self.whole.seconds_left, self.seed + 1, self.stop, ruins=AGAIN * RUINS)
        if answer is not None:
            self._learn(answer, problem.evaluate(answer).values[0])

    def _learn(self, answer: Routes, value: float) -> None:
        """Take an answer, if it is better than the one at hand, and its routes."""
        if value < self.target:
            self.target, self.answer = value, answer
            self.on_answer(answer, value)
        known = {site: node for node, site in enumerate(self.arcs.customers.tolist(), start=1)}
        routes = [np.array([known[site] for site in route.visits], dtype=np.int64) for route in answer if route.visits]
        self.pool.add(self.pool.new(routes))

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

    def _cut(self, solved: _Solved, *, rows: bool) -> bool:
        """Add cuts that the solution violates, subset rows too or capacities alone, and drop those that it is far from; whether there were
        any."""
        assert solved.prices is not None
        used = np.nonzero(solved.values > WHOLE)[0]
        some = Pool()
        some.add([self.pool.routes[k] for k in used.tolist()])
        sums = solved.values[used] @ coefficients(self.master.cuts, some, 0)
        idle = [cut for cut, total in zip(self.master.cuts, sums.tolist(), strict=True) if abs(total - cut.right) > SLACK]
        cuts: list[Any] = list(overloaded(self.problem, self.pool.flow(solved.values, len(self.usable)), self.loads, self.stop))  # type: ignore[arg-type]
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

    def _generated(self, master: Master, node: _Node, part: _Part) -> _Solved:
        """Add routes until there are none of negative reduced cost, or enough is proved."""
        from .label_kernels import EXACT, SINGLE, STOPPED

        rows = [cut for cut in master.cuts if isinstance(cut, SubsetRow)]
        self._restrict(master, part)
        self.pricer.restrict(np.isfinite(part.cost), self.near, rows)
        best, centre, how, guess = _Solved("stopped"), node.prices if master is self.master else None, SINGLE, -math.inf
        while True:
            point = master.solve(self.stop)
            if point.status != "optimal" or len(self.pool) > self.most_columns:
                best.status = "stopped" if self.stop.reached() else "full"
                return best
            prices = point.prices
            assert prices is not None
            fresh: list[Longs] = []
            for mixed in (True, False) if centre is not None else (False,):
                at = prices.mixed(centre, SMOOTHING, master.cuts) if mixed and centre is not None else prices
                status, least, routes = self._priced(part, at, how)
                if status != 0:
                    best.status = "stopped" if status == STOPPED else "full"
                    return best
                bound = self._lagrangian(at, least, part)
                if how != EXACT and bound > guess:  # no bound, but a good place to be near to
                    guess, centre = bound, at
                elif how == EXACT:
                    if best.prices is None or bound > best.bound:
                        best.bound, best.prices, best.least, centre = bound, at, least, at
                    if self._enough(master, best.bound):
                        best.status = "enough"
                        if master is not self.master:
                            best.values = np.zeros(0)
                        return best
                fresh = self._chosen(part, prices, routes)
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

    def _priced(self, part: _Part, at: Prices, how: int) -> tuple[int, float, list[Longs]]:
        reduced, fines = self._reduced(part, at)
        # Each route pays for being one of so many.
        status, least, _, routes = self.pricer.search(self.stop, reduced, fines, how, FOUND, at.routes - self.step)
        return status, least, routes

    def _reduced(self, part: _Part, at: Prices) -> tuple[Floats, Floats]:
        """Reduced costs of moves, and the prices of the cuts that they do not tell."""
        reduced = part.cost.copy()
        reduced[:, 1:] -= at.visits[1:]
        for cut, price in at.cuts.items():
            if isinstance(cut, LoadCut):
                reduced[cut.entering] -= price
        return reduced, at.of(self.pricer.cuts)

    def _chosen(self, part: _Part, prices: Prices, routes: Sequence[Longs]) -> list[Longs]:
        """New routes of negative reduced cost, the cheapest first, of each customer a few."""
        fresh = self.pool.new(routes)
        if not fresh:
            return []
        some = Pool()
        some.add(fresh)
        reduced = part.cost.copy()
        reduced[:, 1:] -= prices.visits[1:]
        cost = some.sums(np.where(np.isfinite(reduced), reduced, 1e12)) - prices.routes
        cost -= coefficients(list(prices.cuts), some, 0) @ np.array(list(prices.cuts.values()))
        chosen, counts = list[Longs](), np.zeros(len(part.cost), np.int64)
        for k in np.argsort(cost, kind="stable").tolist():
            if cost[k] > -self.step or len(chosen) == COLUMNS:
                break
            if counts[fresh[k]].min() < EACH:
                counts[fresh[k]] += 1
                chosen.append(fresh[k])
        return chosen

    def _lagrangian(self, at: Prices, least: float, part: _Part) -> float:
        return math.fsum([*at.visits[1:], *(price * cut.right for cut, price in at.cuts.items())]) + min(
            part.fewest * least, part.most * least
        )

    def _restrict(self, master: Master, part: _Part) -> None:
        """Have a master program choose among the routes that a node allows."""
        shut = self.pool.sums(np.where(np.isfinite(part.cost), 0.0, 1.0)) > 0
        master.refresh()
        twice = np.nonzero(self.pool.twice & ~shut)[0]
        shut[twice] = [_comes_back(self.pool.routes[k], self.near) for k in twice.tolist()]
        master.restrict(shut, part.fewest, part.most)

    def _enough(self, master: Master, bound: float) -> bool:
        if master is not self.master:
            return bound > WHOLE
        return self.reached(lift(bound * self.unit, "min", self.grain))

    # -- branching ---------------------------------------------------------------------------------------------------

    def branch(self, node: _Node) -> bool:
        statement = self._statement(node, self._part(node), try_them=True)
        assert statement is not None
        children = _Node(node, (statement, True)), _Node(node, (statement, False))
        if sum(1 for _ in self.look_at_all(node, children)) < 2:
            return False
        node.children = children
        return True

    def release(self, node: _Node) -> None:
        node.flow = node.prices = None

    def _statement(self, node: _Node, part: _Part, *, try_them: bool = False) -> dict[str, Any] | None:
        """The statement to branch on; None if nothing is left."""
        assert node.flow is not None
        number = float(node.flow[0].sum())
        if part.fewest < part.most and number > 1.0 and abs(number - round(number)) > WHOLE:
            return {"routes": math.floor(number)}
        usable = np.isfinite(part.cost)
        more_out, more_in = usable.sum(axis=1) > 1, usable.sum(axis=0) > 1  # of customers, who are left and entered by one move
        more_out[0] = more_in[0] = True
        undecided = usable & more_out[:, None] & more_in[None, :]
        if self.ends is None:  # a statement names one depot of several
            undecided[0] = undecided[:, 0] = False
        middle = np.where(undecided, np.abs(node.flow - np.floor(node.flow) - 0.5), math.inf)
        order = np.argsort(middle, axis=None, kind="stable")[:CANDIDATES]
        pairs = [divmod(int(k), len(part.cost)) for k in order if math.isfinite(middle.flat[k])]
        fractional = [pair for pair in pairs if middle[pair] < 0.5 - WHOLE]
        if not fractional:
            used = [(int(i), int(j)) for i, j in np.argwhere(undecided & (node.flow > WHOLE))]
            pair = next(iter(used or pairs), None)
            return None if pair is None else self._move(*pair)
        if not try_them or len(fractional) == 1:
            return self._move(*fractional[0])
        gains = [self._gain(node, pair) for pair in fractional]
        best = [fractional[k] for k in np.argsort(gains, kind="stable")[::-1][:PRICED].tolist()]
        gains = [self._gain(node, pair, priced=True) for pair in best] if len(best) > 1 else [1.0]
        return self._move(*best[int(np.argmax(gains))])

    def _gain(self, node: _Node, pair: tuple[int, int], *, priced: bool = False) -> float:
        """Product of what the linear program gains on both sides of a move, over the routes at hand, or (``priced``) with those that quick
        searches find."""
        from .label_kernels import DONE, SINGLE

        statement, least = self._move(*pair), LEAST_GAIN * self.dearest
        product = 1.0
        for holds in (True, False):
            if self.stop.reached():
                return 0.0
            part = self._part(_Node(node, (statement, holds)))
            self._restrict(self.master, part)
            point = self.master.solve(self.stop)
            if priced:
                self.pricer.restrict(np.isfinite(part.cost), self.near, [cut for cut in self.master.cuts if isinstance(cut, SubsetRow)])
                for _ in range(QUICK):
                    if point.prices is None:
                        break
                    status, _, routes = self._priced(part, point.prices, SINGLE)
                    fresh = self._chosen(part, point.prices, routes) if status == DONE else []
                    if not fresh:
                        break
                    self.pool.add(fresh)
                    self.master.refresh()
                    point = self.master.solve(self.stop)
            product *= max(least, point.value - node.value if point.status == "optimal" else 0.0)
        return product

    def _move(self, i: int, j: int) -> dict[str, Any]:
        names = self._names()
        return {"arc": [names[i][0], names[j][1]]}


def _comes_back(route: Longs, near: Flags) -> bool:
    """Whether a route comes back to a customer who is still remembered."""
    kept: set[int] = set()
    for node in route.tolist():
        if node in kept:
            return True
        kept = {other for other in kept if near[node, other]} | {node}
    return False


def branch_price_cut_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None,
    answer: Routes | None = None,
) -> Evidence | None:  # fmt: skip
    """Evidence from branch, price and cut: a branching tree, or ``set-partitioning-duals`` where no branching was needed.

    The tree ends where its bound reaches ``target``, the value of an ``answer``, whose routes are the first ones; better answers that it
    meets on the way take its place. Without either, it looks for an answer first. The linear programs are solved by HiGHS, whoever solves
    others, and go on from where the last one ended. None where the routes at the root were too many for the memory or the time.

    Source: Desrochers, Desrosiers, Solomon (1992); Barnhart, Johnson, Nemhauser, Savelsbergh, Vance (1998), "Branch-and-price".
    """
    if stop.reached() or not 0 < len(problem.customers) <= CUSTOMERS:
        return None
    arcs = arc_costs(problem, stop)
    if arcs is None or len(arcs.customers) == 0:
        return None
    seed = 1 if linear is None else linear.seed
    if len(problem.fleet) > 1:  # merged into one type, they are seldom proved to the end
        stop = stop.within(MERGED * stop.seconds_left)
    if target is None:
        answer = first_answer(problem, OPENING * stop.seconds_left, seed, stop)
        target = None if answer is None else problem.evaluate(answer).values[0]
    tree = Tree(problem, arcs, target, stop, seed, answer=answer)
    tree.grow()
    return tree.evidence("routes")


def first_answer(
    problem: RoutingProblem, seconds: float, seed: int, stop: Stop, *, compiled: bool = True, ruins: int = RUINS
) -> Routes | None:
    """A good answer soon, by ruin and recreate; None where there is none, or where its loops were never ``compiled`` and should be."""
    from ...backend import Control, Options
    from ...engines.routing.ruin_recreate import RuinRecreate
    from ...engines.routing.ruin_recreate_steps import near_kernels, search_kernels

    engine, control = RuinRecreate(), Control()
    if engine.missing(problem) or (compiled and not (near_kernels.nearest.kept() and search_kernels.anneal.kept())):
        return None
    with stop.telling(control.stop):
        # It cools down by its ruins: cut short by the time it would still be hot.
        most = max(1, min(ruins * len(problem.customers), int(SPEED * seconds)))
        answer = engine.run(problem, Options(seconds, iterations=most, seed=seed), control).answer
    return answer if answer is not None and problem.evaluate(answer).feasible else None


KERNELS = (
    *(f"waybound.solvers.bounds.routing.{name}_kernels" for name in ("label", "subset_row", "cut")),
    "waybound.formulations.routing.checking.walk_kernels",
)

BOUNDS.add(
    "branch-price-cut",
    BoundMethod(
        "branch-price-cut", of_family("routing", lacks_arc_costs), branch_price_cut_bound, order=1, aims=True, starts=True, kernels=KERNELS
    ),
)
