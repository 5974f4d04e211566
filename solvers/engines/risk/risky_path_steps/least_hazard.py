"""Least hazards by labels that carry what a path has done, exact for traverse elements and for paths without repetition.

Labels grow in the order of their hazard plus the least that is left to a goal. One is dominated by another that ends with the same move at
no more hazard, with memories that are no worse, and with none but the same states behind it that must not be repeated. These are few: a
search begins with none, and where the walk that it finds comes to a state twice, that state joins them and the search begins again, so
that the first walk without repetition is a best path. Sources: Xiao (2019), section 4.2.2.1, for labels of moves; Righini and Salani (2008)
for states added as they are needed; docs/formulations/risky-path.md#labels-with-memory.
"""

import heapq
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from .....formulations.evidence import Evidence
from .....formulations.risk.moves import Memories
from .....formulations.risk.risky_path import Path, RiskyPath
from .....formulations.stop import Stop

LOOK = 256
"""Labels between two looks at the clock."""


@dataclass(frozen=True)
class LeastHazard:
    """Outcome of a search for a path of least hazard; ``path`` is None where there is none, or none was known in time.

    No path to a goal has less than ``hazard``, infinite where there is none; ``labels`` counts those grown, ``limit`` says what cut the
    search short, ``guarded`` holds the states that no walk was let come to twice: no other walk has less than ``hazard``.
    """

    path: Path | None
    hazard: float
    labels: int
    limit: str = "none"
    guarded: frozenset[int] = frozenset()

    def evidence(self) -> Evidence:
        """Evidence of ``hazard``: the states that walks must not repeat to have no less."""
        most = self.hazard if math.isfinite(self.hazard) else None
        return Evidence("guarded-walks", "walks with memory", self.hazard, {"guarded": sorted(self.guarded), "most": most})


def least_hazard(
    problem: RiskyPath, goals: Sequence[int], stop: Stop, memories: Memories | None = None, most: float = math.inf,
    labels: int | None = None,
) -> LeastHazard:  # fmt: skip
    """A path without repetition of least hazard to one of ``goals``.

    ``memories`` may be shared by searches of one problem. Paths of hazard ``most`` or more are of no use: where there are no others, none
    is returned, and ``hazard`` is at least this. ``labels`` is how many may be grown.
    """
    moves, graph = problem.moves, problem.graph
    if graph.start in goals:
        return LeastHazard((graph.start,) if moves.start_hazard < math.inf else None, moves.start_hazard, 0)
    left = moves.from_moves(goals).tolist()
    if not graph.traverse:
        walks = [walk for goal in goals if (walk := moves.walk(goal)) is not None]
        reach = moves.to_states()
        if not walks or reach[list(goals)].min() >= most:
            return LeastHazard(None, float(reach[list(goals)].min()), 0)
        best = min(walks, key=lambda walk: (reach[walk[-1]], len(walk)))
        if len(set(best)) == len(best):
            return LeastHazard(best, float(reach[best[-1]]), 0)
    search = _Search(problem, frozenset(goals), left, memories or Memories(problem.graph), stop, most, labels)
    guarded: frozenset[int] = frozenset()
    while True:
        walk, hazard, limit = search.run(guarded)
        twice = frozenset(state for state in walk if walk.count(state) > 1) if walk is not None else frozenset()
        if walk is None or not twice:
            return LeastHazard(walk, hazard, search.grown, limit, guarded)
        guarded |= twice


class _Search:
    def __init__(
        self, problem: RiskyPath, goals: frozenset[int], left: list[float], memories: Memories, stop: Stop, most: float, labels: int | None
    ) -> None:
        self.moves, self.goals, self.left, self.memories, self.stop, self.most = problem.moves, goals, left, memories, stop, most
        self.head, self.start = problem.graph.head.tolist(), problem.graph.start
        self.budget, self.grown = labels, 0

    def run(self, guarded: frozenset[int]) -> tuple[Path | None, float, str]:
        """The first walk to a goal that comes to no guarded state twice, the least hazard of such walks, and the limit that ended it."""
        moves, left, head, memories = self.moves, self.left, self.head, self.memories
        begin = len(head)
        bit = {state: 1 << k for k, state in enumerate(sorted(guarded))}
        serial = itertools.count()
        # (hazard at least, moves, serial number, hazard, move, memory, guarded states behind, label before)
        heap: list[tuple[Any, ...]] = [
            (moves.start_hazard + left[begin], 0, next(serial), moves.start_hazard, begin, memories.begin, 0, None)
        ]
        settled: dict[int, list[tuple[float, int, int]]] = {}
        while heap:
            label = heapq.heappop(heap)
            least, count, _, hazard, move, memory, behind, _ = label
            if least >= self.most:
                return None, least, "none"
            state = self.start if move == begin else head[move]
            if state in self.goals:
                return self._path(label), hazard, "none"
            others = settled.setdefault(move, [])
            if any(h <= hazard and not b & ~behind and memories.no_worse(m, memory) for h, m, b in others):
                continue
            others.append((hazard, memory, behind))
            self.grown += 1
            if self.grown % LOOK == 0 and (limit := self.stop.reached()):
                return None, least, limit
            if self.budget is not None and self.grown > self.budget:
                return None, least, "iterations"
            for after, own in zip(*moves.successors[move], strict=True):
                reached = head[after]
                mark = bit.get(reached, 0)
                if behind & mark or left[after] == math.inf:
                    continue
                carried, more = memories.step(memory, state, reached) if memories.elements else (memory, 0.0)
                total = hazard + own + more
                if total < math.inf:
                    entry = (max(least, total + left[after]), count + 1, next(serial), total, after, carried, behind | mark, label)
                    heapq.heappush(heap, entry)
        return None, math.inf, "none"

    def _path(self, label: tuple[Any, ...] | None) -> Path:
        states: list[int] = []
        while label is not None:
            states.append(self.start if label[4] == len(self.head) else self.head[label[4]])
            label = label[7]
        return tuple(reversed(states))
