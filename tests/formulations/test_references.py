from typing import Any

import numpy as np
import pytest
from coded import coded

from waybound.formulations.references import indices_of, is_number, vector_of
from waybound.instances.errors import UsageError

LETTERS = {"a": 0, "b": 1, "c": 2}
FROM_0 = {"0": 0, "1": 1, "2": 2}
FROM_1 = {"1": 0, "2": 1, "3": 2}
FROM_100 = {"100": 0, "101": 1, "102": 2}


@pytest.mark.parametrize(
    ("given", "names", "meant"),
    [
        ([], LETTERS, []),
        (["c", "a"], LETTERS, [2, 0]),
        ([2, 0], LETTERS, [2, 0]),
        (["c", 0, np.int64(1)], LETTERS, [2, 0, 1]),
        ([1, 2], FROM_0, [1, 2]),
        (["3", "1"], FROM_1, [2, 0]),
        ([0, 2], FROM_1, [0, 2]),  # 0 is no name
        ([3, 1], FROM_1, [2, 0]),  # 3 is no index
        ([100, 102], FROM_100, [0, 2]),
        ([0, 2], FROM_100, [0, 2]),
    ],
)
def test_what_is_meant_where_it_is_clear(given: list[Any], names: dict[str, int], meant: list[int]) -> None:
    assert indices_of(given, names, "site") == meant


@pytest.mark.parametrize(
    ("given", "names", "says"),
    [
        (["d"], LETTERS, "there is no site 'd'"), ([0, 3], LETTERS, "there is no site 0|there is no site 3"),
        ([-1], FROM_0, "there is no site -1"), ([0, 3], FROM_1, "there is no site 0"),
        ([True], LETTERS, "a site is given by its name or its index, not by True"), ([1.0], LETTERS, "not by 1.0"),
        ([[1]], LETTERS, r"not by \[1\]"), ([None], LETTERS, "not by None"),
    ],
)  # fmt: skip
def test_what_is_not_clear_is_refused(given: list[Any], names: dict[str, int], says: str) -> None:
    with pytest.raises(UsageError, match=says):
        indices_of(given, names, "site")


def test_numbers_that_could_be_names_or_indices_are_refused() -> None:
    with pytest.raises(UsageError, match="of sites here", check=coded("ambiguous")):
        indices_of([1, 2], FROM_1, "site")


@pytest.mark.parametrize("given", [None, "x", [1, "x"], [[1], [1, 2]], {"a": 1}, 10**400, np.ones(2, dtype=complex), object()])
def test_what_is_no_list_of_numbers_is_no_vector_of_any_length(given: Any) -> None:
    assert vector_of(given).ndim != 1


def test_a_vector_is_any_list_or_array_of_numbers() -> None:
    for given in ([1, 2], (1.0, 2.0), np.array([1, 2]), np.array([1.0, 2.0])[:, None][:, 0]):
        assert vector_of(given).tolist() == [1.0, 2.0]


def test_a_number_is_what_a_double_holds() -> None:
    assert all(map(is_number, (0, -1, 1.5, 10**300, float("nan"))))
    assert not any(map(is_number, (True, None, "1", 1j, 10**400, -(10**400), [1])))
