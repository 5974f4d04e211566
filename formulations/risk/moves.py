"""Moves of a graph with risk, and which may follow each other: the graph on which least hazards are shortest ways.

Hazards ``-ln(1 - r)`` add up along a path, and an element that looks at three states is a length between two moves. So least hazards of all
walks that do not turn back on themselves are Dijkstra's on moves as vertices, exact for locale and action elements, a lower bound for
traverse elements. Source: Xiao (2019), algorithm 2 in logarithms; docs/formulations/risky-path.md#search-over-moves.
"""

import math
from collections.abc import Hashable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ...instances.errors import UsageError
from ...instances.number_arrays import Floats as Floats, Integers as Indices, entries_of
from ...instances.risk.element import TraverseElement
from ...instances.risk.risky_graph import RiskyGraph
from ..evidence import Evidence

MOST_PAIRS = 30_000_000
"""Pairs of moves that are written down at most: 24 bytes each, and as much again while they are made."""


class MoveGraph:
    """The moves of ``graph`` and their successors; not ``priced``, every risk counts as none.

    ``first`` and ``second`` are numbers of two moves, the second of which may follow the first, ``hazard`` the least hazard of the second
    after the first, finite, and ``own_hazard`` the part of it that is the same on every path: that of locale and action elements; shape
    (pairs,). ``begin``, ``begin_hazard`` and ``own_begin_hazard`` are those of moves that leave the start, ``start_hazard`` that of the
    start itself.
    """

    def __init__(self, graph: RiskyGraph, priced: bool = True) -> None:
        self.graph, self._priced = graph, priced
        tail, head = graph.tail.astype(np.int64), graph.head.astype(np.int64)
        away = np.nonzero(head != graph.start)[0]  # no path comes back to its start
        at, counts = entries_of(graph.indptr, head[away])
        if len(at) > MOST_PAIRS:
            raise UsageError(
                f"{graph.name} has {len(at)} pairs of moves that follow each other; at most {MOST_PAIRS} are searched", "too-large"
            )
        first, second = np.repeat(away, counts), at
        kept = (head[second] != graph.start) & (head[second] != tail[first])
        first, second = first[kept], second[kept]
        own, hazard = self._hazards(tail[first], tail[second], head[second])
        passable = np.isfinite(hazard)
        self.first, self.second = first[passable], second[passable]
        self.own_hazard, self.hazard = own[passable], hazard[passable]
        begin = np.arange(graph.indptr[graph.start], graph.indptr[graph.start + 1])
        own, hazard = self._hazards(np.full(len(begin), -1), tail[begin], head[begin])
        passable = np.isfinite(hazard)
        self.begin, self.own_begin_hazard, self.begin_hazard = begin[passable], own[passable], hazard[passable]
        self.start_hazard = self._start_hazard()

    def _hazards(self, before: Indices, state: Indices, after: Indices) -> tuple[Floats, Floats]:
        """Hazards of locale and action elements, and the least of all elements."""
        own, more = np.zeros(len(after)), np.zeros(len(after))
        for element in self.graph.elements if self._priced else ():
            with np.errstate(divide="ignore"):
                hazard = -np.log1p(-self.graph.least_risks(element, before, state, after))
            if isinstance(element, TraverseElement):
                more += hazard
            else:
                own += hazard
        return own, own + more

    def _start_hazard(self) -> float:
        if not self._priced:
            return 0.0
        start = self.graph.start
        risks = [e.begin(self.graph, start)[1] for e in self.graph.traverse]
        memoryless = [e for e in self.graph.elements if not isinstance(e, TraverseElement)]
        risks += [float(self.graph.least_risks(e, [-1], [-1], [start])[0]) for e in memoryless]
        return hazard_of(risks)

    def with_any_risk(self) -> "MoveGraph":
        """The same moves without their risks."""
        return MoveGraph(self.graph, priced=False)

    @property
    def num_moves(self) -> int:
        return len(self.graph.tail)

    @cached_property
    def _matrix(self) -> Any:
        """Moves and, last, the start as vertices."""
        import scipy.sparse as sp

        m = self.num_moves
        rows, columns = np.concatenate([self.first, np.full(len(self.begin), m)]), np.concatenate([self.second, self.begin])
        return sp.csr_matrix((np.concatenate([self.hazard, self.begin_hazard]), (rows, columns)), shape=(m + 1, m + 1))

    @cached_property
    def _reach(self) -> Floats:
        from scipy.sparse.csgraph import dijkstra

        return np.asarray(dijkstra(self._matrix, indices=self.num_moves))

    @property
    def to_moves(self) -> Floats:
        """Least hazard of a walk from the start that ends with each move, that of the start included; the start last."""
        return self._reach + self.start_hazard

    def priced(self, prices: Floats) -> Floats:
        """Least hazard of a walk from the start that ends with each move; states cost ``prices`` >= 0 of shape (states,) more."""
        from scipy.sparse.csgraph import dijkstra

        dearer = self._matrix.copy()
        dearer.data = dearer.data + prices[self.graph.head[dearer.indices]]
        return np.asarray(dijkstra(dearer, indices=self.num_moves))[:-1] + self.start_hazard

    def to_states(self) -> Floats:
        """Least hazard of a walk from the start to each state, shape (states,)."""
        least = np.full(self.graph.num_states, math.inf)
        np.minimum.at(least, self.graph.head, self.to_moves[:-1])
        least[self.graph.start] = self.start_hazard
        return least

    def from_moves(self, goals: Sequence[int]) -> Floats:
        """Least hazard from each move to one of ``goals``, shape (moves + 1,), the start last."""
        from scipy.sparse.csgraph import dijkstra

        ends = np.nonzero(np.isin(self.graph.head, list(goals)))[0]
        if self.graph.start in goals:
            ends = np.append(ends, self.num_moves)
        if not len(ends):
            return np.full(self.num_moves + 1, math.inf)
        return np.asarray(dijkstra(self._matrix.T.tocsr(), indices=ends, min_only=True))

    @cached_property
    def successors(self) -> list[tuple[list[int], list[float]]]:
        """Moves that may follow each move, the start last, and their hazards that are the same on every path."""
        m = self.num_moves
        order = np.argsort(self.first, kind="stable")
        ends = np.cumsum(np.bincount(self.first, minlength=m))[:-1]
        rows = zip(np.split(self.second[order], ends), np.split(self.own_hazard[order], ends), strict=True) if m else ()
        followers = [(moves.tolist(), hazards.tolist()) for moves, hazards in rows]
        return [*followers, (self.begin.tolist(), self.own_begin_hazard.tolist())]

    @cached_property
    def _walks(self) -> Indices:
        """Predecessor of each move on a walk of least hazard, of these one of the fewest moves; -9999 for none."""
        import scipy.sparse as sp
        from scipy.sparse.csgraph import breadth_first_order

        m, reach = self.num_moves, self._reach
        entries = self._matrix.tocoo()
        tight = np.isfinite(reach[entries.row]) & (reach[entries.row] + entries.data == reach[entries.col])
        among = sp.csr_matrix((np.ones(int(tight.sum())), (entries.row[tight], entries.col[tight])), shape=(m + 1, m + 1))
        return np.asarray(breadth_first_order(among, m, return_predecessors=True)[1], dtype=np.int64)

    def walk(self, state: int) -> tuple[int, ...] | None:
        """A walk of least hazard to ``state``, of these one of few moves; None where there is none."""
        if state == self.graph.start:
            return (state,)
        into = np.nonzero(self.graph.head == state)[0]
        into = into[np.isfinite(self._reach[into])]
        if not len(into):
            return None
        best = into[self._reach[into] == self._reach[into].min()]
        return min((self._walk_of(int(move)) for move in best), key=len)

    def _walk_of(self, move: int) -> tuple[int, ...]:
        states = []
        while move != self.num_moves:
            states.append(int(self.graph.head[move]))
            move = int(self._walks[move])
        return (self.graph.start, *reversed(states))

    def evidence(self, value: float) -> Evidence:
        """Evidence ``move-potentials``: least hazards to the moves."""
        potentials = [None if math.isinf(p) else p for p in self.to_moves[:-1].tolist()]
        return Evidence("move-potentials", "least hazards of walks", value, {"potentials": potentials})


