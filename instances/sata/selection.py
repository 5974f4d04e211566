"""A selection as a file gives it: a ground set, a set function, and a constraint on what may be chosen together."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Generic, TypeVar

import numpy as np

from ..declared import Declared, Names
from ..document import array, fields, flags, integer, json_number, json_numbers, matrix, real, reals, string, strings, wholes
from ..errors import InputError
from ..instance import digest
from ..parts import Axis
from ..registry import Registry
from .constraints import Cardinality, Constraint, Knapsack, PartitionMatroid
from .set_functions import Coverage, DenseFacilityLocation, FacilityLocation, SetFunction

T = TypeVar("T")


@dataclass(frozen=True)
class JsonPart(Generic[T]):
    """Reader and writer of a kind of set function or constraint in JSON.

    Parameters
    ----------
    required, optional : tuple of str
    encode : callable
        From the object to the values of its keys.
    decode : callable
        From these, and the number of elements of a constraint's ground set (0 for a function), to the object. Raises InputError.
    """

    required: tuple[str, ...]
    encode: Callable[[Any], dict[str, Any]]
    decode: Callable[[Mapping[str, Any], int], T]
    optional: tuple[str, ...] = ()


SET_FUNCTIONS: Registry[JsonPart[SetFunction]] = Registry(
    "kind of set function", "waybound.instances.sata.selection", group="waybound.set_functions"
)
CONSTRAINTS: Registry[JsonPart[Constraint]] = Registry(
    "kind of constraint", "waybound.instances.sata.selection", group="waybound.constraints"
)


@dataclass(frozen=True, eq=False, repr=False)
class SelectionInstance(Declared):
    """A set function and a constraint as a file gives them.

    Parameters
    ----------
    function : SetFunction
        What a set is worth.
    constraint : Constraint
        Which sets are allowed.
    element_names : tuple of str, optional
        None stands for "1", "2", ...
    name, format, problem, problems, notes
        See ``Instance``.
    """

    kind = "selection"
    problem_names = ("selection",)
    lists_problems = True
    content = "selections"
    axes = (Axis("element", table=False, least=0),)
    keys = ("elements", "function", "constraint")
    own_keys = ("function", "constraint")
    function: SetFunction
    constraint: Constraint
    element_names: Names = None

    def arrange(self) -> None:
        self.counts["element"] = self.function.num_elements
        self.constraint.check(self.function.num_elements)

    def __repr__(self) -> str:
        return f"<SelectionInstance {self.name}: {self.function!r}, {self.constraint!r}>"

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        return digest(self.kind, *self.function.parts(), *self.constraint.parts())

    def write_own(self) -> dict[str, Any]:
        data: dict[str, Any] = {} if self.element_names is None else {"elements": list(self.element_names)}
        for key, known, part in (("function", SET_FUNCTIONS, self.function), ("constraint", CONSTRAINTS, self.constraint)):
            if part.kind not in known:
                raise InputError(f"the {key} {part.name} cannot be written to a file", "unsupported", expected=", ".join(known))
            data[key] = {"kind": part.kind, **known[part.kind].encode(part)}
        return data

    @classmethod
    def read_own(cls, data: Mapping[str, Any], counts: Mapping[str, int]) -> dict[str, Any]:
        function = _decoded(data["function"], "function", SET_FUNCTIONS, 0)
        constraint = _decoded(data["constraint"], "constraint", CONSTRAINTS, function.num_elements)
        names = strings(data["elements"], "elements") if "elements" in data else None
        return {"function": function, "constraint": constraint, "element_names": names}


def _decoded(data: Any, path: str, known: Registry[JsonPart[T]], elements: int) -> T:
    kind = string(fields(data, path, tuple(data) if isinstance(data, dict) else (), ("kind",))["kind"], f"{path}.kind")
    if kind not in known:
        raise InputError(f"{path}.kind is unknown", "unknown-name", expected=", ".join(known), found=kind)
    part = known[kind]
    return part.decode(fields(data, path, ("kind", *part.required, *part.optional), ("kind", *part.required)), elements)


# -- set functions ----------------------------------------------------------------------------------------------------


def _rows(indptr: Any, values: list[Any]) -> list[list[Any]]:
    return [values[a:b] for a, b in pairwise(indptr.tolist())]


def _sets(data: Mapping[str, Any]) -> tuple[list[Any], Any, Any]:
    """The sets, and as CSR."""
    sets = [wholes(items, f"function.sets[{k}]") for k, items in enumerate(array(data["sets"], "function.sets"))]
    return sets, np.cumsum([0, *(len(items) for items in sets)]), np.concatenate(sets) if sets else np.zeros(0, dtype=np.int64)


def _refuse_sets(sets: list[Any], count: int) -> None:
    """Refuse here, by the path, what the set function would refuse by the number of the entry."""
    for k, items in enumerate(sets):
        if len(items) and (items.max() >= count or (np.diff(items) <= 0).any()):
            expected = f"items from 0 to {count - 1}, ascending, none twice" if count else "no items, for there are none"
            raise InputError(f"function.sets[{k}] is no set of items", expected=expected)


def _encode_coverage(f: Coverage) -> dict[str, Any]:
    return {"item_weights": json_numbers(f.item_weights), "sets": _rows(f.indptr, f.indices.tolist())}


def _decode_coverage(data: Mapping[str, Any], elements: int) -> Coverage:
    sets, starts, items = _sets(data)
    count = len(array(data["item_weights"], "function.item_weights"))
    _refuse_sets(sets, count)
    return Coverage(starts, items, reals(data["item_weights"], "function.item_weights", count))


def _encode_sparse(f: FacilityLocation) -> dict[str, Any]:
    return {
        "items": f.num_items, "sets": _rows(f.indptr, f.indices.tolist()), "weights": _rows(f.indptr, json_numbers(f.weights))
    }  # fmt: skip


def _decode_sparse(data: Mapping[str, Any], elements: int) -> FacilityLocation:
    sets, starts, items = _sets(data)
    count = integer(data["items"], "function.items", 0)
    _refuse_sets(sets, count)
    lists = array(data["weights"], "function.weights", len(sets))
    weights = [reals(row, f"function.weights[{k}]", len(sets[k])) for k, row in enumerate(lists)]
    return FacilityLocation(starts, items, np.concatenate(weights) if weights else np.zeros(0), count)


def _encode_dense(f: DenseFacilityLocation) -> dict[str, Any]:
    data = {"single": True} if f.matrix.dtype == np.float32 else {}
    return {**data, "matrix": [json_numbers(row) for row in f.matrix.astype(np.float64)]}


def _decode_dense(data: Mapping[str, Any], elements: int) -> DenseFacilityLocation:
    values = matrix(data["matrix"], "function.matrix")
    if not flags([data.get("single", False)], "function.single", 1)[0]:
        return DenseFacilityLocation(values)
    with np.errstate(over="ignore"):
        single = values.astype(np.float32)
    if not np.array_equal(single.astype(np.float64), values):
        raise InputError("function.matrix holds numbers that single precision does not", "out-of-range")
    return DenseFacilityLocation(single)


SET_FUNCTIONS.add("coverage", JsonPart(("sets", "item_weights"), _encode_coverage, _decode_coverage))
SET_FUNCTIONS.add("facility-location", JsonPart(("items", "sets", "weights"), _encode_sparse, _decode_sparse))
SET_FUNCTIONS.add("dense-facility-location", JsonPart(("matrix",), _encode_dense, _decode_dense, ("single",)))


# -- constraints ------------------------------------------------------------------------------------------------------

CONSTRAINTS.add(
    "cardinality",
    JsonPart(("limit",), lambda c: {"limit": c.limit}, lambda data, elements: Cardinality(integer(data["limit"], "constraint.limit", 1))),
)
CONSTRAINTS.add(
    "partition",
    JsonPart(
        ("groups", "limits"),
        lambda c: {"groups": c.groups.tolist(), "limits": c.limits.tolist()},
        lambda data, elements: PartitionMatroid(
            wholes(data["groups"], "constraint.groups", elements),  # type: ignore[arg-type]
            wholes(data["limits"], "constraint.limits"),  # type: ignore[arg-type]
        ),
    ),
)
CONSTRAINTS.add(
    "knapsack",
    JsonPart(
        ("costs", "budget"),
        lambda c: {"costs": json_numbers(c.costs), "budget": json_number(c.budget)},
        lambda data, elements: Knapsack(reals(data["costs"], "constraint.costs", elements), real(data["budget"], "constraint.budget")),
    ),
)
