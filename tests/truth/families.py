"""Brute force in exact arithmetic for tiny problems of every family, written from the definitions.

Doubles are taken for the fractions that they are. It shares no code with the package's judges, forms, checkers or heuristics, and reads
nothing of a problem but its data. ``best`` is the optimum over the answers that keep every limit exactly, ``lenient`` over those
that exceed none by more than 1e-9 of what is added up and compared there: sums of doubles cannot be told apart more finely for sure.
"""

import itertools
import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import numpy as np

from waybound import BottleneckSATA, MaxMinLP, Problem, RiskyPath, RoutingProblem, Selection, SubmodularSelection
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid
from waybound.instances.sata.set_functions import Coverage, DenseFacilityLocation, FacilityLocation

from .auctions import AUCTIONS
from .base import PARTS, Truth, Values
from .routing import RoutingTruth
from .simplex import Tableau, bounded

# -- whole choices -------------------------------------------------------------------------------------------------------


class SelectionTruth(Truth):
    """All sets of elements; winner takes all is one of these problems."""

    def __init__(self, problem: SubmodularSelection) -> None:
        super().__init__(("max",))
        self.problem, f = problem, problem.function
        self.gives: list[list[Fraction]] | None = None
        if isinstance(f, Coverage | FacilityLocation | DenseFacilityLocation):
            self.gives = [[Fraction(float(v)) for v in row] for row in _dense(f).tolist()]
        for chosen in every_set(problem):
            excess = excess_of(problem, chosen)
            if excess is not None:
                self.meet(self._values(chosen), excess == 0, Selection(chosen))

    def _values(self, chosen: tuple[int, ...]) -> Values:
        if self.gives is None:
            return (Fraction(float(self.problem.function.values(_mask(self.problem, chosen))[0])),)
        return (
            sum((max(column) for column in zip(*(self.gives[e] for e in chosen), strict=True)), Fraction(0)) if chosen else Fraction(0),
        )

    def value(self, answer: Any) -> Values | None:
        chosen, n = tuple(sorted(answer.elements)), self.problem.num_elements
        if len(set(chosen)) < len(chosen) or any(not 0 <= e < n for e in chosen) or excess_of(self.problem, chosen) is None:
            return None
        return self._values(chosen)


def every_set(problem: SubmodularSelection) -> Iterator[tuple[int, ...]]:
    """All sets of elements, the small ones first."""
    n = problem.num_elements
    return itertools.chain.from_iterable(itertools.combinations(range(n), size) for size in range(n + 1))


def excess_of(problem: SubmodularSelection, chosen: tuple[int, ...]) -> Fraction | None:
    """The excess of a set over the constraint, as a share; None where that is more than doubles can."""
    c = problem.constraint
    if isinstance(c, Knapsack):
        over = sum((Fraction(float(c.costs[e])) for e in chosen), Fraction(0)) - Fraction(c.budget)
        return Fraction(0) if over <= 0 else None if over * PARTS > Fraction(c.budget) else over
    if isinstance(c, Cardinality):
        return Fraction(0) if len(chosen) <= c.limit else None
    if isinstance(c, PartitionMatroid):
        counts = np.bincount(c.groups[list(chosen)], minlength=len(c.limits))
        return Fraction(0) if (counts <= c.limits).all() else None
    return Fraction(0) if c.allows(_mask(problem, chosen))[0] else None


def _dense(function: Any) -> Any:
    if isinstance(function, DenseFacilityLocation):
        return function.matrix
    dense = np.zeros((function.num_elements, function.num_items))
    element = np.repeat(np.arange(function.num_elements), np.diff(function.indptr))
    dense[element, function.indices] = function.item_weights[function.indices] if isinstance(function, Coverage) else function.weights
    return dense


def _mask(problem: SubmodularSelection, chosen: tuple[int, ...]) -> Any:
    mask = np.zeros((1, problem.num_elements), dtype=bool)
    mask[0, list(chosen)] = True
    return mask


class PathTruth(Truth):
    """All paths to a goal, at risks of places, of moves, and of pairs of moves."""

    def __init__(self, problem: RiskyPath) -> None:
        super().__init__(("min",))
        self.graph, self.locale, moves = problem.graph, *problem.graph.elements
        self.risks = {tuple(key): Fraction(r) for *key, r in np.column_stack([moves.before, moves.state, moves.after, moves.risk]).tolist()}
        others = [state for state in range(self.graph.num_states) if state != self.graph.start]
        for length in range(len(others) + 1):
            for rest in itertools.permutations(others, length):
                value = self.value((self.graph.start, *rest))
                if value is not None:
                    self.meet(value, True, (self.graph.start, *rest))

    def value(self, answer: Any) -> Values | None:
        arcs = set(zip(self.graph.tail.tolist(), self.graph.head.tolist(), strict=True))
        if answer[-1] not in self.graph.goals or len(set(answer)) < len(answer) or not arcs.issuperset(itertools.pairwise(answer)):
            return None
        risks = [Fraction(float(self.locale.risk[state])) for state in answer]
        risks += [self.risks.get((-1, *move), Fraction(0)) for move in itertools.pairwise(answer)]
        risks += [self.risks.get(three, Fraction(0)) for three in zip(answer, answer[1:], answer[2:], strict=False)]
        failing = 1 - math.prod(1 - risk for risk in risks)
        return None if failing == 1 else (Fraction(-math.log1p(-float(failing))),)


