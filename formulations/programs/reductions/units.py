"""Units in which a program has the magnitudes that solvers count in: powers of two, so that nothing is rounded.

Solvers decide with absolute tolerances, 1e-6 a row and 1e-9 a coefficient, which mean nothing for weights of 1e-9 or times of 1e12.
With x = S x' and row factors R, and f for the objective, all of them powers of two::

    min c x + c0,  l <= A x <= u      becomes      min f c S x' + f c0,  R l <= R A S x' <= R u

Integers keep their unit, and rows of ones theirs. The powers follow from the data alone, so that the program is the same to the bit in
whatever unit these are. Whole numbers and short decimals of ordinary size stay so, but for a power of two that all of a row, of the
objective or of what stands beside a block of variables have in common; all else is brought to one size.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..program import Floats, Program
from .reduction import Reduction, Step

SMALLEST, LARGEST = -4, 20
"""Binary exponents of ordinary sizes: from 1/16, of which a solver's tolerance is 1.6e-5, to a million."""

SPREAD = 10
"""Binary exponent of how far apart the variables of a block may be and still have one unit."""

COMMON = 2
"""Binary exponent of the size that other numbers are brought to."""

_PASSES = 4

_BITS = 30
"""Bits of whole numbers, and of short decimals once they are multiplied: 20 before the point and three digits behind it."""

_ROUNDING = 2.0**-20
"""Rounding of doubles, fourfold, in steps of 2**-_BITS of the largest number."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Scaled(Step):
    """A program in other units; ``columns``, ``rows`` and ``objective`` are the binary exponents of S, R and f."""

    name = "units"
    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    objective: int

    def vector(self, x: Floats) -> Floats:
        return np.asarray(np.ldexp(x, self.columns), dtype=np.float64)

    def encoded(self, x: Floats) -> Floats:
        return np.asarray(np.ldexp(x, -self.columns), dtype=np.float64)

    def residual(self, x: Floats) -> float:
        """Largest violation by a vector of the original program, in the solver's units."""
        return float(self.program.residual(self.encoded(x)))

    def counted(self, value: float) -> float:
        """Objective of the original program, in the solver's unit."""
        return _times(value, self.objective)

    def value(self, value: float) -> float:
        return _times(value, -self.objective)

    def duals(self, duals: Floats) -> Floats:
        return np.asarray(np.ldexp(duals, self.rows - self.objective), dtype=np.float64)


def scaled(program: Program) -> Scaled:
    """The program with numbers of ordinary size, as far as one factor per row and a block of columns can bring them there."""
    row = np.repeat(np.arange(program.num_rows), np.diff(program.indptr))
    columns = _column_units(program, row)
    rows, objective = _row_units(program, row, columns), _objective_unit(program, columns)
    same = Scaled(program=program, columns=0 * columns, rows=0 * rows, objective=0)
    if not (columns.any() or rows.any() or objective):
        return same
    if not math.isfinite(_times(program.offset, objective)):
        objective = 0
    with np.errstate(over="ignore"):
        result = _apply(program, columns, rows, objective)
    if any(np.isfinite(new).sum() < np.isfinite(old).sum() for old, new in zip(_numbers(program), _numbers(result), strict=True)):
        return same  # numbers too far apart for any unit
    note = f"{program.num_variables} variables and {program.num_rows} rows brought to ordinary sizes by powers of two"
    return Scaled(program=result, told=note, columns=columns, rows=rows, objective=objective)


class Units(Reduction):
    """Brings programs to ordinary units, the same for data in any unit."""

    def apply(self, program: Program) -> tuple[Step, ...]:
        step = scaled(program)
        return () if step.program is program else (step,)


UNITS = Units()


def objective_unit(program: Program) -> float:
    """A solver's unit of the objective, in the program's own unit."""
    return _times(1.0, -scaled(program).objective)


