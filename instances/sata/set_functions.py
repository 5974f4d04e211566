"""Set functions over a ground set of elements, numbered from 0: what each is worth, and the data that algorithms and checkers read."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..text import an

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Masks = NDArray[np.bool_]

AT_ITEM, AT_ENTRY, IN_MATRIX = 0, 1, 2
"""Place of the weights: one an item (the same for all elements that have it), one an entry of a CSR form, or a full matrix."""

STRIP = 1 << 21
"""Numbers that are kept at once while many sets are valued."""


@dataclass(frozen=True, eq=False)
class ItemWeights:
    """The weights >= 0 that elements give to items, in one of three layouts: f(S) is the sum over items of the largest weight of S.

    Parameters
    ----------
    layout : int
        ``AT_ITEM``, ``AT_ENTRY`` or ``IN_MATRIX``.
    indptr, indices : arrays
        CSR form of elements x items: ascending items within an element, none twice; empty beside a matrix.
    weights : array
        One an item or one an entry.
    matrix : array of shape (elements, items)
        float64 or float32; empty beside a CSR form.
    num_items : int
    """

    layout: int
    indptr: Indices
    indices: Indices
    weights: Floats
    matrix: NDArray[np.floating[Any]]
    num_items: int

    @classmethod
    def sparse(cls, layout: int, indptr: Indices, indices: Indices, weights: Floats, num_items: int) -> "ItemWeights":
        return cls(
            layout, _frozen(indptr, np.int32), _frozen(indices, np.int32), _frozen(weights, np.float64),
            _frozen(np.zeros((0, 0)), np.float64), num_items,
        )  # fmt: skip

    @classmethod
    def dense(cls, matrix: NDArray[np.floating[Any]]) -> "ItemWeights":
        none = np.zeros(0)
        return cls(
            IN_MATRIX, _frozen(none, np.int32), _frozen(none, np.int32), _frozen(none, np.float64), _frozen(matrix, matrix.dtype),
            int(matrix.shape[1]),
        )  # fmt: skip

    def check(self, elements: int) -> None:
        """Raise InputError unless they are what is said above, for that many elements: every bound rests on it."""
        if self.layout == IN_MATRIX:
            # One reduction each way instead of a mask of the same size: the matrix may hold gigabytes.
            if self.matrix.size and not (self.matrix.min() >= 0 and math.isfinite(float(self.matrix.max()))):
                raise InputError("weights must be finite and not negative", "out-of-range")
            arrays.refuse_overflow("the weights", self.matrix)
            count = len(self.matrix)
        else:
            thing, every, size = "entry", "the weights", len(self.indices)
            if self.layout == AT_ITEM:
                thing, every, size = "item", "the weights of the items", self.num_items
            arrays.check_csr(self.indptr, self.indices, self.num_items, "element", "item", "entries")
            if self.weights.shape != (size,):
                raise InputError(f"there must be one weight {an(thing)}", "wrong-shape", expected=str(size), found=str(self.weights.shape))
            arrays.refuse_negative(f"the weight of {thing} {{}}", self.weights)
            arrays.refuse_overflow(every, self.weights)
            count = len(self.indptr) - 1
        if count != elements:
            raise InputError("there must be weights for each element", "wrong-shape", expected=str(elements), found=str(count))

    @property
    def arrays(self) -> tuple[int, Indices, Indices, Floats, Floats, NDArray[np.float32]]:
        """Arguments of compiled loops: one place for a matrix of doubles and one for single precision, of which at least one is empty."""
        places = [_frozen(self.matrix if self.matrix.dtype == kind else np.zeros((0, 0)), kind) for kind in (np.float64, np.float32)]
        return self.layout, self.indptr, self.indices, self.weights, places[0], places[1]

    @property
    def entries(self) -> int:
        """Weights that a look at all elements reads."""
        return len(self.indices) or int(self.matrix.size)

    def given_by(self, element: int) -> tuple[Any, Floats]:
        """Items of an element, as an index, and the weights that it gives them."""
        if self.layout == IN_MATRIX:
            return slice(None), self.matrix[element].astype(np.float64)
        entries = slice(self.indptr[element], self.indptr[element + 1])
        items = self.indices[entries]
        return items, self.weights[items if self.layout == AT_ITEM else entries]

    def best(self, chosen: NDArray[np.integer[Any]]) -> Floats:
        """The largest weight that one of ``chosen`` gives to each item, 0 for none."""
        if self.layout == IN_MATRIX:
            return np.asarray(self.matrix[chosen].max(axis=0, initial=0.0), dtype=np.float64)
        best, (entries, _) = np.zeros(self.num_items), arrays.entries_of(self.indptr, chosen)
        items = self.indices[entries]
        np.maximum.at(best, items, self.weights[items if self.layout == AT_ITEM else entries])
        return best

    def edges(self) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats]:
        """Element, item and weight of each positive weight, by element and then by item."""
        if self.layout == IN_MATRIX:
            element, item = np.nonzero(self.matrix)
            return element, item, self.matrix[element, item].astype(np.float64)
        element, item = np.repeat(np.arange(len(self.indptr) - 1), np.diff(self.indptr)), self.indices.astype(np.int64)
        weight = self.weights[item] if self.layout == AT_ITEM else self.weights
        if not weight.all():
            keep = weight > 0
            element, item, weight = element[keep], item[keep], weight[keep]
        return element, item, weight


def _frozen(values: NDArray[Any], dtype: Any) -> NDArray[Any]:
    """A read-only view: numba takes writable and read-only arrays for two types, and would compile a loop for each."""
    return arrays.frozen(np.ascontiguousarray(values, dtype))


class SetFunction(ABC):
    """A function of sets of elements, with f({}) = 0.

    ``name``, ``num_elements``, ``values`` and ``parts`` are all that a subclass needs: greedy methods, brute force and, where it is
    declared monotone and submodular, bounds then work through its values.

    Attributes
    ----------
    name : str
    kind : str
        Its name in waybound's JSON; empty if it cannot be written there.
    feature : str
        What a method must be able to take: by default a function that is known by its values only.
    monotone, submodular : bool
        Guarantees and bounds rest on it, and say so where it is a mere declaration.
    num_elements : int
    label : str
        What names it in messages.
    """

    name: ClassVar[str]
    kind: ClassVar[str] = ""
    feature: ClassVar[str] = "function:user"
    monotone = False
    submodular = False

    if TYPE_CHECKING:  # an attribute or a property, as the subclass likes

        @property
        def num_elements(self) -> int: ...

    @property
    def label(self) -> str:
        return self.name

    @abstractmethod
    def values(self, masks: Masks) -> Floats:
        """Values of the sets given by the rows of ``masks``, shape (sets,)."""

    @abstractmethod
    def parts(self) -> tuple[Any, ...]:
        """Data that the digest covers."""

    def as_item_weights(self) -> ItemWeights | None:
        """The function as a sum over items of the largest weight that an element gives each, where it is one."""
        return None

    def check(self) -> None:  # noqa: B027
        """Raise InputError unless its data are sound; a problem asks once."""

    def value(self, chosen: NDArray[np.integer[Any]]) -> float:
        """Value of the set of the elements ``chosen``, none twice."""
        mask = np.zeros((1, self.num_elements), dtype=bool)
        mask[0, chosen] = True
        return float(self.values(mask)[0])

    def gains(self, elements: Sequence[int]) -> Floats:
        """Gain of each element over the value of those before it, shape (elements,)."""
        return np.diff([self.value(np.array(elements[:k], dtype=np.int64)) for k in range(len(elements) + 1)])

    def facts(self) -> dict[str, Any]:
        """Facts about the function as plain JSON values."""
        return {"kind": self.name, "elements": self.num_elements}


class ItemFunction(SetFunction):
    """A sum over items of the largest weight that an element of the set gives each: monotone and submodular.

    A subclass needs ``name``, ``num_elements``, ``parts`` and ``as_item_weights``, and gets every form, bound and compiled heuristic.
    """

    feature: ClassVar[str] = "function:facility-location"
    monotone = True
    submodular = True

    @abstractmethod
    def as_item_weights(self) -> ItemWeights: ...

    def check(self) -> None:
        self.as_item_weights().check(self.num_elements)

    def values(self, masks: Masks) -> Floats:
        weights = self.as_item_weights()
        totals, step = np.zeros(len(masks)), max(1, STRIP // max(1, weights.num_items))
        for first in range(0, len(masks), step):
            some = masks[first : first + step]
            best = np.zeros((len(some), weights.num_items))
            for element in np.nonzero(some.any(axis=0))[0].tolist():
                items, offered = weights.given_by(element)
                rows = np.nonzero(some[:, element])[0]
                raised = best[rows]
                raised[:, items] = np.maximum(raised[:, items], offered)
                best[rows] = raised
            totals[first : first + step] = best.sum(axis=1)
        return totals

    def value(self, chosen: NDArray[np.integer[Any]]) -> float:
        return math.fsum(self.as_item_weights().best(chosen))

    def gains(self, elements: Sequence[int]) -> Floats:
        weights, added = self.as_item_weights(), np.zeros(len(elements))
        best = np.zeros(weights.num_items)
        for k, element in enumerate(elements):
            items, offered = weights.given_by(element)
            more = np.maximum(offered, best[items])
            added[k] = math.fsum(more - best[items])
            best[items] = more
        return added

    def facts(self) -> dict[str, Any]:
        weights = self.as_item_weights()
        return {**super().facts(), "items": weights.num_items, "entries": weights.entries}

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.num_elements} elements, {self.as_item_weights().num_items} items>"


class _Checked(ItemFunction):
    """Checked when it is made, and not by each problem."""

    def check(self) -> None:
        pass


@dataclass(frozen=True, eq=False, repr=False)
class Coverage(_Checked):
    """``f(S)`` = sum of the weights of the items that some element of S covers. Monotone submodular.

    Parameters
    ----------
    indptr, indices : arrays
        CSR form of elements x items: ascending items within an element, none twice.
    item_weights : array of shape (items,), >= 0
        What each item is worth where it is covered.
    """

    name: ClassVar[str] = "coverage"
    kind: ClassVar[str] = "coverage"
    feature: ClassVar[str] = "function:coverage"
    indptr: Indices
    indices: Indices
    item_weights: Floats

    @classmethod
    def from_sets(cls, sets: Any, item_weights: ArrayLike) -> "Coverage":
        """A coverage function from one list of items an element; items are numbers from 0, and repeated ones count once.

        Parameters
        ----------
        sets : sequence of sequences of int
            The items that each element covers.
        item_weights : array-like, shape (items,), >= 0
            As of the class.
        """
        lists = [np.unique(arrays.whole_numbers(f"set {k}", list(s), "items by their numbers from 0")) for k, s in enumerate(sets)]
        starts = np.cumsum([0] + [len(s) for s in lists])
        items = np.concatenate(lists) if lists else np.zeros(0)
        return cls(starts.astype(np.int32), items.astype(np.int32), np.array(arrays.reals("item_weights", item_weights)))

    def __post_init__(self) -> None:
        _make_csr(self)
        object.__setattr__(self, "item_weights", arrays.reals("item_weights", self.item_weights))
        if self.item_weights.ndim != 1:
            raise InputError("item_weights must be a list with one weight an item", "wrong-shape", found=f"shape {self.item_weights.shape}")
        ItemFunction.check(self)

    @property
    def num_elements(self) -> int:
        return len(self.indptr) - 1

    @property
    def num_items(self) -> int:
        return len(self.item_weights)

    def as_item_weights(self) -> ItemWeights:
        return ItemWeights.sparse(AT_ITEM, self.indptr, self.indices, self.item_weights, self.num_items)

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.indptr, self.indices, self.item_weights)


@dataclass(frozen=True, eq=False, repr=False)
class FacilityLocation(_Checked):
    """``f(S)`` = sum over items (clients) of the largest weight that an element of S gives them, 0 for none. Monotone submodular.

    Parameters
    ----------
    indptr, indices, weights : arrays
        CSR form of elements x items, weights >= 0; pairs that are left out weigh 0.
    num_items : int
        Clients, those included that no element serves.
    """

    name: ClassVar[str] = "facility-location"
    kind: ClassVar[str] = "facility-location"
    indptr: Indices
    indices: Indices
    weights: Floats
    num_items: int

    def __post_init__(self) -> None:
        _make_csr(self)
        object.__setattr__(self, "weights", arrays.reals("weights", self.weights))
        object.__setattr__(self, "num_items", arrays.size("num_items", self.num_items))
        arrays.refuse_unused("items", self.num_items, len(self.indices), "entries")
        ItemFunction.check(self)

    @property
    def num_elements(self) -> int:
        return len(self.indptr) - 1

    def as_item_weights(self) -> ItemWeights:
        return ItemWeights.sparse(AT_ENTRY, self.indptr, self.indices, self.weights, self.num_items)

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.num_items, self.indptr, self.indices, self.weights)


@dataclass(frozen=True, eq=False, repr=False)
class DenseFacilityLocation(_Checked):
    """Facility location whose weights are a full matrix.

    Parameters
    ----------
    matrix : array of shape (elements, items), >= 0
        float64 or float32, row-major; kept as it is.
    """

    name: ClassVar[str] = "facility-location"
    kind: ClassVar[str] = "dense-facility-location"
    matrix: NDArray[np.floating[Any]]

    def __post_init__(self) -> None:
        if not isinstance(self.matrix, np.ndarray) or self.matrix.dtype not in (np.float32, np.float64):
            object.__setattr__(self, "matrix", arrays.reals("the weights", self.matrix))
        if self.matrix.ndim != 2:
            raise InputError("the weights must be a matrix of elements x items", "wrong-shape", found=f"shape {self.matrix.shape}")
        object.__setattr__(self, "matrix", np.ascontiguousarray(self.matrix))  # the same one where it is row-major
        ItemFunction.check(self)

    @property
    def num_elements(self) -> int:
        return int(self.matrix.shape[0])

    @property
    def num_items(self) -> int:
        return int(self.matrix.shape[1])

    def as_item_weights(self) -> ItemWeights:
        return ItemWeights.dense(self.matrix)

    def parts(self) -> tuple[Any, ...]:
        return ("dense facility-location", self.matrix)


@dataclass(frozen=True, eq=False)
class UserFunction(SetFunction):
    """A set function of the user's own, evaluated for many sets at once.

    Parameters
    ----------
    evaluate : callable
        From a boolean array of shape (sets, elements) to the values, shape (sets,).
    num_elements : int
        Size of the ground set.
    monotone, submodular : bool
        What the user declares; guarantees and bounds rest on it and say so. ``check_submodular`` samples it.
    label : str
        What names the function, for the digest of the problem.
    """

    name: ClassVar[str] = "user"
    evaluate: Callable[[Masks], ArrayLike]
    num_elements: int
    monotone: bool = False
    submodular: bool = False
    label: str = "user function"

    def values(self, masks: Masks) -> Floats:
        """Values of the sets given by the rows of ``masks``.

        Raises
        ------
        InputError
            If the function returns anything but one finite number a set.
        """
        returned = self.evaluate(masks)
        try:
            totals = np.asarray(returned, dtype=np.float64)
        except (TypeError, ValueError):
            kind = type(returned).__name__
            raise InputError(f"the set function {self.label} must return numbers", expected=f"({len(masks)},)", found=kind) from None
        if totals.shape != (len(masks),):
            raise InputError(
                f"the set function {self.label} must return one number a set",
                "wrong-shape",
                expected=f"({len(masks)},)",
                found=str(totals.shape),
            )
        if not np.isfinite(totals).all():
            raise InputError(
                f"the set function {self.label} must return finite numbers", "out-of-range", found=str(totals[~np.isfinite(totals)][0])
            )
        return totals

    def parts(self) -> tuple[Any, ...]:
        """Data that the digest covers: the function itself cannot be hashed."""
        return (self.name, self.label, self.num_elements, self.monotone, self.submodular)


def _make_csr(function: Coverage | FacilityLocation) -> None:
    for key in ("indptr", "indices"):
        object.__setattr__(function, key, arrays.indices(key, getattr(function, key)))