class Memories:
    """Memories of all traverse elements along paths, by number: equal memories and repeated moves are worked out once."""

    def __init__(self, graph: RiskyGraph) -> None:
        self.graph, self.elements = graph, graph.traverse
        self._numbers: dict[tuple[Hashable, ...], int] = {}
        self._known: list[tuple[Hashable, ...]] = []
        self._steps: dict[tuple[int, int, int], tuple[int, float]] = {}
        self._orders: dict[tuple[int, int], bool] = {}
        self.begin = self._number(tuple(element.begin(graph, graph.start)[0] for element in self.elements))

    def step(self, memory: int, state: int, after: int) -> tuple[int, float]:
        """Number of the memory after a move, and the hazard of the move."""
        key = memory, state, after
        if key not in self._steps:
            moved = [e.step(self.graph, m, state, after) for e, m in zip(self.elements, self._known[memory], strict=True)]
            self._steps[key] = self._number(tuple(m for m, _ in moved)), hazard_of([r for _, r in moved])
        return self._steps[key]

    def no_worse(self, memory: int, other: int) -> bool:
        """True if all that may follow is at most as risky with ``memory`` as with ``other``."""
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


def hazard_of(risks: Sequence[float]) -> float:
    """``-ln prod (1 - r)``; infinite where a risk is 1."""
    return math.inf if any(r >= 1.0 for r in risks) else math.fsum(-math.log1p(-r) for r in risks)
