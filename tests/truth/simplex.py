"""A linear program in exact arithmetic: fraction-free simplex with Bland's rule, for programs of a few rows and columns."""

import math
from collections.abc import Sequence
from fractions import Fraction

Number = int | float | Fraction
Vector = Sequence[Number]


def whole(numbers: Sequence[Number]) -> list[int]:
    """The numbers times their least common denominator."""
    exact = [Fraction(v) for v in numbers]
    scale = math.lcm(*(v.denominator for v in exact)) if exact else 1
    return [int(v * scale) for v in exact]


class Tableau:
    """Maximise c x over A x <= b, x >= 0. Every entry of the tableau is an integer over the common denominator ``unit`` > 0.

    ``status`` is ``optimal`` (then ``value`` and ``point``), ``infeasible`` or ``unbounded``.
    """

    def __init__(self, cost: Vector, matrix: Sequence[Vector], right: Vector) -> None:
        self.columns, rows = len(cost), len(matrix)
        self.unit = 1
        self.body: list[list[int]] = []
        for k, (row, side) in enumerate(zip(matrix, right, strict=True)):
            # The slack counts in units of its own, so that its column stays a unit vector.
            *entries, limit = whole([*row, side])
            self.body.append([*entries, *(int(j == k) for j in range(rows)), limit])
        self.basis = [self.columns + k for k in range(rows)]
        self.value, self.point = Fraction(0), [Fraction(0)] * self.columns
        if any(row[-1] < 0 for row in self.body) and not self._phase_one():
            self.status = "infeasible"
            return
        self.status = "optimal" if self._maximise(cost) else "unbounded"
        if self.status == "optimal":
            for row, j in zip(self.body, self.basis, strict=True):
                if j < self.columns:
                    self.point[j] = Fraction(row[-1], self.unit)
            self.value = sum((Fraction(c) * x for c, x in zip(cost, self.point, strict=True)), Fraction(0))

    def _pivot(self, r: int, column: int, goal: list[int] | None) -> list[int] | None:
        if self.body[r][column] < 0:
            self.body[r] = [-v for v in self.body[r]]
        own = self.body[r]
        pivot = own[column]

        def eliminated(row: list[int]) -> list[int]:
            factor = row[column]
            return [(v * pivot - factor * w) // self.unit for v, w in zip(row, own, strict=True)]

        self.body = [row if k == r else eliminated(row) for k, row in enumerate(self.body)]
        reduced = None if goal is None else eliminated(goal)
        self.basis[r], self.unit = column, pivot
        return reduced

    def _phase_one(self) -> bool:
        """Go from a basis that breaks right sides to one that does not, by one more variable that every row may subtract."""
        extra = len(self.body[0]) - 1
        for row in self.body:
            row.insert(extra, -1)
        self._pivot(min(range(len(self.body)), key=lambda k: self.body[k][-1]), extra, None)
        goal = [0] * len(self.body[0])
        goal[extra] = -1
        self._climb(goal)
        if extra in self.basis:
            r = self.basis.index(extra)
            if self.body[r][-1] > 0:
                return False
            self._pivot(r, next(j for j, v in enumerate(self.body[r][:-1]) if v and j != extra), None)
        for row in self.body:
            del row[extra]
        return True

    def _maximise(self, cost: Vector) -> bool:
        width = len(self.body[0]) if self.body else self.columns + 1
        goal = whole(cost) + [0] * (width - self.columns)
        if not self.body:
            return not any(v > 0 for v in goal)
        return self._climb(goal)

    def _climb(self, cost: list[int]) -> bool:
        """Pivots until nothing improves (True) or nothing limits (False)."""
        width = len(cost)
        goal = [-v * self.unit for v in cost]
        for row, j in zip(self.body, self.basis, strict=True):
            if cost[j]:
                goal = [g + cost[j] * v for g, v in zip(goal, row, strict=True)]
        while True:
            column = next((j for j in range(width - 1) if goal[j] < 0), None)
            if column is None:
                return True
            best: int | None = None
            for k, row in enumerate(self.body):
                if row[column] <= 0:
                    continue
                if best is not None:
                    ahead = row[-1] * self.body[best][column] - self.body[best][-1] * row[column]
                    if ahead > 0 or (ahead == 0 and self.basis[k] > self.basis[best]):
                        continue
                best = k
            if best is None:
                return False
            reduced = self._pivot(best, column, goal)
            assert reduced is not None
            goal = reduced


def bounded(
    cost: Vector, matrix: Sequence[Vector], low: Vector, high: Vector, lower: Vector, upper: Vector
) -> tuple[str, Fraction, list[Fraction]]:
    """Minimise c x over low <= A x <= high, lower <= x <= upper: status, value and point."""
    parts: list[tuple[int, int, Fraction]] = []  # (variable, sign, origin) of each column
    for j, (a, b) in enumerate(zip(lower, upper, strict=True)):
        if math.isfinite(a):
            parts.append((j, 1, Fraction(a)))
        elif math.isfinite(b):
            parts.append((j, -1, Fraction(b)))
        else:
            parts += [(j, 1, Fraction(0)), (j, -1, Fraction(0))]
    origin = [Fraction(0)] * len(cost)
    for j, _, start in parts:
        origin[j] = start
    rows: list[list[Fraction]] = []
    right: list[Fraction] = []
    for row, least, most in zip(matrix, low, high, strict=True):
        exact = [Fraction(v) for v in row]
        moved = sum((v * x for v, x in zip(exact, origin, strict=True)), Fraction(0))
        for side, sign in ((most, 1), (least, -1)):
            if math.isfinite(side):
                rows.append([sign * s * exact[j] for j, s, _ in parts])
                right.append(sign * (Fraction(side) - moved))
    for column, (j, _, _) in enumerate(parts):
        if math.isfinite(lower[j]) and math.isfinite(upper[j]):
            rows.append([Fraction(int(k == column)) for k in range(len(parts))])
            right.append(Fraction(upper[j]) - Fraction(lower[j]))
    optimum = Tableau([-s * Fraction(cost[j]) for j, s, _ in parts], rows, right)
    point = list(origin)
    for (j, s, _), x in zip(parts, optimum.point, strict=True):
        point[j] += s * x
    value = sum((Fraction(c) * x for c, x in zip(cost, point, strict=True)), Fraction(0))
    return optimum.status, value, point