class BottleneckTruth(Truth):
    """All ways to give each robot one of its actions, or none."""

    def __init__(self, problem: BottleneckSATA) -> None:
        super().__init__(("max",))
        g = self.graph = problem.graph
        self.sees = [_edges(g, a) for a in range(g.num_actions)]
        own = [[a for a in range(g.num_actions) if g.robot_of_action[a] == r] for r in range(g.num_robots)]
        for chosen in itertools.product(*([None, *actions] for actions in own)):
            answer = tuple(a for a in chosen if a is not None)
            self.meet(self._values(answer), True, Selection(answer))

    def _values(self, chosen: tuple[int, ...]) -> Values:
        cover = [Fraction(0)] * self.graph.num_targets
        for a in chosen:
            for target, weight in self.sees[a]:
                cover[target] += weight
        return (min(cover),)

    def value(self, answer: Any) -> Values | None:
        robots = [int(self.graph.robot_of_action[a]) for a in answer.elements if 0 <= a < self.graph.num_actions]
        return None if len(set(robots)) < len(answer.elements) else self._values(tuple(answer.elements))


def _edges(graph: Any, action: int) -> list[tuple[int, Fraction]]:
    at = range(graph.indptr[action], graph.indptr[action + 1])
    return [(int(graph.indices[e]), Fraction(float(graph.weights[e]))) for e in at]


# -- vectors -------------------------------------------------------------------------------------------------------------


class SharesTruth(Truth):
    """Packing and covering rows: the linear program of either sense, solved exactly."""

    def __init__(self, problem: BottleneckSATA | MaxMinLP) -> None:
        super().__init__(problem.senses, continuous=True)
        if isinstance(problem, BottleneckSATA):
            g = problem.graph
            self.columns = g.num_actions
            pack = [[Fraction(int(g.robot_of_action[a] == r)) for a in range(self.columns)] for r in range(g.num_robots)]
            cover = [[Fraction(0)] * self.columns for _ in range(g.num_targets)]
            for a in range(self.columns):
                for target, weight in _edges(g, a):
                    cover[target][a] = weight
        else:
            self.columns = problem.num_variables
            pack, cover = (_matrix(m, self.columns) for m in (problem.packing, problem.covering))
        self.pack, self.cover = [r for r in pack if any(r)], cover
        one, zero = Fraction(1), Fraction(0)
        if self.senses[0] == "max":
            rows = [[*row, zero] for row in self.pack] + [[*(-v for v in row), one] for row in cover]
            optimum = Tableau([zero] * self.columns + [one], rows, [one] * len(self.pack) + [zero] * len(cover))
        else:
            rows = [[*row, -one] for row in self.pack] + [[*(-v for v in row), zero] for row in cover]
            optimum = Tableau([zero] * self.columns + [-one], rows, [zero] * len(self.pack) + [-one] * len(cover))
        assert optimum.status == "optimal"
        self.best = self.lenient = (abs(optimum.value),)
        self.size = abs(optimum.value)
        self.samples = _vectors(optimum.point[: self.columns])

    def value(self, answer: Any) -> Values | None:
        entries, slack = [Fraction(float(v)) for v in answer], Fraction(1, self.parts)
        x = [max(v, Fraction(0)) for v in entries]  # an answer is worth what its nonnegative part is, scaled into the rows
        packed, covered = (
            [sum((v * s for v, s in zip(row, x, strict=True) if v), Fraction(0)) for row in m] for m in (self.pack, self.cover)
        )
        heaviest = [
            max(column, default=Fraction(0)) for column in zip(*(self.pack if self.senses[0] == "max" else self.cover), strict=True)
        ]
        negative = any(-v * max(h, Fraction(1)) > slack for v, h in zip(entries, heaviest, strict=True))
        most, least = max(packed, default=Fraction(0)), min(covered)
        if negative or (most > 1 + slack if self.senses[0] == "max" else least < 1 - slack):
            return None
        return (least / max(most, Fraction(1)),) if self.senses[0] == "max" else (most / min(least, Fraction(1)),)


