"""A program as an OR-Tools MathOpt model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..names import column_names, row_names
from ._checks import check_export, merged_rows

if TYPE_CHECKING:
    from ..program import Program


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
