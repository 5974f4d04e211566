"""All routes that a better answer can have, where they are few: a program of its own over them, with a tree that proves it.

docs/branch-price-cut.md#all-routes
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ..proof_tree import Node, ProofTree
from .arcs import Floats, Integers, by_site
from .column_generation import ColumnGeneration, Part, Solved
from .load_cuts import LoadCut
from .restricted_master import Master, Point, Pool, Prices
from .route_levels import DONE, WORD
from .route_rows import RouteLoad, RouteRow, violated_rows, visited
from .subset_rows import SubsetRow

LABELS, ROUTES = 1_000_000, 50_000
"""Most labels and routes; with more nothing is listed."""

LABEL = 150
"""Bytes of a label, beside its rows."""

ADDED = 300
"""Most routes that are added to the linear program at once."""

ROUNDS, WORTH = 3, 0.04
"""Rows are added until so many rounds together close less than this share of the gap."""

CANDIDATES = 6
"""Pairs of customers that are tried before one is branched on."""

NODES = 3_000
"""Most nodes; beyond, the tree is given up."""

WHOLE = 1e-6
"""Distance to a whole number up to which a value counts as one."""

FACTOR = 2.0
"""Price of a visit that no route makes, as a multiple of the best value."""


def routes_below(columns: ColumnGeneration, part: Part, solved: Solved, gap: float, most: int = ROUTES) -> Pool | None:
    """The cheapest route through each set of customers, where its reduced cost is less than ``gap`` above the least; None where there are
    more than ``most``, or there was no time."""
    from .enumeration_kernels import all_below

    prices, (pricer,) = solved.prices, columns.pricers
    assert prices is not None
    rows, loads = columns.row_cuts, [cut for cut in prices.cuts if isinstance(cut, LoadCut)]
    words = (len(rows) + len(loads)) // WORD + 2
    room = int(min(LABELS, columns.shares.routes / 2.0 / (LABEL + 8 * words)))  # the share of labels is taken by those from both ends
    if pricer.backwards(columns.stop, columns.reduced_costs(part, prices)[0], prices.of(rows)) != DONE:
        return None
    ahead, back = pricer.ends
    unit, nodes = pricer.unit, pricer.nodes
    paid = np.floor(part.cost[0][ahead.tails, ahead.heads] * unit).astype(np.int64)
    worth = np.rint(prices.visits * unit).astype(np.int64)
    row_members = [list(cut.customers) for cut in rows]
    load_members = [np.nonzero(cut.inside)[0].tolist() for cut in loads]
    fines, gains = (np.rint(np.abs(prices.of(cuts)) * unit).astype(np.int64) for cuts in (rows, loads))
    node, parent, ended, total = np.empty(room, np.int32), np.empty(room, np.int32), np.empty(most, np.int32), np.empty(most, np.int64)
    keys = np.random.default_rng(1).integers(1 << 62, size=nodes)
    below = pricer.bar(float(solved.least[0]) + gap + columns.step)
    status, number = all_below(
        columns.stop.flag, ahead.arcs, ahead.heads, paid, ahead.arc_weight, worth, _bits(row_members, nodes), _by_bit(fines),
        _bits(load_members, nodes), _by_bit(gains), ahead.lower, ahead.upper, ahead.above, pricer.members, back.rows, back.after,
        back.chains, back.cheapest, back.lower, back.upper, pricer.top, ahead.start, keys, below, node, parent, ended, total,
    )  # fmt: skip
    if status != DONE:
        return None
    pool, drives = Pool(), []
    for label in ended[:number].tolist():
        visits = []
        while label > 0:
            visits.append(node[label])
            label = parent[label]
        drives.append((0, np.array(visits[::-1], dtype=np.int64)))
    pool.add(drives)
    return pool


def _bits(members: Sequence[list[int]], nodes: int) -> Integers:
    """The sets that each node belongs to, as bits, shape (nodes, words)."""
    bits = np.zeros((nodes, -(-len(members) // WORD)), np.int64)
    for c, inside in enumerate(members):
        bits[inside, c // WORD] |= 1 << (c % WORD)
    return bits


def _by_bit(values: Integers) -> Integers:
    padded = np.zeros((-(-len(values) // WORD), WORD), np.int64)
    padded.flat[: len(values)] = values
    return padded


@dataclass(eq=False)
class _Case(Node):
    """A node, its routes as positions ``at`` in all, its linear program's ``prices`` and the ``used`` routes with their ``values``."""

    at: Integers = field(default_factory=lambda: np.zeros(0, np.int64))
    prices: Prices | None = None
    used: Integers = field(default_factory=lambda: np.zeros(0, np.int64))
    values: Floats = field(default_factory=lambda: np.zeros(0))


