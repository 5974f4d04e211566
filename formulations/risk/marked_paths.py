"""Paths without repetition that have a mark: a reward and no risk, or some risk at all.

Labels of moves carry the memories of traverse elements. Repetition is forbidden only where it pays: where a walk comes to a state twice,
that state is guarded, and the search begins again (Righini and Salani 2008), so that the first walk without repetition is a path, and that
there is none is known.
"""

from __future__ import annotations

import math
import operator
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ..stop import NEVER, Stop
from .moves import Memories

if TYPE_CHECKING:
    from .risky_path import Path, RiskyPath

MOST_LABELS = 200_000
"""Labels that are grown at most before a problem is taken for one that cannot be decided."""

LOOK = 256
"""Labels between two looks at the clock."""


class CutShortError(Exception):
    """The search had to end before it knew: the reason as ``Stop.reached`` gives it, or ``iterations``."""


def free_reward(problem: RiskyPath, most: int = MOST_LABELS) -> Path | None:
    """A path that may end where it does with a reward and without any risk; None where there is none.

    Raises CutShortError if more than ``most`` labels would have to be grown to know.
    """
    graph, moves, rewards = problem.graph, problem.moves, problem.rewards.tolist()
    if moves.start_hazard > 0.0:
        return None
    if rewards[graph.start] > 0.0 and (not graph.goals or graph.start in graph.goals):
        return (graph.start,)

    def marked(mark: bool, state: int, hazard: float) -> bool | None:
        return None if hazard > 0.0 else rewards[state] > 0.0 or (mark and graph.discount > 0.0)

    search = _Search(problem, marked, lambda hazard: hazard == 0.0, NEVER, most)
    search.covers = search.memories.no_worse
    return search.path(False)


def risky_path(problem: RiskyPath, stop: Stop = NEVER, most: int | None = None) -> Path | None:
    """A path that may end where it does, at a risk between 0 and 1, both excluded; None where there is none.

    Raises CutShortError if ``stop``, or ``most`` labels, ended the search before.
    """
    graph, moves = problem.graph, problem.moves
    if moves.start_hazard == math.inf:
        return None
    if moves.start_hazard > 0.0 and (not graph.goals or graph.start in graph.goals):
        return (graph.start,)

    def marked(mark: bool, state: int, hazard: float) -> bool | None:
        return None if hazard == math.inf else mark or hazard > 0.0

    search = _Search(problem, marked, lambda hazard: hazard < math.inf, stop, most)
    search.guard_all = bool(graph.traverse)  # memories seldom are the same
    return search.path(moves.start_hazard > 0.0)


class _Search:
    """Breadth-first search for a marked walk to an end.

    ``marked`` gives the mark at the next state from a label's mark, that state and the hazard of the move to it; None where there is no
    way on. ``passable`` says of the least hazard from a move to an end whether the walk may go on, ``covers`` whether whatever is worth
    while with the second of two memories is so with the first, ``guard_all`` whether no state may be repeated from the outset.
    """

    def __init__(
        self, problem: RiskyPath, marked: Callable[[bool, int, float], bool | None], passable: Callable[[float], bool], stop: Stop,
        most: int | None,
    ) -> None:  # fmt: skip
        self.graph, self.moves, self.marked, self.memories = problem.graph, problem.moves, marked, Memories(problem.graph)
        self.head, self.ends = problem.graph.head.tolist(), frozenset(problem.graph.goals)
        to_end = self.moves.from_moves(problem.graph.goals).tolist() if self.ends else [0.0] * (self.moves.num_moves + 1)
        self.open = [passable(hazard) for hazard in to_end]
        self.stop, self.most, self.grown, self.guard_all = stop, most, 0, False
        self.covers: Callable[[int, int], bool] = operator.eq

    def path(self, mark: bool) -> Path | None:
        """The first walk that comes to no state twice; ``mark`` is the start's."""
        guarded = frozenset(range(self.graph.num_states)) if self.guard_all else frozenset()
        while True:
            walk = self._walk(mark, {state: 1 << k for k, state in enumerate(sorted(guarded))})
            twice = frozenset() if walk is None else frozenset(state for state in walk if walk.count(state) > 1)
            if not twice:
                return walk
            guarded |= twice

    def _walk(self, mark: bool, bit: dict[int, int]) -> Path | None:
        """A walk of the fewest moves that comes to none of the guarded states twice."""
        graph, memories = self.graph, self.memories
        # move, state, memory, mark, guarded states behind, label before, moves
        ahead: deque[tuple[Any, ...]] = deque([(len(self.head), graph.start, memories.begin, mark, 0, None, 0)])
        settled: dict[int, list[tuple[int, bool, int]]] = {}
        while ahead:
            label = ahead.popleft()
            move, state, memory, mark, behind, before, count = label
            if before is not None and mark and (not self.ends or state in self.ends):
                return _states(label)
            if count == graph.num_states - 1:  # a longer one repeats a state, whatever its memories
                continue
            others = settled.setdefault(move, [])
            if any(other >= mark and not b & ~behind and self.covers(m, memory) for m, other, b in others):
                continue
            others.append((memory, mark, behind))
            self.grown += 1
            if self.grown % LOOK == 0 and (limit := self.stop.reached()):
                raise CutShortError(limit)
            if self.most is not None and self.grown > self.most:
                raise CutShortError("iterations")
            for after, own in zip(*self.moves.successors[move], strict=True):
                reached = self.head[after]
                if behind & bit.get(reached, 0) or not self.open[after]:
                    continue
                carried, more = memories.step(memory, state, reached)
                then = self.marked(mark, reached, own + more)
                if then is not None:
                    ahead.append((after, reached, carried, then, behind | bit.get(reached, 0), label, count + 1))
        return None


def _states(label: tuple[Any, ...] | None) -> Path:
    states: list[int] = []
    while label is not None:
        states.append(label[1])
        label = label[5]
    return tuple(reversed(states))
