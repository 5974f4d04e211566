"""Bound ``branching-tree``: branch and bound that is there to prove, whoever found the answer.

Every node's linear relaxation leaves row duals, or a ray where it is infeasible; the family's own checker multiplies them out on the
problem restricted by the branchings above (``Problem.restricted``), and what it derives is the node's bound: nothing that the simplex
says of it counts. The value of a known answer is the cutoff. The node of the least bound is branched next, so that the least open bound,
which is what the tree proves, rises from the first second on. The branching variable is chosen by pseudo-costs that begin with strong
branching.

Source: Land and Doig (1960); Achterberg, Koch, Martin (2005), "Branching rules revisited".
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.certificate import verified_bound
from ...formulations.evidence import Evidence
from ...formulations.forms import FORMS
from ...formulations.problem import Decision, Problem
from ...formulations.programs.compiled import Compiled
from ...formulations.programs.program import INTEGERS, Floats
from ...formulations.programs.reductions.continuous_relaxation import CONTINUOUS_RELAXATION
from ...formulations.programs.reductions.units import scaled
from ...formulations.stop import NEVER, Stop
from ...formulations.tolerance import same
from ...instances.errors import InputError
from ..linear_programs import LinearPrograms
from ..linear_session import LinearResult, LinearSession
from . import BOUNDS, BoundMethod
from .linear_relaxation import ENTRIES_PER_SECOND

WHOLE = 1e-6
"""Distance to a whole number up to which a simplex value counts as one."""

RELIABLE = 4
"""Branchings on a variable, in each direction, after which its pseudo-costs stand for it."""

CANDIDATES = 4
"""Variables that strong branching looks at in one node at most."""

PATIENCE = 3
"""Candidates in a row that are no better than the best before them, after which strong branching ends."""

STRONG_ITERATIONS = 40
"""Of the simplex for each side of a candidate."""

MOST_NUMBERS = 4_000_000
"""In the evidence of all nodes together, some 200 megabytes: then the tree is handed over as it is."""

ROOT = 0.5
"""Share of the budget within which the first linear program must be solved; else no tree of it would be worth having."""

SWEEP = 256
"""Nodes after which evidence that no leaf can need any more is dropped."""

LEAST_GAIN = 1e-6
"""Of the objective's size: what a branching gains at least in a product of two gains."""


@dataclass(eq=False)
class _Node:
    """A node; bounds and values are those of a minimisation.

    Attributes
    ----------
    parent : _Node or None
    decision : Decision or None
        What it adds to the decisions of its parent.
    column, low, high : int, float, float
        The column that it bounds, and its new bounds.
    value : float
        Of its linear relaxation.
    bound : float
        Verified: its own or the best above it.
    evidence : Evidence or None
        What proves ``own``.
    own : float
        What its own evidence proves.
    columns, values : arrays
        Columns that are fractional, or that are left to decide on where none is.
    basis : object
        Where its children begin.
    children : tuple of _Node
        That for which its statement holds first.
    """

    parent: _Node | None
    decision: Decision | None = None
    column: int = -1
    low: float = -math.inf
    high: float = math.inf
    value: float = -math.inf
    bound: float = -math.inf
    evidence: Evidence | None = None
    own: float = -math.inf
    columns: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    values: Floats = field(default_factory=lambda: np.zeros(0))
    basis: Any = None
    children: tuple[_Node, ...] = ()

    def above(self) -> Iterator[_Node]:
        """The node and all above it but the root, upwards."""
        node = self
        while node.parent is not None:
            yield node
            node = node.parent


class _Costs:
    """Pseudo-costs: what the objective gained a unit on branchings of each variable, downwards (0) and upwards (1)."""

    def __init__(self, columns: int) -> None:
        self.gain, self.seen = np.zeros((2, columns)), np.zeros((2, columns), np.int64)

    def learn(self, side: int, column: int, gain: float, distance: float) -> None:
        if math.isfinite(gain) and distance > WHOLE:
            self.gain[side, column] += max(0.0, gain) / distance
            self.seen[side, column] += 1

    def estimates(self, columns: NDArray[np.int64], values: Floats) -> tuple[Floats, Floats]:
        """What branching on each of ``columns`` is expected to gain, downwards and upwards; the mean of all where nothing is known."""
        down = values - np.floor(values)
        found = []
        for side, distance in ((0, down), (1, 1.0 - down)):
            seen = self.seen[side]
            known = seen > 0
            mean = float((self.gain[side, known] / seen[known]).mean()) if known.any() else 1.0
            rate = np.where(known[columns], self.gain[side, columns] / np.maximum(seen[columns], 1), mean)
            found.append(rate * distance)
        return found[0], found[1]


