from dataclasses import replace

import numpy as np

from tests.program_text import expected, program_text
from tests.programs import INF, program
from waybound.formulations.programs.reductions.sound_arrays import UNIQUE_ENTRIES, WHOLE_BOUNDS


def test_a_sound_program_is_left_alone() -> None:
    assert UNIQUE_ENTRIES.apply(program([1, 1], [[1, 1]], 1, 2, 0, 1)) == ()


def test_what_a_row_holds_of_one_column_is_added_up_and_the_original_stays() -> None:
    given = program([1, 1], [[1, 5]], 1, 2, 0, 1)
    (rows,) = given.rows
    twice = replace(rows, indptr=np.array([0, 3], np.int32), indices=np.array([0, 1, 0], np.int32), data=np.array([1.0, 5.0, 2.0]))
    given = replace(given, rows=(twice,))
    (step,) = UNIQUE_ENTRIES.apply(given)
    assert program_text(step.program) == expected("""
        min x0 + x1
        row: 1 <= 3 x0 + 5 x1 <= 2
        0 <= x0, x1 <= 1
    """)
    assert step.program.data.tolist() == [3.0, 5.0]
    assert str(step.link) == "unique-entries (exact): 1 coefficients added to others"
    assert len(given.data) == 3


def test_whole_and_infinite_bounds_are_left_alone_and_so_are_those_of_continuous_variables() -> None:
    assert WHOLE_BOUNDS.apply(program([1, 1, 1], [[1, 1, 1]], 1, 2, [0, -INF, 0.5], [1, INF, 0.7], integer=[0, 1])) == ()


def test_bounds_of_integer_variables_are_rounded_inwards_but_for_the_rounding_of_floats() -> None:
    given = program([1] * 4, [[1] * 4], 1, 2, [0.3, -1.5, 1.0 + 1e-12, 0.2], [1.5, INF, 3.0 - 1e-12, 0.8], integer=range(4))
    (step,) = WHOLE_BOUNDS.apply(given)
    assert step.program.lower.tolist() == [1, -1, 1, 1]
    assert step.program.upper.tolist() == [1, INF, 3, 0]
    assert str(step.link) == "whole-bounds (exact): bounds of 4 integer variables rounded"
