"""Evidence ``guarded-walks``: the least hazard of walks that come to some states once at most, found again by the checker.

Paths without repetition are such walks, whatever states are guarded. What traverse elements remember of a walk is kept beside its last
move, so that their risks count in full.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ....instances.risk.element import TraverseElement
from ...evidence import CHECKERS
from ...stop import current_stop
from .following_moves import FollowingMoves, following_moves

if TYPE_CHECKING:
    from ..risky_path import RiskyPath

MOST_WALKS = 300_000
"""Walks that are kept."""

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("guarded-walks")
def check_guarded_walks(problem: RiskyPath, data: Mapping[str, Any]) -> float:
    """The least risk or hazard of walks to a goal that come to no state of ``guarded`` twice, or ``most``, a hazard, if that is less.

    ``guarded`` lists states, ``most`` is a number or null. Nothing is proved for rewards, nor where there are too many walks.
    """
    if problem.family != "risky-path":
        raise InputError("walks are evidence for risky paths", found=problem.family)
    graph = problem.graph
    guarded = [int(state) for state in data["guarded"]]
    if not all(0 <= state < graph.num_states for state in guarded):
        raise InputError("evidence guards a state that does not exist", expected=f"0 to {graph.num_states - 1}")
    most = math.inf if data["most"] is None else float(data["most"])
    if math.isnan(most):
        raise InputError("most must be a number or null")
    if problem.sense != "min":
        return math.inf
    memoryless = tuple(e for e in graph.elements if not isinstance(e, TraverseElement))
    own, whole = following_moves(graph, memoryless), following_moves(graph)
    found = None if own is None or whole is None else _least(problem, own, least_left(problem, whole), frozenset(guarded), most)
    if found is None:
        return -math.inf
    low = max(0.0, found * (1.0 - 16.0 * _EPS * (graph.num_states + 4)))
    return low if problem.objective == "hazard" or low == math.inf else -math.expm1(-low) * (1.0 - 4.0 * _EPS)


def least_left(problem: RiskyPath, pairs: FollowingMoves) -> NDArray[np.float64]:
    """Least hazard from each move to a goal, whatever came before; 0 without goals."""
    goals = list(problem.graph.goals)
    if not goals:
        return np.zeros(len(problem.graph.tail))
    left = np.where(np.isin(problem.graph.head, goals), 0.0, math.inf)
    inner = pairs.earlier >= 0
    earlier, later, hazard = pairs.earlier[inner], pairs.later[inner], pairs.hazard[inner]
    for _ in range(len(left)):
        before = left.copy()
        np.minimum.at(left, earlier, hazard + before[later])
        if (left == before).all():
            break
    return left * (1.0 - 1e-12)


class Remembered:
    """Memories of all traverse elements along walks; steps that were made before are looked up."""

    def __init__(self, problem: RiskyPath) -> None:
        self._graph, self._elements = problem.graph, problem.graph.traverse
        self._made: dict[tuple[Any, int, int], tuple[tuple[Any, ...], float]] = {}
        begun = [e.begin(self._graph, self._graph.start) for e in self._elements]
        self.begin, self.start_hazard = tuple(memory for memory, _ in begun), _hazard([risk for _, risk in begun])

    def step(self, memories: tuple[Any, ...], state: int, after: int) -> tuple[tuple[Any, ...], float]:
        """Memories and hazard after a move."""
        if not self._elements:
            return memories, 0.0
        key = memories, state, after
        if key not in self._made:
            stepped = [e.step(self._graph, memory, state, after) for e, memory in zip(self._elements, memories, strict=True)]
            self._made[key] = tuple(memory for memory, _ in stepped), _hazard([risk for _, risk in stepped])
        return self._made[key]


def _hazard(risks: list[float]) -> float:
    return math.inf if any(r >= 1.0 for r in risks) else math.fsum(-math.log1p(-r) for r in risks)


def _least(problem: RiskyPath, own: FollowingMoves, left: NDArray[np.float64], guarded: frozenset[int], most: float) -> float | None:
    graph, remembered, stop = problem.graph, Remembered(problem), current_stop()
    head, goals, to_goal = graph.head.tolist(), set(graph.goals), left.tolist()
    after: dict[int, list[tuple[int, float]]] = {}
    for earlier, later, hazard in zip(own.earlier.tolist(), own.later.tolist(), own.hazard.tolist(), strict=True):
        after.setdefault(earlier, []).append((later, hazard))
    start = own.start_hazard + remembered.start_hazard
    if graph.start in goals:
        return min(start, most)
    # hazard with what is left, number, hazard, last move, memories, guarded states behind
    ahead: list[tuple[float, int, float, int, tuple[Any, ...], frozenset[int]]] = [(start, 0, start, -1, remembered.begin, frozenset())]
    kept: dict[tuple[int, tuple[Any, ...]], list[tuple[float, frozenset[int]]]] = {}
    number = walks = 0
    while ahead:
        least, _, hazard, move, memories, behind = heapq.heappop(ahead)
        if least >= most:
            return most
        if move >= 0 and head[move] in goals:
            return min(hazard, most)
        others = kept.setdefault((move, memories), [])
        if any(h <= hazard and b <= behind for h, b in others):
            continue
        others.append((hazard, behind))
        walks += 1
        if walks > MOST_WALKS or (walks % 512 == 0 and stop.reached()):
            return None
        here = graph.start if move < 0 else head[move]
        for later, more in after.get(move, ()):
            state = head[later]
            if state in behind:
                continue
            then, extra = remembered.step(memories, here, state)
            total = hazard + more + extra
            if total + to_goal[later] < math.inf:
                number += 1
                marked = behind | {state} if state in guarded else behind
                heapq.heappush(ahead, (max(least, total + to_goal[later]), number, total, later, then, marked))
    return most
