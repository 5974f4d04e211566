"""PuLP models: the same columns in the same order, and what PuLP cannot hold is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from exported import PROGRAMS, reference, rows_of, variables

from waybound.formulations.programs.program import Program


@pytest.mark.parametrize("name", PROGRAMS)
def test_pulp_has_the_same_optimum_and_columns(name: str) -> None:
    import pulp

    program = PROGRAMS[name]
    model = program.to_pulp()
    assert pulp.LpStatus[model.solve(pulp.PULP_CBC_CMD(msg=False, gapRel=0.0))] == "Optimal"
    assert pulp.value(model.objective) == pytest.approx(reference(program), abs=1e-6)
    assert [int(v.name[1:]) for v in model.variables()] == list(range(program.num_variables))
    x = np.array([v.varValue for v in model.variables()])
    assert program.residual(x) <= 1e-6


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
