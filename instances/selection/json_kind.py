"""Selection instances in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from ..document import array, fields, flags, integer, json_number, json_numbers, real, reals, string, strings, wholes
from ..errors import InputError
from ..kinds import KINDS, Kind
from .instance import (
    Cardinality,
    Constraint,
    Coverage,
    DenseFacilityLocation,
    FacilityLocation,
    Knapsack,
    PartitionMatroid,
    SelectionInstance,
    SetFunction,
)

KEYS = ("name", "problem", "problems", "elements", "function", "constraint", "notes")
FUNCTION_KEYS = {
    "coverage": ("kind", "sets", "item_weights"),
    "facility-location": ("kind", "items", "sets", "weights"),
    "dense-facility-location": ("kind", "matrix", "single"),
}
CONSTRAINT_KEYS = {
    "cardinality": ("kind", "limit"),
    "partition": ("kind", "groups", "limits"),
    "knapsack": ("kind", "costs", "budget"),
}


def encode(instance: SelectionInstance) -> dict[str, Any]:
    """The keys of a selection instance; those that hold nothing but defaults are left out."""
    data: dict[str, Any] = {"name": instance.name, "problem": instance.problem}
    if instance.problems != (instance.problem,):
        data["problems"] = list(instance.problems)
    if instance.element_names is not None:
        data["elements"] = list(instance.element_names)
    data["function"] = _encode_function(instance.function)
    c = instance.constraint
    if isinstance(c, Cardinality):
        data["constraint"] = {"kind": "cardinality", "limit": c.limit}
    elif isinstance(c, PartitionMatroid):
        data["constraint"] = {"kind": "partition", "groups": c.groups.tolist(), "limits": c.limits.tolist()}
    else:
        data["constraint"] = {"kind": "knapsack", "costs": json_numbers(c.costs), "budget": json_number(c.budget)}
    if instance.notes:
        data["notes"] = list(instance.notes)
    return data


def _encode_function(f: SetFunction) -> dict[str, Any]:
    if isinstance(f, DenseFacilityLocation):
        data: dict[str, Any] = {"kind": "dense-facility-location"}
        if f.matrix.dtype == np.float32:
            data["single"] = True
        return {**data, "matrix": [json_numbers(row) for row in f.matrix.astype(np.float64)]}
    starts, items = f.indptr.tolist(), f.indices.tolist()
    sets = [items[a:b] for a, b in pairwise(starts)]
    if isinstance(f, Coverage):
        return {"kind": "coverage", "item_weights": json_numbers(f.item_weights), "sets": sets}
    weights = json_numbers(f.weights)
    made = {"kind": "facility-location", "items": f.num_items, "sets": sets}
    return {**made, "weights": [weights[a:b] for a, b in pairwise(starts)]}


def decode(data: dict[str, Any]) -> SelectionInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "function", "constraint"))
    problem = string(data["problem"], "problem")
    problems = strings(data.get("problems", [problem]), "problems")
    if problem != "selection" or problems != ("selection",):
        raise InputError("selections allow one problem", expected="selection", found=", ".join(dict.fromkeys((problem, *problems))))
    function = _decode_function(data["function"])
    return SelectionInstance(
        function, _decode_constraint(data["constraint"], function.num_elements),
        strings(data["elements"], "elements") if "elements" in data else None, name=string(data["name"], "name"), format="json",
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


def _of_kind(data: Any, path: str, known: Mapping[str, tuple[str, ...]]) -> tuple[str, Mapping[str, Any]]:
    kind = string(fields(data, path, tuple(data) if isinstance(data, dict) else (), ("kind",))["kind"], f"{path}.kind")
    if kind not in known:
        raise InputError(f"{path}.kind is unknown", expected=", ".join(known), found=kind)
    required = [key for key in known[kind] if key != "single"]
    return kind, fields(data, path, known[kind], required)


def _decode_function(data: Any) -> SetFunction:
    kind, given = _of_kind(data, "function", FUNCTION_KEYS)
    if kind == "dense-facility-location":
        rows = array(given["matrix"], "function.matrix")
        width = len(array(rows[0], "function.matrix[0]")) if rows else 0
        matrix = np.array([reals(row, f"function.matrix[{k}]", width) for k, row in enumerate(rows)]).reshape(len(rows), width)
        if flags([given.get("single", False)], "function.single", 1)[0]:
            return DenseFacilityLocation(_single(matrix))
        return DenseFacilityLocation(matrix)
    sets = [wholes(items, f"function.sets[{k}]") for k, items in enumerate(array(given["sets"], "function.sets"))]
    starts = np.cumsum([0, *(len(items) for items in sets)])
    items = np.concatenate(sets) if sets else np.zeros(0, dtype=np.int64)
    if kind == "coverage":
        count = len(array(given["item_weights"], "function.item_weights"))
        _refuse_sets(sets, count)
        return Coverage(starts, items, reals(given["item_weights"], "function.item_weights", count))  # type: ignore[arg-type]
    count = integer(given["items"], "function.items", 0)
    _refuse_sets(sets, count)
    lists = array(given["weights"], "function.weights", len(sets))
    weights = [reals(row, f"function.weights[{k}]", len(sets[k])) for k, row in enumerate(lists)]
    return FacilityLocation(starts, items, np.concatenate(weights) if weights else np.zeros(0), count)  # type: ignore[arg-type]


def _refuse_sets(sets: list[Any], count: int) -> None:
    """Refuse here, by the path, what the set function would refuse by the number of the entry."""
    for k, items in enumerate(sets):
        if len(items) and (items.max() >= count or (np.diff(items) <= 0).any()):
            expected = f"items from 0 to {count - 1}, ascending, none twice" if count else "no items, for there are none"
            raise InputError(f"function.sets[{k}] is no set of items", expected=expected)


def _single(matrix: Any) -> Any:
    with np.errstate(over="ignore"):
        made = matrix.astype(np.float32)
    if not np.array_equal(made.astype(np.float64), matrix):
        raise InputError("function.matrix holds numbers that single precision does not")
    return made


def _decode_constraint(data: Any, elements: int) -> Constraint:
    kind, given = _of_kind(data, "constraint", CONSTRAINT_KEYS)
    if kind == "cardinality":
        return Cardinality(integer(given["limit"], "constraint.limit", 1))
    if kind == "knapsack":
        return Knapsack(reals(given["costs"], "constraint.costs", elements), real(given["budget"], "constraint.budget"))
    return PartitionMatroid(
        wholes(given["groups"], "constraint.groups", elements), wholes(given["limits"], "constraint.limits")  # type: ignore[arg-type]
    )  # fmt: skip


KINDS.add("selection", Kind("selection", encode, decode))
