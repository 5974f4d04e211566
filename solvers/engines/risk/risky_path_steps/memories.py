"""What traverse elements remember of a path, by number: equal memories and repeated moves are worked out once."""

from __future__ import annotations

import math
from collections.abc import Hashable

from .....formulations.risk.risky_path import RiskyPath


class Memories:
    """The memories of all traverse elements of a problem together.

    Parameters
    ----------
    problem : RiskyPath
    """

    def __init__(self, problem: RiskyPath) -> None:
        self.graph = problem.graph
        self.elements = self.graph.traverse
        self._numbers: dict[tuple[Hashable, ...], int] = {}
        self._known: list[tuple[Hashable, ...]] = []
        self._steps: dict[tuple[int, int, int], tuple[int, float]] = {}
        self._orders: dict[tuple[int, int], bool] = {}
        first = [element.begin(self.graph, self.graph.start) for element in self.elements]
        self.begin = self._number(tuple(memory for memory, _ in first))

    def step(self, memory: int, state: int, after: int) -> tuple[int, float]:
        """Number of the memory after a move, and the hazard of the move."""
        key = memory, state, after
        if key not in self._steps:
            moved = [e.step(self.graph, m, state, after) for e, m in zip(self.elements, self._known[memory], strict=True)]
            hazard = math.inf if any(r >= 1.0 for _, r in moved) else math.fsum(-math.log1p(-r) for _, r in moved)
            self._steps[key] = self._number(tuple(m for m, _ in moved)), hazard
        return self._steps[key]

    def no_worse(self, memory: int, other: int) -> bool:
        """Whether whatever follows is at most as risky with ``memory`` as with ``other``."""
        if memory == other:
            return True
        key = memory, other
        if key not in self._orders:
            pairs = zip(self.elements, self._known[memory], self._known[other], strict=True)
            self._orders[key] = all(e.no_worse(a, b) for e, a, b in pairs)
        return self._orders[key]

    def _number(self, memory: tuple[Hashable, ...]) -> int:
        if memory not in self._numbers:
            self._numbers[memory] = len(self._known)
            self._known.append(memory)
        return self._numbers[memory]
