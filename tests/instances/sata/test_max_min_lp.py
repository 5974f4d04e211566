import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from file_cases import refused
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError
from waybound.instances.formats.waybound_json import read, write
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
    assert says in refused(make)


def test_more_variables_than_entries_could_mean_are_refused() -> None:
    wide = SparseMatrix(np.array([0, 1], np.int32), np.array([0], np.int32), np.array([1.0]), 2 * 10**9)
    with pytest.raises(InputError, match="there are 2000000000 variables, but only 2 entries"):
        MaxMinInstance(wide, wide)


def test_an_instance_shows_itself_in_one_line() -> None:
    assert repr(MaxMinInstance(A, C)) == "<MaxMinInstance max-min-lp: max, 3 variables, 2 packing and 1 covering rows>"
    assert repr(A) == "<SparseMatrix: 2 rows, 3 columns, 3 entries>"


SMALL = {
    "waybound": 1, "kind": "max-min", "name": "small", "problem": "max-min-lp", "sense": "max", "variables": 2,
    "packing": {"rows": 1, "row": [0, 0], "variable": [0, 1], "value": [1, 2]}, "covering": {"rows": 2, "row": [1, 0], "variable": [1, 0]},
}  # fmt: skip


def load(**changes: Any) -> MaxMinInstance:
    data: dict[str, Any] = json.loads(json.dumps(SMALL))
    for key, value in changes.items():
        part, _, inner = key.partition("__")
        (data if not inner else data[part])[inner or part] = value
    made = read(json.dumps(data), Path("small.json"))
    assert isinstance(made, MaxMinInstance)
    return made


def test_entries_may_come_in_any_order_and_weigh_1_by_default() -> None:
    made = load()
    assert made.packing.scipy.toarray().tolist() == [[1, 2]]
    assert made.covering.scipy.toarray().tolist() == [[1, 0], [0, 1]]
    assert (made.format, made.variable_names, made.sense) == ("json", None, "max")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sense": "most"}, "the sense must be max (max-min) or min (min-max); found most"),
        ({"problem": "bottleneck"}, "packing and covering rows allow one problem; expected max-min-lp"),
        ({"colour": 1}, "the document has an unknown key 'colour'"),
        ({"variables": 0}, "variables must be a whole number; expected 1 or more; found 0"),
        ({"variables": "two"}, "variables must be a list of names or a whole number; found 'two'"),
        ({"variables": True}, "variables must be a whole number"),
        ({"variables": ["a", "a"]}, "two variables have the name 'a'"),
        ({"variables": 1}, "packing.variable[1] does not exist; expected 0 to 0; found 1"),
        ({"packing": []}, "packing must be an object; found a list"),
        ({"packing__rows": 0}, "packing.rows must be a whole number; expected 1 or more; found 0"),
        ({"packing__rows": 2 * 10**9}, "there are 2000000000 rows of packing, but only 2 entries"),
        ({"packing__row": [0, 1]}, "packing.row[1] does not exist; expected 0 to 0; found 1"),
        ({"packing__row": [0]}, "packing.variable has a wrong length; expected 1; found 2"),
        ({"packing__variable": [0, 0]}, "packing has two entries in row 1 for variable 0"),
        ({"packing__value": [1, 0]}, "packing.value[1] must be positive; found 0.0"),
        ({"packing__value": [1, -2]}, "packing.value[1] must be positive; found -2.0"),
        ({"packing__value": [1]}, "packing.value has a wrong length; expected 2; found 1"),
        ({"covering__weight": [1]}, "covering has an unknown key 'weight'"),
        ({"packing__variable": [0], "packing__row": [0], "packing__value": [1]}, "variable 1 covers but is in no packing row"),
        ({"sense": "min", "covering__rows": 3}, "covering row 3 holds no variable: nothing can cover it"),
    ],
)
def test_a_fault_is_refused_by_its_path(changes: dict[str, Any], message: str) -> None:
    assert message in refused(load, **changes)


@given(st.integers(0, 2**32 - 1), st.sampled_from(["max", "min"]), st.booleans())
def test_what_is_written_reads_back_to_the_bit(
    differences: Callable[..., list[str]], seed: int, sense: str, named: bool
) -> None:  # fmt: skip
    rng = np.random.default_rng(seed)
    a, c = np.exp(rng.normal(0, 30, (3, 4))), np.exp(rng.normal(0, 30, (2, 4)))
    a[rng.random(a.shape) < 0.3], c[rng.random(c.shape) < 0.3] = 0, 0
    a[0], c[:, 0] = 1.0, 2.0
    names = tuple("wxyz") if named else None
    made = MaxMinInstance(SparseMatrix.of(a), SparseMatrix.of(c), sense, names, name="g", notes=("note",))
    again = read(write(made), Path("a.json"))
    assert differences(made, again) == []
    assert again.sense == sense  # type: ignore[attr-defined]
    assert write(again) == write(made)
