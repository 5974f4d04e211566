"""Programs that an export refuses, and rows as exports need them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....instances.errors import InputError, UnsupportedError
from ..soundness import refuse_numbers

if TYPE_CHECKING:
    from ..program import Floats, Indices, Program


def check_export(program: Program, target: str, *, cones: bool = False, quadratic: bool = True) -> None:
    """Raise UnsupportedError for a feature that ``target`` cannot hold, and InputError for numbers that mean nothing."""
    present = {
        "cone programs": bool(program.cones) and not cones,
        "circuits": bool(program.circuits),
        "quadratic programs": program.quadratic is not None and not quadratic,
        "levels of priority": bool(program.further),
    }
    for feature, is_present in present.items():
        if is_present:
            raise UnsupportedError(target, {feature})
    refuse_numbers(program)


def refuse_crossing(program: Program) -> None:
    """Raise InputError for lower bounds or sides above upper ones."""
    for lower, upper, what, name in (
        (program.lower, program.upper, "bounds of variable", program.variable_name),
        (program.row_lower, program.row_upper, "sides of row", program.row_name),
    ):
        crossed = lower > upper
        if crossed.any():
            k = int(np.argmax(crossed))
            raise InputError(
                f"the {what} {name(k)} cross, so that the program has no answer", "contradiction", found=f"{lower[k]:g} > {upper[k]:g}"
            )


def merged_rows(program: Program) -> tuple[Indices, Indices, Floats]:
    """Row starts, columns and coefficients with each column once a row, in ascending order."""
    matrix = program.matrix
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    return matrix.indptr.astype(np.int32), matrix.indices.astype(np.int32), matrix.data
