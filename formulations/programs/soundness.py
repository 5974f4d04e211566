"""Checks a program for meaningless numbers, such as NaN."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ...instances.errors import InputError

if TYPE_CHECKING:
    from .program import Floats, Program

SYMMETRIC = 1e-9
"""Relative difference up to which two quadratic coefficients are the same one."""


def refuse_numbers(program: Program) -> None:
    """Raise InputError, naming the place, for numbers that mean nothing.

    A NaN anywhere; an infinite cost, coefficient or constant; a limit that leaves no number; a column that does not exist; two
    coefficients of one product, for each solver reads but one of them; circuits over nodes, arcs or columns that are none.
    """
    if program.indices.size and (program.indices.min() < 0 or program.indices.max() >= program.num_variables):
        raise InputError("a row names a column that does not exist", "unknown-name", expected=f"0 to {program.num_variables - 1}")
    _refuse_infinite(program.cost, "cost of variable", program.variable_name)
    _refuse_infinite(program.data, "coefficient of", lambda k: _entry_name(program, k))
    for values, wrong, what, name in (
        (program.lower, np.inf, "lower bound of variable", program.variable_name),
        (program.upper, -np.inf, "upper bound of variable", program.variable_name),
        (program.row_lower, np.inf, "left side of row", program.row_name),
        (program.row_upper, -np.inf, "right side of row", program.row_name),
    ):
        if np.isnan(values).any():
            raise InputError(f"{what} {name(int(np.argmax(np.isnan(values))))} is not a number", "out-of-range")
        if (values == wrong).any():
            raise InputError(f"{what} {name(int(np.argmax(values == wrong)))} leaves no number", "out-of-range", found=str(wrong))
    if not np.isfinite(program.offset):
        raise InputError("the constant of the objective is not a finite number", "out-of-range", found=str(program.offset))
    if program.quadratic is not None:
        _refuse_infinite(np.asarray(program.quadratic.data, dtype=np.float64), "quadratic coefficient number", str)
        skew = abs(program.quadratic - program.quadratic.T)
        if skew.nnz and skew.max() > SYMMETRIC * abs(program.quadratic).max():
            one, other = (program.variable_name(int(k)) for k in sorted(np.unravel_index(int(skew.argmax()), skew.shape)))
            raise InputError(f"the quadratic part is not symmetric: {one} times {other}", "contradiction")
    for block in program.cones:
        _refuse_infinite(np.concatenate([block.data, block.offset]), f"entry of cones {block.name}, number", str)
    for graph in program.circuits:
        fault = graph.fault(program.lower, program.upper, program.integer)
        if fault:
            raise InputError(f"circuit {graph.name}: {fault}")


def _refuse_infinite(values: Floats, what: str, name: Callable[[int], str]) -> None:
    # A sum is finite unless an entry is not, or it overflows; only then is it worth looking closer.
    with np.errstate(over="ignore", invalid="ignore"):
        doubtful = not np.isfinite(values.sum())
    if doubtful and not np.isfinite(values).all():
        k = int(np.argmax(~np.isfinite(values)))
        raise InputError(f"{what} {name(k)} is not a finite number", "out-of-range", found=str(values[k]))


def _entry_name(program: Program, k: int) -> str:
    row = int(np.searchsorted(program.indptr, k, side="right")) - 1
    return f"{program.variable_name(int(program.indices[k]))} in row {program.row_name(row)}"
