"""Arrays straight into HiGHS."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....instances.errors import InputError
from ..names import column_names, row_names
from ..program import Program
from ..soundness import refuse_numbers
from ._checks import merged_rows, refuse_circuits, refuse_cones, refuse_levels


def to_highs(program: Program, *, names: bool = False) -> Any:
    """A ``highspy.Highs`` model, silent and ready to run.

    Parameters
    ----------
    program : Program
        Without cones. Its quadratic part, if any, must be convex (concave for maximisation) for HiGHS to solve it.
    names : bool
        Name columns and rows as in files.

    Returns
    -------
    highspy.Highs

    Raises
    ------
    UnsupportedError
        If the program has cones, circuits, or several objectives in order of priority.
    InputError
        If the data hold a NaN or an infinite coefficient, or HiGHS refuses them for another reason.

    Notes
    -----
    ``addCols`` and ``addRows`` read numpy's buffers. ``passModel`` takes the same arrays as vectors that are converted entry by
    entry, in two to three times the time. Names go with a copy of the model that HiGHS has made of them: named one by one they would take
    twice the time that all the rest takes.
    """
    import highspy

    refuse_cones(program, "HiGHS")
    refuse_circuits(program, "HiGHS")
    refuse_levels(program, "HiGHS")
    refuse_numbers(program)
    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    n, none = program.num_variables, np.zeros(0, dtype=np.int32)
    done = [model.addCols(n, program.cost, program.lower, program.upper, 0, np.zeros(n, dtype=np.int32), none, np.zeros(0))]
    whole = np.nonzero(program.integer)[0].astype(np.int32)
    if len(whole):
        done.append(model.changeColsIntegrality(len(whole), whole, np.ones(len(whole), dtype=np.uint8)))
    sides = program.num_rows, program.row_lower, program.row_upper
    added = model.addRows(*sides, len(program.data), program.indptr[:-1], program.indices, program.data)
    if added == highspy.HighsStatus.kError:  # a column that stands twice in a row
        indptr, indices, data = merged_rows(program)
        added = model.addRows(*sides, len(data), indptr[:-1], indices, data)
    done.append(added)
    if program.offset:
        done.append(model.changeObjectiveOffset(program.offset))
    if program.sense == "max":
        done.append(model.changeObjectiveSense(highspy.ObjSense.kMaximize))
    if names:
        named = model.getLp()
        named.col_names_, named.row_names_ = column_names(program), row_names(program)
        done.append(model.passModel(named))
    if program.quadratic is not None:
        import scipy.sparse as sp

        lower = sp.csc_matrix(sp.tril(program.quadratic))
        triangle = int(highspy.HessianFormat.kTriangular)
        indptr, indices = lower.indptr.astype(np.int32), lower.indices.astype(np.int32)
        done.append(model.passHessian(n, lower.nnz, triangle, indptr, indices, lower.data.astype(np.float64)))
    if highspy.HighsStatus.kError in done:
        raise InputError(f"HiGHS refuses the program {program.name}: {n} variables, {program.num_rows} rows")
    return model
