import numpy as np

from waybound.solvers.bounds.routing.move_rows import MoveRow
from waybound.solvers.bounds.routing.restricted_master import Pool


def test_coefficients_count_the_moves_of_the_set() -> None:
    pool = Pool()
    pool.add([(0, np.array(route)) for route in ([1, 2, 3], [2, 1, 2], [3])])
    moves = np.zeros((4, 4), dtype=bool)
    moves[1, 2] = moves[2, 1] = True
    row = MoveRow.of({"a": ["b"], "b": ["a"]}, moves)
    assert row == MoveRow.of({"a": ["b"], "b": ["a"]}, moves.copy()) != MoveRow.of({"a": ["b"]}, moves)
    assert MoveRow.coefficients([row], pool, 0).tolist() == [[1.0], [2.0], [0.0]]
    assert MoveRow.coefficients([row], pool, 1).tolist() == [[2.0], [0.0]]
    assert row.missing(4).tolist() == [1.0, 1.0, 1.0] and (row.sign, row.right) == (1, 1.0)
