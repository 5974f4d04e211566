"""MathOpt models: the same optimum."""

from __future__ import annotations

import numpy as np
import pytest
from exported import PROGRAMS, reference


@pytest.mark.parametrize("name", PROGRAMS)
def test_mathopt_has_the_same_optimum(name: str) -> None:
    from ortools.math_opt.python import mathopt

    program = PROGRAMS[name]
    result = mathopt.solve(program.to_mathopt(), mathopt.SolverType.GSCIP)
    assert result.termination.reason == mathopt.TerminationReason.OPTIMAL
    assert result.objective_value() == pytest.approx(reference(program), abs=1e-4)
    values = result.variable_values()
    x = np.array([values[v] for v in sorted(values, key=lambda v: v.id)])
    assert program.residual(x) <= 1e-5


def test_the_model_keeps_names_sides_and_integers_in_the_programs_order() -> None:
    program = PROGRAMS["everything-max"]
    model = program.to_mathopt()
    columns = list(model.variables())
    assert [v.id for v in columns] == list(range(program.num_variables))
    assert [v.lower_bound for v in columns] == program.lower.tolist()
    assert [v.upper_bound for v in columns] == program.upper.tolist()
    assert [v.integer for v in columns] == program.integer.tolist()
    rows = list(model.linear_constraints())
    assert [(r.lower_bound, r.upper_bound) for r in rows] == list(zip(program.row_lower, program.row_upper, strict=True))
    matrix = np.zeros((program.num_rows, program.num_variables))
    for entry in model.linear_constraint_matrix_entries():
        matrix[entry.linear_constraint.id, entry.variable.id] = entry.coefficient
    assert np.array_equal(matrix, program.matrix.toarray())
    assert model.objective.is_maximize and model.objective.offset == program.offset
    assert [model.objective.get_linear_coefficient(v) for v in columns] == program.cost.tolist()
