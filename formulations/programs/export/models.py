"""Programs as models of HiGHS, OR-Tools MathOpt and PuLP."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ..names import column_names, row_names
from ..reductions.one_sided_rows import ONE_SIDED_ROWS
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
        raise InputError(f"HiGHS refuses the program {program.name}: {n} variables, {program.num_rows} rows", "unsupported")
    return model


def to_mathopt(program: Program, *, names: bool = False) -> Any:
    """A ``mathopt.Model``, whose variable and constraint ids are columns and rows; with ``names`` they are named as in files.

    The arrays become a model message, which is read in one go; adding variables and rows one by one takes ten times longer.
    """
    from ortools.math_opt import model_pb2
    from ortools.math_opt.python import mathopt

    check_export(program, "MathOpt")
    n, m = program.num_variables, program.num_rows
    message = model_pb2.ModelProto(name=program.name)
    message.variables.ids.extend(range(n))
    message.variables.lower_bounds.extend(program.lower.tolist())
    message.variables.upper_bounds.extend(program.upper.tolist())
    message.variables.integers.extend(program.integer.tolist())
    objective = message.objective
    objective.maximize, objective.offset = program.sense == "max", float(program.offset)
    priced = np.nonzero(program.cost)[0]
    objective.linear_coefficients.ids.extend(priced.tolist())
    objective.linear_coefficients.values.extend(program.cost[priced].tolist())
    if program.quadratic is not None:
        import scipy.sparse as sp

        upper = sp.csr_matrix(sp.triu(program.quadratic))
        upper.sum_duplicates()
        entries = upper.tocoo()
        square = entries.row == entries.col  # each product stands once here, twice in x' Q x / 2
        objective.quadratic_coefficients.row_ids.extend(entries.row.tolist())
        objective.quadratic_coefficients.column_ids.extend(entries.col.tolist())
        objective.quadratic_coefficients.coefficients.extend(np.where(square, entries.data / 2.0, entries.data).tolist())
    message.linear_constraints.ids.extend(range(m))
    message.linear_constraints.lower_bounds.extend(program.row_lower.tolist())
    message.linear_constraints.upper_bounds.extend(program.row_upper.tolist())
    indptr, indices, data = merged_rows(program)
    entry = data != 0
    rows = np.repeat(np.arange(m), np.diff(indptr))
    message.linear_constraint_matrix.row_ids.extend(rows[entry].tolist())
    message.linear_constraint_matrix.column_ids.extend(indices[entry].tolist())
    message.linear_constraint_matrix.coefficients.extend(data[entry].tolist())
    if names:
        message.variables.names.extend(column_names(program))
        message.linear_constraints.names.extend(row_names(program))
    return mathopt.Model.from_model_proto(message)


def to_pulp(program: Program, *, names: bool = False) -> Any:
    """A ``pulp.LpProblem``; with ``names`` its variables and constraints are named as in files.

    Without names column j is the variable named ``x`` and j, padded with zeros, so that PuLP's order of names is that of columns, and row
    i the constraint ``r`` and i. A row with two different sides becomes two constraints (the name of the second ends with ``_low``), a row
    with none is left out. Integers are of PuLP's category ``Integer`` with their bounds: ``Binary`` would reset these to [0, 1].
    """
    import pulp

    check_export(program, "PuLP", quadratic=False)
    model = pulp.LpProblem(program.name.replace("-", "_"), pulp.LpMaximize if program.sense == "max" else pulp.LpMinimize)
    digits = len(str(max(0, program.num_variables - 1)))
    columns = zip(program.lower.tolist(), program.upper.tolist(), program.integer.tolist(), strict=True)
    called = column_names(program) if names else [f"x{j:0{digits}d}" for j in range(program.num_variables)]
    rows = row_names(program) if names else [f"r{i}" for i in range(program.num_rows)]
    x = [
        model.add_variable(
            called[j], low if low > -math.inf else None, high if high < math.inf else None,
            cat=pulp.LpInteger if whole else pulp.LpContinuous,
        )
        for j, (low, high, whole) in enumerate(columns)
    ]  # fmt: skip
    model.setObjective(pulp.LpAffineExpression(zip(x, program.cost.tolist(), strict=True), constant=program.offset))
    steps = ONE_SIDED_ROWS.apply(program)
    split = steps[0].program if steps else program
    indptr, indices, data = (part.tolist() for part in merged_rows(split))
    origins = steps[0].rows.tolist() if steps else range(program.num_rows)
    for k, (i, low, high) in enumerate(zip(origins, split.row_lower.tolist(), split.row_upper.tolist(), strict=True)):
        if low == -math.inf and high == math.inf:
            continue
        sense, side = (pulp.LpConstraintEQ, low) if low == high else (pulp.LpConstraintLE, high)
        if high == math.inf:
            sense, side = pulp.LpConstraintGE, low
        entries = pulp.LpAffineExpression([(x[indices[e]], data[e]) for e in range(indptr[k], indptr[k + 1])])
        model.addConstraint(pulp.LpConstraint(entries, sense, rows[i] if k < program.num_rows else f"{rows[i]}_low", side))
    return model
