"""Bound ``column-generation``: branch and price, to prove a bound rather than to find answers.

Each node's linear program chooses routes so that each customer is visited once; routes of negative reduced cost are found by labels, and
added until there are none (Desrochers, Desrosiers, Solomon 1992). Prices of visits are smoothed towards the best ones so far (Wentges
1997); those of the best Lagrangian bound are the node's evidence, which the checker goes through with labels of its own. Where a solution
visits a customer twice on one route, more neighbours are remembered. Branchings are on the number of routes, then on single moves, chosen
by what the linear program without further routes gains on both sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.checking.granularity import grain, lift
from ....formulations.evidence import Evidence
from ....formulations.routing.routes import Routes
from ....formulations.stop import NEVER, Stop
from ....formulations.tolerance import same
from ....instances.errors import InputError
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod, of_family
from ..proof_tree import Node, ProofTree
from .arcs import Arcs, Flags, Floats, Longs, arc_costs, by_site, lacks_arc_costs
from .restricted_master import Master, Pool

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

CUSTOMERS = 400
"""Most customers that the checker looks at."""

LABELS = 500_000
"""Most labels in one search for routes, some 60 bytes each; a node that needs more is left open."""

COLUMNS = 200
"""Most routes that are added at once."""

MOST_COLUMNS = 100_000
"""Most routes in all; then the tree is handed over as it is."""

MEMORY = 8
"""Neighbours that are remembered at a customer to begin with."""

SMOOTHING = 0.5
"""Weight of the best prices so far."""

CANDIDATES = 8
"""Moves that are tried before one is branched on."""

LEAST_GAIN = 1e-6
"""Least gain of a branching in a product of two gains, as a part of the largest cost of a move."""

REDUCED = 1e-7
"""Part of the largest cost of a move by which a reduced cost must be below 0 to count."""

WHOLE = 1e-6
"""Distance to a whole number up to which a value counts as one."""


@dataclass(eq=False)
class _Node(Node):
    """A node and its linear relaxation.

    ``memory`` is the number of neighbours that are remembered; ``prices``, shape (customers,), are those of its best bound, where its
    children begin; ``flow``, shape (nodes, nodes), is how often its linear program makes each move.
    """

    memory: int = MEMORY
    prices: Floats | None = None
    flow: Floats | None = None


@dataclass(frozen=True, eq=False)
class _Part:
    """Costs of the moves that a node allows, and its limits on the number of routes."""

    cost: Floats
    fewest: int
    most: int


@dataclass(eq=False)
class _Solved:
    """The end of column generation, its ``status``: ``done``, ``enough`` (the prices prove enough), ``stopped`` or ``full``.

    ``bound`` and ``prices`` are the best Lagrangian bound by our own labels; ``values`` those of the routes in the linear program;
    ``lacking`` is how much of it no route makes up for.
    """

    status: str
    bound: float = -math.inf
    prices: Floats | None = None
    values: Floats = field(default_factory=lambda: np.zeros(0))
    lacking: float = 0.0


class _Tree(ProofTree[_Node]):
    """A tree over moves and numbers of routes."""

    def __init__(self, problem: RoutingProblem, arcs: Arcs, target: float | None, stop: Stop, seed: int) -> None:
        nodes = len(arcs.cost)
        super().__init__(problem, _Node(None, memory=min(MEMORY, nodes - 2)), target, stop)
        self.usable, self.seed = np.isfinite(arcs.cost), seed
        # Costs of about a thousand, as tolerances of linear programs ask for.
        self.unit = 2.0 ** (math.frexp(float(np.abs(arcs.cost[self.usable]).max(initial=1e-300)))[1] - 10)
        self.arcs = arcs = replace(arcs, cost=arcs.cost / self.unit)
        self.grain = grain(arcs.cost[self.usable] * self.unit)
        self.dearest = float(np.abs(arcs.cost[self.usable]).max(initial=0.0))
        self.index = {problem.sites.ids[site]: k for k, site in enumerate(arcs.customers.tolist(), start=1)}
        starts, ends = {v.start for v in problem.fleet}, {v.end for v in problem.fleet}
        self.ends = (problem.sites.ids[min(starts)], problem.sites.ids[min(ends)]) if len(starts) == len(ends) == 1 else None
        far = problem.travel.distances[np.ix_(arcs.customers, arcs.customers)]
        self.far = np.minimum(far, far.T)
        # Where nothing limits time, levels of it only keep labels apart that are alike.
        timed = np.isfinite(problem.sites.due[[*arcs.customers, *ends]]).any()
        kept = [r for name, r in arcs.resources.items() if name != "time" or timed] or [arcs.resources["time"]]

        def grid(weight: Floats) -> Floats:
            square = weight[:-1, :-1].copy()
            square[:, 0] = weight[:-1, -1]
            return np.where(self.usable, square, math.inf)

        self.weight = np.array([grid(r.weight) for r in kept])
        self.way = self.weight.copy()
        for k in range(1, nodes):
            np.minimum(self.way, self.way[:, :, k, None] + self.way[:, None, k], out=self.way)
        self.start = np.array([r.lower[0] for r in kept])
        self.lower = np.array([r.lower[:-1] for r in kept])
        self.upper = np.array([np.append(r.upper[-1], r.upper[1:-1]) + r.tolerance for r in kept])
        self.pool = Pool()
        self.finite = np.where(self.usable, arcs.cost, self.dearest)
        self.dear = 1.0
        self.master = self._new_master()
        self.phase_one: Master | None = None

    def _new_master(self) -> Master:
        lacking = self.dear * np.append(self.dearest, self.finite[0, 1:] + self.finite[1:, 0])
        return Master(self.pool, self.finite, np.maximum(lacking, 1e-3 * self.dear * self.dearest), self.seed)

    # -- nodes -------------------------------------------------------------------------------------------------------

    def _part(self, node: _Node) -> _Part:
        cost, fewest, most = self.arcs.cost.copy(), self.arcs.fewest, self.arcs.most
        for statement, holds in node.decisions():
            if "routes" in statement:
                fewest, most = (fewest, min(most, statement["routes"])) if holds else (max(fewest, statement["routes"] + 1), most)
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

    def _near(self, cost: Floats, memory: int) -> Flags:
        """The customers that each node remembers."""
        usable = np.isfinite(cost[1:, 1:])
        far = np.where(usable | usable.T, self.far, math.inf)
        np.fill_diagonal(far, -math.inf)
        near = np.zeros(cost.shape, dtype=bool)
        np.put_along_axis(near[1:, 1:], np.argsort(far, axis=1, kind="stable")[:, : memory + 1], True, axis=1)
        return near

    def look(self, node: _Node) -> bool:
        part, parent = self._part(node), node.parent
        if isinstance(parent, _Node):
            node.memory, node.prices = parent.memory, parent.prices
        problem = self.restricted(node)
        solved = self._solved(node, part)
        if solved.status == "stopped" and (parent is not None or solved.prices is None):
            return False
        self.begin(node)
        if part.fewest > part.most or len(self.usable) < 2:
            solved.prices = np.zeros(len(self.usable) - 1)
        if solved.prices is not None:
            self.prove(node, problem, [self._evidence(solved.prices, node.memory, ray=solved.bound == math.inf)])
            node.prices = solved.prices
        if self.reached(node.bound) or solved.status in ("full", "stopped"):
            self.close(node)
        else:
            self._keep(node, part, solved)
        return True

    def _keep(self, node: _Node, part: _Part, solved: _Solved) -> None:
        """Let a node wait for its branching, unless an answer proves it or nothing is left to branch on."""
        node.flow = self.pool.flow(solved.values, len(self.usable))
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
        self.target = min(self.target, judged.values[0])
        return same(node.bound, judged.values[0], judged.size, judged.precision)

    def _evidence(self, prices: Floats, memory: int, *, ray: bool = False) -> Evidence:
        data: dict[str, Any] = {"visits": by_site(self.problem, prices * self.unit), "memory": memory}  # type: ignore[arg-type]
        source = f"column generation, {memory} neighbours remembered"
        return Evidence("set-partitioning-duals", source, math.inf if ray else 0.0, {**data, "ray": True} if ray else data)

    # -- column generation -------------------------------------------------------------------------------------------

    def _solved(self, node: _Node, part: _Part) -> _Solved:
        """The linear program of a node; where no routes make up a solution, prices that prove it, and an infinite bound."""
        if part.fewest > part.most or len(part.cost) < 2:
            return _Solved("enough", math.inf)
        while True:
            solved = self._generated(self.master, node, part)
            if solved.status != "done":
                return solved
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
            twice = any(t and v > WHOLE for t, v in zip(self.pool.twice, solved.values.tolist(), strict=False))
            if not twice or node.memory >= len(part.cost) - 2:
                return solved
            before = node.memory
            node.memory = min(max(1, 2 * before), len(part.cost) - 2)
            node.prices = solved.prices
            more = self._generated(self.master, node, part)
            if more.status == "full" or (more.status == "stopped" and more.bound <= solved.bound):
                node.memory = before
                return replace(solved, status="stopped") if more.status == "stopped" else solved
            if more.status != "done" or more.lacking > WHOLE:
                return more

    def _generated(self, master: Master, node: _Node, part: _Part) -> _Solved:
        """Add routes until there are none of negative reduced cost, or enough is proved."""
        from .route_label_kernels import STOPPED

        near, usable = self._near(part.cost, node.memory), np.isfinite(part.cost)
        step = REDUCED * max(float(np.abs(part.cost[usable]).max(initial=0.0)), float(self.dearest if master is self.master else 1.0))
        self._restrict(master, part, near)
        memory, weight = _bits(near), np.where(usable, self.weight, math.inf)
        best = _Solved("stopped")
        centre: Floats | None = None if node.prices is None or master is not self.master else np.append(0.0, node.prices)

        def priced(duals: Floats, *, careful: bool, below: float) -> tuple[int, float, Floats, list[Longs]]:
            reduced = part.cost.copy()
            reduced[:, 1:] -= duals[1:]
            arrays = reduced, weight, self.way, self.start, self.lower, self.upper, memory
            return least_routes(self.stop, arrays, careful=careful, most=COLUMNS, below=below)

        careless = True
        while True:
            result = master.session.solve(self.stop)
            if result.status != "optimal" or len(self.pool.routes) > MOST_COLUMNS:
                best.status = "stopped" if self.stop.reached() else "full"
                return best
            duals = result.duals
            fresh: list[Longs] = []
            if careless:
                fresh = self.pool.new(priced(duals, careful=False, below=duals[0] - step)[-1])
                careless = bool(fresh)
            for mixed in () if fresh else (True, False):
                at = duals if centre is None or not mixed else SMOOTHING * centre + (1.0 - SMOOTHING) * duals
                if mixed and centre is None:
                    continue
                status, least, _, routes = priced(at, careful=True, below=at[0] - step if at is duals else math.inf)
                if status != 0:
                    best.status = "stopped" if status == STOPPED else "full"
                    return best
                bound = math.fsum(at[1:]) + min(part.fewest * least, part.most * least)
                if best.prices is None or bound > best.bound:
                    best.bound, best.prices, centre = bound, at[1:].copy(), at.copy()
                    best.prices.setflags(write=False)
                if self._enough(master, best.bound):
                    best.status = "enough"
                    if master is not self.master:
                        best.values = np.zeros(0)
                    return best
                fresh = self.pool.new([r for r in routes if self._reduced(part.cost, r, duals) < -step])
                if fresh:
                    careless = True
                    break
            if not fresh:
                best.status, best.values = "done", result.x[master.own :]
                best.lacking = float(result.x[: master.own - 1].sum())
                return best
            self.pool.add(fresh)
            master.refresh()

    def _restrict(self, master: Master, part: _Part, near: Flags) -> None:
        """Have a master program choose among the routes that a node allows."""
        shut = self.pool.sums(np.where(np.isfinite(part.cost), 0.0, 1.0)) > 0
        master.refresh()
        master.restrict(shut | self.pool.forgetful(near), part.fewest, part.most)

    def _enough(self, master: Master, bound: float) -> bool:
        if master is not self.master:
            return bound > WHOLE
        return self.reached(lift(bound * self.unit, "min", self.grain))

    @staticmethod
    def _reduced(cost: Floats, route: Longs, duals: Floats) -> float:
        stops = np.concatenate([[0], route, [0]])
        return float(cost[stops[:-1], stops[1:]].sum() - duals[route].sum() - duals[0])

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
        return self._move(*fractional[int(np.argmax(gains))])

    def _gain(self, node: _Node, pair: tuple[int, int]) -> float:
        """Product of what the linear program over the routes at hand gains on both sides of a move."""
        statement, least = self._move(*pair), LEAST_GAIN * self.dearest
        product = 1.0
        for holds in (True, False):
            if self.stop.reached():
                return 0.0
            part = self._part(_Node(node, (statement, holds)))
            self._restrict(self.master, part, self._near(part.cost, node.memory))
            result = self.master.session.solve(self.stop)
            product *= max(least, result.value - node.bound / self.unit if result.status == "optimal" else 0.0)
        return product

    def _move(self, i: int, j: int) -> dict[str, Any]:
        ids, customers = self.problem.sites.ids, self.arcs.customers  # type: ignore[attr-defined]
        first, last = self.ends or ("", "")
        return {"arc": [ids[customers[i - 1]] if i else first, ids[customers[j - 1]] if j else last]}


def _bits(near: Flags) -> NDArray[np.uint64]:
    """Rows of flags over nodes 1, 2, ... as bits."""
    bits = np.zeros((len(near), (len(near) + 62) // 64), np.uint64)
    for i, j in np.argwhere(near).tolist():
        bits[i, (j - 1) // 64] |= np.uint64(1 << ((j - 1) % 64))
    return bits


def column_generation_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """Evidence from branch and price: a branching tree, or ``set-partitioning-duals`` where no branching was needed.

    The tree ends where its bound reaches ``target``, the value of an answer; better answers that it meets on the way take its place. The
    linear programs are solved by HiGHS, whoever solves others, and go on from where the last one ended. None where the routes at the root
    were too many for the memory or the time.

    Source: Desrochers, Desrosiers, Solomon (1992); Barnhart, Johnson, Nemhauser, Savelsbergh, Vance (1998), "Branch-and-price".
    """
    if stop.reached() or not 0 < len(problem.customers) <= CUSTOMERS:
        return None
    arcs = arc_costs(problem, stop)
    if arcs is None or len(arcs.customers) == 0:
        return None
    tree = _Tree(problem, arcs, target, stop, 1 if linear is None else linear.seed)
    tree.grow()
    return tree.evidence("routes")


def least_routes(
    stop: Stop, arrays: tuple[NDArray[Any], ...], *, careful: bool, most: int, below: float
) -> tuple[int, float, Floats, list[Longs]]:
    """Result of ``cheapest_routes`` for ``arrays``, with the customers of the ``most`` cheapest routes, cheapest first."""
    from .route_label_kernels import cheapest_routes

    status, least, totals, ends, at, parent = cheapest_routes(stop.flag, *arrays, careful, LABELS, below)
    order = np.argsort(totals, kind="stable")[:most]
    here, steps = ends[order], []
    while (here >= 0).any():  # from the ends of all routes towards the depot
        steps.append(np.where(here >= 0, at[here], 0))
        here = np.where(here >= 0, parent[here], -1)
    visits = np.array(steps[::-1], dtype=np.int64).reshape(len(steps), len(order)).T
    return status, least, totals[order], [row[row > 0] for row in visits]


KERNELS = ("waybound.solvers.bounds.routing.route_label_kernels", "waybound.formulations.routing.checking.walk_kernels")

BOUNDS.add(
    "column-generation",
    BoundMethod("column-generation", of_family("routing", lacks_arc_costs), column_generation_bound, order=8, aims=True, kernels=KERNELS),
)
