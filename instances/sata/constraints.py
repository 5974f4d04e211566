"""Constraints on sets of elements, as data."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from .set_functions import Floats, Indices, Masks

Elements = NDArray[np.integer[Any]]
Excess = tuple[Floats, Callable[[int], str]]


@dataclass(frozen=True, eq=False)
class LimitRows:
    """Rows ``sum of coefficients of the chosen elements <= limit``, coefficients >= 0.

    Parameters
    ----------
    name : str
        Of the rows in programs.
    row, element, coefficient : arrays of shape (entries,)
        No element twice in a row.
    limit : array of shape (rows,)
    label : callable, optional
        Name of each row; without it there is one row, called ``name``.
    """

    name: str
    row: Elements
    element: Elements
    coefficient: Floats
    limit: Floats
    label: Callable[[int], str] | None = None

    def check(self, elements: int) -> None:
        """Raise InputError unless they are what is said above, for that many elements: every bound rests on it."""
        if not len(self.row) == len(self.element) == len(self.coefficient):
            lengths = f"{len(self.row)}, {len(self.element)} and {len(self.coefficient)}"
            raise InputError(
                f"each entry of the rows {self.name} must have a row, an element and a coefficient", "wrong-shape", found=lengths
            )
        arrays.refuse_outside(f"the row of entry {{}} of {self.name}", self.row, len(self.limit), "row")
        arrays.refuse_outside(f"the element of entry {{}} of {self.name}", self.element, elements, "element")
        arrays.refuse_negative(f"the coefficient of entry {{}} of {self.name}", self.coefficient)
        arrays.refuse_negative(f"the limit of row {{}} of {self.name}", self.limit)
        if len(np.unique(self.row.astype(np.int64) * elements + self.element)) < len(self.row):
            raise InputError(f"an element stands twice in a row of {self.name}", "duplicate")

    def label_of(self, row: int) -> str:
        return self.name if self.label is None else f"{self.name} {self.label(row)}"

    def budgets(self, elements: int) -> Iterator[tuple[Floats, float]]:
        """Coefficients of all elements, and the limit, row after row."""
        order = np.argsort(self.row, kind="stable")
        ends = np.searchsorted(self.row[order], np.arange(len(self.limit) + 1))
        for a, b, limit in zip(ends, ends[1:], self.limit.tolist(), strict=False):
            costs = np.zeros(elements)
            costs[self.element[order[a:b]]] = self.coefficient[order[a:b]]
            yield costs, limit

    def totals(self, masks: Masks) -> Floats:
        """Left-hand sides for the sets in the rows of ``masks``, shape (sets, rows)."""
        import scipy.sparse as sp

        matrix = sp.csr_matrix((self.coefficient, (self.row, self.element)), shape=(len(self.limit), masks.shape[1]))
        return np.asarray((matrix @ masks.T.astype(np.float64)).T)


class Constraint(ABC):
    """A rule that says which sets may be chosen; every subset of an allowed set is allowed.

    ``name``, ``parts`` and ``allows`` are all that a subclass needs: greedy methods, random choices and brute force then ask it.

    Attributes
    ----------
    name : str
    kind : str
        Its name in waybound's JSON; empty if it cannot be written there.
    feature : str
        What a method must be able to take: by default a constraint that is known by what it allows only.
    matroid : str
        Which matroid it is, if it is one: ratios of greedy methods rest on that.
    """

    name: ClassVar[str]
    kind: ClassVar[str] = ""
    feature: ClassVar[str] = "constraint:user"
    matroid: ClassVar[str] = ""

    @abstractmethod
    def parts(self) -> tuple[Any, ...]:
        """Data that the digest covers."""

    @abstractmethod
    def allows(self, masks: Masks) -> NDArray[np.bool_]:
        """Mask of the allowed sets among the rows of ``masks``, shape (sets,)."""

    def check(self, elements: int) -> None:  # noqa: B027
        """Raise InputError unless it fits a ground set of that many elements."""

    def rows(self, elements: int) -> LimitRows | None:
        """The constraint as rows, where it is that."""
        return None

    def as_partition(self, elements: int) -> PartitionMatroid | None:
        """The constraint as a limit for each group of elements, where it is that."""
        return None

    def as_knapsack(self) -> Knapsack | None:
        """The constraint as one budget, where it is that."""
        return None

    def excess(self, chosen: Elements, elements: int) -> Excess:
        """Excess of ``chosen``, none twice, over each limit, and the k-th fault in words; the judge of answers reads it."""
        mask = np.zeros((1, elements), dtype=bool)
        mask[0, chosen] = True
        return (~self.allows(mask)).astype(np.float64), lambda _: f"the chosen elements are not allowed together: {self.name}"

    def facts(self) -> dict[str, Any]:
        """Facts about the constraint as plain JSON values."""
        return {"kind": self.name}


class LinearConstraint(Constraint):
    """Rows of limits. A subclass needs ``name``, ``parts`` and ``rows``, and gets forms and bounds beside what every constraint has."""

    feature: ClassVar[str] = "constraint:rows"

    @abstractmethod
    def rows(self, elements: int) -> LimitRows: ...

    def check(self, elements: int) -> None:
        self.rows(elements).check(elements)

    def allows(self, masks: Masks) -> NDArray[np.bool_]:
        """Whether each set keeps the constraint exactly; ``formulations.sata.feasibility`` allows for the rounding of sums."""
        rows = self.rows(masks.shape[1])
        return np.asarray((rows.totals(masks) <= rows.limit).all(axis=1))

    def excess(self, chosen: Elements, elements: int) -> Excess:
        """One number per row."""
        mask = np.zeros((1, elements), dtype=bool)
        mask[0, chosen] = True
        rows = self.rows(elements)
        total = rows.totals(mask)[0]
        return total - rows.limit, lambda k: f"{rows.label_of(k)}: {total[k]:.12g} where at most {rows.limit[k]:.12g} is allowed"


@dataclass(frozen=True)
class Cardinality(LinearConstraint):
    """A number of elements at most.

    Parameters
    ----------
    limit : int
        At least 1.
    """

    name: ClassVar[str] = "cardinality"
    kind: ClassVar[str] = "cardinality"
    feature: ClassVar[str] = "constraint:cardinality"
    matroid: ClassVar[str] = "uniform"
    limit: int

    def __post_init__(self) -> None:
        if isinstance(self.limit, bool) or not isinstance(self.limit, int | np.integer) or self.limit < 1:
            raise InputError(
                "the number of elements to choose must be a whole number of at least 1", "out-of-range", found=repr(self.limit)[:40]
            )
        object.__setattr__(self, "limit", int(self.limit))

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.limit)

    def rows(self, elements: int) -> LimitRows:
        return LimitRows(self.name, np.zeros(elements, np.int64), np.arange(elements), np.ones(elements), np.array([float(self.limit)]))

    def as_partition(self, elements: int) -> PartitionMatroid:
        return PartitionMatroid(np.zeros(elements, np.int32), np.array([min(self.limit, arrays.LARGEST_NUMBER)], np.int32))

    def excess(self, chosen: Elements, elements: int) -> Excess:
        message = f"{len(chosen)} elements are chosen, at most {self.limit} are allowed"
        return np.array([float(len(chosen) - self.limit)]), lambda _: message

    def facts(self) -> dict[str, Any]:
        return {"kind": self.name, "limit": self.limit}


@dataclass(frozen=True, eq=False)
class PartitionMatroid(LinearConstraint):
    """At most ``limits[g]`` elements of group g.

    Parameters
    ----------
    groups : array of shape (elements,)
        Group of each element, from 0.
    limits : array of shape (groups,)
        Whole numbers >= 0.
    thing : str
        What a group is called: group, robot.
    label : callable, optional
        Name of each group; by default "1", "2", ...
    """

    name: ClassVar[str] = "partition"
    kind: ClassVar[str] = "partition"
    feature: ClassVar[str] = "constraint:partition"
    matroid: ClassVar[str] = "partition"
    groups: Indices
    limits: Indices
    thing: str = "group"
    label: Callable[[int], str] | None = None

    @classmethod
    def of(cls, groups: ArrayLike, limits: ArrayLike = 1) -> PartitionMatroid:
        """A partition matroid from any arrays; one limit for all groups, or one each.

        Parameters
        ----------
        groups : array-like of int, shape (elements,)
            The group of each element, from 0.
        limits : int or array-like of int, shape (groups,)
            Most elements of a group.
        """
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
            raise InputError(f"the limit of group {k} must not be negative", "out-of-range", found=str(self.limits[k]))

    def __repr__(self) -> str:
        return f"<PartitionMatroid: {len(self.groups)} elements in {len(self.limits)} groups>"

    def group_label(self, group: int) -> str:
        return str(group + 1) if self.label is None else self.label(group)

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.groups, self.limits)

    def check(self, elements: int) -> None:
        _one_each("groups", self.groups, elements)

    def rows(self, elements: int) -> LimitRows:
        return LimitRows(self.thing, self.groups, np.arange(elements), np.ones(elements), self.limits.astype(np.float64), self.group_label)

    def as_partition(self, elements: int) -> PartitionMatroid:
        return self

    def excess(self, chosen: Elements, elements: int) -> Excess:
        used, counts = np.unique(self.groups[chosen], return_counts=True)
        return counts.astype(np.float64) - self.limits[
            used
        ], lambda k: f"{counts[k]} elements of {self.thing} {self.group_label(int(used[k]))} are chosen, {self.limits[used[k]]} allowed"

    def facts(self) -> dict[str, Any]:
        rank = np.minimum(np.bincount(self.groups, minlength=len(self.limits)), self.limits).sum()
        return {"kind": self.name, "groups": len(self.limits), "limits": sorted(set(self.limits.tolist())), "rank": int(rank)}


@dataclass(frozen=True, eq=False)
class Knapsack(LinearConstraint):
    """Costs of the chosen elements sum to at most ``budget``.

    Parameters
    ----------
    costs : array of shape (elements,), >= 0
        One an element, in any unit.
    budget : float, >= 0
        In the unit of the costs.
    """

    name: ClassVar[str] = "knapsack"
    kind: ClassVar[str] = "knapsack"
    feature: ClassVar[str] = "constraint:knapsack"
    costs: Floats
    budget: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "costs", np.atleast_1d(arrays.reals("costs", self.costs)))
        arrays.refuse_negative("the cost of element {}", self.costs)
        budget = arrays.reals("budget", self.budget)
        if budget.ndim or not 0 <= float(budget) < math.inf:
            raise InputError("the budget must be a finite number, not negative", "out-of-range", found=repr(self.budget)[:40])
        object.__setattr__(self, "budget", float(budget))

    def __repr__(self) -> str:
        return f"<Knapsack: {len(self.costs)} elements, budget {self.budget:g}>"

    def parts(self) -> tuple[Any, ...]:
        return (self.name, self.costs, self.budget)

    def check(self, elements: int) -> None:
        _one_each("costs", self.costs, elements)

    def rows(self, elements: int) -> LimitRows:
        paid = np.nonzero(self.costs)[0]
        return LimitRows("budget", np.zeros(len(paid), np.int64), paid, self.costs[paid], np.array([self.budget]))

    def as_knapsack(self) -> Knapsack:
        return self

    def excess(self, chosen: Elements, elements: int) -> Excess:
        cost = math.fsum(self.costs[chosen])
        message = f"the chosen elements cost {cost:.12g}, the budget is {self.budget:.12g}"
        return np.array([cost - self.budget]), lambda _: message

    def facts(self) -> dict[str, Any]:
        return {"kind": self.name, "budget": self.budget, "cost": float(self.costs.sum())}


def _one_each(what: str, values: NDArray[Any], elements: int) -> None:
    if len(values) != elements:
        raise InputError(f"{what} must have one entry an element", "wrong-shape", expected=str(elements), found=str(len(values)))
