"""Packing and covering data."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from waybound.instances.errors import InputError
from waybound.instances.sata.max_min_lp import MaxMinInstance, SparseMatrix

A = SparseMatrix.of([[1, 0, 2], [0, 1, 0]])
C = SparseMatrix.of([[1, 1, 1.5]])


def test_zeros_are_left_out_and_duplicates_added() -> None:
    made = SparseMatrix.of(sp.coo_matrix(([1.0, 2.0, 0.0, 4.0], ([1, 1, 0, 0], [2, 2, 0, 1])), shape=(2, 3)))
    assert (made.rows, made.columns) == (2, 3)
    assert made.scipy.toarray().tolist() == [[0, 4, 0], [0, 0, 3]]
    assert (made.indptr.dtype, made.indices.dtype, made.data.dtype) == (np.int32, np.int32, np.float64)


def test_the_matrix_that_is_given_stays_as_it_is() -> None:
    own = sp.csr_matrix(([3.0, 0.0, 1.0], [2, 1, 0], [0, 3]), shape=(1, 3))
    SparseMatrix.of(own)
    assert (own.indices.tolist(), own.data.tolist()) == ([2, 1, 0], [3.0, 0.0, 1.0])


def test_the_digest_covers_rows_and_sense() -> None:
    first = MaxMinInstance(A, C).digest()
    assert MaxMinInstance(A, C, variable_names=("a", "b", "c"), name="x").digest() == first
    assert MaxMinInstance(A, C, "min").digest() != first
    assert MaxMinInstance(SparseMatrix.of([[1, 0, 2], [0, 1.5, 0]]), C).digest() != first


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: SparseMatrix.of([[1, -1]]), "coefficients must be positive and finite; zeros are left out; found -1.0"),
        (lambda: SparseMatrix.of([[np.nan]]), "coefficients must be positive and finite"),
        (lambda: SparseMatrix.of([[np.inf]]), "coefficients must be positive and finite"),
        (lambda: SparseMatrix.of("matrix"), "a matrix of numbers is needed"),
        (lambda: SparseMatrix.of([[1, 2], [3]]), "a matrix of numbers is needed"),
        (lambda: SparseMatrix([0, 2], [1, 0], [1.0, 1.0], 2), "the columns of each row must ascend"),
        (lambda: SparseMatrix([0, 1], [2], [1.0], 2), "column of entry 1 does not exist"),
        (lambda: SparseMatrix([0, 1], [0], [1.0, 2.0], 2), "one value an entry"),
        (lambda: MaxMinInstance(A, SparseMatrix.of([[1, 1]])), "over the same variables; expected 3; found 2"),
        (lambda: MaxMinInstance(A, C, "largest"), "the sense must be max (max-min) or min (min-max); found largest"),
        (lambda: MaxMinInstance(SparseMatrix.of(np.zeros((0, 3))), C, "min"), "at least one packing row and one covering row"),
        (lambda: MaxMinInstance(SparseMatrix.of([[1, 0, 2]]), C), "variable 1 covers but is in no packing row: it is not bounded"),
        (lambda: MaxMinInstance(A, SparseMatrix.of([[1, 1, 1], [0, 0, 0]]), "min"), "covering row 2 holds no variable"),
        (lambda: MaxMinInstance(A, C, variable_names=("a", "b")), "one name for each variable; expected 3; found 2"),
        (lambda: MaxMinInstance(A, C, variable_names=("a", "b", "a")), "two variables have the name 'a'"),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(make: Any, says: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_more_variables_than_entries_could_mean_are_refused() -> None:
    wide = SparseMatrix(np.array([0, 1], np.int32), np.array([0], np.int32), np.array([1.0]), 2 * 10**9)
    with pytest.raises(InputError, match="there are 2000000000 variables, but only 2 entries"):
        MaxMinInstance(wide, wide)


def test_an_instance_shows_itself_in_one_line() -> None:
    assert repr(MaxMinInstance(A, C)) == "<MaxMinInstance max-min-lp: max, 3 variables, 2 packing and 1 covering rows>"
    assert repr(A) == "<SparseMatrix: 2 rows, 3 columns, 3 entries>"
