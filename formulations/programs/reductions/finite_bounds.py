"""Finite bounds for the variables of a program, from its rows and from its objective."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..program import Floats, Program
from .reduction import Reduction, Step

PASSES = 20
WIDEST = 1e12
"""Bounds beyond this are not worth having."""

_SLACK = 1e-9


class Bounded(Step):
    """The same variables, with bounds that leave the optimum in place; infinite where none could be derived."""

    name = "finite-bounds"


class FiniteBounds(Reduction):
    """Derives bounds where the given ones are infinite.

    A missing bound is taken from a row, whose other variables are bounded; or from the objective: a variable that costs nothing or more
    need not exceed what the rows can ever ask of it. Bounds are moved outwards by more than their rounding, new ones of integer
    variables to whole numbers. An infeasible program stays infeasible.
    """

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``; the rows hold each column once."""
        search = _Search(program)
        for _ in range(PASSES):
            if not (np.isinf(search.lower) | np.isinf(search.upper)).any():
                break
            if not (search.from_rows() or search.from_objective()):
                break
        count = int(((search.lower != program.lower) | (search.upper != program.upper)).sum())
        if not count:
            return ()
        variables, first = [], 0
        for block in program.variables:
            mine = slice(first, first := first + block.size)
            variables.append(replace(block, lower=search.lower[mine], upper=search.upper[mine]))
        note = f"bounds of {count} variables from rows and objective"
        return (Bounded(program=replace(program, variables=tuple(variables)), told=note),)


FINITE_BOUNDS = FiniteBounds()


class _Search:
    def __init__(self, program: Program) -> None:
        sign = 1.0 if program.sense == "min" else -1.0
        self.cost = sign * program.cost
        self.multiplied = np.zeros(program.num_variables, dtype=bool)
        if program.quadratic is not None:
            self.multiplied[np.asarray(abs(program.quadratic).sum(axis=0)).ravel() > 0] = True
        self.integer = program.integer
        self.lower, self.upper = program.lower, program.upper
        entry = program.data != 0
        self.row = np.repeat(np.arange(program.num_rows), np.diff(program.indptr))[entry]
        self.column, self.value = program.indices[entry], program.data[entry]
        self.rows, self.row_lower, self.row_upper = program.num_rows, program.row_lower, program.row_upper

    def _rest(self) -> tuple[Floats, Floats]:
        """Smallest and largest sum of the other entries in the row of each entry."""
        up = self.value > 0
        least = self.value * np.where(up, self.lower[self.column], self.upper[self.column])
        most = self.value * np.where(up, self.upper[self.column], self.lower[self.column])
        return self._without_own(least, -np.inf), self._without_own(most, np.inf)

    def _without_own(self, extreme: Floats, endless: float) -> Floats:
        open_ = np.isinf(extreme)
        finite = np.where(open_, 0.0, extreme)
        total = np.bincount(self.row, finite, minlength=self.rows)
        size = np.bincount(self.row, np.abs(finite), minlength=self.rows)
        count = np.bincount(self.row, open_, minlength=self.rows)
        rest = (total[self.row] - finite) + np.sign(endless) * _SLACK * (1.0 + size[self.row]) * 1e-3
        return np.where(count[self.row] - open_ > 0, endless, rest)

    def from_rows(self) -> bool:
        """Take bounds that single rows imply; whether any is new."""
        least, most = self._rest()
        up = self.value > 0
        with np.errstate(invalid="ignore"):
            ceiling, floor = (self.row_upper[self.row] - least) / self.value, (self.row_lower[self.row] - most) / self.value
        above, below = np.where(up, ceiling, floor), np.where(up, floor, ceiling)
        high, low = np.full(len(self.upper), np.inf), np.full(len(self.lower), -np.inf)
        np.minimum.at(high, self.column, np.where(np.isnan(above), np.inf, above))
        np.maximum.at(low, self.column, np.where(np.isnan(below), -np.inf, below))
        return self._take(np.isinf(self.upper), high, np.isinf(self.lower), low)

    def from_objective(self) -> bool:
        """Take bounds beyond which a variable only costs; whether any is new."""
        least, most = self._rest()
        up, plain = self.value > 0, ~self.multiplied
        # What a row can at most ask of the variable: from below where that helps it, from above likewise.
        with np.errstate(invalid="ignore"):
            by_lower = np.where(np.isfinite(self.row_lower)[self.row], (self.row_lower[self.row] - least) / self.value, np.nan)
            by_upper = np.where(np.isfinite(self.row_upper)[self.row], (self.row_upper[self.row] - most) / self.value, np.nan)
        upward, downward = np.where(up, by_lower, by_upper), np.where(up, by_upper, by_lower)
        high, low = self.lower.copy(), self.upper.copy()
        np.maximum.at(high, self.column, np.where(np.isnan(upward), -np.inf, upward))
        np.minimum.at(low, self.column, np.where(np.isnan(downward), np.inf, downward))
        high = np.where(np.isinf(self.lower) & (high == -np.inf), np.inf, np.maximum(high, self.lower))
        low = np.where(np.isinf(self.upper) & (low == np.inf), -np.inf, np.minimum(low, self.upper))
        return self._take(
            np.isinf(self.upper) & plain & (self.cost >= 0), high, np.isinf(self.lower) & plain & (self.cost <= 0), low, ask=True
        )

    def _take(self, upper: NDArray[np.bool_], high: Floats, lower: NDArray[np.bool_], low: Floats, *, ask: bool = False) -> bool:
        """Take finite ``high`` and ``low`` as bounds where ``upper`` and ``lower`` say so; with ``ask`` they are rounded up to what rows
        need."""
        near = tuple(_SLACK * np.maximum(1.0, np.where(np.isfinite(v), np.abs(v), 0.0)) for v in (high, low))
        whole = (np.ceil(high - near[0]), np.floor(low + near[1])) if ask else (np.floor(high + near[0]), np.ceil(low - near[1]))
        high, low = np.where(self.integer, whole[0], high + near[0]), np.where(self.integer, whole[1], low - near[1])
        upper, lower = upper & (np.abs(high) < WIDEST), lower & (np.abs(low) < WIDEST)
        if ask:
            lower &= ~upper  # what leaves room on both sides could be cut from both
        self.upper, self.lower = np.where(upper, high, self.upper), np.where(lower, low, self.lower)
        return bool(upper.any() or lower.any())
