"""Bound ``branch-price-cut``: branch and price with cuts, for routes whose limits and costs add up along them.

The best prices of a node's linear program are its evidence; the checker goes through them with labels of its own. Subset-row and capacity
cuts are added while they help. Moves that no better answer can make are left out by a branching of their own. Else branchings are on the
number of routes, then on visits, on the types of vehicle that make them, and on single moves. docs/branch-price-cut.md
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ....formulations.checking.granularity import grain, lift
from ....formulations.evaluation import Evaluation
from ....formulations.evidence import Evidence
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.stop import NEVER, Stop
from ....formulations.tolerance import same
from ....instances.errors import InputError
from ...linear_programs import LinearPrograms
from ..proof_tree import ROOT, Node, ProofTree
from .arcs import Flags, Floats, by_site
from .column_generation import WHOLE, ColumnGeneration, Part, Solved
from .enumerated_routes import ROUTES, ChoiceTree, routes_below
from .first_answer import RUINS, first_answer
from .load_cuts import LoadCut
from .memory_shares import NUMBER
from .move_rows import MoveRow
from .restricted_master import Prices
from .routes_at_hand import best_choice
from .set_partition import SetPartition, set_partition
from .subset_rows import SubsetRow

CUSTOMERS = 400
"""Most customers; the shortest ways between all of them are looked for again at each node."""

OPENING = 0.1
"""Share of the time for a first answer at most, where none is given."""

AGAIN, DOUBTFUL = 10, 0.006
"""Factor on the ruins of another search for an answer, and the part of its value that must still be open for that after some cuts."""

CHOICES, CHOOSING = 16, 0.05
"""Nodes after which an answer is looked for among the routes at hand, as it is at the root, and again when there are twice as many; and the
share of the time for it at most."""

SHARED = 0.4
"""Share of the time for several types of vehicle, or sites that may be left out, after which other methods have their turn."""

ROUNDS, WORTH = 4, 0.03
"""Cuts are added until so many rounds together close less than this share of the gap; one round where something was branched on."""

SMALLER, MANY = 0.6, 0.02
"""Moves that no better answer makes are looked for each time the gap has become so much smaller, and left out where they are more than a
share of all."""

WIDEST, NARROWER = 0.02, 0.7
"""Part of the best value that may be open for all routes of a better answer to be listed, and how much smaller the gap is to be before
that is tried again."""

CHOOSING = 0.2
"""Part of the time that is left in which the choice among all these routes is to be proved."""

CANDIDATES, PRICED = 20, 3
"""Statements that are tried over the routes at hand before one is branched on, and those of them that are tried with further routes too."""

CLAIM = 1e-8
"""Part of the largest cost of a move by which more is claimed of the cheapest route than labels in rounded numbers found. The checker looks
at whatever costs less."""

FOLLOWED = (12, 8, 4, 2)
"""How many are remembered at each customer where the checker cannot follow with more; then neither can it at the next node."""

ATTEMPT = 0.3
"""Share of the time that is left in which the checker is to follow, before it is given fewer."""

EARLY, LONG = 0.8, 10_000_000
"""Share of the time, and number of labels: a first linear program that ends when less time is left, or after more labels, is proved at
once, as others may not end."""

LEAST_GAIN = 1e-6
"""Least gain of a branching in a product of two gains, as a part of the largest cost of a move."""


@dataclass(eq=False)
class _Node(Node):
    """A node and its linear relaxation: ``prices`` of its best bound, where its children begin; ``flow``, shape (types, nodes, nodes), how
    often vehicles of each type make each move in its linear program, and its ``value``; the ``gap`` at which hopeless moves were last
    looked for, and ``listed``, at which all routes of a better answer were; ``chosen`` is the proof over these; ``rest``: it only leaves
    out moves."""

    prices: Prices | None = None
    flow: Floats | None = None
    value: float = -math.inf
    gap: float = math.inf
    listed: float = math.inf
    chosen: Evidence | None = None
    rest: bool = False

    @property
    def first(self) -> bool:
        """Whether it is the root, but for moves that were left out."""
        return all(node.rest for node in self.above())


class Tree(ProofTree[_Node]):
    """A tree over moves and numbers of routes.

    ``answer`` is the best answer so far; ``most`` are those of ``ColumnGeneration``, and ``enumeration``, the most routes that are
    listed; ``on_answer`` hears of better answers, ``on_step``
    of the bound after some work, ``gap`` is the part of the target that may stay open, and ``share`` that of the time for the root.
    """

    def __init__(
        self, problem: RoutingProblem, partition: SetPartition, target: float | None, stop: Stop, seed: int, *,
        answer: Routes | None = None, most: Mapping[str, Any] | None = None, gap: float = 0.0, share: float = ROOT,
        on_answer: Callable[[Routes, float], None] = lambda answer, value: None, on_step: Callable[[float], None] = lambda bound: None,
    ) -> None:  # fmt: skip
        super().__init__(problem, _Node(None), target, stop, share)
        self.routing, self.partition, self.customers, self.seed = problem, partition, partition.customers, seed
        self.answer, self.on_answer, self.on_step, self.gap, self.whole = answer, on_answer, on_step, gap, stop
        self.time = stop.seconds_left
        costs = partition.cost
        self.grain = grain(np.append(costs[np.isfinite(costs)], partition.constant))
        self.columns = ColumnGeneration(problem, partition, stop, self._enough, seed, most)
        self.cost, self.unit = self.columns.cost, self.columns.unit
        self.fixing, self.rounds, self.choosing, self.remembered = True, 0, CHOICES, len(partition.row)
        self.looked_again = False
        self.most_listed = (most or {}).get("enumeration", ROUTES) if self.columns.shares.listing else 0
        self.branched: list[MoveRow] = []
        ids = problem.sites.ids
        self.starts, self.ends = sorted({ids[v.start] for v in problem.fleet}), sorted({ids[v.end] for v in problem.fleet})
        self.one_depot = len(self.starts) == len(self.ends) == 1
        self.ids = ["", *(ids[site] for site in self.customers.tolist())]
        self.index = {site: node for node, site in enumerate(self.ids) if node}
        if answer is not None:
            self.columns.add(answer)

    def reached(self, bound: float) -> bool:
        return super().reached(bound) or bound >= self.target - self.gap * abs(self.target)

    @property
    def full(self) -> bool:
        if super().full or NUMBER * self.numbers + 8 * self.cost.size * len(self.open) > self.columns.shares.tree:
            self.columns.limit = "memory"
            return True
        return False

    def _enough(self, bound: float) -> bool:
        return self.reached(lift(bound * self.unit, "min", self.grain))

    def counts(self) -> dict[str, int]:
        """Routes, cuts and labels, for statistics."""
        return {"columns": len(self.columns.pool), "cuts": len(self.columns.master.cuts), "labels": self.columns.labels}

    # -- nodes -------------------------------------------------------------------------------------------------------

    def _part(self, node: _Node) -> Part:
        cost, fewest, most = self.cost.copy(), self.partition.fewest, self.partition.most
        row, left_out, rows = self.partition.row, self.partition.optional.copy(), list[MoveRow]()

        def visited(i: int) -> None:
            left_out[row[i]] = False
            others = (row == row[i]) & (np.arange(len(row)) != i)
            cost[:, others] = cost[:, :, others] = math.inf

        for statement, holds in node.decisions():
            if "routes" in statement:
                fewest, most = (fewest, min(most, statement["routes"])) if holds else (max(fewest, statement["routes"] + 1), most)
            elif "moves" in statement and holds:
                rows.append(MoveRow.of(statement["moves"], self._among(statement["moves"])))
            elif "moves" in statement:
                cost[:, self._among(statement["moves"])] = math.inf
            elif "visited" in statement:
                i, by = self.index[statement["visited"]], statement.get("by")
                if holds:
                    visited(i)
                if by is not None or not holds:
                    named = np.array([by is None or any(vehicle in by for vehicle, _ in one.vehicles) for one in self.partition.types])
                    barred = named != holds
                    cost[barred, i] = math.inf
                    cost[barred, :, i] = math.inf
            else:
                i, j = (self.index.get(site, 0) for site in statement["arc"])
                if not holds:
                    cost[:, i, j] = math.inf
                    continue
                kept = cost[:, i, j].copy()
                for k in (i, j):
                    if k:
                        visited(k)
                if i:
                    cost[:, i] = math.inf
                if j:
                    cost[:, :, j] = math.inf
                cost[:, i, j] = kept
        return Part(cost, fewest, most, left_out, rows)

    def _among(self, moves: Mapping[str, list[str]]) -> Flags:
        """Moves of a statement, shape (nodes, nodes)."""
        among = np.zeros(self.cost.shape[1:], dtype=bool)
        for tail, heads in moves.items():
            among[self.index.get(tail, 0), [self.index.get(head, 0) for head in heads]] = True
        return among

    def look(self, node: _Node) -> bool:
        part, parent, first = self._part(node), node.parent, node.first
        if isinstance(parent, _Node):
            node.prices, node.gap, node.listed = parent.prices, parent.gap, parent.listed
        solved, hopeless = self._solved(node, part)
        if solved.status == "stopped" and (not first or solved.prices is None):
            return False
        self.begin(node)
        if hopeless is not None:
            if node is self.root:
                self._prove(node, solved)
            left_out = self._without(node, solved, *hopeless)
            if left_out or (left_out is None and not first):
                return bool(left_out)
            # The checker did not follow, or there was no time for the rest: then what was proved of all moves counts.
            self.fixing = False
            again, _ = self._solved(node, part)
            if again.prices is None and not first:
                return False
            solved = solved if again.prices is None else again
        node.prices = solved.prices or node.prices
        if solved.prices is not None:
            self._prove(node, solved)
        if node.chosen is not None and not self.reached(node.bound):
            self._prove_by(node, node.chosen)
        if self.reached(node.bound) or solved.status in ("full", "flooded", "stopped"):
            self.close(node)
        else:
            self._keep(node, part, solved)
        return True

    def _solved(self, node: _Node, part: Part) -> tuple[Solved, tuple[Flags, float] | None]:
        """The linear program of a node with its cuts, or its end before them with moves that no better answer makes."""
        if part.fewest > part.most:
            none = Prices(np.zeros(len(part.cost)), np.zeros(part.cost.shape[1]), {})
            return Solved("enough", math.inf, none, near=self.columns.near), None
        columns = self.columns
        columns.stop = self.stop
        best, bounds, rows = Solved("stopped"), list[float](), not node.first

        def early(solved: Solved) -> None:
            late = self.whole.seconds_left < EARLY * self.time
            if node is self.root and node.evidence is None and (late or columns.labels > LONG):
                self._prove(node, solved)
            if node is self.root and late:
                self._look_again(solved.bound)

        while True:
            solved = columns.solve(part, node.prices, early)
            if solved.status == "flooded" and columns.weaken():
                continue
            if solved.status != "done" or solved.lacking > WHOLE:
                return (solved if solved.status == "enough" or best.prices is None else best), None
            node.prices = solved.prices
            best = solved if solved.bound >= best.bound else best
            self.on_step(-math.inf)
            hopeless = self._hopeless(node, part, solved)
            if hopeless is not None:
                return solved, hopeless
            if self._over_all(node, part, solved):
                return solved, None
            columns.purge(self.target / self.unit - solved.bound)
            bounds.append(solved.bound)
            self.rounds += node.first
            if self.rounds == ROUNDS and node.first:
                self._look_again(solved.bound)
            goal = self.target / self.unit if math.isfinite(self.target) else 2.0 * bounds[-1] - bounds[0]
            rounds = ROUNDS if node.first else 1
            slow = len(bounds) > rounds and bounds[-1] - bounds[-1 - rounds] < WORTH * (goal - bounds[-1])
            if slow and rows:
                return solved, None
            if slow:  # capacities are done with
                rows, bounds = True, bounds[-1:]
            found = columns.cut(solved, rows=rows)
            if not found and rows:
                return solved, None
            if not found:
                rows, bounds = True, bounds[-1:]

    def _hopeless(self, node: _Node, part: Part, solved: Solved) -> tuple[Flags, float] | None:
        """Moves that no better answer makes, if there are many since the gap was last so much larger, and by how much more than the
        cheapest route one over them costs."""
        gap = self.target / self.unit - solved.bound
        if not self.fixing or not gap < SMALLER * node.gap:
            return None
        node.gap, gap = gap, self._goal() - solved.bound
        hopeless = self.columns.hopeless(part, solved, gap)
        if hopeless is not None and self.partition.symmetric:
            hopeless &= hopeless.T
        many = MANY * np.isfinite(part.cost).any(axis=0).sum()
        return (hopeless, gap + 0.5 * self.columns.step) if hopeless is not None and hopeless.sum() > many else None

    def _goal(self) -> float:
        """The bound to be proved, in units: as values are multiples of the grain, more than the last one before the target will do."""
        below = 0.0 if self.grain is None else self.grain.size * (1.0 - 1e-4)
        return (self.target - below) / self.unit

    def _over_all(self, node: _Node, part: Part, solved: Solved) -> bool:
        """List all routes of a better answer, where the gap is small, and choose among them; whether that proves the node."""
        gap = self._goal() - solved.bound
        if (
            not (self.most_listed and self.partition.merged)
            or part.rows
            or not gap < min(NARROWER * node.listed, WIDEST * abs(self.target) / self.unit)
        ):
            return False
        node.listed = gap
        every = routes_below(self.columns, part, solved, gap, self.most_listed)
        if every is None or not len(every):
            return False

        def told(answer: Routes) -> None:
            self._judged(answer)

        stop = self.stop.within(CHOOSING * self.stop.seconds_left)
        choice = ChoiceTree(self.columns, part, solved, every, self._goal, stop, told)
        choice.grow()
        if choice.bound < choice.target:
            return False
        prices = self._evidence(solved, None).data
        data = {"goal": self._goal() * self.unit, "prices": prices, "nodes": choice.listed()}
        node.chosen = Evidence("enumerated-routes", f"{len(every)} routes, {len(choice.nodes)} cases", choice.bound * self.unit, data)
        return True

    def _without(self, node: _Node, solved: Solved, hopeless: Flags, more: float) -> bool | None:
        """Leave moves out over which routes cost ``more`` than the cheapest: a branching of which one side is proved at once.

        Whether it was; None where there was no time for the other side.
        """
        moves = {}
        for i, row in enumerate(hopeless):
            heads = [site for j in np.nonzero(row)[0].tolist() for site in (self.ids[j : j + 1] if j else self.ends)]
            moves.update({site: heads for site in (self.ids[i : i + 1] if i else self.starts) if heads})
        used, rest = _Node(node, ({"moves": moves}, True)), _Node(node, ({"moves": moves}, False), rest=True)
        self.begin(used)
        self._prove(used, solved, more)
        if not self.reached(used.bound):
            self.nodes.remove(used)
            return False
        if not self.look(rest):
            return None
        self.close(used)
        node.children = used, rest
        return True

    def _keep(self, node: _Node, part: Part, solved: Solved) -> None:
        """Let a node wait for its branching, unless an answer proves it or nothing is left to branch on."""
        node.flow, node.value = solved.routes.flow(solved.values, part.cost.shape), solved.bound
        whole = np.abs(solved.values - np.round(solved.values)) <= WHOLE
        if node.first or len(self.nodes) >= self.choosing:
            self.choosing = max(self.choosing, 2 * len(self.nodes))
            self._choose(solved)
        if (whole.all() and self._is_best(node, solved)) or self.reached(node.bound) or self._statement(node, part) is None:
            self.close(node)
        else:
            self.wait(node)

    def release(self, node: _Node) -> None:
        node.flow = node.prices = None

    # -- answers -----------------------------------------------------------------------------------------------------

    def _is_best(self, node: _Node, solved: Solved) -> bool:
        """Whether whole routes are an answer that meets the node's bound."""
        judged = self._judged(self.partition.routes(solved.routes.drives(np.nonzero(solved.values > 0.5)[0])))
        return judged is not None and same(node.bound, self.sign * judged.values[0], judged.size, judged.precision)

    def _judged(self, answer: Routes) -> Evaluation | None:
        """The values of an answer, if it keeps all limits; one that is better than the answer at hand takes its place."""
        try:
            judged = self.routing.evaluate(answer)
        except InputError:
            return None
        if not judged.feasible:
            return None
        if self.sign * judged.values[0] < self.target:
            self.target, self.answer = self.sign * judged.values[0], answer
            self.on_answer(answer, judged.values[0])
        return judged

    def _look_again(self, bound: float) -> None:
        """Look for a better answer, once, where the one at hand is far from a bound."""
        if self.looked_again or self.answer is None or self.target - bound * self.unit <= DOUBTFUL * abs(self.target):
            return
        self.looked_again = True
        seconds = 2.0 * OPENING * self.whole.seconds_left
        answer = first_answer(self.routing, seconds, self.seed + 1, self.stop, ruins=AGAIN * RUINS)
        if answer is not None:
            self.columns.add(answer)
            self._judged(answer)

    def _choose(self, solved: Solved) -> None:
        """Look for a better answer among the routes at hand."""
        gap = self.target / self.unit - solved.bound + self.columns.step
        seconds = CHOOSING * self.whole.seconds_left
        answer = best_choice(self.columns.pool, self.partition, self.columns.point.reduced, gap, seconds, self.whole)
        if answer is not None:
            self._judged(answer)

    # -- evidence ----------------------------------------------------------------------------------------------------

    def _prove(self, node: _Node, solved: Solved, more: float | None = None) -> None:
        """Prove a node by the prices of its best bound, with as many remembered as the checker can follow."""
        evidence = self._evidence(solved, more)
        first = min(self.remembered, max(map(len, evidence.data["remembered"])) - 1)
        fewer = [k for k in FOLLOWED if k < first]
        for most in (first, *fewer):
            share = ATTEMPT if fewer and most > fewer[-1] else 1.0
            if self._prove_by(node, self._remembering(evidence, most), share) > -math.inf:
                self.remembered = self.remembered if most == first else most
                return
            if self.whole.reached():
                return
        if "ray" not in evidence.data:  # which may also fail because it proves nothing
            self.remembered = min(self.remembered, FOLLOWED[-1])

    def _remembering(self, evidence: Evidence, most: int) -> Evidence:
        """The same prices with at most so many remembered at each customer beside himself, the nearest."""
        lists = evidence.data["remembered"]
        if max(map(len, lists)) <= most + 1:
            return evidence
        far = self.routing.travel.distances
        far = np.minimum(far, far.T)
        nearest = [[sites[k] for k in np.argsort(far[here, sites], kind="stable")[: most + 1]] for here, sites in enumerate(lists)]
        return replace(evidence, data={**evidence.data, "remembered": nearest})

    def _prove_by(self, node: _Node, evidence: Evidence, share: float = 1.0) -> float:
        """Prove a node in a share of what is left of all the time; returns what the evidence proves."""
        stop, self.stop = self.stop, self.whole.within(share * self.whole.seconds_left)
        bound = self.prove(node, self.restricted(node), [evidence])
        self.stop = stop
        return bound

    def _evidence(self, solved: Solved, more: float | None) -> Evidence:
        """The prices, and what they are said to prove of the cheapest route, and of those that make a needed move and cost ``more``."""
        prices, sites = solved.prices, self.customers
        assert prices is not None
        remembered: list[list[int]] = [[] for _ in self.routing.sites.ids]
        for node, site in enumerate(sites.tolist(), start=1):
            remembered[site] = sites[np.nonzero(solved.near[node, 1:])[0]].tolist()
        data: dict[str, Any] = {"visits": by_site(self.routing, prices.visits[1:] * self.unit), "remembered": remembered}
        rows, loads, needed = list[dict[str, Any]](), list[dict[str, Any]](), list[dict[str, Any]]()
        for cut, price in prices.cuts.items():
            if isinstance(cut, SubsetRow):
                memory, inside = (sites[np.array(nodes) - 1].tolist() for nodes in (np.nonzero(cut.memory)[0], cut.customers))
                rows.append({"sites": inside, "memory": memory, "price": price * self.unit})
            elif isinstance(cut, MoveRow):
                needed.append({"moves": {tail: list(heads) for tail, heads in cut.names}, "price": price * self.unit})
            elif isinstance(cut, LoadCut):
                loads.append({"sites": sites[np.nonzero(cut.inside)[0] - 1].tolist(), "price": price * self.unit})
        ray = solved.bound == math.inf
        listed = {"rows": rows, "loads": loads, "needed": needed}
        data |= {key: entries for key, entries in listed.items() if entries} | ({"ray": True} if ray else {})
        if not self.partition.merged:
            data["apart"] = True
        elif not ray and math.isfinite(least := float(solved.least.min(initial=math.inf))):
            data["least"] = (least + CLAIM * self.columns.dearest) * self.unit
            if more is not None:
                data["least_needed"] = (least + more) * self.unit
        source = f"column generation, {len(rows) + len(loads)} cuts"
        return Evidence("set-partitioning-duals", source, self.sign * solved.bound * self.unit, data)

    # -- branching ---------------------------------------------------------------------------------------------------

    def branch(self, node: _Node) -> bool:
        self.on_step(min(self.closed, node.bound))
        statement = self._statement(node, self._part(node), try_them=True)
        assert statement is not None
        if "moves" in statement:
            self.branched.append(MoveRow.of(statement["moves"], self._among(statement["moves"])))
        self.columns.master.forget(self.branched)  # but not those that were only tried
        return self.divide(node, statement)

    def _statement(self, node: _Node, part: Part, *, try_them: bool = False) -> dict[str, Any] | None:
        """The statement to branch on; None if nothing is left."""
        assert node.flow is not None
        number = float(node.flow[:, 0].sum())
        # With several types, each keeps its own number.
        if len(part.cost) == 1 and part.fewest < part.most and number > 1.0 and abs(number - round(number)) > WHOLE:
            return {"routes": math.floor(number)}
        moves = self._ways(node.flow[0], part) if self.partition.symmetric else self._moves(node.flow, part)
        undecided: list[tuple[float, dict[str, Any]]] = [*self._visits(node.flow, part), *self._types(node.flow, part), *moves]
        fractional = [(abs(value % 1.0 - 0.5), k) for k, (value, _) in enumerate(undecided) if WHOLE < value % 1.0 < 1.0 - WHOLE]
        if not fractional:
            used = [statement for value, statement in undecided if value > WHOLE]
            left = used or [statement for _, statement in undecided]
            return left[0] if left else None
        statements = [undecided[k][1] for _, k in sorted(fractional)[:CANDIDATES]]
        if not try_them or len(statements) == 1:
            return statements[0]
        gains = [self._gain(node, statement) for statement in statements]
        best: list[dict[str, Any]] = [statements[k] for k in np.argsort(gains, kind="stable")[::-1][:PRICED].tolist()]
        gains = [self._gain(node, statement, priced=True) for statement in best] if len(best) > 1 else [1.0]
        return best[int(np.argmax(gains))]

    def _visits(self, flow: Floats, part: Part) -> Iterator[tuple[float, dict[str, Any]]]:
        """Visits that need not be made, with how often they are, and the statements on them."""
        row, can_be = self.partition.row, np.isfinite(part.cost).any(axis=(0, 1))
        several = np.bincount(row, weights=can_be)[row] > 1.5
        for i in np.nonzero(can_be & (several | part.left_out[row]))[0].tolist():
            if i:
                yield float(flow[:, :, i].sum()), {"visited": self.ids[i]}

    def _types(self, flow: Floats, part: Part) -> Iterator[tuple[float, dict[str, Any]]]:
        """Types of vehicle that more than one can visit a customer, with how often the first of them does, and the statements on them."""
        can = np.logical_or.reduce(np.isfinite(part.cost), axis=1)
        visits = flow.sum(axis=1)
        for i in np.nonzero(can.sum(axis=0) > 1)[0].tolist():
            if i:
                kind = int(np.argmax(np.where(can[:, i], visits[:, i], -1.0)))
                by = [vehicle for vehicle, _ in self.partition.types[kind].vehicles]
                yield float(visits[kind, i]), {"visited": self.ids[i], "by": by}

    def _moves(self, flow: Floats, part: Part) -> Iterator[tuple[float, dict[str, Any]]]:
        """Moves that are neither made nor left out for certain, with how often they are made, and the statements on them."""
        usable, merged = np.isfinite(part.cost).any(axis=0), flow.sum(axis=0)
        more_out, more_in = usable.sum(axis=1) > 1, usable.sum(axis=0) > 1  # of customers, who are left and entered by one move
        more_out[0] = more_in[0] = True
        undecided = usable & more_out[:, None] & more_in[None, :]
        if not self.one_depot:  # a statement names one depot of several
            undecided[0] = undecided[:, 0] = False
        chosen = np.argwhere(undecided & (merged > WHOLE))
        for i, j in (chosen if len(chosen) else np.argwhere(undecided)[:1]).tolist():
            yield float(merged[i, j]), {"arc": [self.ids[i] if i else self.starts[0], self.ids[j] if j else self.ends[0]]}

    def _ways(self, flow: Floats, part: Part) -> Iterator[tuple[float, dict[str, Any]]]:
        """Pairs of places, where every route could be driven backwards at the same cost: how often routes go between them, in either
        direction, and the statement that some route does.

        Between the depot and a customer a route may go twice, to him alone; pairs with more than one are left out.
        """
        both, usable = flow + flow.T, np.isfinite(part.cost[0])
        for row in part.rows:
            usable = usable & ~row.moves
        chosen = np.argwhere(np.triu(usable & (both > WHOLE) & (both < 1.0 + WHOLE)))
        for i, j in (chosen if len(chosen) else np.argwhere(np.triu(usable))[:1]).tolist():
            tail, head = self.ids[i] if i else self.starts[0], self.ids[j]
            yield float(both[i, j]), {"moves": {tail: [head], head: [tail]}}

    def _gain(self, node: _Node, statement: dict[str, Any], *, priced: bool = False) -> float:
        """Product of what the linear program gains on both sides of a statement."""
        product = 1.0
        for holds in (True, False):
            if self.stop.reached():
                return 0.0
            value = self.columns.value(self._part(_Node(node, (statement, holds))), priced=priced)
            product *= max(LEAST_GAIN * self.columns.dearest, 0.0 if math.isnan(value) else value - node.value)
        return product