def _vectors(x: list[Fraction]) -> list[Any]:
    """The point as a vector of doubles, where it has one."""
    return [np.array([float(v) for v in x])] if max(map(abs, x), default=0) < 10**300 else []


def _matrix(matrix: Any, columns: int) -> list[list[Fraction]]:
    rows = [[Fraction(0)] * columns for _ in range(matrix.rows)]
    for row in range(matrix.rows):
        for e in range(matrix.indptr[row], matrix.indptr[row + 1]):
            rows[row][matrix.indices[e]] = Fraction(float(matrix.data[e]))
    return rows


class ProgramTruth(Truth):
    """A linear program whose integer variables have few values each: one exact simplex for each choice of those."""

    def __init__(self, problem: Any) -> None:
        p = self.program = problem.program
        super().__init__((p.sense,), continuous=True)
        sign, self.mixed = 1 if p.sense == "min" else -1, True
        self.rows = [[Fraction(0)] * p.num_variables for _ in range(p.num_rows)]
        for row in range(p.num_rows):
            for e in range(p.indptr[row], p.indptr[row + 1]):
                self.rows[row][int(p.indices[e])] += Fraction(float(p.data[e]))
        at = np.nonzero(p.integer)[0].tolist()
        for chosen in itertools.product(*_values_of(p, at)):
            lower, upper = p.lower.tolist(), p.upper.tolist()
            for j, v in zip(at, chosen, strict=True):
                lower[j] = upper[j] = v
            status, value, x = bounded(
                [sign * c for c in p.cost.tolist()], self.rows, p.row_lower.tolist(), p.row_upper.tolist(), lower, upper
            )
            self.unbounded |= status == "unbounded"
            if status == "optimal":
                values = (sign * value + Fraction(float(p.offset)),)
                if self.better(values, self.best):
                    self.best, self.samples = values, _vectors(x)
                    self.size = sum((abs(Fraction(c) * v) for c, v in zip(p.cost.tolist(), x, strict=True)), abs(Fraction(float(p.offset))))
        self.best = self.lenient = None if self.unbounded else self.best
        if self.best is None:  # an answer may pass all the same, by a hair: the largest terms that it can have
            widest = np.maximum(np.abs(p.lower), np.abs(p.upper))
            terms = zip(p.cost[np.isfinite(widest)].tolist(), widest[np.isfinite(widest)].tolist(), strict=True)
            self.size = sum((abs(Fraction(c) * Fraction(w)) for c, w in terms), abs(Fraction(float(p.offset))))

    def value(self, answer: Any) -> Values | None:
        """Up to 1e-6 of what solvers count as 1: of a row's size, where that is 1/16 or more, of 1."""
        p, x = self.program, [Fraction(float(v)) for v in answer]
        ends = [Fraction(v) for v in [*p.lower.tolist(), *p.upper.tolist()] if math.isfinite(v)]
        unit = max([abs(v) for v in (*x, *ends)] or [Fraction(1)]) or Fraction(1)
        tests = [(v, a, b, unit) for v, a, b in zip(x, p.lower.tolist(), p.upper.tolist(), strict=True)]
        for row, a, b in zip(self.rows, p.row_lower.tolist(), p.row_upper.tolist(), strict=True):
            total = sum((c * v for c, v in zip(row, x, strict=True)), Fraction(0))
            tests.append((total, a, b, 16 * sum((abs(c) for c in row), Fraction(0)) * unit))
        for v, a, b, size in tests:
            for side, sign in ((a, -1), (b, 1)):
                if math.isfinite(side) and sign * (v - Fraction(side)) * 10**6 > max(size, abs(Fraction(side))):
                    return None
        if any(k and v.denominator != 1 and abs(v - round(v)) * 10**6 > 1 for k, v in zip(p.integer.tolist(), x, strict=True)):
            return None
        return (sum((Fraction(c) * v for c, v in zip(p.cost.tolist(), x, strict=True)), Fraction(float(p.offset))),)


def _values_of(p: Any, at: list[int]) -> Iterator[range]:
    return (range(math.ceil(p.lower[j]), math.floor(p.upper[j]) + 1) for j in at)


KNOWN: dict[type, type] = {
    RoutingProblem: RoutingTruth, SubmodularSelection: SelectionTruth, BottleneckSATA: BottleneckTruth, MaxMinLP: SharesTruth,
    RiskyPath: PathTruth, **AUCTIONS,
}  # fmt: skip


def truth(problem: Problem) -> Truth:
    """All there is to know about a tiny problem."""
    if isinstance(problem, BottleneckSATA) and problem.fractional:
        return SharesTruth(problem)
    return next((known for family, known in KNOWN.items() if isinstance(problem, family)), ProgramTruth)(problem)  # type: ignore[no-any-return]
