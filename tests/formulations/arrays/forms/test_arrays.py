"""The form of bare programs: what is given is what is handed over."""

from __future__ import annotations

import numpy as np
import pytest
from program_text import expected, program_text
from programs import INF, program

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.instances.errors import InputError


def test_arrays_from_text_to_text() -> None:
    given = program(
        cost=[3, 2, -1], matrix=[[2, 3, 0], [1, 0, -1]], low=[-INF, 1], high=[10.5, 4], lower=[0, 0, -2], upper=[4, 1, INF],
        integer=[0, 1], sense="max", offset=7, quadratic=[[-2, 1, 0], [1, 0, 0], [0, 0, 0]],
    )  # fmt: skip
    made = ArrayProblem(given).compile("arrays")
    assert program_text(made.program) == expected(
        """
        max 3 x0 + 2 x1 - x2 - x0^2 + x0 x1 + 7
        row[0]: 2 x0 + 3 x1 <= 10.5
        row[1]: 1 <= x0 - x2 <= 4
        0 <= x0 <= 4 integer
        x1 binary
        x2 >= -2
        """
    )


def test_the_form_gives_the_program_its_name_and_changes_no_number() -> None:
    given = program([3, 2], [[2, 3]], -INF, 10.5, 0, [4, 5], integer=[0, 1], sense="max")
    made = ArrayProblem(given).compile("arrays").program
    assert made.name == "arrays"
    assert program_text(made) == program_text(given)


def test_row_duals_of_either_sign_prove_the_relaxation() -> None:
    """max 3 x0 + 2 x1 with 2 x0 + 3 x1 <= 10.5 in [0,4] x [0,5]: 12 + 2 (2.5 / 3) with the price 2/3."""
    problem = ArrayProblem(program([3, 2], [[2, 3]], -INF, 10.5, 0, [4, 5], sense="max"))
    made = problem.compile("arrays")
    assert made.dual_evidence is not None
    for duals in (np.array([2 / 3]), np.array([-2 / 3])):
        evidence = made.dual_evidence(duals)
        assert evidence.kind == "lp-dual"
        assert verified_bound(problem, evidence) == pytest.approx(12 + 5 / 3)


def test_duals_of_a_quadratic_program_are_no_evidence() -> None:
    assert ArrayProblem(program([1], [[1]], 0, 1, quadratic=[[2]])).compile("arrays").dual_evidence is None


def test_a_start_of_another_shape_is_refused() -> None:
    made = ArrayProblem(program([1, 1], [[1, 1]], 0, 1)).compile("arrays")
    assert made.encode is not None
    assert made.encode([0, 1]).tolist() == [0.0, 1.0]
    with pytest.raises(InputError, match="one number a variable"):
        made.encode([1, 2, 3])
