import math

import numpy as np
import scipy.sparse as sp
from hypothesis import given, strategies as st

from waybound.formulations.programs.rows import rows


def test_entries_of_several_parts_are_sorted_by_row_and_numbers_are_spread() -> None:
    block = rows(
        "r", 3, [(np.array([2, 0]), np.array([4, 1]), 1.5), (np.array([0, 2]), np.array([0, 3]), np.array([-1.0, 7.0]))], upper=[1, 2, 3]
    )
    assert block.indptr.tolist() == [0, 2, 2, 4]
    assert list(zip(block.indices.tolist(), block.data.tolist(), strict=True)) == [(1, 1.5), (0, -1.0), (4, 1.5), (3, 7.0)]
    assert block.lower.tolist() == [-math.inf] * 3 and block.upper.tolist() == [1.0, 2.0, 3.0]
    assert (block.indptr.dtype, block.indices.dtype, block.data.dtype) == (np.int32, np.int32, np.float64)


def test_no_parts_are_empty_rows() -> None:
    block = rows("r", 2, [], lower=0.0)
    assert (block.indptr.tolist(), len(block.indices), block.lower.tolist()) == ([0, 0, 0], 0, [0.0, 0.0])


def test_sides_are_the_blocks_own() -> None:
    """Two blocks from one number do not share an array that a caller might change."""
    side = np.array([1.0, 2.0])
    block = rows("r", 2, [], upper=side)
    side[0] = 9.0
    assert block.upper.tolist() == [1.0, 2.0]
    block.lower[0] = 5.0
    assert block.lower.tolist() == [5.0, -math.inf]


@given(st.data())
def test_the_block_is_the_matrix_of_its_entries(data: st.DataObject) -> None:
    size, width = data.draw(st.integers(1, 6)), data.draw(st.integers(1, 6))
    places = data.draw(st.lists(st.tuples(st.integers(0, size - 1), st.integers(0, width - 1)), unique=True, max_size=20))
    cut = data.draw(st.integers(0, len(places)))
    dense = np.zeros((size, width))
    parts = []
    for number, group in enumerate((places[:cut], places[cut:]), start=1):
        row, column = (np.array([p[k] for p in group], dtype=np.int64) for k in (0, 1))
        value = np.arange(len(group)) + 10.0 * number
        dense[row, column] = value
        parts.append((row, column, value))
    block = rows("r", size, parts)
    assert np.array_equal(sp.csr_matrix((block.data, block.indices, block.indptr), shape=dense.shape).toarray(), dense)
