from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from file_cases import refused
from hypothesis import given, strategies as st

from waybound.instances import number_arrays as arrays
from waybound.instances.errors import InputError


@pytest.mark.parametrize(
    "values", [[0, 3, 1], (0, 3, 1), np.array([0, 3, 1], np.uint8), np.array([0.0, 3.0, 1.0]), np.array([0, 3, 1], ">i8")]
)
def test_whole_numbers_of_any_type_are_taken(values: Any) -> None:
    assert arrays.whole_numbers("x", values).tolist() == [0, 3, 1]
    assert arrays.indices("x", values).dtype == np.int32


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ([0.5], "found 0.5"), ([0, float("nan")], "found nan"), ([float("inf")], "found inf"), (["a"], "found 'a'"), ([None], "found None"),
        ([True], "found True"), ([[0]], "shape (1, 1)"), (3, "shape ()"), ([0, [1]], "different lengths"), ([10**30], "too large"),
        ([2**31], "at most 2147483646; found 2147483648"), ([-(2**40)], "found -1099511627776"),
        (np.array([2**63], np.uint64), "too large"),
    ],
)  # fmt: skip
def test_what_is_no_list_of_whole_numbers_is_refused(values: Any, says: str) -> None:
    with pytest.raises(InputError) as caught:
        arrays.whole_numbers("x", values)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("values", ["a", [1, "b"], [[1], [1, 2]], object(), np.ones(2, dtype=complex)])
def test_what_holds_no_numbers_is_refused(values: Any) -> None:
    with pytest.raises(InputError, match="weights must hold numbers"):
        arrays.reals("weights", values)


def test_a_frozen_array_leaves_the_callers_own_writable() -> None:
    own = np.arange(3)
    kept = arrays.frozen(own)
    own[0] = 7
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 1
    assert kept[0] == 7


def test_positions_are_copied_and_checked() -> None:
    own = np.zeros((2, 2))
    made = arrays.positions("target", own, 2)
    own[0, 0] = 5
    assert made[0, 0] == 0
    for wrong, says in (
        (np.zeros((3, 2)), "expected (2, 2); found (3, 2)"),
        ([[0, 1], [np.nan, 0]], "position of target 2 must be finite"),
    ):
        assert says in refused(arrays.positions, "target", wrong, 2)
    with pytest.raises(InputError, match="position of target q must be finite"):
        arrays.positions("target", [[0, 1], [np.nan, 0]], 2, ("p", "q"))


@st.composite
def csr(draw: st.DrawFn) -> tuple[list[list[int]], int]:
    columns = draw(st.integers(1, 6))
    return draw(st.lists(st.lists(st.integers(0, columns - 1), max_size=columns), min_size=0, max_size=5)), columns


@given(csr())
def test_rows_are_taken_exactly_if_each_ascends(data: tuple[list[list[int]], int]) -> None:
    rows, columns = data
    indptr = np.cumsum([0, *map(len, rows)]).astype(np.int32)
    entries = np.array([c for row in rows for c in row], dtype=np.int32)
    good = all(a < b for row in rows for a, b in pairwise(row))
    try:
        arrays.check_csr(indptr, entries, columns, "row", "column", "entries")
    except InputError as error:
        assert not good
        assert "must ascend, none twice" in str(error)
    else:
        assert good


@pytest.mark.parametrize("indptr", [[], [1, 2], [0, 2, 1, 2], [0, 1]])
def test_starts_that_do_not_ascend_to_the_number_of_entries_are_refused(indptr: list[int]) -> None:
    with pytest.raises(InputError, match="starts of the rows"):
        arrays.check_csr(np.array(indptr, np.int32), np.array([0, 1], np.int32), 3, "row", "column", "entries")


@pytest.mark.parametrize(
    ("given_names", "says"),
    [
        (["a"], "one name for each robot; expected 2; found 1"), (["a", "a"], "two robots have the name 'a'"), ("ab", "must be a list"),
        (["a", ""], "without blanks"), (["a", " b"], "without blanks"), (["a", "b\n"], "printable"), (5, "must be a list"),
    ],
)  # fmt: skip
def test_names_are_printable_and_different(given_names: Any, says: str) -> None:
    with pytest.raises(InputError, match=says):
        arrays.names("robot", given_names, 2)


def test_more_unused_things_than_could_be_meant_are_refused() -> None:
    arrays.refuse_unused("targets", arrays.MOST_UNUSED + 5, 5, "edges")
    with pytest.raises(InputError, match="there are 1000006 targets, but only 5 edges"):
        arrays.refuse_unused("targets", arrays.MOST_UNUSED + 6, 5, "edges")


@given(st.integers(0, 2**32 - 1))
def test_entries_of_rows_come_row_after_row(seed: int) -> None:
    rng = np.random.default_rng(seed)
    indptr = np.concatenate([[0], np.cumsum(rng.integers(0, 4, 6))])
    rows = rng.integers(0, 6, rng.integers(0, 8))
    found, counts = arrays.entries_of(indptr, rows)
    expected = [list(range(indptr[row], indptr[row + 1])) for row in rows.tolist()]
    assert found.tolist() == [k for entries in expected for k in entries]
    assert counts.tolist() == [len(entries) for entries in expected]


def test_starts_of_rows_count_their_entries() -> None:
    assert arrays.row_starts(np.array([0, 2, 2]), 4).tolist() == [0, 1, 1, 3, 3]
    assert arrays.row_starts(np.zeros(0, dtype=np.int64), 2).tolist() == [0, 0, 0]