class _Tree:
    """A tree that grows until its least open bound reaches the target, or there is no time or room left."""

    def __init__(self, made: Compiled, target: float | None, stop: Stop, seed: int) -> None:
        assert made.dual_evidence is not None and made.at_most is not None
        self.made, self.problem, self.stop = made, made.problem, stop
        self.units = scaled(made.program)  # in which integers are what they were
        (relaxed,) = CONTINUOUS_RELAXATION.apply(self.units.program)
        self.program = relaxed.program
        self.at_most, self.dual_evidence = made.at_most, made.dual_evidence
        self.sign = 1.0 if self.problem.sense == "min" else -1.0
        self.target = math.inf if target is None else self.sign * target
        self.session = LinearSession(self.program, seed)
        self.integer = np.nonzero(made.program.integer)[0]
        self.costs = _Costs(self.program.num_variables)
        self.root = _Node(None)
        self.nodes: list[_Node] = []
        self.open: list[tuple[float, int, _Node]] = []
        self.closed = math.inf
        self.numbers = 0
        self.count = itertools.count()

    # -- growing -----------------------------------------------------------------------------------------------------

    def grow(self) -> None:
        """Branch until nothing is open."""
        whole, self.stop = self.stop, self.stop.within(ROOT * self.stop.seconds_left)
        if not self._look(self.root):
            self.closed = -math.inf
        self.stop = whole
        while self.open and self.numbers <= MOST_NUMBERS and not self.stop.reached():
            if self._reached(self.open[0][0]):  # by an answer that was found later
                break
            node = heapq.heappop(self.open)[-1]
            if not self._branch(node):
                self._wait(node)
                break
            node.basis, node.columns, node.values = None, np.zeros(0, np.int64), np.zeros(0)

    @property
    def bound(self) -> float:
        """What the tree proves."""
        return min(self.closed, self.open[0][0] if self.open else math.inf)

    def _wait(self, node: _Node) -> None:
        heapq.heappush(self.open, (node.bound, next(self.count), node))

    def _reached(self, bound: float) -> bool:
        return bound >= self.target or same(bound, self.target)

    def _look(self, node: _Node) -> bool:
        """Solve and prove a node, and close it or let it wait; False where there was no time for it."""
        lower, upper = self._bounds(node)
        self.session.bound(lower, upper)
        result = self.session.solve(self.stop)
        if result.status == "unknown" and self.stop.reached():
            return False
        self.nodes.append(node)
        if len(self.nodes) % SWEEP == 0:
            self._sweep()
        if node.parent is not None:
            node.bound = node.parent.bound
        self._prove(node, result)
        left = self.integer[lower[self.integer] < upper[self.integer]]
        if not self._reached(node.bound) and len(left):
            if result.status == "optimal":
                node.value = self._value(result)
                values = result.x[left]
                fractional = np.abs(values - np.round(values)) > WHOLE
                if not fractional.any() and self._is_best(node, result.x):
                    self.closed = min(self.closed, node.bound)
                    return True
                # Where the program is whole and the proof is not, anything that is used and still open may be what it lacks.
                kept = fractional if fractional.any() else (values > lower[left] + WHOLE)
                kept = kept if kept.any() else np.ones(len(left), dtype=bool)
                node.columns, node.values = left[kept], values[kept]
            elif node.parent is not None:
                node.value = node.parent.value
            if not len(node.columns):
                node.columns, node.values = left, (lower + np.minimum(upper, lower + 1.0))[left] / 2.0
            node.basis = self.session.basis() if result.status == "optimal" else None
            self._wait(node)
        else:
            self.closed = min(self.closed, node.bound)
        return True

    def _value(self, result: LinearResult) -> float:
        """Objective of a linear program, of a minimisation in the problem's units."""
        return self.sign * self.units.value(result.value)

    def _bounds(self, node: _Node) -> tuple[Floats, Floats]:
        lower, upper = self.program.lower.copy(), self.program.upper.copy()
        for n in node.above():
            lower[n.column], upper[n.column] = max(lower[n.column], n.low), min(upper[n.column], n.high)
        return lower, upper

    def _is_best(self, node: _Node, x: Floats) -> bool:
        """Whether a whole point is an answer whose value the node's bound meets; a better answer than known moves the target."""
        try:
            judged = self.problem.evaluate(self.made.decode(self.units.vector(x)))
        except InputError:
            return False
        if not judged.feasible:
            return False
        value = self.sign * judged.values[0]
        self.target = min(self.target, value)
        return same(node.bound, value, judged.size, judged.precision)

    # -- proving -----------------------------------------------------------------------------------------------------

    def _prove(self, node: _Node, result: LinearResult) -> None:
        """Evidence of what the linear program left, multiplied out on the restricted problem."""
        path = [n.decision for n in node.above() if n.decision is not None][::-1]
        problem = self.problem.restricted(path) if path else self.problem
        found: list[Evidence] = []
        if result.status == "optimal":
            found = [self.dual_evidence(self.units.duals(result.duals), problem)]
        elif result.status == "infeasible" and self.made.ray_evidence is not None:
            ray = np.zeros(self.program.num_rows) if result.ray is None else self.units.duals(result.ray)
            found = [self.made.ray_evidence(ray), self.made.ray_evidence(-ray)]
        for evidence in found:
            for given in _shortened(evidence):
                bound = self._verified(problem, given)
                if bound > node.own:
                    node.own, node.evidence = bound, given
                if self._reached(bound) or given is evidence:
                    break
            if node.own == math.inf:
                break
        if node.evidence is not None:
            self.numbers += _size(node.evidence.data)
        node.bound = max(node.bound, node.own)

    def _verified(self, problem: Problem, evidence: Evidence) -> float:
        try:
            bound = self.sign * verified_bound(problem, evidence)
        except InputError:
            return -math.inf
        return -math.inf if math.isnan(bound) else bound

    def _sweep(self) -> None:
        """Drop the evidence of nodes that can be no leaf of what is handed over."""
        least, kept = self.bound, []
        for node in self.nodes:
            if node.children and node.bound < least:
                if node.evidence is not None:
                    self.numbers -= _size(node.evidence.data)
                    node.evidence, node.own = None, -math.inf
            else:
                kept.append(node)
        self.nodes = kept

    # -- branching ---------------------------------------------------------------------------------------------------

    def _branch(self, node: _Node) -> bool:
        """Give a node its two children; False where there was no time for both."""
        lower, upper = self._bounds(node)
        at = self._chosen(node, lower, upper)
        column, value = int(node.columns[at]), float(node.values[at])
        most = self._split(value, float(lower[column]), float(upper[column]))
        statement, holds = self.at_most(column, most)
        below = _Node(node, (statement, holds), column, high=float(most))
        above = _Node(node, (statement, not holds), column, low=float(most + 1))
        before, count = self.closed, len(self.open)
        for child in (below, above):
            if node.basis is not None:
                self.session.start(node.basis)
            if not self._look(child):
                self.closed = before
                if len(self.open) > count:
                    self.open = [entry for entry in self.open if entry[-1].parent is not node]
                    heapq.heapify(self.open)
                return False
            self._learn(node, child, 0 if child is below else 1, column, value)
        node.children = (below, above) if holds else (above, below)
        return True

    @staticmethod
    def _split(value: float, lower: float, upper: float) -> int:
        """The whole number at or below ``value`` that leaves something on both sides."""
        least = math.ceil(lower - WHOLE) if math.isfinite(lower) else -math.inf
        most = math.floor(upper + WHOLE) - 1 if math.isfinite(upper) else math.inf
        return int(max(least, min(math.floor(value + WHOLE), most)))

    def _learn(self, node: _Node, child: _Node, side: int, column: int, value: float) -> None:
        if math.isfinite(child.value) and math.isfinite(node.value):
            down = value - math.floor(value)
            self.costs.learn(side, column, child.value - node.value, down if side == 0 else 1.0 - down)

    def _chosen(self, node: _Node, lower: Floats, upper: Floats) -> int:
        """Position among the node's columns of the one to branch on."""
        down, up = self.costs.estimates(node.columns, node.values)
        least = LEAST_GAIN * max(1.0, abs(node.value) if math.isfinite(node.value) else 0.0)
        score = np.maximum(down, least) * np.maximum(up, least)
        middle = np.abs(node.values - np.floor(node.values) - 0.5)
        order = np.lexsort((node.columns, middle, -score))
        unsure = np.minimum(self.costs.seen[0, node.columns], self.costs.seen[1, node.columns]) < RELIABLE
        if node.basis is None or not unsure[order[:CANDIDATES]].any():
            return int(order[0])
        best, best_score, waited = int(order[0]), -1.0, 0
        for at in order[:CANDIDATES].tolist():
            if self.stop.reached() or waited >= PATIENCE:
                break
            mine = float(score[at])
            if unsure[at]:
                gains = self._tried(node, int(node.columns[at]), float(node.values[at]), lower, upper)
                mine = max(gains[0], least) * max(gains[1], least)
            if mine > best_score:
                best, best_score, waited = at, mine, 0
            else:
                waited += 1
        return best

    def _tried(self, node: _Node, column: int, value: float, lower: Floats, upper: Floats) -> tuple[float, float]:
        """What some simplex iterations gain on both sides of a variable; no more than what reaches the target counts."""
        most = self._split(value, float(lower[column]), float(upper[column]))
        enough = max(self.target - node.value, 0.0) if math.isfinite(self.target) else math.inf
        dearest = max(abs(node.value), 1.0)
        gains = []
        for side in (0, 1):
            low, high = lower.copy(), upper.copy()
            if side == 0:
                high[column] = most
            else:
                low[column] = most + 1
            self.session.bound(low, high)
            self.session.start(node.basis)
            result = self.session.solve(self.stop, STRONG_ITERATIONS)
            gain = math.inf if result.status == "infeasible" else self._value(result) - node.value
            if math.isnan(gain):
                gain = 0.0
            elif result.status == "optimal":
                down = value - math.floor(value)
                self.costs.learn(side, column, gain, down if side == 0 else 1.0 - down)
            gains.append(min(gain, enough, dearest))
        return gains[0], gains[1]

    # -- handing over ------------------------------------------------------------------------------------------------

    def evidence(self) -> Evidence | None:
        """The smallest tree that proves the bound; None where nothing is proved."""
        bound = self.bound
        if bound == -math.inf:
            return None
        listed, leaves = [], 0
        waiting = [self.root]
        while waiting:
            node = waiting.pop()
            entry: dict[str, Any] = {}
            if node.own >= bound and node.evidence is not None:
                entry = {"kind": node.evidence.kind, "data": node.evidence.data}
                leaves += 1
                if node is self.root:
                    return Evidence(node.evidence.kind, node.evidence.source, self.sign * bound, node.evidence.data)
            elif node.children:
                first = node.children[0]
                assert first.decision is not None
                entry = {"branch": first.decision[0]}
                waiting.extend(reversed(node.children))
            listed.append(entry)
        source = f"branch and bound over {self.made.form}, {leaves} leaves, each with evidence of its own"
        return Evidence("branching-tree", source, self.sign * bound, {"nodes": listed})


