"""The sets that a constraint allows, within what a check lets pass for the rounding of sums, and the elements that may still join a set."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...instances.number_arrays import Flags as Masks, Floats
from ...instances.sata.constraints import Constraint, LimitRows
from ..tolerance import room

CHUNK = 1 << 24
"""Bytes of masks that are made at once."""


def spendable(rows: LimitRows) -> Floats:
    """The most that may be chosen of each row: its limit, and what a check lets pass beyond it, so that three costs of 0.1 fit into 0.3."""
    if (rows.coefficient == 1.0).all() and (np.floor(rows.limit) == rows.limit).all():
        return rows.limit
    return np.array([room(costs, limit) for costs, limit in rows.budgets(int(rows.element.max(initial=-1)) + 1)])


def in_budgets(costs: Floats, budget: float) -> tuple[Floats, float]:
    """Costs and budget times the power of two that brings the budget below 1, so that no gain per cost overflows for its unit."""
    exponent = int(np.frexp(budget)[1])
    with np.errstate(over="ignore"):
        return np.ldexp(costs, -exponent), float(np.ldexp(budget, -exponent))


def allowed(constraint: Constraint, masks: Masks) -> Masks:
    """True for each of the sets given by the rows of ``masks`` that passes the check, shape (sets,)."""
    rows = constraint.rows(masks.shape[1])
    return constraint.allows(masks) if rows is None else np.asarray((rows.totals(masks) <= spendable(rows)).all(axis=1))


def with_each(inside: Masks, elements: NDArray[np.integer[Any]]) -> Iterator[tuple[slice, Masks]]:
    """Masks of the set ``inside`` with one of ``elements`` added to each, a part of them at a time, and where this part stands."""
    step = max(1, CHUNK // max(1, len(inside)))
    for first in range(0, len(elements), step):
        some = elements[first : first + step]
        masks = np.repeat(inside[None, :], len(some), axis=0)
        masks[np.arange(len(some)), some] = True
        yield slice(first, first + len(some)), masks


class Openings:
    """The elements that may still join a set that grows, out of ``elements`` in all."""

    def __init__(self, constraint: Constraint, elements: int) -> None:
        self.inside = np.zeros(elements, dtype=bool)
        self._constraint, rows = constraint, constraint.rows(elements)
        self._linear = rows is not None
        if rows is not None:
            self._left = spendable(rows).copy()
            order = np.argsort(rows.element, kind="stable")
            self._element, self._row, self._coefficient = rows.element[order], rows.row[order], rows.coefficient[order]
            self._starts = np.searchsorted(self._element, np.arange(elements + 1))

    def open(self) -> NDArray[np.int64]:
        """The elements outside of the set that may join it, ascending."""
        fits = ~self.inside
        if self._linear:
            fits[self._element[self._coefficient > self._left[self._row]]] = False
        else:
            outside = np.nonzero(fits)[0]
            for part, masks in with_each(self.inside, outside):
                fits[outside[part]] = self._constraint.allows(masks)
        return np.nonzero(fits)[0]

    def fits(self, element: int) -> bool:
        """True if ``element``, which is outside, may join."""
        if self._linear:
            return all(self._coefficient[k] <= self._left[self._row[k]] for k in self._entries(element))
        return all(bool(self._constraint.allows(mask)[0]) for _, mask in with_each(self.inside, np.array([element])))

    def take(self, element: int) -> None:
        """Let ``element`` join."""
        self.inside[element] = True
        if self._linear:
            for k in self._entries(element):
                self._left[self._row[k]] -= self._coefficient[k]

    def take_in_order(self, order: Iterable[int]) -> list[int]:
        """The elements of ``order``, one after the other, that may still join."""
        taken = []
        for element in order:
            if self.fits(element):
                self.take(element)
                taken.append(element)
        return taken

    def _entries(self, element: int) -> range:
        return range(self._starts[element], self._starts[element + 1])
