import numpy as np

from tests.program_text import expected, program_text
from tests.programs import INF, program
from waybound.formulations.programs.reductions.minimisation import MINIMISATION


def test_a_program_to_be_maximised_has_its_sign_turned_and_loses_its_constant() -> None:
    (step,) = MINIMISATION.apply(program([3, -2], [[1, 2]], -INF, 8, 0, 5, integer=[0], sense="max", offset=7))
    assert program_text(step.program) == expected("""
        min - 3 x0 + 2 x1
        row: x0 + 2 x1 <= 8
        0 <= x0 <= 5 integer
        0 <= x1 <= 5
    """)
    assert (step.value(-15.0), step.bound(-16.0)) == (22.0, 23.0)
    assert step.duals(np.array([-1.0, 2.0])).tolist() == [1.0, -2.0]


def test_a_constant_alone_is_left_out_and_comes_back() -> None:
    (step,) = MINIMISATION.apply(program([3], [[1]], 1, 8, offset=-2))
    assert (step.program.offset, step.value(3.0), step.told) == (0.0, 1.0, "constant -2 left out")
    assert MINIMISATION.apply(step.program) == ()


def test_a_quadratic_part_is_turned_with_the_rest() -> None:
    given = program([1, 0], [[1, 1]], 0, 1, 0, 1, sense="max", quadratic=[[0, 2], [2, 0]])
    (step,) = MINIMISATION.apply(given)
    x = np.array([0.5, 0.25])
    assert step.value(step.program.value(x)) == given.value(x)
