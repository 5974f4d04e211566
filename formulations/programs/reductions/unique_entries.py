"""Rows that hold each column once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..program import Program, Rows
from .reduction import Reduction, Step


class Added(Step):
    """Coefficients that a row held of the same column, added up."""

    name = "unique-entries"


class UniqueEntries(Reduction):
    """Adds up what a row holds of the same column."""

    def apply(self, program: Program) -> tuple[Step, ...]:
        """See ``Reduction.apply``."""
        matrix = program.matrix
        if not matrix.nnz or matrix.has_canonical_format:
            return ()
        merged = matrix.copy()
        merged.sum_duplicates()
        if merged.nnz == matrix.nnz:
            return ()  # in no order, but unique
        whole = Rows(
            name="row", indptr=merged.indptr.astype(np.int32), indices=merged.indices.astype(np.int32), data=merged.data,
            lower=program.row_lower, upper=program.row_upper,
        )  # fmt: skip
        return (Added(program=replace(program, rows=(whole,)), told=f"{matrix.nnz - merged.nnz} coefficients added to others"),)


UNIQUE_ENTRIES = UniqueEntries()