def _numbers(p: Program) -> tuple[Floats, ...]:
    return p.cost, p.lower, p.upper, p.row_lower, p.row_upper, p.data


def _column_units(program: Program, row: NDArray[np.int64]) -> NDArray[np.int64]:
    """Binary exponents of S; integers are counted by one.

    Continuous variables are counted as their bounds and as the other numbers in their rows are, where all of these are short decimals; else
    their bounds decide, else their size. A variable beside nothing but other continuous variables follows these.
    """
    none = np.zeros(program.num_variables, dtype=np.int64)
    if program.integer.all():
        return none
    sizes, group = _sizes(program, row)
    many = int(group.max()) + 1
    held, bounds = program.data != 0, np.abs(np.concatenate([program.lower, program.upper]))
    fixed, free = (held & part[program.indices] for part in (program.integer, ~program.integer))
    sides, at = _sides(program)
    beside = _counted(np.concatenate([np.abs(program.data[fixed]), sides]), np.concatenate([row[fixed], at]), program.num_rows)
    i, g, entry = row[free], group[program.indices[free]], np.abs(program.data[free])
    some = beside.largest[i] > 0
    with np.errstate(over="ignore", under="ignore", divide="ignore"):
        least = np.ldexp(1.0 / beside.decimals[i[some]], beside.units[i[some]])  # infinite where there is no decimal
        numbers = np.concatenate([bounds, beside.largest[i[some]] / entry[some], least / entry[some]])
    counted = _counted(numbers, np.concatenate([group, group, g[some], g[some]]), many)
    bounded = _counted(bounds, np.concatenate([group, group]), many)
    beside_integers = np.zeros(many, dtype=bool)
    beside_integers[g[(np.bincount(row[fixed], minlength=program.num_rows) > 0)[i]]] = True
    all_counted = ((bounded.largest > 0) | beside_integers) & (counted.decimals > 0)
    all_counted[g[some][beside.decimals[i[some]] == 0]] = False
    good = all_counted | (bounded.decimals > 0)
    units = np.where(all_counted, counted.units, bounded.units)
    alone = counted.largest == 0
    for _ in range(_PASSES):
        known, unknown = good[g], alone[g]
        least_of_row = np.full(program.num_rows, math.inf)
        np.minimum.at(least_of_row, i[known], np.ldexp(entry[known], units[g[known]]))
        reached = unknown & np.isfinite(least_of_row[i])
        if not reached.any():
            break
        least_of_group = np.full(many, math.inf)
        np.minimum.at(least_of_group, g[reached], least_of_row[i[reached]] / entry[reached])
        new = np.isfinite(least_of_group)
        units[new] = np.frexp(least_of_group[new])[1] - 1
        good |= new
        alone &= ~new
    return np.where(program.integer, 0, np.where(good[group], units[group], _shift(sizes)))


def _row_units(program: Program, row: NDArray[np.int64], columns: NDArray[np.int64]) -> NDArray[np.int64]:
    """Binary exponents of R; sides count where that leaves them whole, but rows of ones stay so."""
    many = program.num_rows
    with np.errstate(over="ignore", under="ignore"):
        entries = np.ldexp(np.abs(program.data), columns[program.indices])
    units = _counted(entries, row, many).units
    held = entries > 0.0
    empty = np.bincount(row[held], minlength=many) == 0
    ones = ~empty
    ones[row[held & (np.ldexp(entries, -units[row]) != 1.0)]] = False
    sides, at = _sides(program)
    counted = _counted(np.concatenate([entries, sides]), np.concatenate([row, at]), many)
    return -np.where((counted.decimals > 0) & ~ones | empty, counted.units, units)


def _sides(program: Program) -> tuple[Floats, NDArray[np.int64]]:
    """Sizes of the finite sides of rows, and the row of each."""
    sides = np.abs(np.concatenate([program.row_lower, program.row_upper]))
    limited = np.isfinite(sides)
    return sides[limited], np.tile(np.arange(program.num_rows), 2)[limited]


