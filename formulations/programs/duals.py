"""The value of a dual vector of a linear program."""

from __future__ import annotations

import numpy as np

from .program import Floats, Program


def dual_value(program: Program, row_duals: Floats) -> float:
    """Lagrangian value of the rows' duals over the bounds of the columns; minus (plus) infinity where unbounded."""
    sign = 1.0 if program.sense == "min" else -1.0
    y = sign * np.asarray(row_duals, dtype=np.float64)
    reduced = sign * program.cost - program.matrix.T @ y
    value = _least(y, program.row_lower, program.row_upper) + _least(reduced, program.lower, program.upper)
    return sign * value + program.offset


def _least(price: Floats, lower: Floats, upper: Floats) -> float:
    """Sum of ``price`` times the bound that it is smallest at; prices of 0 ignore their bounds."""
    bound = np.where(price > 0, lower, upper)
    used = np.abs(price) > 1e-9
    return float(price[used] @ bound[used])
