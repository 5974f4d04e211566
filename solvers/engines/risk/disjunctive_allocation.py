"""Disjunctive allocation: chance constraints with alternatives, such as sides of obstacles, by branch and bound over convex ones."""

import heapq
import math
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.programs.exactness import Exactness
from ....formulations.risk.allocations import Allocation, Floats
from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.stop import Stop
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...bounds.proof_tree import Node, ProofTree
from ...bounds.risk.convex_allocation import part_evidence
from .convex_allocation import LEANING, leans
from .convex_allocation_steps.successive_tangents import SuccessiveTangents

CLOSED = 1e-6
"""Gap at which a search for an optimum ends."""

NODE_GAP = 1e-7

DIVE_EVERY = 8
"""Nodes between two plans with the safest alternatives of a node's decision."""


@BACKENDS.register("disjunctive-allocation")
class DisjunctiveAllocation(Engine):
    """Branch and bound (Blackmore, Ono and Williams 2011): a node leaves out the constraints whose alternative is undecided.

    Its convex allocation is bounded by verified prices, and all nodes together are evidence ``branching-tree``. Where risk is joint the
    best allocation is an answer (Boole), and bounds nothing. ``iterations`` counts nodes.
    """

    name = "disjunctive-allocation"
    package = "highspy"
    summary = "risk allocation around obstacles: branch and bound over convex allocations, with a proved bound"
    interrupts = "keeps the best answer and what its tree proves"
    one_thread = bounds_itself = True
    honours = frozenset({"gap", "iterations"})
    family = "risk-allocation"
    features = frozenset({"allocated-risk", "joint-risk", "alternatives", "quadratic-cost", "cones"})
    order: ClassVar[int] = 3

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, RiskAllocation)
        joint = problem.risk.kind == "joint"
        tree = _Tree(problem.by_allocation() if joint else problem, options, control, stop)
        tree.grow()
        result = _result(tree, options, stop)
        if not joint:
            return result
        answer = None if result.answer is None else Allocation(result.answer.decision)
        return replace(result, answer=answer, holds=Exactness.RESTRICTION, evidence=())


@dataclass(eq=False)
class _Node(Node):
    """A node, the decision of its convex allocation (None where it has none), and the chance rows that this decides on."""

    decision_vector: Floats | None = None
    rows: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))


