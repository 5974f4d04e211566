import numpy as np

from tests.program_text import expected, program_text
from tests.programs import INF, program
from waybound.formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS


def test_ranges_are_split_and_their_duals_added_up() -> None:
    (step,) = ONE_SIDED_ROWS.apply(program([1, 1], [[1, 2], [1, -1], [0, 1], [2, 1]], [1, -INF, 3, 4], [8, 5, 3, INF]))
    assert program_text(step.program) == expected("""
        min x0 + x1
        row[0]: x0 + 2 x1 <= 8
        row[1]: x0 - x1 <= 5
        row[2]: x1 = 3
        row[3]: 2 x0 + x1 >= 4
        row.low: x0 + 2 x1 >= 1
        x0, x1 >= 0
    """)
    assert step.duals(np.array([0.0, 1.0, 2.0, 3.0, 4.0])).tolist() == [4.0, 1.0, 2.0, 3.0]
    assert step.told == "1 ranges split"


def test_rows_of_one_side_are_left_alone() -> None:
    assert ONE_SIDED_ROWS.apply(program([1], [[1], [1]], [1, -INF], [1, 2])) == ()
