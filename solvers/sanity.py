"""What every program backend does before its solver sees a program: refuse bad numbers, merge duplicates, settle trivial cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..formulations.programs.export._checks import refuse_numbers
from ..formulations.programs.program import Program, Rows
from ..instances.errors import InputError
from .backend import RawResult


def prepared(program: Program) -> Program:
    """The program with finite, ordered and unique entries.

    Parameters
    ----------
    program : Program

    Returns
    -------
    Program
        The same object where its rows hold each column once; else one whose duplicate coefficients are added up.

    Raises
    ------
    InputError
        Naming the variable or row that holds a NaN, an infinite cost or coefficient, or a bound that leaves no number.
    """
    refuse_numbers(program)
    for values, wrong, what, name in (
        (program.lower, np.inf, "lower bound of", program.variable_name),
        (program.upper, -np.inf, "upper bound of", program.variable_name),
        (program.row_lower, np.inf, "left side of row", program.row_name),
        (program.row_upper, -np.inf, "right side of row", program.row_name),
    ):
        if (values == wrong).any():
            raise InputError(f"the {what} {name(int(np.argmax(values == wrong)))} leaves no number", found=str(wrong))
    if program.indices.size and (program.indices.min() < 0 or program.indices.max() >= program.num_variables):
        raise InputError("a row names a column that does not exist", expected=f"0 to {program.num_variables - 1}")
    matrix = program.matrix
    if matrix.nnz and not matrix.has_canonical_format:
        merged = matrix.copy()
        merged.sum_duplicates()
        whole = Rows(
            name="row", indptr=merged.indptr.astype(np.int32), indices=merged.indices.astype(np.int32), data=merged.data,
            lower=program.row_lower, upper=program.row_upper,
        )  # fmt: skip
        return replace(program, rows=(whole,))
    return program


def settled(program: Program) -> RawResult | None:
    """The result where no search is needed: limits that cross, empty rows that exclude 0, no variables; None for every other program."""
    for lower, upper, name, what in (
        (program.lower, program.upper, program.variable_name, "bounds of"),
        (program.row_lower, program.row_upper, program.row_name, "sides of row"),
    ):
        crossed = lower > upper
        if crossed.any():
            at = int(np.argmax(crossed))
            return RawResult("infeasible", message=f"the {what} {name(at)} cross: {lower[at]:g} > {upper[at]:g}")
    empty = np.ones(program.num_rows, dtype=bool)
    empty[np.repeat(np.arange(program.num_rows), np.diff(program.indptr))[program.data != 0]] = False
    fails = empty & ((program.row_lower > 0) | (program.row_upper < 0))  # by less than a solver's tolerance, too
    if fails.any():
        return RawResult("infeasible", message=f"row {program.row_name(int(np.argmax(fails)))} adds up nothing and excludes 0")
    if program.num_variables:
        return None
    duals = np.zeros(program.num_rows)
    return RawResult("optimal", answer=np.zeros(0), objective=program.offset, bound=program.offset, row_duals=duals)
