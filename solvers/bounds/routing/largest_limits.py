"""The largest of all routes by bisection: trees that rule out all answers within a limit, and the answers that they meet.

An answer whose routes all keep a limit T adds up to no more than T for each vehicle. So the tree of a limit is one of the sum of all
routes, each of at most T: a case without routes, or whose sum is more than that, has no answer. Where all cases are so, the largest route
is longer than T. docs/branch-price-cut.md#the-largest-of-all-routes
"""

import heapq
import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ....formulations.evaluation import Evaluation
from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import EPS, departure
from ....formulations.routing.checking.round_trips import check_farthest_round_trip, longest, peak_grain, totals
from ....formulations.routing.objective import Objective
from ....formulations.routing.preparation import waiting_is_possible
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.stop import Stop
from ....formulations.tolerance import same
from ....formulations.verified_bounds import verified_bound
from ....instances.errors import InputError
from ..proof_tree import ROOT
from .branch_price_cut import Tree
from .column_generation import Solved
from .first_answer import first_answer
from .load_cuts import LoadCut
from .restricted_master import Drive
from .set_partition import SetPartition, set_partition
from .subset_rows import SubsetRow

NEAR, LESS = 1e-3, 5e-10
"""Parts of the best value: two limits that are so near are not told apart where the data are no multiples of anything, and the last limit
is so much below it."""

ABOVE = 1e-4
"""Part of a grain by which a limit is above the multiple that it allows."""

MOST_GRAINS = 1e8
"""With more in the best value, bounds cannot be lifted to them."""

SEARCH, LOWER = 0.03, (0.01, 0.003)
"""Share of the time for ruin and recreate within a limit at most, and parts of the value by which that is below the best, each as often as
there is a better answer."""

MORE = 8
"""Factor on the nodes of a tree that was not done."""


class LimitTree(Tree):
    """The answers of ``problem`` whose largest route, by ``term``, is at most ``limit``; infinity is no limit.

    It grows over the problem of their sum, towards the sum that no such answer exceeds, and ends with the first answer.
    """

    def __init__(
        self, limited: RoutingProblem, summed: RoutingProblem, partition: SetPartition, limit: float, most: float, stop: Stop, seed: int,
        extra: Mapping[str, Any],
    ) -> None:  # fmt: skip
        super().__init__(summed, partition, most, stop, seed, most=extra)
        self.limited, self.limit, self.looked, self.began = limited, limit, 0, False

    @classmethod
    def of(
        cls, problem: RoutingProblem, term: str, limit: float, stop: Stop, seed: int, extra: Mapping[str, Any]
    ) -> "LimitTree | None":  # fmt: skip
        """None where moves are too many for the time."""
        limited = problem.restricted([(stated(term, limit), True)]) if math.isfinite(limit) else problem
        summed = totals(limited)
        partition = None if summed is None else set_partition(summed, stop)
        if summed is None or partition is None:
            return None
        if term != "longest-route" and any(math.isfinite(v.max_distance) for v in problem.fleet):  # which sums of times have no place for
            other = set_partition(limited.altered(objective=Objective()), stop)
            partition = partition if other is None else _within(partition, other)
        n = len(problem.customers)
        routes = min(n, sum(n if v.count is None else v.count for v in problem.fleet))
        start = min(departure(problem, v) for v in problem.fleet) if term == "latest-return" else 0.0
        room = longest(limited, term) - start
        # What a leaf of this sum proves is more than the limit by more than its checker's rounding.
        most = routes * (room + 32.0 * EPS * (abs(room) + abs(start))) if room > 0.0 else math.inf
        return cls(limited, summed, partition, limit, most, stop, seed, extra)

    def take(self, known: Routes | None, former: "LimitTree | None") -> None:
        """Begin with routes of an answer, and with routes and cuts of the tree of another limit, as far as the limit lets them be."""
        columns, problem = self.columns, self.routing
        if known is not None:
            columns.add(known)
        if former is not None and len(former.partition.types) == len(self.partition.types):
            columns.near |= former.columns.near
            columns.pool.add(columns.pool.new(_once(former)))
            columns.cuts.update(former.columns.cuts)
            cuts = former.columns.master.cuts
            # Not those of windows: where the limit is a due time, they hold for that one.
            kept = [cut for cut in cuts if isinstance(cut, SubsetRow) or (isinstance(cut, LoadCut) and not cut.due)]
            columns.loads |= {cut.inside.tobytes() for cut in kept if isinstance(cut, LoadCut)}
            columns.master.cut(kept)
        timed = any(math.isfinite(v.shift[1]) for v in problem.fleet)
        begins = max(departure(problem, v) for v in problem.fleet) if timed else 0.0
        room = -math.inf if timed and waiting_is_possible(problem) else self.limit - begins
        columns.pool.keep(columns.pool.sums(self.partition.cost) <= room)

    def work(self, nodes: int) -> None:
        """Grow until nothing is open, an answer is found, or so many nodes were looked at."""
        if not self.began:
            self.stop = self.whole.within(ROOT * self.whole.seconds_left)
            self.began = self.look(self.root)
            self.stop = self.whole
        while self.open and self.answer is None and self.looked < nodes and not self.full and not self.stop.reached():
            node = heapq.heappop(self.open)[-1]
            if not self.branch(node):
                self.wait(node)
                break
            self.release(node)

    def look(self, node: Any) -> bool:
        self.looked += 1
        return super().look(node)

    def reached(self, bound: float) -> bool:
        return bound >= self.target or self.answer is not None

    @property
    def ended(self) -> bool:
        """Whether more work comes to nothing."""
        return self.began and (not self.open or self.answer is not None or self.full)

    @property
    def refuted(self) -> bool:
        """Whether no answer keeps the limit."""
        return self.began and self.answer is None and self.bound >= self.target

    def _prove(self, node: Any, solved: Solved, more: float | None = None) -> None:
        self.problem = self.limited if solved.bound == math.inf else self.routing
        super()._prove(node, solved, more)

    def _evidence(self, solved: Solved, more: float | None) -> Evidence:
        evidence = super()._evidence(solved, more)
        return replace(evidence, data={**evidence.data, "apart": True}) if solved.bound == math.inf else evidence

    def _judged(self, answer: Routes) -> Evaluation | None:
        try:
            judged = self.limited.evaluate(answer)
        except InputError:
            return None
        if judged.feasible and self.answer is None:
            self.answer = answer
        return judged if judged.feasible else None

    def listed(self) -> list[dict[str, Any]]:
        """Nodes that prove that there is no answer within the limit."""
        evidence = self.evidence("routes")
        assert evidence is not None
        whole = [{"kind": evidence.kind, "data": evidence.data}]
        return [_averaged(node) for node in (evidence.data["nodes"] if evidence.kind == "branching-tree" else whole)]


