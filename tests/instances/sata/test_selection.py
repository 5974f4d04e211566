"""Selection data."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coded import coded
from file_cases import refused
from hypothesis import given, strategies as st
from selection_problems import Apart, Weights

from waybound import Cardinality, Coverage, DenseFacilityLocation, FacilityLocation, InputError, Knapsack, PartitionMatroid
from waybound.instances.formats.waybound_json import read, write
from waybound.instances.sata.selection import CONSTRAINTS, SET_FUNCTIONS, JsonPart, SelectionInstance


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
    assert says in refused(make)


def test_it_shows_itself_in_one_line() -> None:
    made = SelectionInstance(Coverage.from_sets([[0]] * 500, [1]), PartitionMatroid.of(np.arange(500)), name="s")
    assert repr(made) == ("<SelectionInstance s: <Coverage: 500 elements, 1 items>, <PartitionMatroid: 500 elements in 500 groups>>")


COVERAGE = {"kind": "coverage", "item_weights": [1, 2.5, 3], "sets": [[0, 2], [1], []]}
FACILITY = {"kind": "facility-location", "items": 3, "sets": [[0, 2], [1], []], "weights": [[1, 2], [0.5], []]}
DENSE = {"kind": "dense-facility-location", "matrix": [[1, 2], [0, 3], [4, 0]]}
SMALL = {
    "waybound": 1, "kind": "selection", "name": "small", "problem": "selection", "function": COVERAGE,
    "constraint": {"kind": "cardinality", "limit": 2},
}  # fmt: skip


def load(**changes: Any) -> SelectionInstance:
    made = read(json.dumps({key: value for key, value in {**SMALL, **changes}.items() if value != "drop"}), Path("small.json"))
    assert isinstance(made, SelectionInstance)
    return made


@pytest.mark.parametrize("function", [COVERAGE, FACILITY, DENSE, {**DENSE, "single": True}])
@pytest.mark.parametrize(
    "constraint",
    [
        {"kind": "cardinality", "limit": 2},
        {"kind": "partition", "groups": [0, 1, 0], "limits": [1, 0]},
        {"kind": "knapsack", "costs": [1, 0.1, 2], "budget": 2.5},
    ],
)
def test_every_function_goes_with_every_constraint(
    function: Any, constraint: Any, differences: Callable[..., list[str]]
) -> None:  # fmt: skip
    made = load(function=function, constraint=constraint, elements=["a", "b", "c"], notes=["n"])
    again = read(write(made), Path("a.json"))
    assert differences(made, again) == []
    assert write(again) == write(made)
    assert json.loads(write(made))["constraint"] == constraint


def test_precision_is_kept() -> None:
    single = load(function={**DENSE, "single": True}).function
    assert isinstance(single, DenseFacilityLocation) and single.matrix.dtype == np.float32
    double = load(function=DENSE).function
    assert isinstance(double, DenseFacilityLocation) and double.matrix.dtype == np.float64


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"function": "drop"}, "the document lacks the key 'function'"),
        ({"colour": 1}, "the document has an unknown key 'colour'"),
        ({"problem": "bottleneck"}, "selections allow one problem; expected selection; found bottleneck"),
        ({"problems": ["selection", "tsp"]}, "selections allow one problem"),
        ({"elements": ["a", "b"]}, "there must be one name for each element; expected 3; found 2"),
        ({"elements": ["a", "b", "a"]}, "two elements have the name 'a'"),
        ({"function": 5}, "function must be an object; found 5"),
        (
            {"function": {"kind": "sum"}},
            "function.kind is unknown; expected coverage, dense-facility-location, facility-location; found sum",
        ),
        ({"function": {**COVERAGE, "items": 3}}, "function has an unknown key 'items'"),
        ({"function": {"kind": "coverage", "sets": []}}, "function lacks the key 'item_weights'"),
        ({"function": {**COVERAGE, "sets": [[0, 3], [1], []]}}, "function.sets[0] is no set of items; expected items from 0 to 2"),
        (
            {"function": {**COVERAGE, "sets": [[0], [1, 1], []]}},
            "function.sets[1] is no set of items; expected items from 0 to 2, ascending",
        ),
        ({"function": {**COVERAGE, "sets": [[0], 1, []]}}, "function.sets[1] must be a list; found 1"),
        ({"function": {**COVERAGE, "sets": [[0], [-1], []]}}, "function.sets[1][0] must be a whole number"),
        ({"function": {**COVERAGE, "item_weights": [1, -2, 3]}}, "the weight of item 2 must be finite and not negative"),
        ({"function": {**COVERAGE, "item_weights": [], "sets": [[0]]}}, "expected no items, for there are none"),
        ({"function": {**FACILITY, "weights": [[1, 2], [0.5]]}}, "function.weights has a wrong length; expected 3; found 2"),
        ({"function": {**FACILITY, "weights": [[1], [0.5], []]}}, "function.weights[0] has a wrong length; expected 2; found 1"),
        ({"function": {**FACILITY, "weights": [[1, None], [0.5], []]}}, "function.weights[0][1] must be a number"),
        ({"function": {**FACILITY, "items": 10**17}}, "num_items must be a whole number from 0"),
        ({"function": {**DENSE, "matrix": [[1, 2], [3], [4, 0]]}}, "function.matrix[1] has a wrong length; expected 2; found 1"),
        ({"function": {**DENSE, "matrix": [[1, -2], [3, 1], [4, 0]]}}, "weights must be finite and not negative"),
        ({"function": {**DENSE, "single": 1}}, "function.single[0] must be true or false"),
        ({"function": {**DENSE, "matrix": [[0.1]], "single": True}}, "function.matrix holds numbers that single precision does not"),
        ({"constraint": {"kind": "matroid"}}, "constraint.kind is unknown; expected cardinality, knapsack, partition; found matroid"),
        ({"constraint": {"limit": 2}}, "constraint lacks the key 'kind'"),
        ({"constraint": {"kind": "cardinality", "limit": 0}}, "constraint.limit must be a whole number; expected 1 or more; found 0"),
        ({"constraint": {"kind": "cardinality", "limit": 2, "budget": 1}}, "constraint has an unknown key 'budget'"),
        (
            {"constraint": {"kind": "partition", "groups": [0, 1], "limits": [1]}},
            "constraint.groups has a wrong length; expected 3; found 2",
        ),
        ({"constraint": {"kind": "partition", "groups": [0, 1, 0], "limits": [1]}}, "the group of element 2 does not exist"),
        ({"constraint": {"kind": "knapsack", "costs": [1, 2, -3], "budget": 1}}, "the cost of element 3 must be finite and not negative"),
        ({"constraint": {"kind": "knapsack", "costs": [1, 2, 3], "budget": -1}}, "the budget must be a finite number, not negative"),
    ],
)
def test_a_fault_is_refused_by_its_path(changes: dict[str, Any], message: str) -> None:
    assert message in refused(load, **changes)


values = st.floats(0, 1e300)


@given(st.lists(st.lists(values, min_size=3, max_size=3), min_size=1, max_size=4), values, st.booleans())
def test_numbers_read_back_to_the_bit(rows: list[list[float]], budget: float, dense: bool) -> None:
    matrix = np.array(rows)
    f: Any = DenseFacilityLocation(matrix)
    if not dense:
        indptr = np.arange(0, 3 * len(rows) + 1, 3)
        f = FacilityLocation(indptr, np.tile([0, 1, 2], len(rows)), matrix.ravel(), 3)  # type: ignore[arg-type]
    made = SelectionInstance(f, Knapsack(matrix[:, 0], budget))
    again = read(write(made), Path("a.json"))
    assert isinstance(again, SelectionInstance)
    assert again.digest() == made.digest()


def test_nothing_to_choose_from_is_legal() -> None:
    for constraint in (Cardinality(1), PartitionMatroid.of([], []), Knapsack(np.zeros(0), 0.0)):
        made = SelectionInstance(Coverage.from_sets([], []), constraint)
        assert read(write(made), Path("a.json")).digest() == made.digest()  # type: ignore[attr-defined]


def test_functions_and_constraints_from_outside_are_written_and_read() -> None:
    function = JsonPart(("table",), lambda f: {"table": f.table.tolist()}, lambda given, elements: Weights(np.array(given["table"])))
    rule = JsonPart((), lambda c: {}, lambda given, elements: Apart())
    made = SelectionInstance(Weights(np.eye(2)), Apart())
    with pytest.raises(InputError, match="the function weights cannot be written to a file; expected coverage", check=coded("unsupported")):
        write(made)
    with SET_FUNCTIONS.temporary("weights", function), CONSTRAINTS.temporary("apart", rule):
        assert json.loads(write(made))["function"] == {"kind": "weights", "table": [[1.0, 0.0], [0.0, 1.0]]}
        again = read(write(made), Path("a.json"))
        assert isinstance(again, SelectionInstance) and again.digest() == made.digest()
