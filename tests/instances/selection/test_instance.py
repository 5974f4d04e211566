"""Selection data."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from waybound.instances.errors import InputError
from waybound.instances.selection.constraints import Cardinality, Knapsack, PartitionMatroid
from waybound.instances.selection.functions import Coverage, DenseFacilityLocation, FacilityLocation
from waybound.instances.selection.instance import SelectionInstance


def test_repeated_items_of_a_set_count_once() -> None:
    f = Coverage.from_sets([[2, 0, 2], [], {1}], [1, 2, 3])
    assert (f.indptr.tolist(), f.indices.tolist()) == ([0, 2, 2, 3], [0, 2, 1])
    assert (f.num_elements, f.num_items, f.as_item_weights().edges()[2].tolist()) == (3, 3, [1.0, 3.0, 2.0])
    assert Coverage.from_sets([], []).num_elements == 0


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


def test_one_limit_holds_for_all_groups_or_each_has_its_own() -> None:
    assert PartitionMatroid.of([0, 2, 0]).limits.tolist() == [1, 1, 1]
    assert PartitionMatroid.of([0, 2, 0], 5).limits.tolist() == [5, 5, 5]
    assert PartitionMatroid.of([0, 1, 0], [2, 0, 7]).limits.tolist() == [2, 0, 7]


def test_a_matrix_of_either_precision_is_kept_as_it_is() -> None:
    for kind in (np.float32, np.float64):
        matrix = np.ones((2, 3), kind)
        assert DenseFacilityLocation(matrix).matrix is matrix
    assert DenseFacilityLocation([[1, 2]]).matrix.dtype == np.float64  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Coverage.from_sets([[0], [2]], [1, 1]), "item of entry 1 does not exist; expected 0 to 1; found 2"),
        (lambda: Coverage.from_sets([[0], [-1]], [1, 1]), "item of entry 1 does not exist"),
        (lambda: Coverage.from_sets([["a"]], [1]), "set 0 must be a list of whole numbers; expected items by their numbers from 0"),
        (lambda: Coverage.from_sets([[0]], [-1]), "the weight of item 0 must be finite and not negative; found -1.0"),
        (lambda: Coverage.from_sets([[0]], [np.nan]), "the weight of item 0 must be finite"),
        (lambda: Coverage.from_sets([[0]], ["x"]), "item_weights must hold numbers"),
        (lambda: Coverage.from_sets([[0]], 1.0), "item_weights must be a list"),
        (lambda: Coverage([0, 2], [1, 0], [1, 1]), "the items of each element must ascend, none twice"),
        (lambda: Coverage([0, 3], [0, 1], [1, 1]), "the starts of the elements do not ascend"),
        (lambda: FacilityLocation([0, 1], [0], [1.0], 2 * 10**9), "there are 2000000000 items, but only 1 entries"),
        (lambda: FacilityLocation([0, 1], [0], [-1.0], 1), "the weight of entry 0"),
        (lambda: FacilityLocation([0, 1], [0], [1.0, 2.0], 1), "one weight an entry; expected 1"),
        (lambda: DenseFacilityLocation([1.0, 2.0]), "the weights must be a matrix of elements x items; found shape (2,)"),
        (lambda: DenseFacilityLocation([[1.0, -2.0]]), "weights must be finite and not negative"),
        (lambda: DenseFacilityLocation([[1e308, 1.0], [0.0, 1e308]]), "the weights add up to more than a floating-point number can hold"),
        (lambda: Coverage.from_sets([[0], [1]], [1e308, 1e308]), "the weights of the items add up to more than"),
        (lambda: DenseFacilityLocation(np.array([[np.inf]], np.float32)), "weights must be finite"),
        (lambda: DenseFacilityLocation([[1.0, np.nan]]), "weights must be finite"),
        (lambda: Cardinality(0), "must be a whole number of at least 1; found 0"),
        (lambda: Cardinality(2.0), "must be a whole number of at least 1; found 2.0"),
        (lambda: Cardinality(True), "must be a whole number"),
        (lambda: Cardinality("3"), "must be a whole number of at least 1; found '3'"),
        (lambda: PartitionMatroid([0, 2], [1, 1]), "the group of element 1 does not exist; expected 0 to 1; found 2"),
        (lambda: PartitionMatroid([0, -1], [1, 1]), "the group of element 1 does not exist"),
        (lambda: PartitionMatroid([0], [-1]), "the limit of group 0 must not be negative; found -1"),
        (lambda: PartitionMatroid.of([0, 10**9]), "there are 1000000001 groups, but only 2 elements"),
        (lambda: PartitionMatroid.of([0.5]), "groups must be a list of whole numbers"),
        (lambda: Knapsack([1, -1], 3), "the cost of element 1 must be finite and not negative"),
        (lambda: Knapsack([1, np.nan], 3), "the cost of element 1"),
        (lambda: Knapsack([1], -1), "the budget must be a finite number, not negative; found -1"),
        (lambda: Knapsack([1], np.inf), "the budget must be a finite number"),
        (lambda: Knapsack([1], "much"), "budget must hold numbers"),
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


def test_parts_show_themselves_in_one_line() -> None:
    parts = [
        Coverage.from_sets([[0]] * 500, [1]), FacilityLocation([0, 1], [0], [1.0], 3), DenseFacilityLocation(np.ones((99, 99))),  # type: ignore[arg-type]
        PartitionMatroid.of(np.arange(500)), Knapsack(np.ones(500), 3), Cardinality(3),
    ]  # fmt: skip
    assert all(len(repr(part)) < 80 for part in parts)
    assert repr(SelectionInstance(parts[0], parts[3], name="s")) == (  # type: ignore[arg-type]
        "<SelectionInstance s: <Coverage: 500 elements, 1 items>, <PartitionMatroid: 500 elements in 500 groups>>"
    )