def stated(term: str, limit: float) -> dict[str, Any]:
    """The statement that the largest of all routes keeps a limit."""
    return {"term": term, "at_most": limit}


def _once(tree: LimitTree) -> list[Drive]:
    """Its routes that come back to nobody."""
    return tree.columns.pool.drives(np.nonzero(~tree.columns.pool.twice)[0])


def _averaged(node: Mapping[str, Any]) -> dict[str, Any]:
    """A node whose evidence on the sum of all routes, if it is that, is one on the largest of them."""
    if "kind" not in node or node["data"].get("ray"):
        return dict(node)
    inner = {"kind": "averaged-tour", "data": {key: node[key] for key in ("kind", "data")}}
    return {key: value for key, value in node.items() if key == "branch"} | inner


def _within(partition: SetPartition, limiting: SetPartition) -> SetPartition:
    """The same routes, at the same costs, that keep the limits of another program of the same vehicles as well."""
    if [one.vehicles for one in limiting.types] != [one.vehicles for one in partition.types]:
        return partition
    pairs = zip(partition.types, limiting.types, strict=True)
    types = [replace(one, cost=np.where(np.isfinite(other.cost), one.cost, math.inf), levels=other.levels) for one, other in pairs]
    return replace(partition, types=tuple(types), symmetric=partition.symmetric and limiting.symmetric)


