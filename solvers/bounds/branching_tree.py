"""Bound ``branching-tree``: branch and bound that proves bounds, whatever method found the answer.

Every node's linear relaxation leaves row duals, or a ray where it is infeasible; the family's own checker multiplies them out on the
problem restricted by the branchings above (``Problem.restricted``), and what it derives is the node's bound: nothing that the simplex
says of it counts. The value of a known answer is the cutoff. The node of the least bound is branched next, so that the least open bound,
which is what the tree proves, rises from the first second on. The branching variable is chosen by pseudo-costs that begin with strong
branching.

Source: Land and Doig (1960); Achterberg, Koch, Martin (2005), "Branching rules revisited".
"""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Evidence
from ...formulations.forms import FORMS
from ...formulations.problem import Problem
from ...formulations.programs.compiled import Compiled
from ...formulations.programs.program import INTEGERS, Floats
from ...formulations.programs.reductions.continuous_relaxation import CONTINUOUS_RELAXATION
from ...formulations.programs.reductions.units import scaled
from ...formulations.stop import NEVER, Stop
from ...formulations.tolerance import same
from ...instances.errors import InputError
from ..linear_programs import LinearPrograms
from ..linear_session import LinearResult, LinearSession
from . import bound_method
from .linear_relaxation import ENTRIES_PER_SECOND
from .proof_tree import Node, ProofTree

WHOLE = 1e-6
"""Distance to a whole number up to which a simplex value counts as one."""

RELIABLE = 4
"""Branchings on a variable, in each direction, after which its pseudo-costs stand for it."""

CANDIDATES = 4
"""Variables that strong branching looks at in one node at most."""

PATIENCE = 3
"""Candidates in a row that are no better than the best before them, after which strong branching ends."""

STRONG_ITERATIONS = 40
"""Simplex iterations for each side of a candidate."""

LEAST_GAIN = 1e-6
"""Least gain of a side in the product of two gains, as a part of the objective's size."""


@dataclass(eq=False)
class _Node(Node):
    """A node and its linear relaxation.

    ``column``, ``low``, ``high``: the column that it bounds, and its new bounds. ``value``: of its linear relaxation, of a
    minimisation. ``columns`` and ``values``: columns that are fractional, or that are left to decide on where none is. ``basis``: where its
    children begin.
    """

    column: int = -1
    low: float = -math.inf
    high: float = math.inf
    value: float = -math.inf
    columns: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    values: Floats = field(default_factory=lambda: np.zeros(0))
    basis: Any = None


class _Costs:
    """Pseudo-costs: what the objective gained a unit on branchings of each variable, downwards (0) and upwards (1)."""

    def __init__(self, columns: int) -> None:
        self.gain, self.seen = np.zeros((2, columns)), np.zeros((2, columns), np.int64)

    def learn(self, side: int, column: int, gain: float, distance: float) -> None:
        if math.isfinite(gain) and distance > WHOLE:
            self.gain[side, column] += max(0.0, gain) / distance
            self.seen[side, column] += 1

    def estimates(self, columns: NDArray[np.int64], values: Floats) -> tuple[Floats, Floats]:
        """Expected gain of the bound from branching on each of ``columns``, downwards and upwards; their mean where nothing is known."""
        down = values - np.floor(values)
        gains = []
        for side, distance in ((0, down), (1, 1.0 - down)):
            seen = self.seen[side]
            known = seen > 0
            mean = float((self.gain[side, known] / seen[known]).mean()) if known.any() else 1.0
            rate = np.where(known[columns], self.gain[side, columns] / np.maximum(seen[columns], 1), mean)
            gains.append(rate * distance)
        return gains[0], gains[1]


