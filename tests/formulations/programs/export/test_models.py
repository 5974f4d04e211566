import math

import numpy as np
import pytest
import scipy.sparse as sp
from exported import PROGRAMS, arrays_of, everything, reference, rows_of, variables

from waybound import InputError, Program


@pytest.mark.parametrize("name", PROGRAMS)
def test_highs_holds_every_array_of_the_program(name: str) -> None:
    program = PROGRAMS[name]
    held = arrays_of(program.to_highs())
    for key in ("cost", "lower", "upper", "row_lower", "row_upper", "integer", "offset", "sense"):
        assert np.array_equal(held[key], getattr(program, key)), key
    assert np.array_equal(held["matrix"], program.matrix.toarray())


def test_both_senses_of_a_program_have_opposite_optima() -> None:
    assert reference(everything("max")) == pytest.approx(-reference(everything("min")), abs=1e-9)
    assert reference(everything("max", quadratic=True)) == pytest.approx(-reference(everything("min", quadratic=True)), abs=1e-5)


def test_one_triangle_of_the_products_is_handed_over() -> None:
    program = everything("min", quadratic=True)
    hessian = program.to_highs().getModel().hessian_
    n = program.num_variables
    held = sp.csc_matrix((hessian.value_, hessian.index_, hessian.start_), shape=(n, n)).toarray()
    assert np.array_equal(held, np.tril(program.quadratic.toarray()))


def test_what_highs_itself_refuses_is_told_with_the_size_of_the_program() -> None:
    """A coefficient beyond 1e15 is an error to HiGHS."""
    row = rows_of("huge", [[1e200]], [0.0], [math.inf])
    with pytest.raises(InputError, match="HiGHS refuses the program huge: 1 variables, 1 rows"):
        Program("huge", "min", (variables("x", [0.0], [1.0], [1.0]),), (row,)).to_highs()


@pytest.mark.parametrize("name", PROGRAMS)
def test_mathopt_has_the_same_optimum(name: str) -> None:
    from ortools.math_opt.python import mathopt

    program = PROGRAMS[name]
    result = mathopt.solve(program.to_mathopt(), mathopt.SolverType.GSCIP)
    assert result.termination.reason == mathopt.TerminationReason.OPTIMAL
    assert result.objective_value() == pytest.approx(reference(program), abs=1e-4)
    values = result.variable_values()
    assert program.residual(np.array([values[v] for v in sorted(values, key=lambda v: v.id)])) <= 1e-5


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


@pytest.mark.parametrize("name", PROGRAMS)
def test_pulp_has_the_same_optimum_and_columns(name: str) -> None:
    import pulp

    program = PROGRAMS[name]
    model = program.to_pulp()
    assert pulp.LpStatus[model.solve(pulp.PULP_CBC_CMD(msg=False, gapRel=0.0))] == "Optimal"
    assert pulp.value(model.objective) == pytest.approx(reference(program), abs=1e-6)
    assert [int(v.name[1:]) for v in model.variables()] == list(range(program.num_variables))
    assert program.residual(np.array([v.varValue for v in model.variables()])) <= 1e-6


def test_pulp_keeps_the_bounds_of_binaries() -> None:
    program = Program("must", "min", (variables("x", [1.0, 0.0], [1.0, 0.0], [2.0, -1.0], integer=True),), ())
    model = program.to_pulp()
    assert [(v.lowBound, v.upBound, v.cat) for v in model.variables()] == [(1.0, 1.0, "Integer"), (0.0, 0.0, "Integer")]
    model.solve(__import__("pulp").PULP_CBC_CMD(msg=False))
    assert model.objective.value() == 2.0


def test_columns_are_numbered_so_that_names_sort_as_columns_and_rows_by_their_sides() -> None:
    """Twelve columns need two digits; the range is r0 and r0_low, the row without sides r1 is left out, r2 has a lower side alone."""
    n = 12
    rows = tuple(
        rows_of(name, np.ones(n), [low], [high])
        for name, low, high in (("range", 1.0, 5.0), ("free", -math.inf, math.inf), ("least", 2.0, math.inf), ("exact", 3.0, 3.0))
    )
    model = Program("two-words", "max", (variables("x", np.zeros(n), np.full(n, math.inf), np.arange(n)),), rows, offset=4.0).to_pulp()
    assert model.name == "two_words" and model.sense == -1
    assert [v.name for v in model.variables()] == [f"x{k:02d}" for k in range(n)]
    assert {v.upBound for v in model.variables()} == {None}
    sides = {name: (row.sense, -row.constant) for name, row in model.constraints.items()}
    assert sides == {"r0": (-1, 5.0), "r0_low": (1, 1.0), "r2": (1, 2.0), "r3": (0, 3.0)}
    assert model.objective.constant == 4.0
