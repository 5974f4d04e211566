"""Linear programs in fractions: the simplex method on dictionaries with Bland's rule, which ends whatever the ties.

Source: Chvátal (1983), Linear Programming, chapters 2 and 3.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

Vector = list[Fraction]
ZERO, ONE = Fraction(0), Fraction(1)


@dataclass(frozen=True)
class Optimum:
    """``status`` is ``optimal, infeasible`` or ``unbounded``; the others hold for ``optimal`` alone."""

    status: str
    value: Fraction = ZERO
    point: tuple[Fraction, ...] = ()


class _Dictionary:
    """``basic[i] = constants[i] + entries[i] nonbasic``, and the objective, to be minimised, likewise."""

    def __init__(self, entries: list[Vector], constants: Vector) -> None:
        self.entries, self.constants = entries, constants
        width = len(entries[0]) if entries else 0
        self.nonbasic, self.basic = list(range(width)), list(range(width, width + len(entries)))
        self.cost: Vector = []
        self.value = ZERO

    def price(self, cost: Sequence[Fraction], value: Fraction = ZERO) -> None:
        """Write the objective ``value + sum cost[j] x_j`` in the variables that are not basic."""
        spread = dict(enumerate(cost))
        self.cost, self.value = [spread.get(j, ZERO) for j in self.nonbasic], value
        for row, (variable, constant) in enumerate(zip(self.basic, self.constants, strict=True)):
            factor = spread.get(variable, ZERO)
            if factor:
                self.value += factor * constant
                self.cost = [c + factor * e for c, e in zip(self.cost, self.entries[row], strict=True)]

    def pivot(self, row: int, column: int) -> None:
        """Exchange the basic variable of ``row`` with the nonbasic one of ``column``."""
        by = self.entries[row][column]
        solved = [-e / by for e in self.entries[row]]
        solved[column], constant = ONE / by, -self.constants[row] / by

        def replaced(entries: Vector) -> Vector:
            factor = entries[column]
            row_after = [e + factor * s for e, s in zip(entries, solved, strict=True)]
            row_after[column] = factor * solved[column]
            return row_after

        for k, entries in enumerate(self.entries):
            if k != row and entries[column]:
                self.constants[k] += entries[column] * constant
                self.entries[k] = replaced(entries)
        self.value += self.cost[column] * constant
        self.cost = replaced(self.cost)
        self.entries[row], self.constants[row] = solved, constant
        self.basic[row], self.nonbasic[column] = self.nonbasic[column], self.basic[row]

    def minimise(self) -> bool:
        """Pivot to an optimum; False if there is none because the objective falls for ever."""
        while True:
            entering = min((j for j, c in zip(self.nonbasic, self.cost, strict=True) if c < 0), default=None)
            if entering is None:
                return True
            column = self.nonbasic.index(entering)
            falling = [k for k, entries in enumerate(self.entries) if entries[column] < 0]
            if not falling:
                return False
            self.pivot(min(falling, key=lambda k: (self.constants[k] / -self.entries[k][column], self.basic[k])), column)


def minimised(cost: Sequence[Fraction], rows: Sequence[Sequence[Fraction]], limits: Sequence[Fraction]) -> Optimum:
    """The least ``cost x`` over ``rows x <= limits``, ``x >= 0``."""
    dictionary = _Dictionary([[*(-e for e in row), ONE] for row in rows], list(limits))
    helper = len(cost)  # makes every row feasible where it is large enough
    if not rows:
        return Optimum("unbounded") if any(c < 0 for c in cost) else Optimum("optimal", ZERO, (ZERO,) * len(cost))
    dictionary.price([ZERO] * helper + [ONE])
    worst = min(range(len(rows)), key=lambda k: dictionary.constants[k])
    if dictionary.constants[worst] < 0:
        dictionary.pivot(worst, helper)
        dictionary.minimise()
        if dictionary.value > 0:
            return Optimum("infeasible")
        if helper in dictionary.basic:  # at 0: any exchange keeps the point
            row = dictionary.basic.index(helper)
            column = next((k for k, e in enumerate(dictionary.entries[row]) if e), None)
            if column is None:
                del dictionary.entries[row], dictionary.constants[row], dictionary.basic[row]
            else:
                dictionary.pivot(row, column)
    if helper in dictionary.nonbasic:
        column = dictionary.nonbasic.index(helper)
        del dictionary.nonbasic[column]
        for entries in dictionary.entries:
            del entries[column]
    dictionary.price(cost)
    if not dictionary.minimise():
        return Optimum("unbounded")
    levels = dict(zip(dictionary.basic, dictionary.constants, strict=True))
    return Optimum("optimal", dictionary.value, tuple(levels.get(j, ZERO) for j in range(len(cost))))


@dataclass(frozen=True)
class Region:
    """``row_lower <= rows x <= row_upper``, ``lower <= x <= upper``; sides and bounds are doubles, infinite where there is none."""

    rows: Sequence[Sequence[Fraction]]
    row_lower: Sequence[float | Fraction]
    row_upper: Sequence[float | Fraction]
    lower: Sequence[float | Fraction]
    upper: Sequence[float | Fraction]

    def sides(self) -> list[tuple[Vector, Fraction]]:
        """All of it as rows ``a x <= b``."""
        unit = [[ONE if j == k else ZERO for j in range(len(self.lower))] for k in range(len(self.lower))]
        ranges = [(row, low, high) for row, low, high in zip(self.rows, self.row_lower, self.row_upper, strict=True)]
        ranges += list(zip(unit, self.lower, self.upper, strict=True))
        upper_sides = [(list(row), Fraction(high)) for row, _, high in ranges if not math.isinf(high)]
        return upper_sides + [([-e for e in row], -Fraction(low)) for row, low, _ in ranges if not math.isinf(low)]

    def minimised(self, cost: Sequence[Fraction]) -> Optimum:
        """The least ``cost x``; the point is left out."""
        if any(low > high for low, high in zip(self.lower, self.upper, strict=True)):
            return Optimum("infeasible")
        # Every variable as the difference of two that are not negative: bounds are rows like any other.
        sides = self.sides()
        doubled = [[*row, *(-e for e in row)] for row, _ in sides]
        solution = minimised([*cost, *(-c for c in cost)], doubled, [limit for _, limit in sides])
        half = len(cost)
        point = tuple(a - b for a, b in zip(solution.point[:half], solution.point[half:], strict=True))
        return Optimum(solution.status, solution.value, point)

    def falls_for_ever(self, cost: Sequence[Fraction]) -> bool:
        """Look for a direction that no side limits and that lowers ``cost x``."""
        width = len(cost)
        sides = [row for row, _ in self.sides()]
        box = Region(sides, [-math.inf] * len(sides), [ZERO] * len(sides), [-ONE] * width, [ONE] * width)
        return box.minimised(cost).value < 0