def _objective_unit(program: Program, columns: NDArray[np.int64]) -> int:
    with np.errstate(over="ignore", under="ignore"):
        costs = np.ldexp(np.abs(program.cost), columns)
        if program.quadratic is not None:
            q = program.quadratic.tocoo()
            costs = np.append(costs, np.ldexp(np.abs(q.data), columns[q.row] + columns[q.col]))
    return -int(_counted(costs, np.zeros(len(costs), dtype=np.int64), 1).units[0])


@dataclass(frozen=True, eq=False)
class _Counts:
    """Units of groups of numbers; arrays of shape (groups,).

    ``units`` are binary exponents, 0 without a number; ``decimals`` the least of 1, 10, 100 and 1000 times which all numbers in these
    units are whole, 0 where none does it; ``largest`` the largest number, in its own units.
    """

    units: NDArray[np.int64]
    decimals: Floats
    largest: Floats


def _counted(values: Floats, group: NDArray[np.int64], groups: int) -> _Counts:
    """The unit of each group of numbers, the same whatever all of them are multiplied by.

    It is the largest power of two of which all of them, times 1, 10, 100 or 1000, are multiples, if the largest number is then of ordinary
    size, so that whole numbers and short decimals stay so. Else it brings the largest to the common size, or the least to 1 if that is
    more, as far as the largest stays ordinary: small numbers are not lost among a solver's tolerances.
    """
    kept = (values > 0) & np.isfinite(values)
    values, group = values[kept], group[kept]
    largest = np.zeros(groups)
    np.maximum.at(largest, group, values)
    least = np.full(groups, math.inf)
    np.minimum.at(least, group, values)
    top, low = (np.frexp(np.where((ends > 0) & np.isfinite(ends), ends, 1.0))[1].astype(np.int64) - 1 for ends in (largest, least))
    units = np.where(largest > 0, np.maximum(top - (LARGEST - 1), np.minimum(top - COMMON, low)), 0)
    counted_in = np.zeros(groups)
    for decimals in (1.0, 10.0, 100.0, 1000.0):
        if not len(values):
            break
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            top = np.frexp(largest * decimals)[1].astype(np.int64)
            steps = np.ldexp(values * decimals, _BITS - top[group])
            near = np.rint(steps)
            bad = ~(np.abs(steps - near) <= _ROUNDING) | (near == 0)
        counts = np.where(bad, 1.0, near).astype(np.int64)
        lowest, most = np.full(groups, 2**_BITS), np.zeros(groups, dtype=np.int64)
        np.minimum.at(lowest, group, counts & -counts)
        np.maximum.at(most, group, counts)
        good = _ordinary(most / lowest / decimals)
        good[group[bad]] = False
        units[good] = (top - _BITS + np.log2(lowest).astype(np.int64))[good]
        counted_in[good] = decimals
        uncounted = ~good[group]
        values, group = values[uncounted], group[uncounted]
    return _Counts(units, counted_in, largest)


def _ordinary(sizes: Floats) -> NDArray[np.bool_]:
    return (sizes >= 2.0**SMALLEST) & (sizes < 2.0**LARGEST)


def _shift(sizes: Floats) -> NDArray[np.int64]:
    """Binary exponents to be taken off sizes; 0 where a size is not known."""
    with np.errstate(invalid="ignore"):
        exponent = np.frexp(sizes)[1].astype(np.int64) - 1 - COMMON
    return np.where((sizes > 0) & np.isfinite(sizes), exponent, 0)


