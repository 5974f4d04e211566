"""A program as a CVXPY problem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..names import block_names
from ._checks import check_export, refuse_crossing

if TYPE_CHECKING:
    from ..program import Floats, Program, Rows


def to_cvxpy(program: Program) -> Any:
    """A ``cvxpy.Problem`` with one vector variable per block of variables and up to three constraints per block of rows.

    ``problem.var_dict`` holds the variables by the names of their blocks, in column order; a name that occurs again gets a number
    (``x, x.2``), and empty blocks have none. A quadratic part must be convex (concave for maximisation).
    """
    import cvxpy as cp
    import scipy.sparse as sp

    check_export(program, "CVXPY", cones=True)
    refuse_crossing(program)
    variables: list[Any] = []
    starts: list[int] = []
    column = 0
    for block, name in zip(program.variables, block_names(program), strict=True):
        if block.size:
            binary = block.integer and bool((block.lower == 0).all() and (block.upper == 1).all())
            bounds = None if binary else [block.lower, block.upper]
            v = cp.Variable(block.size, name=name, boolean=binary, integer=block.integer and not binary, bounds=bounds)
            variables.append(v)
            starts.append(column)
        column += block.size
    constraints: list[Any] = []
    ends = [s + v.size for s, v in zip(starts, variables, strict=True)]
    for rows in program.rows:
        matrix = sp.csr_matrix((rows.data, rows.indices, rows.indptr), shape=(rows.size, program.num_variables))
        for chosen, side, sense in _sides(rows):
            part = matrix[chosen].tocsc()
            left = _image(part, np.zeros(part.shape[0]), variables, starts, ends)
            constraints.append({"==": left == side[chosen], "<=": left <= side[chosen], ">=": left >= side[chosen]}[sense])
    for cones in program.cones:
        image = _image(cones.matrix(program.num_variables).tocsc(), cones.offset, variables, starts, ends)
        parts = [image[k :: cones.width] for k in range(cones.width)]
        if cones.kind == "second-order":
            constraints.append(cp.SOC(parts[0], cp.vstack(parts[1:])))
        else:
            constraints.append(cp.ExpCone(*parts))
    objective = sum(program.cost[s:e] @ v for s, e, v in zip(starts, ends, variables, strict=True)) + program.offset
    if program.quadratic is not None:
        sign = -1.0 if program.sense == "max" else 1.0
        objective += sign * 0.5 * cp.quad_form(cp.hstack(variables), sign * sp.csc_matrix(program.quadratic))
    direction: Any = cp.Maximize if program.sense == "max" else cp.Minimize
    return cp.Problem(direction(objective), constraints)


def _image(matrix: Any, offset: Floats, variables: list[Any], starts: list[int], ends: list[int]) -> Any:
    """``matrix x + offset`` over the vector variables of the blocks."""
    import cvxpy as cp

    terms = [matrix[:, s:e] @ v for s, e, v in zip(starts, ends, variables, strict=True) if matrix[:, s:e].nnz]
    return sum(terms) + offset if terms else cp.Constant(offset)


def vector_of(program: Program, model: Any) -> Floats | None:
    """Values of a model made by ``to_cvxpy``, in column order; None where it holds none."""
    held = model.var_dict
    parts = [held[name].value for block, name in zip(program.variables, block_names(program), strict=True) if block.size]
    return None if any(p is None for p in parts) else np.concatenate([np.zeros(0), *(np.atleast_1d(p) for p in parts)])


def row_duals_of(program: Program, model: Any) -> Floats | None:
    """Row duals, d objective / d right side, from the constraints of ``model``; None where it holds none.

    CVXPY's multipliers of inequalities are nonnegative and belong to the minimised (negated) objective.
    """
    sign = -1.0 if program.sense == "min" else 1.0
    duals, row, constraints = np.zeros(program.num_rows), 0, iter(model.constraints)
    for rows in program.rows:
        for chosen, _, sense in _sides(rows):
            value = next(constraints).dual_value
            if value is None:
                return None
            duals[row + np.nonzero(chosen)[0]] += (-sign if sense == ">=" else sign) * np.atleast_1d(value)
        row += rows.size
    return duals


def _sides(rows: Rows) -> list[tuple[NDArray[np.bool_], Floats, str]]:
    """The constraints that a block of rows becomes: a mask of the rows, their sides, and the relation."""
    equal = rows.lower == rows.upper
    parts = [
        (equal, rows.lower, "=="),
        (~equal & np.isfinite(rows.upper), rows.upper, "<="),
        (~equal & np.isfinite(rows.lower), rows.lower, ">="),
    ]
    return [part for part in parts if part[0].any()]
