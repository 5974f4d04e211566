"""What no hand-over lets pass."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ....instances.errors import InputError, UnsupportedError
from ..program import Floats, Indices, Program


def refuse_cones(program: Program, target: str) -> None:
    """Raise UnsupportedError for a program with cones."""
    if program.cones:
        raise UnsupportedError(target, {"cone programs"})


def refuse_quadratic(program: Program, target: str) -> None:
    """Raise UnsupportedError for a program with a quadratic objective."""
    if program.quadratic is not None:
        raise UnsupportedError(target, {"quadratic programs"})


def refuse_numbers(program: Program) -> None:
    """Raise InputError, naming the place, for a NaN anywhere or an infinite cost, coefficient or constant."""
    _refuse_infinite(program.cost, "cost of variable", program.variable_name)
    _refuse_infinite(program.data, "coefficient of", lambda k: _entry_name(program, k))
    for values, what, name in (
        (program.lower, "lower bound of variable", program.variable_name),
        (program.upper, "upper bound of variable", program.variable_name),
        (program.row_lower, "left side of row", program.row_name),
        (program.row_upper, "right side of row", program.row_name),
    ):
        if np.isnan(values).any():
            raise InputError(f"{what} {name(int(np.argmax(np.isnan(values))))} is not a number")
    if not np.isfinite(program.offset):
        raise InputError("the constant of the objective is not a finite number", found=str(program.offset))
    if program.quadratic is not None:
        _refuse_infinite(np.asarray(program.quadratic.data, dtype=np.float64), "quadratic coefficient number", str)
    for block in program.cones:
        _refuse_infinite(np.concatenate([block.data, block.offset]), f"entry of cones {block.name}, number", str)


def refuse_crossing(program: Program) -> None:
    """Raise InputError for lower bounds above upper ones: a program that says at once that it has no answer."""
    for lower, upper, what, name in (
        (program.lower, program.upper, "bounds of variable", program.variable_name),
        (program.row_lower, program.row_upper, "sides of row", program.row_name),
    ):
        crossed = lower > upper
        if crossed.any():
            k = int(np.argmax(crossed))
            raise InputError(f"the {what} {name(k)} cross, so that the program has no answer", found=f"{lower[k]:g} > {upper[k]:g}")


def merged_rows(program: Program) -> tuple[Indices, Indices, Floats]:
    """Row starts, columns and coefficients with each column once a row, in ascending order."""
    matrix = program.matrix
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    return matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32), matrix.data


def _refuse_infinite(values: Floats, what: str, name: Callable[[int], str]) -> None:
    # A sum is finite unless an entry is not, or it overflows; only then is it worth looking closer.
    with np.errstate(over="ignore", invalid="ignore"):
        doubtful = not np.isfinite(values.sum())
    if doubtful and not np.isfinite(values).all():
        k = int(np.argmax(~np.isfinite(values)))
        raise InputError(f"{what} {name(k)} is not a finite number", found=str(values[k]))


def _entry_name(program: Program, k: int) -> str:
    row = int(np.searchsorted(program.indptr, k, side="right")) - 1
    return f"{program.variable_name(int(program.indices[k]))} in row {program.row_name(row)}"
