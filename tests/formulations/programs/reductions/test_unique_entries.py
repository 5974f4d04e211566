from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.programs import program
from waybound.formulations.programs.export.lp import lp_text
from waybound.formulations.programs.reductions.unique_entries import UNIQUE_ENTRIES


def test_a_sound_program_is_left_alone() -> None:
    assert UNIQUE_ENTRIES.apply(program([1, 1], [[1, 1]], 1, 2, 0, 1)) == ()


def test_what_a_row_holds_of_one_column_is_added_up_and_the_original_stays() -> None:
    given = program([1, 1], [[1, 5]], 1, 2, 0, 1)
    (rows,) = given.rows
    twice = replace(rows, indptr=np.array([0, 3], np.int32), indices=np.array([0, 1, 0], np.int32), data=np.array([1.0, 5.0, 2.0]))
    given = replace(given, rows=(twice,))
    (step,) = UNIQUE_ENTRIES.apply(given)
    assert (
        lp_text(step.program)
        == """\
Minimize
 obj: + 1.0 x0 + 1.0 x1
Subject To
 row: + 3.0 x0 + 5.0 x1 <= 2.0
 row_low: + 3.0 x0 + 5.0 x1 >= 1.0
Bounds
 0.0 <= x0 <= 1.0
 0.0 <= x1 <= 1.0
End
"""
    )
    assert str(step.link) == "unique-entries (exact): 1 coefficients added to others"
    assert len(given.data) == 3
