import math

import numpy as np
import pytest
import scipy.sparse as sp

from waybound.formulations.programs.cones import Cones


def cones(kind: str, width: int, matrix: list[list[float]], offset: list[float]) -> Cones:
    a = sp.csr_matrix(np.array(matrix, dtype=float))
    return Cones("k", kind, width, a.indptr, a.indices, a.data, np.array(offset, dtype=float))


def test_a_second_order_cone_is_broken_by_what_the_norm_exceeds_its_first_row() -> None:
    """(t, v) = (x0 + 1, x1, 2 x1 - 3): at (4, 3) it is (5, 3, 3); at (2, 0) it is (3, 0, -3), on the edge."""
    block = cones("second-order", 3, [[1, 0], [0, 1], [0, 2]], [1, 0, -3])
    assert block.size == 1
    assert block.excess(np.array([4.0, 3.0])) == pytest.approx([math.sqrt(18) - 5])
    assert block.excess(np.array([2.0, 0.0])) == pytest.approx([0.0])
    assert block.excess(np.array([0.0, 3.0])) == pytest.approx([math.sqrt(18) - 1])


def test_each_cone_of_a_block_is_judged_by_itself() -> None:
    block = cones("second-order", 2, [[1, 0], [0, 1], [0, 0], [0, 1]], [0, 0, 2, 0])
    assert block.size == 2
    assert block.excess(np.array([1.0, -3.0])) == pytest.approx([2.0, 1.0])


@pytest.mark.parametrize(
    ("point", "excess"),
    [
        ((0.0, 1.0, 1.0), 0.0),  # 1 exp(0) <= 1
        ((2.0, 2.0, 1.0), 2 * math.e - 1),
        ((1.0, 1.0, 5.0), math.e - 5),
        ((-3.0, 0.0, 2.0), 0.0),  # the limit: a <= 0, b = 0, c >= 0
        ((0.5, 0.0, 2.0), 0.5),
        ((-1.0, 0.0, -0.25), 0.25),
        ((-1.0, -0.75, 9.0), 0.75),
        ((1e6, 1.0, 1.0), math.inf),
    ],
)
def test_an_exponential_cone_and_its_limit(point: tuple[float, ...], excess: float) -> None:
    block = cones("exponential", 3, np.eye(3).tolist(), [0, 0, 0])
    assert block.excess(np.array(point)) == pytest.approx([excess])


def test_what_is_no_number_is_outside() -> None:
    block = cones("exponential", 3, np.eye(3).tolist(), [0, 0, 0])
    assert block.excess(np.array([math.nan, 1.0, 1.0])).tolist() == [math.inf]


def test_the_matrix_spans_all_variables_of_the_program() -> None:
    block = cones("second-order", 2, [[1, 0], [0, 3]], [0, 0])
    assert block.matrix(5).toarray().tolist() == [[1, 0, 0, 0, 0], [0, 3, 0, 0, 0]]


def test_the_digest_covers_every_number() -> None:
    kind, width, *arrays = cones("second-order", 2, [[1, 0], [0, 3]], [0, 1]).parts()
    assert (kind, width) == ("second-order", 2)
    assert [a.tolist() for a in arrays] == [[0, 1, 2], [0, 1], [1, 3], [0, 1]]
