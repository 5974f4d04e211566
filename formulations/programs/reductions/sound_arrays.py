"""Reductions of every program: each column once a row, and whole bounds of integer variables, on which solvers count."""

from dataclasses import replace

import numpy as np

from ..program import Program, Rows
from .reduction import Reduction, Step

SLACK = 1e-9
"""Distance from a whole number up to which a bound means that number."""


class Added(Step):
    """Coefficients that a row held of the same column, added up."""

    name = "unique-entries"


class UniqueEntries(Reduction):
    """Adds up the coefficients of each column in a row."""

    def apply(self, program: Program) -> tuple[Step, ...]:
        matrix = program.matrix
        if not matrix.nnz or matrix.has_canonical_format:
            return ()
        merged = matrix.copy()
        merged.sum_duplicates()
        if merged.nnz == matrix.nnz:
            return ()  # in no order, but unique
        rows = Rows(
            name="row", indptr=merged.indptr.astype(np.int32), indices=merged.indices.astype(np.int32), data=merged.data,
            lower=program.row_lower, upper=program.row_upper,
        )  # fmt: skip
        return (Added(program=replace(program, rows=(rows,)), told=f"{matrix.nnz - merged.nnz} coefficients added to others"),)


class Rounded(Step):
    """The same variables, with whole bounds of those that are integer."""

    name = "whole-bounds"


class WholeBounds(Reduction):
    """Rounds bounds of integer variables inwards: HiGHS called 0.3 the optimum of a whole number from 0.3 to 1.5.

    Bounds between which there is no whole number cross.
    """

    def apply(self, program: Program) -> tuple[Step, ...]:
        variables, count = [], 0
        for block in program.variables:
            low, high = block.lower, block.upper
            if block.integer:
                low, high = np.ceil(low - SLACK), np.floor(high + SLACK)
                count += int(((low != block.lower) | (high != block.upper)).sum())
            variables.append(replace(block, lower=low, upper=high))
        if not count:
            return ()
        return (Rounded(program=replace(program, variables=tuple(variables)), told=f"bounds of {count} integer variables rounded"),)


UNIQUE_ENTRIES, WHOLE_BOUNDS = UniqueEntries(), WholeBounds()