class LimitSearch:
    """Bisection between the largest limit that no answer keeps and the best answer, both of which stand at any time.

    For problems for which ``lacks_one_peak`` is empty. ``value`` is that of the answer, or of another one, ``gap`` the part of it that may
    stay open, and ``most`` goes to ``ColumnGeneration``. ``on_answer`` hears of better answers with their values, ``on_step`` of the bound
    after some work.
    """

    def __init__(
        self, problem: RoutingProblem, stop: Stop, seed: int, *, answer: Routes | None = None, value: float | None = None,
        most: Mapping[str, Any] | None = None, gap: float = 0.0,
        on_answer: Callable[[Routes, float], None] = lambda answer, value: None, on_step: Callable[[], None] = lambda: None,
    ) -> None:  # fmt: skip
        self.problem, self.stop, self.seed, self.answer, self.extra, self.gap = problem, stop, seed, answer, most or {}, gap
        self.on_answer, self.on_step = on_answer, on_step
        ((self.weight, term),) = problem.objective.levels()[0].terms
        self.term, self.value = term.name, math.inf if value is None else value
        self.size = peak_grain(problem)
        self.bound = check_farthest_round_trip(problem, {})
        self.proof: list[dict[str, Any]] | None = None
        self.tree: LimitTree | None = None
        self.tried, self.nodes, self.given_up, self.limit = 0, 0, 0, ""

    def counts(self) -> dict[str, int]:
        """Counts of the tree at hand."""
        return {} if self.tree is None else self.tree.counts()

    @property
    def grain(self) -> float | None:
        """The number of which all values of the term are multiples, if there are few enough of them."""
        size = self.size
        return None if size is None or abs(self.value) > MOST_GRAINS * size.size else size.size / self.weight

    @property
    def done(self) -> bool:
        """Whether the bound meets the best value, or nothing is left to be found."""
        reached = self.bound >= self.value - (self.gap * abs(self.value) if self.gap else 0.0)
        return reached or same(self.bound, self.value)

    def run(self) -> None:
        """Bisect until both ends meet, or the time is up."""
        if not math.isfinite(self.value):
            self._try(math.inf, 1 << 60)
        if not math.isfinite(self.value):
            return
        for part in LOWER:
            while not self.done and self._searched(self.value - part * abs(self.value)):
                pass
        nodes, still_open = 1, math.inf  # the least limit of which nothing is known
        while not self.done and not self.stop.reached():
            limit = self._between(self.bound / self.weight, min(still_open, self.value / self.weight))
            if limit is None and math.isfinite(still_open):
                nodes, limit = MORE * nodes, still_open
            if limit is None or (self.tree is not None and self.tree.limit == limit and self.tree.ended):
                break
            decided = self._try(limit, nodes)
            if self.tree is None:
                break
            if not decided:
                still_open = limit
            elif not self.bound < still_open * self.weight < self.value:
                still_open = math.inf

    def _searched(self, value: float) -> bool:
        """Look for an answer of a value by ruin and recreate; whether there was a better one."""
        if self.stop.reached() or value <= self.bound:
            return False
        summed = totals(self.problem.restricted([(stated(self.term, value / self.weight), True)]))
        seconds = SEARCH * self.stop.seconds_left
        answer = None if summed is None else first_answer(summed, seconds, self.seed, self.stop)
        return answer is not None and self._better(answer)

    def _between(self, low: float, high: float) -> float | None:
        """A limit in the midst between two others, or just below the best value; None where there is none worth trying."""
        top, grain = high * self.weight >= self.value, self.grain
        if grain is not None:
            first, last = math.ceil(low / grain - 1e-6), round(high / grain) - 1
            return None if first > last else (first + (last - first) // 2 + ABOVE) * grain
        if high - low > NEAR * abs(high):
            return (low + high) / 2.0
        return high - LESS * abs(high) if top else None

    def _try(self, limit: float, nodes: int) -> bool:
        """Look for an answer within a limit, or for a proof that there is none, in so many nodes; whether there is one of them."""
        tree = self.tree
        if tree is None or tree.limit != limit:
            former, tree = self.tree, LimitTree.of(self.problem, self.term, limit, self.stop, self.seed, self.extra)
            self.tree = tree
            if tree is None:
                return False
            tree.take(self.answer, former)
            self.tried += 1
        before = tree.looked
        tree.on_step = lambda bound: self.on_step()
        tree.work(nodes)
        self.nodes, self.given_up = self.nodes + tree.looked - before, max(self.given_up, tree.columns.given_up)
        self.limit = tree.columns.limit
        if tree.answer is not None:
            return self._better(tree.answer)
        if not tree.refuted:
            return False
        self.proof = tree.listed()
        if math.isfinite(limit):
            side = Evidence("farthest-round-trip", "", 0.0, {})
            self.proof = [{"branch": stated(self.term, limit)}, *self.proof, {"kind": side.kind, "data": {}}]
            self.bound = max(self.bound, verified_bound(self.problem.restricted([(stated(self.term, limit), False)]), side))
        else:
            self.bound = math.inf
        self.on_step()
        return True

    def _better(self, answer: Routes) -> bool:
        """Take an answer, if it is a better one."""
        judged = self.problem.evaluate(answer)
        if not judged.feasible or not judged.values[0] < self.value:
            return False
        self.answer, self.value = answer, judged.values[0]
        self.on_answer(answer, self.value)
        return True

    def evidence(self) -> Evidence:
        """Proof of the bound."""
        if self.proof is None:
            return Evidence("farthest-round-trip", "farthest round trip", self.bound, {})
        leaves = sum("kind" in node for node in self.proof)
        return Evidence(
            "branching-tree", f"limits of routes, {leaves} leaves, each with evidence of its own", self.bound, {"nodes": self.proof}
        )
