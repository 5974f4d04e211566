"""A program as a HiGHS model, straight from its arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ..names import column_names, row_names
from ._checks import check_export, merged_rows

if TYPE_CHECKING:
    from ..program import Program


def to_highs(program: Program, *, names: bool = False) -> Any:
    """A ``highspy.Highs`` model, silent and ready to run; with ``names`` its columns and rows are named as in files.

    ``addCols`` and ``addRows`` read numpy's buffers. ``passModel`` takes the same arrays as vectors that are converted entry by
    entry, in two to three times the time. Names go with a copy of the model that HiGHS has made of them: named one by one they would take
    twice the time that all the rest takes.
    """
    import highspy

    check_export(program, "HiGHS")
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    n, none = program.num_variables, np.zeros(0, dtype=np.int32)
    statuses = [model.addCols(n, program.cost, program.lower, program.upper, 0, np.zeros(n, dtype=np.int32), none, np.zeros(0))]
    whole = np.nonzero(program.integer)[0].astype(np.int32)
    if len(whole):
        statuses.append(model.changeColsIntegrality(len(whole), whole, np.ones(len(whole), dtype=np.uint8)))
    sides = program.num_rows, program.row_lower, program.row_upper
    added = model.addRows(*sides, len(program.data), program.indptr[:-1], program.indices, program.data)
    if added == highspy.HighsStatus.kError:  # a column that stands twice in a row
        indptr, indices, data = merged_rows(program)
        added = model.addRows(*sides, len(data), indptr[:-1], indices, data)
    statuses.append(added)
    if program.offset:
        statuses.append(model.changeObjectiveOffset(program.offset))
    if program.sense == "max":
        statuses.append(model.changeObjectiveSense(highspy.ObjSense.kMaximize))
    if names:
        named = model.getLp()
        named.col_names_, named.row_names_ = column_names(program), row_names(program)
        statuses.append(model.passModel(named))
    if program.quadratic is not None:
        import scipy.sparse as sp

        lower = sp.csc_matrix(sp.tril(program.quadratic))
        triangle = int(highspy.HessianFormat.kTriangular)
        indptr, indices = lower.indptr.astype(np.int32), lower.indices.astype(np.int32)
        statuses.append(model.passHessian(n, lower.nnz, triangle, indptr, indices, lower.data.astype(np.float64)))
    if highspy.HighsStatus.kError in statuses:
        raise InputError(f"HiGHS refuses the program {program.name}: {n} variables, {program.num_rows} rows")
    return model
