"""Evidence ``all-paths``: every path without repetition that could earn more per risk than a target, walked by the checker."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ....instances.risk.element import TraverseElement
from ...evidence import CHECKERS
from ...stop import current_stop
from .following_moves import FollowingMoves, following_moves
from .guarded_walks import Remembered

if TYPE_CHECKING:
    from ..risky_path import RiskyPath

MOST_PATHS = 30_000
"""Beginnings of paths that are walked."""

CANCELLED = 1e-3
"""Part of all rewards under which what is left of them is added up anew, not found by subtraction."""

_EPS = float(np.finfo(np.float64).eps)


@CHECKERS.register("all-paths")
def check_all_paths(problem: RiskyPath, data: Mapping[str, Any]) -> float:
    """The larger of ``target`` and of what the paths earn per risk that could earn more; null asks for all paths.

    A beginning is left alone once all rewards that are not yet collected would not bring it above the target. Nothing is proved for least
    risks, nor where there are more than ``MOST_PATHS`` others.
    """
    if problem.family != "risky-path":
        raise InputError("all paths are evidence for risky paths", found=problem.family)
    target = data["target"]
    if target is not None and (isinstance(target, bool) or not isinstance(target, int | float) or math.isnan(target)):
        raise InputError("the target must be a number", found=str(target)[:40])
    if problem.sense != "max":
        return -math.inf
    own = following_moves(problem.graph, tuple(e for e in problem.graph.elements if not isinstance(e, TraverseElement)))
    best = None if own is None else _walked(problem, own, -math.inf if target is None else float(target))
    return math.inf if best is None else best


def _walked(problem: RiskyPath, own: FollowingMoves, best: float) -> float | None:
    graph, remembered, stop, walked = problem.graph, Remembered(problem), current_stop(), 0
    head, rewards, ends = graph.head.tolist(), problem.rewards.tolist(), set(graph.goals)
    after: dict[int, list[tuple[int, float]]] = {}
    for earlier, later, hazard in zip(own.earlier.tolist(), own.later.tolist(), own.hazard.tolist(), strict=True):
        after.setdefault(earlier, []).append((later, hazard))
    total, slack = math.fsum(rewards), 1.0 + 16.0 * _EPS * (graph.num_states + 4)
    # path, hazard, reward, memories of traverse elements, last move
    ahead: list[tuple[tuple[int, ...], float, float, tuple[Any, ...], int]] = [
        ((graph.start,), own.start_hazard + remembered.start_hazard, rewards[graph.start], remembered.begin, -1)
    ]
    while ahead:
        path, hazard, reward, memories, move = ahead.pop()
        walked += 1
        if walked > MOST_PATHS or (walked % 512 == 0 and stop.reached()):
            return None
        if hazard == math.inf:
            continue
        risk = -math.expm1(-hazard) / slack
        if risk > 0.0 and (not ends or path[-1] in ends):
            best = max(best, reward / risk)
        if risk > 0.0 and len(path) > 1 and (reward + _rest(rewards, total, path)) * slack / risk <= best:
            continue
        for later, more in after.get(move, ()):
            state = head[later]
            if state not in path:
                then, extra = remembered.step(memories, path[-1], state)
                kept = graph.discount * reward if len(path) > 1 else 0.0
                ahead.append(((*path, state), hazard + more + extra, kept + rewards[state], then, later))
    return best


def _rest(rewards: list[float], total: float, path: tuple[int, ...]) -> float:
    """At least the rewards of the states that are not on ``path``, but for a rounding in proportion."""
    rest = total - math.fsum(rewards[state] for state in path)
    if rest > CANCELLED * total:
        return rest + 2.0 * _EPS * total
    behind = set(path)
    return math.fsum(reward for state, reward in enumerate(rewards) if state not in behind)
