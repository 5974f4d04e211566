"""Answers of selection and assignment problems: chosen elements, in the order in which they were chosen."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ..instances.errors import UsageError


@dataclass(frozen=True)
class Selection:
    """Chosen elements (actions of robots, sets, waypoints), numbered from 0.

    Parameters
    ----------
    elements : tuple of int
        In the order in which they were chosen; the value does not depend on it.
    winners : tuple of int, optional
        Winner takes all: the robot that is credited with each target, -1 for nobody. Without it, the best credit is meant.
    """

    elements: tuple[int, ...] = ()
    winners: tuple[int, ...] | None = None

    @classmethod
    def of(cls, elements: Iterable[int], winners: Iterable[int] | None = None) -> Selection:
        """From any whole numbers."""
        try:
            chosen = tuple(int(e) for e in elements)
            credited = None if winners is None else tuple(int(w) for w in winners)
        except (TypeError, ValueError):
            raise UsageError(f"a selection is a list of element numbers, not {elements!r}") from None
        return cls(chosen, credited)

    def __iter__(self) -> Iterator[int]:
        return iter(self.elements)

    def __len__(self) -> int:
        return len(self.elements)