class _Tree(ProofTree[_Node]):
    """A tree over the alternatives of a problem with allocated risk."""

    problem: RiskAllocation

    def __init__(self, problem: RiskAllocation, options: Options, control: Control, stop: Stop) -> None:
        super().__init__(problem, _Node(None), None, stop)
        self.options, self.control = options, control
        self.aim = max(options.gap, CLOSED)
        self.answer: Allocation | None = None
        self.value = math.inf
        self.looked = 0

    def reached(self, bound: float) -> bool:
        return (math.isfinite(self.value) and self.value - bound <= self.aim * abs(self.value)) or bound == math.inf

    def grow(self) -> None:
        most = self.options.iterations
        if not self.look(self.root):
            self.closed = -math.inf
        while self.open and not self.stop.reached() and (most is None or self.looked < most):
            if self.reached(self.open[0][0]):
                break
            node = heapq.heappop(self.open)[-1]
            if not self.branch(node):
                self.wait(node)
                break

    def look(self, node: _Node) -> bool:
        if self.stop.reached():
            return False
        problem = self.problem.restricted(node.decisions())
        alternatives = np.bincount(problem.constraint, weights=problem.open)
        self.begin(node)
        self.looked += 1
        part, rows = problem.convex_part()
        parent = node.parent
        if (alternatives == 0).any():  # the checker sees it
            sizes = {
                "rows": len(problem.row_lower), "chance": len(problem.limits), "budgets": len(problem.budgets),
                "terms": sum(len(t[3]) for t in problem.terms), "cones": sum(1 + len(c[1]) for c in problem.cones),
            }  # fmt: skip
            no_prices = {name: [0.0] * size for name, size in sizes.items()}
            self.prove(node, problem, [Evidence("risk-allocation-duals", "no alternative is left", math.inf, no_prices)])
            self.close(node)
            return True
        if isinstance(parent, _Node) and np.array_equal(rows, parent.rows):
            node.rows, node.decision_vector, node.own, node.evidence = rows, parent.decision_vector, parent.own, parent.evidence
        else:
            interval = SuccessiveTangents(part, self.options.seed).run(self.stop, NODE_GAP)
            if interval.status == "unknown" and self.stop.reached():
                self.nodes.pop()
                return False
            self.prove(node, problem, part_evidence(problem, rows, interval))
            node.rows, node.decision_vector = rows, None if interval.answer is None else interval.answer.decision
            if interval.answer is not None:
                self._try(interval.answer.decision, self.looked % DIVE_EVERY == 1)
            elif interval.status == "infeasible":
                node.bound = max(node.bound, node.own)
                (self.close if node.own == math.inf else self.wait)(node)
                return True
        if self.reached(node.bound) or node.decision_vector is None or not self._undecided(problem, node):
            self.close(node)
        else:
            self.wait(node)
        return True

    def branch(self, node: _Node) -> bool:
        problem = self.problem.restricted(node.decisions())
        row = self._undecided(problem, node)
        if not row:
            self.close(node)
            return True
        return self.divide(node, {"safest": row[0]})

    def _undecided(self, problem: RiskAllocation, node: _Node) -> list[int]:
        """The safest open row of the undecided constraint that the node's decision breaks most; none where all are decided."""
        alternatives = np.bincount(problem.constraint, weights=problem.open)
        several = np.nonzero(alternatives > 1)[0]
        if not len(several) or node.decision_vector is None:
            return []
        excess = problem.chance @ node.decision_vector - problem.limits
        excess = np.where(problem.open, excess / np.where(problem.deviation > 0.0, problem.deviation, 1.0), math.inf)
        least = np.full(len(alternatives), math.inf)
        np.minimum.at(least, problem.constraint, excess)
        worst = int(several[int(np.argmax(least[several]))])
        return [int(np.nonzero((problem.constraint == worst) & (excess == least[worst]))[0][0])]

    def _try(self, x: Floats, dive: bool) -> None:
        """Take a decision if it is an answer; or else the best plan with the alternatives that are safest at it."""
        p = self.problem
        own = p.risks(x)
        if all(float(own[b.constraints].sum()) <= b.risk for b in p.budgets) and (own <= p.risk.each).all():
            self._take(x)
        elif dive:
            excess = (p.chance @ x - p.limits) / np.where(p.deviation > 0.0, p.deviation, 1.0)
            order = np.lexsort((np.arange(len(excess)), excess, p.constraint))
            first = order[np.unique(p.constraint[order], return_index=True)[1]]
            interval = SuccessiveTangents(p.choosing(np.sort(first)), self.options.seed).run(self.stop, NODE_GAP)
            if interval.answer is not None:
                self._take(interval.answer.decision)

    def _take(self, x: Floats) -> None:
        p = self.problem
        value = p.sign * p.value(x)[0]
        if value < self.value:
            self.value, self.answer = value, p.allocated(x)
            self.control.publish(self.answer, p.sign * value)


def _result(tree: _Tree, options: Options, stop: Stop) -> RawResult:
    p = tree.problem
    proof = tree.evidence("alternatives")
    evidence = () if proof is None else (proof,)
    statistics: dict[str, Any] = {"nodes": tree.looked}
    if options.start is not None:
        statistics["start"] = "ignored"
    bound = tree.bound
    if tree.answer is None:
        status = "infeasible" if bound == math.inf else "unknown"
        return RawResult(status, stop.reached() or "none", statistics=statistics, evidence=evidence)
    leaning = leans(p, tree.answer, tree.value, bound)
    closed = tree.reached(bound) and not leaning
    if closed or leaning:
        limit = "gap" if options.gap > 0.0 and not leaning else "none"
    else:
        limit = stop.reached() or ("iterations" if options.iterations else "none")
    status = "optimal" if closed and limit == "none" else "feasible"
    shown = p.sign * min(bound, tree.value) if math.isfinite(min(bound, tree.value)) else None
    message = LEANING if leaning else ""
    return RawResult(status, limit, tree.answer, p.sign * tree.value, shown, statistics=statistics, message=message, evidence=evidence)