def branch_price_cut_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None,
    answer: Routes | None = None, on_answer: Callable[[Routes, float], None] = lambda answer, value: None,
) -> Evidence | None:  # fmt: skip
    """Evidence from branch, price and cut: a branching tree, or ``set-partitioning-duals`` where no branching was needed.

    The tree ends where its bound reaches ``target``, the value of an ``answer``, whose routes are the first ones; better answers that it
    meets on the way take its place, and ``on_answer`` hears of them. Without either, it looks for an answer first. The linear programs are
    solved by HiGHS, whoever solves others, and go on from where the last one ended. None where the routes at the root were too many for
    the memory or the time.

    Source: Desrochers, Desrosiers, Solomon (1992); Barnhart, Johnson, Nemhauser, Savelsbergh, Vance (1998), "Branch-and-price";
    docs/branch-price-cut.md.
    """
    if stop.reached() or not 0 < len(problem.customers) <= CUSTOMERS:
        return None
    partition = set_partition(problem, stop)
    if partition is None:
        return None
    seed = 1 if linear is None else linear.seed
    if not partition.merged:
        stop = stop.within(SHARED * stop.seconds_left)
    if target is None:
        answer, target = opening_answer(problem, stop, seed, on_answer)
    tree = Tree(problem, partition, target, stop, seed, answer=answer, on_answer=on_answer)
    tree.grow()
    return tree.evidence("routes")


def opening_answer(
    problem: RoutingProblem, stop: Stop, seed: int, on_answer: Callable[[Routes, float], None]
) -> tuple[Routes | None, float | None]:
    """An answer to begin with where none is known, and its value."""
    answer = first_answer(problem, OPENING * stop.seconds_left, seed, stop)
    if answer is None:
        return None, None
    value = float(problem.evaluate(answer).values[0])
    on_answer(answer, value)
    return answer, value


KERNELS = (
    *(f"waybound.solvers.bounds.routing.{name}_kernels" for name in ("label", "subset_row", "cut", "enumeration", "route_row")),
    *(f"waybound.formulations.routing.checking.{name}_kernels" for name in ("walk", "cheap_route")),
)
