"""What no hand-over lets pass."""

from __future__ import annotations

import numpy as np

from ....instances.errors import InputError, UnsupportedError
from ..program import Floats, Indices, Program


def refuse_cones(program: Program, target: str) -> None:
    """Raise UnsupportedError for a program with cones."""
    if program.cones:
        raise UnsupportedError(target, {"cone programs"})


def refuse_circuits(program: Program, target: str) -> None:
    """Raise UnsupportedError for a program with circuits."""
    if program.circuits:
        raise UnsupportedError(target, {"circuits"})


def refuse_quadratic(program: Program, target: str) -> None:
    """Raise UnsupportedError for a program with a quadratic objective."""
    if program.quadratic is not None:
        raise UnsupportedError(target, {"quadratic programs"})


def refuse_levels(program: Program, target: str) -> None:
    """Raise UnsupportedError for a program with several objectives in order of priority."""
    if program.further:
        raise UnsupportedError(target, {"levels of priority"})


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
