from typing import Any

import numpy as np
import pytest
from file_cases import refused
from hypothesis import given, strategies as st
from selection_problems import KINDS, OWN_KINDS, random_function

from waybound import Coverage
from waybound.instances.sata.set_functions import AT_ENTRY, AT_ITEM, IN_MATRIX, DenseFacilityLocation, FacilityLocation, ItemFunction


def test_repeated_items_of_a_set_count_once() -> None:
    f = Coverage.from_sets([[2, 0, 2], [], {1}], [1, 2, 3])
    assert (f.indptr.tolist(), f.indices.tolist()) == ([0, 2, 2, 3], [0, 2, 1])
    assert (f.num_elements, f.num_items, f.as_item_weights().edges()[2].tolist()) == (3, 3, [1.0, 3.0, 2.0])
    assert Coverage.from_sets([], []).num_elements == 0


def test_a_matrix_of_either_precision_is_kept_as_it_is() -> None:
    for kind in (np.float32, np.float64):
        matrix = np.ones((2, 3), kind)
        assert DenseFacilityLocation(matrix).matrix is matrix
    assert DenseFacilityLocation([[1, 2]]).matrix.dtype == np.float64  # type: ignore[arg-type]


def by_definition(f: ItemFunction, chosen: list[int]) -> float:
    """The sum over items of the largest weight that an edge from ``chosen`` has."""
    best: dict[int, float] = {}
    for element, item, weight in zip(*(v.tolist() for v in f.as_item_weights().edges()), strict=True):
        if element in chosen:
            best[item] = max(best.get(item, 0.0), weight)
    return sum(best.values())


@given(st.integers(0, 10**6), st.sampled_from((*KINDS, *OWN_KINDS)), st.booleans())
def test_values_of_many_sets_of_one_and_gains_agree(seed: int, kind: str, whole: bool) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 9))
    f = random_function(rng, kind, n, whole=whole)
    masks = rng.random((20, n)) < rng.random()
    sets = [np.nonzero(mask)[0] for mask in masks]
    assert f.values(masks) == pytest.approx([f.value(chosen) for chosen in sets], rel=1e-12, abs=1e-12)
    if isinstance(f, ItemFunction):
        assert f.values(masks) == pytest.approx([by_definition(f, chosen.tolist()) for chosen in sets], rel=1e-12, abs=1e-12)
    assert f.gains(rng.permutation(n).tolist()).sum() == pytest.approx(f.value(np.arange(n)))
    assert f.value(np.zeros(0, dtype=np.int64)) == 0.0 and f.gains([]).tolist() == []


def test_many_sets_are_valued_in_bounded_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    f = DenseFacilityLocation(np.eye(4))
    masks = np.ones((10, 4), dtype=bool)
    monkeypatch.setattr("waybound.instances.sata.set_functions.STRIP", 12)
    assert f.values(masks).tolist() == [4.0] * 10


def test_weights_stand_where_their_layout_says() -> None:
    cover = Coverage.from_sets([[0, 2], [1]], [1.0, 0.0, 3.0]).as_item_weights()
    assert (cover.layout, cover.entries, cover.num_items) == (AT_ITEM, 3, 3)
    assert [v.tolist() for v in cover.edges()] == [[0, 0], [0, 2], [1.0, 3.0]]  # a weight of 0 is no edge
    sparse = FacilityLocation([0, 1, 2], [1, 0], [0.5, 2.0], 2).as_item_weights()  # type: ignore[arg-type]
    assert (sparse.layout, [v.tolist() for v in sparse.edges()]) == (AT_ENTRY, [[0, 1], [1, 0], [0.5, 2.0]])
    dense = DenseFacilityLocation(np.array([[0.0, 2.0]], np.float32)).as_item_weights()
    assert (dense.layout, dense.matrix.dtype, [v.tolist() for v in dense.edges()]) == (IN_MATRIX, np.float32, [[0], [1], [2.0]])
    assert not any(array.flags.writeable for array in dense.arrays[1:])


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Coverage.from_sets([[0], [2]], [1, 1]), "item of entry 2 does not exist; expected 0 to 1; found 2"),
        (lambda: Coverage.from_sets([[0], [-1]], [1, 1]), "item of entry 2 does not exist"),
        (lambda: Coverage.from_sets([["a"]], [1]), "set 0 must be a list of whole numbers; expected items by their numbers from 0"),
        (lambda: Coverage.from_sets([[0]], [-1]), "the weight of item 1 must be finite and not negative; found -1.0"),
        (lambda: Coverage.from_sets([[0]], [np.nan]), "the weight of item 1 must be finite"),
        (lambda: Coverage.from_sets([[0]], ["x"]), "item_weights must hold numbers"),
        (lambda: Coverage.from_sets([[0]], 1.0), "item_weights must be a list"),
        (lambda: Coverage([0, 2], [1, 0], [1, 1]), "the items of each element must ascend, none twice"),
        (lambda: Coverage([0, 3], [0, 1], [1, 1]), "the starts of the elements do not ascend"),
        (lambda: FacilityLocation([0, 1], [0], [1.0], 2 * 10**9), "there are 2000000000 items, but only 1 entries"),
        (lambda: FacilityLocation([0, 1], [0], [-1.0], 1), "the weight of entry 1"),
        (lambda: FacilityLocation([0, 1], [0], [1.0, 2.0], 1), "one weight an entry; expected 1"),
        (lambda: DenseFacilityLocation([1.0, 2.0]), "the weights must be a matrix of elements x items; found shape (2,)"),
        (lambda: DenseFacilityLocation([[1.0, -2.0]]), "weights must be finite and not negative"),
        (lambda: DenseFacilityLocation([[1e308, 1.0], [0.0, 1e308]]), "the weights add up to more than a floating-point number can hold"),
        (lambda: Coverage.from_sets([[0], [1]], [1e308, 1e308]), "the weights of the items add up to more than"),
        (lambda: DenseFacilityLocation(np.array([[np.inf]], np.float32)), "weights must be finite"),
        (lambda: DenseFacilityLocation([[1.0, np.nan]]), "weights must be finite"),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(make: Any, says: str) -> None:
    assert says in refused(make)


def test_they_show_themselves_in_one_line() -> None:
    made = [Coverage.from_sets([[0]] * 500, [1]), FacilityLocation([0, 1], [0], [1.0], 3), DenseFacilityLocation(np.ones((99, 99)))]  # type: ignore[arg-type]
    assert all(len(repr(f)) < 80 for f in made)