def _sizes(program: Program, row: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    """Sizes of variables by their bounds, or by the numbers in their rows, 0 where neither tells; and groups of one size.

    A block has one size, as its variables are of one kind, so that rows that add them up keep their coefficients of 1; but each variable
    has its own where they are more than 2**SPREAD apart.
    """
    bounds = np.maximum(*(np.where(np.isfinite(end), np.abs(end), 0.0) for end in (program.lower, program.upper)))
    size = np.where(program.integer, np.maximum(bounds, 1.0), bounds)
    sides = np.maximum(*(np.where(np.isfinite(side), np.abs(side), 0.0) for side in (program.row_lower, program.row_upper)))
    held = program.data != 0
    at, column, entry = row[held], program.indices[held], np.abs(program.data[held])
    with np.errstate(over="ignore", under="ignore"):
        for _ in range(_PASSES):
            unknown = size == 0
            if not unknown[column].any():
                break
            level = sides.copy()
            np.maximum.at(level, at, entry * size[column])
            open_ = unknown[column] & (level[at] > 0)
            if not open_.any():
                break
            implied = np.full(len(size), math.inf)
            np.minimum.at(implied, column[open_], level[at[open_]] / entry[open_])
            size = np.where(unknown & np.isfinite(implied), implied, size)
    # A bound may be far beyond anything that the rows let a variable be: what these speak of counts where it is less.
    level, free = sides.copy(), ~program.integer[column]
    with np.errstate(over="ignore", under="ignore"):
        np.maximum.at(level, at[~free], entry[~free] * size[column[~free]])
        implied = np.zeros(len(size))
        np.maximum.at(implied, column[free], level[at[free]] / entry[free])
    size = np.where((implied > 0) & np.isfinite(implied), np.minimum(size, implied), size)
    held_blocks = [k for k, b in enumerate(program.variables) if b.size]
    if not held_blocks:
        return size, np.zeros(0, dtype=np.int64)
    starts, widths = np.cumsum([0, *(b.size for b in program.variables)])[held_blocks], [program.variables[k].size for k in held_blocks]
    largest = np.repeat(np.maximum.reduceat(size, starts), widths)
    least = np.repeat(np.minimum.reduceat(np.where(size > 0, size, math.inf), starts), widths)
    apart = (largest > 2.0**SPREAD * least) & (size > 0)
    block = np.repeat(np.arange(len(widths)), widths)
    return np.where(apart, size, largest), np.where(apart, len(widths) + np.arange(len(size)), block)


def _apply(program: Program, columns: NDArray[np.int64], rows: NDArray[np.int64], objective: int) -> Program:
    variables, first = [], 0
    for block in program.variables:
        by = columns[first : first + block.size]
        first += block.size
        scaled_block = replace(
            block, lower=np.ldexp(block.lower, -by), upper=np.ldexp(block.upper, -by), cost=np.ldexp(block.cost, by + objective)
        )  # fmt: skip
        variables.append(scaled_block)
    scaled_rows, first = [], 0
    for part in program.rows:
        by = rows[first : first + part.size]
        first += part.size
        data = np.ldexp(part.data, columns[part.indices] + np.repeat(by, np.diff(part.indptr)))
        scaled_rows.append(replace(part, data=data, lower=np.ldexp(part.lower, by), upper=np.ldexp(part.upper, by)))
    quadratic = program.quadratic
    if quadratic is not None:
        q = quadratic.tocoo()
        q.data = np.ldexp(q.data, columns[q.row] + columns[q.col] + objective)
        quadratic = q.tocsr()
    cones = []
    for cone in program.cones:  # a cone is one whatever its unit
        data = np.ldexp(cone.data, columns[cone.indices])
        unit = -int(_shift(np.abs(np.concatenate([data, cone.offset, [0.0]])).max(keepdims=True))[0])
        cones.append(replace(cone, data=np.ldexp(data, unit), offset=np.ldexp(cone.offset, unit)))
    offset = _times(program.offset, objective)
    return replace(
        program, variables=tuple(variables), rows=tuple(scaled_rows), offset=offset, quadratic=quadratic, cones=tuple(cones)
    )  # fmt: skip


def _times(value: float, exponent: int) -> float:
    with np.errstate(over="ignore", under="ignore"):
        return float(np.ldexp(value, exponent))
