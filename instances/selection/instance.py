"""Selection data: a ground set, a set function given by arrays, and a constraint on what may be chosen together."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..errors import InputError
from ..instance import digest
from ..text import label

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]


@dataclass(frozen=True, eq=False)
class Coverage:
    """``f(S)`` = sum of the weights of the items that some element of S covers. Monotone submodular.

    Parameters
    ----------
    indptr, indices : arrays
        CSR form of elements x items: ascending items within an element, none twice.
    item_weights : array of shape (items,), >= 0
    """

    name: ClassVar[str] = "coverage"
    indptr: Indices
    indices: Indices
    item_weights: Floats

    @classmethod
    def from_sets(cls, sets: Any, item_weights: ArrayLike) -> Coverage:
        """From one list of items an element; items are numbers from 0, and repeated ones count once."""
        lists = [np.unique(arrays.whole_numbers(f"set {k}", list(s), "items by their numbers from 0")) for k, s in enumerate(sets)]
        starts = np.cumsum([0] + [len(s) for s in lists])
        items = np.concatenate(lists) if lists else np.zeros(0)
        return cls(starts.astype(np.int32), items.astype(np.int32), np.array(arrays.reals("item_weights", item_weights)))

    def __post_init__(self) -> None:
        _make_csr(self)
        object.__setattr__(self, "item_weights", arrays.reals("item_weights", self.item_weights))
        if self.item_weights.ndim != 1:
            raise InputError("item_weights must be a list with one weight an item", found=f"shape {self.item_weights.shape}")
        arrays.refuse_negative("the weight of item {}", self.item_weights)
        arrays.refuse_overflow("the weights of the items", self.item_weights)
        arrays.check_csr(self.indptr, self.indices, len(self.item_weights), "element", "item", "entries")

    @property
    def num_elements(self) -> int:
        return len(self.indptr) - 1

    @property
    def num_items(self) -> int:
        return len(self.item_weights)

    @property
    def edge_weights(self) -> Floats:
        """Weight of the item at each entry of ``indices``: coverage is facility location with these."""
        return self.item_weights[self.indices]

    def facts(self) -> dict[str, Any]:
        """Kind and sizes, as plain JSON values."""
        return {"kind": self.name, "elements": self.num_elements, "items": self.num_items, "entries": len(self.indices)}

    def __repr__(self) -> str:
        return f"<Coverage: {self.num_elements} elements, {self.num_items} items>"

    def parts(self) -> tuple[Any, ...]:
        """What the digest covers."""
        return (self.name, self.indptr, self.indices, self.item_weights)


@dataclass(frozen=True, eq=False)
class FacilityLocation:
    """``f(S)`` = sum over items (clients) of the largest weight that an element of S gives them, 0 for none. Monotone submodular.

    Parameters
    ----------
    indptr, indices, weights : arrays
        CSR form of elements x items, weights >= 0; pairs that are left out weigh 0.
    num_items : int
    """

    name: ClassVar[str] = "facility-location"
    indptr: Indices
    indices: Indices
    weights: Floats
    num_items: int

    def __post_init__(self) -> None:
        _make_csr(self)
        object.__setattr__(self, "weights", arrays.reals("weights", self.weights))
        object.__setattr__(self, "num_items", arrays.size("num_items", self.num_items))
        arrays.refuse_unused("items", self.num_items, len(self.indices), "entries")
        arrays.check_csr(self.indptr, self.indices, self.num_items, "element", "item", "entries")
        if self.weights.shape != self.indices.shape:
            raise InputError("there must be one weight an entry", expected=str(len(self.indices)), found=str(self.weights.shape))
        arrays.refuse_negative("the weight of entry {}", self.weights)
        arrays.refuse_overflow("the weights", self.weights)

    @property
    def num_elements(self) -> int:
        return len(self.indptr) - 1

    @property
    def edge_weights(self) -> Floats:
        return self.weights

    def facts(self) -> dict[str, Any]:
        """Kind and sizes, as plain JSON values."""
        return {"kind": self.name, "elements": self.num_elements, "items": self.num_items, "entries": len(self.indices)}

    def __repr__(self) -> str:
        return f"<FacilityLocation: {self.num_elements} elements, {self.num_items} items, {len(self.indices)} weights>"

    def parts(self) -> tuple[Any, ...]:
        """What the digest covers."""
        return (self.name, self.num_items, self.indptr, self.indices, self.weights)


@dataclass(frozen=True, eq=False)
class DenseFacilityLocation:
    """Facility location whose weights are a full matrix.

    Parameters
    ----------
    matrix : array of shape (elements, items), >= 0
        float64 or float32, row-major; kept as it is.
    """

    name: ClassVar[str] = "facility-location"
    matrix: NDArray[np.floating[Any]]

    def __post_init__(self) -> None:
        if not isinstance(self.matrix, np.ndarray) or self.matrix.dtype not in (np.float32, np.float64):
            object.__setattr__(self, "matrix", arrays.reals("the weights", self.matrix))
        if self.matrix.ndim != 2:
            raise InputError("the weights must be a matrix of elements x items", found=f"shape {self.matrix.shape}")
        # One reduction each way instead of a mask of the same size: the matrix may hold gigabytes.
        if self.matrix.size and not (self.matrix.min() >= 0 and math.isfinite(float(self.matrix.max()))):
            raise InputError("weights must be finite and not negative")
        arrays.refuse_overflow("the weights", self.matrix)

    @property
    def num_elements(self) -> int:
        return int(self.matrix.shape[0])

    @property
    def num_items(self) -> int:
        return int(self.matrix.shape[1])

    def facts(self) -> dict[str, Any]:
        """Kind and sizes, as plain JSON values."""
        return {"kind": self.name, "elements": self.num_elements, "items": self.num_items, "entries": self.matrix.size}

    def __repr__(self) -> str:
        return f"<DenseFacilityLocation: {self.num_elements} elements, {self.num_items} items>"

    def parts(self) -> tuple[Any, ...]:
        """What the digest covers."""
        return ("dense facility-location", self.matrix)


@dataclass(frozen=True)
class Cardinality:
    """At most ``limit`` elements."""

    name: ClassVar[str] = "cardinality"
    limit: int

    def __post_init__(self) -> None:
        if isinstance(self.limit, bool) or not isinstance(self.limit, int | np.integer) or self.limit < 1:
            raise InputError("the number of elements to choose must be a whole number of at least 1", found=repr(self.limit)[:40])
        object.__setattr__(self, "limit", int(self.limit))

    def facts(self) -> dict[str, Any]:
        """Kind and limit, as plain JSON values."""
        return {"kind": self.name, "limit": self.limit}

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.limit)


@dataclass(frozen=True, eq=False)
class PartitionMatroid:
    """At most ``limits[g]`` elements of group g.

    Parameters
    ----------
    groups : array of shape (elements,)
        Group of each element, from 0.
    limits : array of shape (groups,)
        Whole numbers >= 0.
    """

    name: ClassVar[str] = "partition"
    groups: Indices
    limits: Indices

    @classmethod
    def of(cls, groups: ArrayLike, limits: ArrayLike = 1) -> PartitionMatroid:
        """From any arrays; one limit for all groups, or one each."""
        member, most = arrays.indices("groups", groups), arrays.indices("limits", np.atleast_1d(np.asarray(limits)))
        if np.ndim(limits):
            return cls(member, most)
        count = int(member.max(initial=-1)) + 1
        arrays.refuse_unused("groups", count, len(member), "elements")
        return cls(member, np.full(count, most[0], dtype=np.int32))

    def __post_init__(self) -> None:
        for key in ("groups", "limits"):
            object.__setattr__(self, key, arrays.indices(key, getattr(self, key)))
        arrays.refuse_outside("the group of element {}", self.groups, len(self.limits), "group")
        if (self.limits < 0).any():
            k = int(np.argmax(self.limits < 0))
            raise InputError(f"the limit of group {k} must not be negative", found=str(self.limits[k]))

    def facts(self) -> dict[str, Any]:
        """Kind, groups, their different limits, and the most elements that can be chosen together, as plain JSON values."""
        rank = np.minimum(np.bincount(self.groups, minlength=len(self.limits)), self.limits).sum()
        return {"kind": self.name, "groups": len(self.limits), "limits": sorted(set(self.limits.tolist())), "rank": int(rank)}

    def __repr__(self) -> str:
        return f"<PartitionMatroid: {len(self.groups)} elements in {len(self.limits)} groups>"

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.groups, self.limits)


@dataclass(frozen=True, eq=False)
class Knapsack:
    """Costs of the chosen elements sum to at most ``budget``.

    Parameters
    ----------
    costs : array of shape (elements,), >= 0
    budget : float, >= 0
    """

    name: ClassVar[str] = "knapsack"
    costs: Floats
    budget: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "costs", np.atleast_1d(arrays.reals("costs", self.costs)))
        arrays.refuse_negative("the cost of element {}", self.costs)
        budget = arrays.reals("budget", self.budget)
        if budget.ndim or not 0 <= float(budget) < math.inf:
            raise InputError("the budget must be a finite number, not negative", found=repr(self.budget)[:40])
        object.__setattr__(self, "budget", float(budget))

    def facts(self) -> dict[str, Any]:
        """Kind, budget, and the cost of all elements together, as plain JSON values."""
        return {"kind": self.name, "budget": self.budget, "cost": float(self.costs.sum())}

    def __repr__(self) -> str:
        return f"<Knapsack: {len(self.costs)} elements, budget {self.budget:g}>"

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.costs, self.budget)


SetFunction = Coverage | FacilityLocation | DenseFacilityLocation
Constraint = Cardinality | PartitionMatroid | Knapsack


@dataclass(frozen=True, eq=False)
class SelectionInstance:
    """A set function and a constraint as a file gives them.

    Parameters
    ----------
    name, format, problem, problems, notes
        See ``Instance``.
    function : Coverage, FacilityLocation or DenseFacilityLocation
    constraint : Cardinality, PartitionMatroid or Knapsack
    element_names : tuple of str, optional
        None stands for "1", "2", ...
    """

    kind: ClassVar[str] = "selection"
    function: SetFunction
    constraint: Constraint
    element_names: tuple[str, ...] | None = None
    name: str = "selection"
    format: str = "arrays"
    problem: str = "selection"
    problems: tuple[str, ...] = ("selection",)
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", label(self.name))
        check_selection(self.function.num_elements, self.constraint, self.element_names)

    def __repr__(self) -> str:
        return f"<SelectionInstance {self.name}: {self.function!r}, {self.constraint!r}>"

    def digest(self) -> str:
        """Hash of everything that values depend on."""
        return digest("selection", *self.function.parts(), *self.constraint.parts())


def check_selection(elements: int, constraint: Constraint, names: tuple[str, ...] | None) -> None:
    """Raise InputError unless constraint and names fit a ground set of ``elements``."""
    held = {"partition": "groups", "knapsack": "costs"}.get(constraint.name)
    if held is not None and len(getattr(constraint, held)) != elements:
        raise InputError(f"{held} must have one entry an element", expected=str(elements), found=str(len(getattr(constraint, held))))
    arrays.names("element", names, elements)


def _make_csr(function: Coverage | FacilityLocation) -> None:
    for key in ("indptr", "indices"):
        object.__setattr__(function, key, arrays.indices(key, getattr(function, key)))
