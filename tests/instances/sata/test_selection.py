"""Selection data."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.sata.constraints import Cardinality, Knapsack, PartitionMatroid
from waybound.instances.sata.selection import SelectionInstance
from waybound.instances.sata.set_functions import Coverage, FacilityLocation


def test_the_digest_does_not_depend_on_the_types_of_the_arrays() -> None:
    parts: tuple[Any, ...] = ([0, 1, 3], [1, 0, 2], [0.5, 1, 2], 4)
    narrow = FacilityLocation(np.array(parts[0], np.int32), np.array(parts[1], np.int32), np.array(parts[2]), 4)
    wide = FacilityLocation(np.array(parts[0], np.int64), parts[1], np.array(parts[2], np.float32), np.int64(4))  # type: ignore[arg-type]
    rules = PartitionMatroid.of([0, 1]), PartitionMatroid(np.array([0, 1], np.int64), [1, 1])  # type: ignore[arg-type]
    made = [SelectionInstance(f, rule).digest() for f, rule in zip((narrow, wide), rules, strict=True)]
    assert made[0] == made[1]


def test_names_are_no_part_of_the_digest_and_numbers_are() -> None:
    f = Coverage.from_sets([[0], [1]], [1, 2])
    first = SelectionInstance(f, Cardinality(1)).digest()
    assert SelectionInstance(f, Cardinality(1), ("a", "b"), name="other").digest() == first
    assert SelectionInstance(f, Cardinality(2)).digest() != first
    assert SelectionInstance(Coverage.from_sets([[0], [1]], [1, 3]), Cardinality(1)).digest() != first


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: SelectionInstance(Coverage.from_sets([[0]], [1]), Knapsack([1, 2], 3)), "costs must have one entry an element"),
        (lambda: SelectionInstance(Coverage.from_sets([[0]], [1]), PartitionMatroid.of([0, 0])), "groups must have one entry an element"),
        (lambda: SelectionInstance(Coverage.from_sets([[0]], [1]), Cardinality(1), ("a", "b")), "one name for each element"),
        (lambda: SelectionInstance(Coverage.from_sets([[0], [0]], [1]), Cardinality(1), ("a", "a")), "two elements have the name 'a'"),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(make: Any, says: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_it_shows_itself_in_one_line() -> None:
    made = SelectionInstance(Coverage.from_sets([[0]] * 500, [1]), PartitionMatroid.of(np.arange(500)), name="s")
    assert repr(made) == ("<SelectionInstance s: <Coverage: 500 elements, 1 items>, <PartitionMatroid: 500 elements in 500 groups>>")
