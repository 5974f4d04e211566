"""Dijkstra's search with one label for the last few states of a path: the source's algorithm 2 for two, Dijkstra's own for one.

A label is priced by its own path, traverse elements included, so that these are seen and still not searched for: what a worse beginning
would save later is lost. Walks may come to a state twice, unless that is refused, which is no remedy: it can miss the best path. Source:
Xiao (2019), section 4.2.2.1, with the start's risk counted and ties broken by the fewest moves; docs/formulations/risky-path.md#look-back.
"""

from __future__ import annotations

import heapq
import itertools
import math
from dataclasses import dataclass

from .....formulations.risk.risky_path import Path, RiskyPath
from .....formulations.stop import Stop, Stopped
from .memories import Memories

LOOK = 256


@dataclass
class _Label:
    hazard: float
    count: int
    move: int
    memory: int
    before: _Label | None


def look_back(problem: RiskyPath, steps: int, stop: Stop, *, revisits: bool = True) -> dict[int, tuple[float, Path]]:
    """Hazard and walk of the best label of each state that has one, the start included.

    Parameters
    ----------
    problem : RiskyPath
    steps : int
        States that a label tells apart: 1, 2, ...
    stop : Stop
    revisits : bool
        Whether walks may come to a state twice, other than straight back.

    Raises
    ------
    Stopped
        If it is asked to end before all labels are closed.
    """
    graph, moves, memories = problem.graph, problem.moves, Memories(problem)
    head, begin, serial = graph.head.tolist(), len(graph.tail), itertools.count()

    def path_of(label: _Label | None) -> Path:
        states: list[int] = []
        while label is not None:
            states.append(graph.start if label.move == begin else head[label.move])
            label = label.before
        return tuple(reversed(states))

    first = _Label(moves.start_hazard, 0, begin, memories.begin, None)
    best: dict[Path, tuple[float, int]] = {(graph.start,): (first.hazard, 0)}
    heap: list[tuple[float, int, int, Path, _Label]] = [(first.hazard, 0, next(serial), (graph.start,), first)]
    closed: set[Path] = set()
    found: dict[int, tuple[float, Path]] = {}
    while heap:
        hazard, count, _, key, label = heapq.heappop(heap)
        if key in closed or hazard == math.inf:
            continue
        closed.add(key)
        if len(closed) % LOOK == 0 and stop.reached():
            raise Stopped
        path = path_of(label) if key[-1] not in found or not revisits else ()
        found.setdefault(key[-1], (hazard, path))
        for after, own in zip(*moves.successors[label.move], strict=True):
            reached = head[after]
            if not revisits and reached in path:
                continue
            carried, more = memories.step(label.memory, key[-1], reached) if memories.elements else (label.memory, 0.0)
            longer, priced = (*key, reached)[-steps:], (hazard + own + more, count + 1)
            if longer not in closed and priced < best.get(longer, (math.inf, 0)):
                best[longer] = priced
                heapq.heappush(heap, (*priced, next(serial), longer, _Label(*priced, after, carried, label)))
    return found


def without_loops(walk: Path) -> Path:
    """``walk`` with every way from a state back to it left out, the first one first."""
    kept: list[int] = []
    for state in walk:
        if state in kept:
            del kept[kept.index(state) :]
        kept.append(state)
    return tuple(kept)