def _shortened(evidence: Evidence) -> Iterator[Evidence]:
    """Evidence with numbers of few digits and without its zeros, which may prove as much; then the evidence itself."""
    short = _short(evidence.data)
    if short != evidence.data:
        yield Evidence(evidence.kind, evidence.source, evidence.value, short)
    yield evidence


def _short(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _short(value) for key, value in data.items()}
    if not isinstance(data, list) or len(data) < 2 or not all(type(v) is float for v in data):
        return data
    given = np.array(data)
    largest = float(np.abs(given).max())
    if not 0.0 < largest < math.inf:
        return {"at": [], "values": []} if largest == 0.0 else data
    values = np.round(given, 9 - math.floor(math.log10(largest))) if 1e-200 < largest < 1e200 else given
    used = np.nonzero(values)[0]
    if 2 * len(used) > len(values):
        return values.tolist()
    return {"at": used.tolist(), "values": values[used].tolist()}


def _size(data: Any) -> int:
    """How many numbers there are in evidence."""
    if isinstance(data, dict):
        return sum(map(_size, data.values()))
    return len(data) if isinstance(data, list) else 1


def branching_tree_bound(
    problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """Evidence from branch and bound over the first form of ``problem`` whose duals its checkers understand.

    Parameters
    ----------
    problem : Problem
    stop : Stop
    linear : LinearPrograms, optional
        Its seed counts. The programs of all nodes are solved by HiGHS, which goes on from where the last one ended, whoever solves others.
    target : float, optional
        Value of an answer: the tree ends where its bound reaches it. Better answers that it meets on the way take its place.

    Returns
    -------
    Evidence or None
        Of kind ``branching-tree``, or of the kind of the root's where no branching was needed; None where the form lacks what it takes,
        or there was no time for the root.
    """
    most = ENTRIES_PER_SECOND * stop.seconds_left
    if stop.reached() or problem.linear_entries() > most:
        return None
    made = next((m for m in map(problem.compile, problem.forms()) if _takes(m)), None)
    if made is None or len(made.program.data) > most:
        return None
    tree = _Tree(made, target, stop, 1 if linear is None else linear.seed)
    tree.grow()
    return tree.evidence()


def _takes(made: Compiled) -> bool:
    program = made.program
    return (
        made.exactness.bound_is_valid and made.dual_evidence is not None and made.at_most is not None
        and program.features() == INTEGERS
    )  # fmt: skip


def _missing(problem: Problem) -> frozenset[str]:
    if type(problem).check_statement is Problem.check_statement:
        return frozenset({f"{problem.family} problems"})
    return frozenset() if any(FORMS[form].makes(problem) == INTEGERS for form in problem.forms()) else frozenset({"integers alone"})


BOUNDS.add("branching-tree", BoundMethod("branching-tree", _missing, branching_tree_bound, order=9, aims=True))
