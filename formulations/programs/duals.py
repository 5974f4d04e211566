"""Value of a dual vector of a linear program."""

import numpy as np
from numpy.typing import NDArray

from .program import Floats, Program

NOISE = 1e-9
"""Part of the terms of a reduced cost below which it is a solver's rounding."""


def dual_value(program: Program, row_duals: Floats) -> float:
    """Lagrangian value of the rows' duals over the bounds of the columns; minus (plus) infinity where unbounded."""
    sign = 1.0 if program.sense == "min" else -1.0
    y = sign * np.asarray(row_duals, dtype=np.float64)
    row = np.repeat(np.arange(program.num_rows), np.diff(program.indptr))
    terms = program.data * y[row]
    reduced = sign * program.cost - np.bincount(program.indices, terms, minlength=program.num_variables)
    weight = np.abs(program.cost) + np.bincount(program.indices, np.abs(terms), minlength=program.num_variables)
    felt = np.zeros(program.num_rows, dtype=bool)
    felt[row[np.abs(terms) > NOISE * weight[program.indices]]] = True
    value = _least(y, felt, program.row_lower, program.row_upper)
    value += _least(reduced, np.abs(reduced) > NOISE * weight, program.lower, program.upper)
    return sign * value + program.offset


def _least(price: Floats, felt: NDArray[np.bool_], lower: Floats, upper: Floats) -> float:
    """Sum of ``price`` times the bound at which it is least; prices that are not ``felt`` ignore their bounds."""
    bound = np.where(price > 0, lower, upper)
    return float(price[felt] @ bound[felt])
