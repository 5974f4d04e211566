"""Programs brought to the magnitudes that solvers count in, by powers of two: exact, and the same program whatever the unit of the data.

Solvers decide with absolute tolerances, 1e-6 a row and 1e-9 a coefficient, which mean nothing for weights of 1e-9 or times of 1e12.
With x = S x' and row factors R, and f for the objective, all of them powers of two::

    min c x + c0,  l <= A x <= u      becomes      min f c S x' + f c0,  R l <= R A S x' <= R u

Integers keep their unit, and rows of ones theirs. A program is handed over as it is if the largest entry of each row and of the objective
and the sizes of its continuous variables are ordinary; else all of them are brought to the same size, so that it is the same program
whatever the units of its data were.
"""

from __future__ import annotations

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
"""Binary exponent of the size that all numbers of other programs are brought to."""

_PASSES = 4


@dataclass(frozen=True, eq=False, kw_only=True)
class Scaled(Step):
    """A program in other units.

    Parameters
    ----------
    columns, rows : int arrays of shape (variables,) and (rows,)
        Binary exponents of S and R.
    objective : int
        That of f.
    """

    name = "units"
    columns: NDArray[np.int64]
    rows: NDArray[np.int64]
    objective: int

    def vector(self, x: Floats) -> Floats:
        return np.asarray(np.ldexp(x, self.columns), dtype=np.float64)

    def encoded(self, x: Floats) -> Floats:
        return np.asarray(np.ldexp(x, -self.columns), dtype=np.float64)

    def residual(self, x: Floats) -> float:
        """Largest violation by x, a vector of the program as it was, as a solver counts it."""
        return float(self.program.residual(self.encoded(x)))

    def value(self, value: float) -> float:
        return _times(value, -self.objective)

    def duals(self, duals: Floats) -> Floats:
        return np.asarray(np.ldexp(duals, self.rows - self.objective), dtype=np.float64)


def scaled(program: Program, *, always: bool = False) -> Scaled:
    """The program in units in which its numbers are of ordinary size, as far as one factor a row and a block of columns can do it.

    ``always`` does so to ordinary programs too: then it is the same program in any units, of whose several optima a solver finds the same.
    """
    row = np.repeat(np.arange(program.num_rows), np.diff(program.indptr))
    sizes = _sizes(program, row)
    ones, none = np.zeros(program.num_variables, dtype=np.int64), np.zeros(program.num_rows, dtype=np.int64)
    found = [np.where(program.integer, 0.0, sizes), *_heaviest(program, row, ones)]
    if not always and all(_ordinary(part) for part in found):
        return Scaled(program=program, columns=ones, rows=none, objective=0)
    columns = np.where(program.integer, 0, _shift(sizes))
    heaviest, dearest = _heaviest(program, row, columns)
    data = np.ldexp(np.abs(program.data), columns[program.indices])
    plain = np.ones(program.num_rows, dtype=bool)
    plain[row[(data != 1.0) & (data != 0.0)]] = False
    rows, objective = np.where(plain, 0, -_shift(heaviest)), -int(_shift(dearest)[0])
    if not math.isfinite(_times(program.offset, objective)):
        objective = 0
    with np.errstate(over="ignore"):
        made = _apply(program, columns, rows, objective)
    if any(np.isfinite(new).sum() < np.isfinite(old).sum() for old, new in zip(_numbers(program), _numbers(made), strict=True)):
        return Scaled(program=program, columns=ones, rows=none, objective=0)  # numbers too far apart for any unit
    told = f"{program.num_variables} variables and {program.num_rows} rows brought to ordinary sizes by powers of two"
    return Scaled(program=made, told=told, columns=columns, rows=rows, objective=objective)


class Units(Reduction):
    """Brings programs with extraordinary numbers to ordinary units."""

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``."""
        made = scaled(program)
        return () if made.program is program else (made,)


UNITS = Units()


def _numbers(p: Program) -> tuple[Floats, ...]:
    return p.cost, p.lower, p.upper, p.row_lower, p.row_upper, p.data


def _heaviest(program: Program, row: NDArray[np.int64], columns: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """The largest entry of each row, and of the objective (an array of one), with the columns in other units."""
    heaviest = np.zeros(program.num_rows)
    with np.errstate(over="ignore", under="ignore"):
        np.maximum.at(heaviest, row, np.ldexp(np.abs(program.data), columns[program.indices]))
        dearest = float(np.ldexp(np.abs(program.cost), columns).max(initial=0.0))
        if program.quadratic is not None:
            q = program.quadratic.tocoo()
            dearest = max(dearest, float(np.ldexp(np.abs(q.data), columns[q.row] + columns[q.col]).max(initial=0.0)))
    return heaviest, np.array([dearest])


def _ordinary(sizes: Floats) -> bool:
    known = sizes[(sizes > 0) & np.isfinite(sizes)]
    return bool(((known >= 2.0**SMALLEST) & (known < 2.0**LARGEST)).all())


def _shift(sizes: Floats) -> NDArray[np.int64]:
    """Binary exponents to be taken off; 0 where nothing is known."""
    with np.errstate(invalid="ignore"):
        exponent = np.frexp(sizes)[1].astype(np.int64) - 1 - COMMON
    return np.where((sizes > 0) & np.isfinite(sizes), exponent, 0)


def _sizes(program: Program, row: NDArray[np.int64]) -> Floats:
    """How large the variables are, by their bounds, or by what the rows that hold them speak of; 0 where nothing tells.

    One size a block, whose variables are of one kind, so that rows that add them up keep their coefficients of 1; but each its own where
    they are more than 2**SPREAD apart.
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
    held_blocks = [k for k, b in enumerate(program.variables) if b.size]
    if not held_blocks:
        return size
    starts, widths = np.cumsum([0, *(b.size for b in program.variables)])[held_blocks], [program.variables[k].size for k in held_blocks]
    largest = np.repeat(np.maximum.reduceat(size, starts), widths)
    least = np.repeat(np.minimum.reduceat(np.where(size > 0, size, math.inf), starts), widths)
    return np.where((largest > 2.0**SPREAD * least) & (size > 0), size, largest)


def _apply(program: Program, columns: NDArray[np.int64], rows: NDArray[np.int64], objective: int) -> Program:
    variables, first = [], 0
    for block in program.variables:
        by = columns[first : first + block.size]
        first += block.size
        made = replace(
            block, lower=np.ldexp(block.lower, -by), upper=np.ldexp(block.upper, -by), cost=np.ldexp(block.cost, by + objective)
        )  # fmt: skip
        variables.append(made)
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