class _Tree(ProofTree[_Node]):
    """A tree over the columns of a program."""

    def __init__(self, made: Compiled, target: float | None, stop: Stop, seed: int) -> None:
        super().__init__(made.problem, _Node(None), target, stop)
        assert made.dual_evidence is not None and made.at_most is not None
        self.made = made
        self.units = scaled(made.program)  # in which integers are what they were
        (relaxed,) = CONTINUOUS_RELAXATION.apply(self.units.program)
        self.program = relaxed.program
        self.at_most, self.dual_evidence = made.at_most, made.dual_evidence
        self.session = LinearSession(self.program, seed)
        self.integer = np.nonzero(made.program.integer)[0]
        self.costs = _Costs(self.program.num_variables)

    def look(self, node: _Node) -> bool:
        lower, upper = self._bounds(node)
        self.session.bound(lower, upper)
        result = self.session.solve(self.stop)
        if result.status == "unbounded":  # all that can be proved is that there is no answer
            self.session.without_costs()
            result = self.session.solve(self.stop)
        if result.status == "unknown" and self.stop.reached():
            return False
        self.begin(node)
        problem = self.restricted(node)
        self.prove(node, problem, self._found(problem, result))
        left = self.integer[lower[self.integer] < upper[self.integer]]
        if self.reached(node.bound) or not len(left):
            self.close(node)
            return True
        if result.status == "optimal":
            node.value = self._value(result)
            values = result.x[left]
            fractional = np.abs(values - np.round(values)) > WHOLE
            if not fractional.any() and self._is_best(node, result.x):
                self.close(node)
                return True
            # Where the program is whole and the proof is not, anything that is used and still open may be what it lacks.
            kept = fractional if fractional.any() else (values > lower[left] + WHOLE)
            kept = kept if kept.any() else np.ones(len(left), dtype=bool)
            node.columns, node.values = left[kept], values[kept]
        elif isinstance(node.parent, _Node):
            node.value = node.parent.value
        if not len(node.columns):
            node.columns, node.values = left, (lower + np.minimum(upper, lower + 1.0))[left] / 2.0
        node.basis = self.session.basis() if result.status == "optimal" else None
        self.wait(node)
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

    def _found(self, problem: Problem, result: LinearResult) -> list[Evidence]:
        """Point, bound and status of a linear program."""
        if result.status == "optimal":
            return [self.dual_evidence(self.units.duals(result.duals), problem)]
        if result.status == "infeasible" and self.made.ray_evidence is not None:
            ray = np.zeros(self.program.num_rows) if result.ray is None else self.units.duals(result.ray)
            return [self.made.ray_evidence(ray), self.made.ray_evidence(-ray)]
        return []

    # -- branching ---------------------------------------------------------------------------------------------------

    def branch(self, node: _Node) -> bool:
        lower, upper = self._bounds(node)
        at = self._chosen(node, lower, upper)
        column, value = int(node.columns[at]), float(node.values[at])
        most = self._split(value, float(lower[column]), float(upper[column]))
        statement, holds = self.at_most(column, most)
        below = _Node(node, (statement, holds), column=column, high=float(most))
        above = _Node(node, (statement, not holds), column=column, low=float(most + 1))
        done = 0
        self._return(node)
        for child in self.look_at_all(node, (below, above)):
            self._learn(node, child, 0 if child is below else 1, column, value)
            self._return(node)
            done += 1
        if done < 2:
            return False
        node.children = (below, above) if holds else (above, below)
        return True

    def release(self, node: _Node) -> None:
        node.basis, node.columns, node.values = None, np.zeros(0, np.int64), np.zeros(0)

    def _return(self, node: _Node) -> None:
        if node.basis is not None:
            self.session.start(node.basis)

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
        """Gain of the bound by a few simplex iterations on both sides of a variable, cut off where it reaches the target."""
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


def _missing(problem: Problem) -> frozenset[str]:
    if type(problem).check_statement is Problem.check_statement:
        return frozenset({f"{problem.family} problems"})
    return frozenset() if any(FORMS[form].makes(problem) == INTEGERS for form in problem.forms()) else frozenset({"integers alone"})


@bound_method("branching-tree", _missing, order=9, aims=True)
def branching_tree_bound(
    problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """Evidence from branch and bound over the first form of ``problem`` whose duals its checkers understand.

    Of ``linear`` the seed counts. The programs of all nodes are solved by HiGHS, which goes on from where the last one ended, whoever
    solves others. ``target``: value of an answer: the tree ends where its bound reaches it. Better answers that it meets on the way take
    its place. It is of kind ``branching-tree``, or of that of the root's evidence where no branching was needed; None where the form lacks
    what it takes, or there was no time for the root.
    """
    most = ENTRIES_PER_SECOND * stop.seconds_left
    if stop.reached() or problem.linear_entries() > most:
        return None
    compiled = next((m for m in map(problem.compile, problem.forms()) if _takes(m)), None)
    if compiled is None or len(compiled.program.data) > most:
        return None
    tree = _Tree(compiled, target, stop, 1 if linear is None else linear.seed)
    tree.grow()
    return tree.evidence(compiled.form)


def _takes(made: Compiled) -> bool:
    program = made.program
    return (
        made.exactness.bound_is_valid and made.dual_evidence is not None and made.at_most is not None
        and program.features() == INTEGERS
    )  # fmt: skip