class ChoiceTree(ProofTree[_Case]):
    """A tree over all routes that a better answer can have; branchings are on two customers being on one route (Ryan, Foster 1981).

    It begins with the rows and loads that have prices in ``solved``. ``every`` has each set of customers once, ``goal`` is the value to be
    proved, in units of costs, lower once a better answer is known, and ``on_answer`` hears of whole choices.
    """

    def __init__(
        self, columns: ColumnGeneration, part: Part, solved: Solved, every: Pool, goal: Callable[[], float], stop: Stop,
        on_answer: Callable[[Routes], object],
    ) -> None:  # fmt: skip
        from scipy import sparse

        super().__init__(columns.problem, _Case(None), goal(), stop, 1.0)
        self.columns, self.part, self.every, self.goal, self.on_answer = columns, part, every, goal, on_answer
        self.partition, nodes = columns.partition, len(columns.partition.row)
        self.cost = every.sums(columns.cost[0])
        self.visits = visited(every, 0, nodes)
        self.table = sparse.csr_array(self.visits, dtype=np.float64)
        self.some, self.inside, self.of = Pool(), np.zeros(len(every), bool), np.zeros(0, np.int64)
        lacking = np.full(nodes, FACTOR * abs(self.target) + columns.dearest)
        self.master = Master(self.some, columns.finite, self.partition.row, lacking, [len(self.partition.row)], columns.seed)
        self.counted: dict[int, Floats] = {}
        assert solved.prices is not None
        rows = [RouteRow(cut.customers) for cut in solved.prices.cuts if isinstance(cut, SubsetRow)]
        loads = [RouteLoad(tuple(np.nonzero(cut.inside)[0].tolist()), cut.right) for cut in solved.prices.cuts if isinstance(cut, LoadCut)]
        self._add([*rows, *loads])

    def _add(self, cuts: Sequence[RouteRow | RouteLoad]) -> None:
        self.counted.update((id(cut), cut.counted(self.visits)) for cut in cuts)
        self.master.cut(cuts)

    @property
    def full(self) -> bool:
        return len(self.nodes) > NODES

    def look(self, node: _Case) -> bool:
        self.begin(node)
        parent = node.parent
        node.at = np.arange(len(self.every)) if not isinstance(parent, _Case) else self._left(parent.at, node)
        if not len(node.at):  # no route is left
            node.bound = max(node.bound, self.target)
            self.close(node)
            return True
        bounds = list[float]()
        while True:
            found = self._solved(node.at)
            if found is None:
                return False
            point, bound, reduced, least = found
            if bound > node.own:
                node.own, node.prices, kept = bound, point.prices, reduced < self.target - bound + least + self.columns.step
                node.bound = max(node.bound, bound)
            self._whole(point)
            if self.reached(node.bound):
                self.close(node)
                return True
            bounds.append(bound)
            slow = len(bounds) > ROUNDS and bounds[-1] - bounds[-1 - ROUNDS] < WORTH * (self.target - bound)
            if slow or not self._cut(point):
                break
        used = np.nonzero(point.values > WHOLE)[0]
        node.at, node.used, node.values = node.at[kept], self.of[used], point.values[used]
        if parent is None:
            self._forget(node)
        if self._pairs(node):
            self.wait(node)
        else:
            self.close(node)
        return True

    def reached(self, bound: float) -> bool:
        return bound >= self.target

    def release(self, node: _Case) -> None:
        node.at = node.used = np.zeros(0, np.int64)

    def _left(self, at: Integers, node: _Case) -> Integers:
        """The routes of a node above that a decision leaves."""
        assert node.decision is not None
        (i, j), together = node.decision
        one, other = self.visits[at, i], self.visits[at, j]
        kept: Integers = at[one == other if together else ~(one & other)]
        return kept

    # -- the linear program --------------------------------------------------------------------------------------------

    def _shut(self, at: Integers) -> None:
        allowed = np.zeros(len(self.every), bool)
        allowed[at] = True
        optional = np.zeros(len(self.partition.optional), bool)
        self.master.restrict(~allowed[self.of], self.part.fewest, self.part.most, optional)

    def _solved(self, at: Integers) -> tuple[Point, float, Floats, float] | None:
        """The linear program over routes ``at``, its bound, their reduced costs and the least of these; None where there was no time."""
        self._shut(at)
        while True:
            point = self.master.solve(self.stop)
            if point.status != "optimal":
                return None
            prices = point.prices
            assert prices is not None
            reduced = self.cost[at] - (self.table @ prices.visits)[at]
            for cut, price in prices.cuts.items():
                reduced -= price * self.counted[id(cut)][at]
            least, per_route = float(reduced.min()), float(prices.routes[0])
            new = np.nonzero((reduced < per_route - self.columns.step) & ~self.inside[at])[0]
            if not len(new):
                break
            self._take(at[new[np.argsort(reduced[new], kind="stable")[:ADDED]]])
        parts = [self.columns.constant, *prices.visits[1:].tolist(), *(price * cut.right for cut, price in prices.cuts.items())]
        number = self.part.most if least < 0.0 else self.part.fewest
        return point, math.fsum(parts) + number * least, reduced, least

    def _take(self, new: Integers) -> None:
        self.some.add(self.every.drives(new))
        self.inside[new] = True
        self.of = np.concatenate([self.of, new])
        self.master.refresh()

    def _forget(self, node: _Case) -> None:
        """Drop the rows that have no price at a node, and the routes that it leaves out."""
        assert node.prices is not None
        self.master.drop([cut for cut in self.master.cuts if cut not in node.prices.cuts])
        kept = np.isin(self.of, node.at)
        self.inside[self.of[~kept]] = False
        self.of = self.of[kept]
        self.master.keep(kept)

    def _cut(self, point: Point) -> bool:
        """Add rows that the point violates; whether there were any."""
        used = np.nonzero(point.values > WHOLE)[0]
        known = {cut.key for cut in self.master.cuts if isinstance(cut, RouteRow)}
        cuts = violated_rows(self.visits[self.of[used]].T, point.values[used], known)
        self._add(cuts)
        return bool(cuts)

    def _whole(self, point: Point) -> None:
        """Tell of a whole choice."""
        used = np.nonzero(point.values > WHOLE)[0]
        if point.lacking <= WHOLE and (point.values[used] > 1.0 - WHOLE).all():
            self.on_answer(self.partition.routes(self.every.drives(self.of[used])))
            self.target = self.goal()

    # -- branching -----------------------------------------------------------------------------------------------------

    def _pairs(self, node: _Case) -> list[tuple[int, int]]:
        """Customers who are on one route in part, the pairs that are nearest to a half first."""
        visits = self.visits[node.used].T.astype(np.float64)
        together = np.triu((visits * node.values) @ visits.T, 1)
        off = np.abs(together - 0.5)
        pairs = np.argwhere(off < 0.5 - WHOLE)
        order = np.argsort(off[pairs[:, 0], pairs[:, 1]], kind="stable")
        return [(int(i), int(j)) for i, j in pairs[order[:CANDIDATES]]]

    def branch(self, node: _Case) -> bool:
        pairs = self._pairs(node)
        gains = [self._gain(node, pair) for pair in pairs] if len(pairs) > 1 else [1.0]
        pair = pairs[int(np.argmax(gains))]
        return self.divide(node, pair)

    def _gain(self, node: _Case, pair: tuple[int, int]) -> float:
        """Product of what the linear program over the routes at hand gains on both sides."""
        product = 1.0
        for holds in (True, False):
            self._shut(self._left(node.at, _Case(node, (pair, holds))))
            value = self.master.solve(self.stop).value + self.columns.constant
            product *= max(1e-6 * self.columns.dearest, 0.0 if math.isnan(value) else min(value, self.target) - node.own)
        return product

    # -- evidence ------------------------------------------------------------------------------------------------------

    def listed(self) -> list[dict[str, Any]]:
        """The nodes as evidence has them."""
        sites, unit, nodes, waiting = self.partition.customers, self.columns.unit, list[dict[str, Any]](), [self.root]

        def at(members: Sequence[int]) -> list[int]:
            return list(sites[np.array(members) - 1].tolist())

        while waiting:
            node, entry = waiting.pop(), dict[str, Any]()
            if node.prices is not None:
                entry["visits"] = by_site(self.columns.problem, node.prices.visits[1:] * unit)
                rows, loads = list[dict[str, Any]](), list[dict[str, Any]]()
                for cut, price in node.prices.cuts.items():
                    if isinstance(cut, RouteRow):
                        rows.append({"sites": at(cut.customers), "price": price * unit})
                        if cut.parts != 2:
                            rows[-1] |= {"weights": list(cut.weights), "parts": cut.parts}
                    elif isinstance(cut, RouteLoad):
                        loads.append({"sites": at(cut.customers), "price": price * unit})
                entry |= {key: listed for key, listed in (("rows", rows), ("loads", loads)) if listed}
            if node.children:
                decision = node.children[0].decision
                assert decision is not None
                entry["branch"] = at(decision[0])
                waiting.extend(child for child in node.children[::-1] if isinstance(child, _Case))
            nodes.append(entry)
        return nodes
