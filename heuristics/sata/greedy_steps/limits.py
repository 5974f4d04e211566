"""Cardinality limits and partition matroids as one thing: groups, and room in each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....formulations.problem import Problem
from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.feasibility import Openings
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....instances.errors import UsageError

FUNCTIONS = frozenset({"function:coverage", "function:facility-location"})
ANY_FUNCTION = FUNCTIONS | {"function:user"}
GROUPED = frozenset({"constraint:cardinality", "constraint:partition"})
FORMULATED = GROUPED | {"constraint:knapsack", "constraint:rows"}
ASKED = frozenset({"constraint:rows", "constraint:user"})
"""Constraints of others, which are asked what may still be chosen."""
ANY_CONSTRAINT = FORMULATED | ASKED


@dataclass(frozen=True, eq=False)
class Limits:
    """At most ``room[g]`` elements of group g, out of no more than it has; a cardinality limit is one group."""

    groups: NDArray[np.int32]
    room: NDArray[np.int64]

    @classmethod
    def of(cls, problem: SubmodularSelection | BottleneckSATA) -> "Limits":
        """The limits of a problem whose constraint is a partition; raises TypeError for another."""
        limits = cls.if_any(problem)
        if limits is None:
            raise TypeError(f"the constraint {problem.constraint.name} is no limit for each group")
        return limits

    @classmethod
    def if_any(cls, problem: SubmodularSelection | BottleneckSATA) -> "Limits | None":
        """The limits, or None where the constraint is no partition."""
        partition = problem.constraint.as_partition(problem.num_elements)
        if partition is None:
            return None
        sizes = np.bincount(partition.groups, minlength=len(partition.limits))
        return cls(np.array(partition.groups, np.int32), np.minimum(partition.limits, sizes).astype(np.int64))

    @property
    def most(self) -> int:
        """Elements of a set that is full."""
        return int(self.room.sum())

    def members(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """``(starts, elements)``: the elements of group g are ``elements[starts[g]:starts[g + 1]]``, in ascending order."""
        starts = np.zeros(len(self.room) + 1, np.int64)
        np.cumsum(np.bincount(self.groups, minlength=len(self.room)), out=starts[1:])
        return starts, np.argsort(self.groups, kind="stable")

    def first(self, order: NDArray[np.int64]) -> NDArray[np.int64]:
        """The elements that come first in ``order``, as many of each group as it has room for, in that order."""
        by_group = np.argsort(self.groups[order], kind="stable")
        member = self.groups[order][by_group]
        place = np.arange(len(order)) - np.searchsorted(member, member)
        return order[np.sort(by_group[place < self.room[member]])]

    def without(self, chosen: Sequence[int]) -> NDArray[np.int64]:
        """Room that is left beside ``chosen``; raises UsageError where they do not fit."""
        spare = self.room - np.bincount(self.groups[list(chosen)], minlength=len(self.room))
        if (spare < 0).any():
            raise UsageError("the elements of base break the constraint already")
        return spare

    def plain_evaluations(self, picks: Sequence[int], base: Sequence[int] = ()) -> int:
        """Gains that a plain greedy evaluates on the way to ``picks``: in each round those of all elements that could be taken."""
        spare = self.without(base)
        free = np.bincount(self.groups, minlength=len(self.room)) - np.bincount(self.groups[list(base)], minlength=len(self.room))
        open_ = int(free[spare > 0].sum())
        total = 0
        for e in picks:
            total += open_
            g = self.groups[e]
            spare[g] -= 1
            free[g] -= 1
            open_ -= 1 + (int(free[g]) if spare[g] == 0 else 0)
        return total


def first_allowed(problem: SubmodularSelection | BottleneckSATA, order: NDArray[np.int64]) -> list[int]:
    """The elements of ``order``, one after the other, that the constraint still allows."""
    limits = Limits.if_any(problem)
    if limits is not None:
        return [int(e) for e in limits.first(order)]
    return Openings(problem.constraint, problem.num_elements).take_in_order(order.tolist())


def not_whole(problem: Problem) -> frozenset[str]:
    """The reason why a heuristic for whole actions cannot take a max-min problem, if it is another than the bottleneck."""
    return frozenset({f"{problem.problem} problems"}) if problem.family == "max-min" and problem.problem != "bottleneck" else frozenset()


def chosen_elements(what: str, elements: object, problem: SubmodularSelection) -> list[int]:
    """Different element numbers from 0, from a list of them or a text of names separated by commas; raises UsageError for anything else."""
    size = problem.num_elements
    if isinstance(elements, str):
        number = {problem.element_name(e): e for e in range(size)}
        numbers = [number.get(part.strip(), -1) for part in elements.split(",") if part.strip()]
    else:
        numbers = list(elements) if isinstance(elements, Sequence | np.ndarray) and not isinstance(elements, bytes) else [-1]
    known = all(isinstance(e, int | np.integer) and not isinstance(e, bool) and 0 <= e < size for e in numbers)
    if not known or len(set(numbers)) < len(numbers):
        raise UsageError(
            f"{what} must be a list of different element numbers from 0 to {size - 1}, or of names, not {str(elements)[:80]!r}", "malformed"
        )
    return [int(e) for e in numbers]
