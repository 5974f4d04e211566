from __future__ import annotations

import numpy as np

from tests.programs import INF, program
from waybound.formulations.programs.export.lp import lp_text
from waybound.formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS


def test_ranges_are_split_and_their_duals_added_up() -> None:
    (step,) = ONE_SIDED_ROWS.apply(program([1, 1], [[1, 2], [1, -1], [0, 1], [2, 1]], [1, -INF, 3, 4], [8, 5, 3, INF]))
    assert (
        lp_text(step.program)
        == """\
Minimize
 obj: + 1.0 x0 + 1.0 x1
Subject To
 row(0): + 1.0 x0 + 2.0 x1 <= 8.0
 row(1): + 1.0 x0 - 1.0 x1 <= 5.0
 row(2): + 1.0 x1 = 3.0
 row(3): + 2.0 x0 + 1.0 x1 >= 4.0
 row.low: + 1.0 x0 + 2.0 x1 >= 1.0
Bounds
End
"""
    )
    assert step.duals(np.array([0.0, 1.0, 2.0, 3.0, 4.0])).tolist() == [4.0, 1.0, 2.0, 3.0]
    assert step.told == "1 ranges split"


def test_rows_of_one_side_are_left_alone() -> None:
    assert ONE_SIDED_ROWS.apply(program([1], [[1], [1]], [1, -INF], [1, 2])) == ()
