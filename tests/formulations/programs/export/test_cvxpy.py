import math

import numpy as np
import pytest
from exported import PROGRAMS, reference, rows_of, variables

from waybound.formulations.programs.export.cvxpy import row_duals_of, vector_of
from waybound.formulations.programs.program import Program


@pytest.mark.parametrize("name", PROGRAMS)
def test_cvxpy_has_the_same_optimum_and_columns(name: str) -> None:
    program = PROGRAMS[name]
    model = program.to_cvxpy()
    model.solve(solver="HIGHS")
    assert model.status == "optimal"
    assert model.value == pytest.approx(reference(program), abs=1e-4)
    x = np.concatenate([np.atleast_1d(model.var_dict[b.name].value) for b in program.variables if b.size])
    assert program.residual(x) <= 1e-5


def test_blocks_of_one_name_are_told_apart_and_binaries_are_recognised() -> None:
    blocks = (
        variables("x", [0.0, 0.0], [1.0, 1.0], [1.0, 1.0], integer=True),
        variables("x", [0.0], [3.0], [1.0], integer=True),
        variables("none", [], [], []),
        variables("y", [-1.0], [2.0], [1.0]),
    )
    held = Program("blocks", "min", blocks, ()).to_cvxpy().var_dict
    assert {name: (v.size, v.attributes["boolean"], v.attributes["integer"]) for name, v in held.items()} == {
        "x": (2, True, False), "x.2": (1, False, True), "y": (1, False, False),
    }  # fmt: skip


@pytest.mark.parametrize("sense", ["min", "max"])
def test_the_point_and_the_row_duals_come_back_in_the_programs_order(sense: str) -> None:
    """min 2 x + 3 y, x + y >= 4, x <= 3, x - y = 1 has x = 2.5, y = 1.5; one unit more of the first row costs 2.5, of the last -0.5."""
    sign = 1.0 if sense == "min" else -1.0
    rows = (rows_of("sides", [[1, 1], [1, 0]], [4.0, -math.inf], [math.inf, 3.0]), rows_of("equal", [[1, -1]], [1.0], [1.0]))
    program = Program("duals", sense, (variables("x", [0, 0], [9, 9], [2 * sign, 3 * sign]),), rows)
    model = program.to_cvxpy()
    assert vector_of(program, model) is None and row_duals_of(program, model) is None
    model.solve(solver="CLARABEL")
    assert vector_of(program, model) == pytest.approx([2.5, 1.5], abs=1e-6)
    assert row_duals_of(program, model) == pytest.approx(np.array([2.5, 0.0, -0.5]) * sign, abs=1e-6)
