"""Selection data: a ground set, a set function given by arrays, and a constraint on what may be chosen together."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError
from .instance import digest

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
        lists = [np.unique(np.asarray(list(s), dtype=np.int64)) for s in sets]
        starts = np.cumsum([0] + [len(s) for s in lists])
        items = np.concatenate(lists) if lists else np.zeros(0)
        return cls(starts.astype(np.int32), items.astype(np.int32), np.array(item_weights, dtype=np.float64))

    def __post_init__(self) -> None:
        _check_csr(self.indptr, self.indices, len(self.item_weights), "item")
        _check_values("the weight of item {}", self.item_weights)

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
        _check_csr(self.indptr, self.indices, self.num_items, "item")
        if len(self.weights) != len(self.indices):
            raise InputError("there must be one weight an entry", expected=str(len(self.indices)), found=str(len(self.weights)))
        _check_values("the weight of entry {}", self.weights)

    @property
    def num_elements(self) -> int:
        return len(self.indptr) - 1

    @property
    def edge_weights(self) -> Floats:
        return self.weights

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
        if self.matrix.ndim != 2 or self.matrix.dtype not in (np.float32, np.float64):
            raise InputError("the weights must be a matrix of elements x items", found=f"{self.matrix.dtype} of shape {self.matrix.shape}")
        # One reduction each way instead of a mask of the same size: the matrix may hold gigabytes.
        if self.matrix.size and not (self.matrix.min() >= 0 and math.isfinite(float(self.matrix.max()))):
            raise InputError("weights must be finite and not negative")

    @property
    def num_elements(self) -> int:
        return int(self.matrix.shape[0])

    @property
    def num_items(self) -> int:
        return int(self.matrix.shape[1])

    def parts(self) -> tuple[Any, ...]:
        """What the digest covers."""
        return ("dense facility-location", self.matrix)


@dataclass(frozen=True)
class Cardinality:
    """At most ``limit`` elements."""

    name: ClassVar[str] = "cardinality"
    limit: int

    def __post_init__(self) -> None:
        if isinstance(self.limit, bool) or int(self.limit) != self.limit or self.limit < 1:
            raise InputError("the number of elements to choose must be a whole number of at least 1", found=str(self.limit))

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
        member = np.asarray(groups, dtype=np.int32)
        most = np.asarray(limits, dtype=np.int32)
        return cls(member, np.array(np.broadcast_to(most, int(member.max(initial=-1)) + 1)) if most.ndim == 0 else most)

    def __post_init__(self) -> None:
        if ((self.groups < 0) | (self.groups >= len(self.limits))).any():
            raise InputError("an element is of a group that does not exist", expected=f"groups from 0 to {len(self.limits) - 1}")
        if (self.limits < 0).any():
            raise InputError("the limit of a group must not be negative", found=str(int(self.limits.min())))

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
        object.__setattr__(self, "costs", np.asarray(self.costs, dtype=np.float64))
        object.__setattr__(self, "budget", float(self.budget))
        _check_values("the cost of element {}", self.costs)
        if not (self.budget >= 0 and math.isfinite(self.budget)):
            raise InputError("the budget must be finite and not negative", found=str(self.budget))

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
        check_selection(self.function.num_elements, self.constraint, self.element_names)

    def digest(self) -> str:
        return digest("selection", *self.function.parts(), *self.constraint.parts())


def check_selection(elements: int, constraint: Constraint, names: tuple[str, ...] | None) -> None:
    """Raise InputError unless constraint and names fit a ground set of ``elements``."""
    held = {"partition": "groups", "knapsack": "costs"}.get(constraint.name)
    if held is not None and len(getattr(constraint, held)) != elements:
        raise InputError(f"{held} must have one entry an element", expected=str(elements), found=str(len(getattr(constraint, held))))
    if names is not None and (len(names) != elements or len(set(names)) != elements):
        raise InputError("there must be one name an element, no two alike", expected=str(elements), found=str(len(set(names))))


def _check_csr(indptr: Indices, indices: Indices, columns: int, what: str) -> None:
    if not len(indptr) or indptr[0] != 0 or indptr[-1] != len(indices) or (np.diff(indptr) < 0).any():
        raise InputError("the starts of the elements do not ascend from 0 to the number of entries")
    outside = (indices < 0) | (indices >= columns)
    if outside.any():
        raise InputError(f"an {what} does not exist", expected=f"0 to {columns - 1}", found=str(indices[np.argmax(outside)]))
    inside = np.ones(max(len(indices) - 1, 0), dtype=bool)
    inside[indptr[1:-1][(indptr[1:-1] > 0) & (indptr[1:-1] < len(indices))] - 1] = False
    if (np.diff(indices)[inside] <= 0).any():
        raise InputError(f"the {what}s of an element must ascend, none twice")


def _check_values(what: str, values: Floats) -> None:
    wrong = ~(values >= 0) | np.isinf(values)
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"{what.format(k)} must be finite and not negative", found=str(values[k]))
