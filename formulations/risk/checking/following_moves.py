"""Which moves of a path without repetition may follow each other, and their least hazards: what the checkers of this room share."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ....instances.risk.risky_graph import RiskyGraph

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

MOST_PAIRS = 40_000_000
"""Pairs of moves that are looked at."""


@dataclass(frozen=True)
class FollowingMoves:
    """Pairs (a, b) of moves, a before b; a = -1 stands for nothing, where b leaves the start.

    Attributes
    ----------
    earlier, later : array, shape (pairs,)
    hazard : array, shape (pairs,)
        At least that of b after a, infinite where nothing survives it.
    start_hazard : float
    """

    earlier: Indices
    later: Indices
    hazard: Floats
    start_hazard: float


def following_moves(graph: RiskyGraph, among: tuple[Any, ...] | None = None) -> FollowingMoves | None:
    """All pairs, priced by the elements ``among`` (all by default); None where there are too many."""
    tail, head = graph.tail.astype(np.int64), graph.head.astype(np.int64)
    numbers = np.arange(len(tail))
    by_head = numbers[np.argsort(head, kind="stable")]
    into = np.bincount(head, minlength=graph.num_states)
    ends = np.cumsum(into)
    many = into[tail]
    if int(many.sum()) > MOST_PAIRS:
        return None
    later = np.repeat(numbers, many)
    place = np.arange(len(later)) - np.repeat(np.cumsum(many) - many, many)
    earlier = by_head[(ends - into)[tail[later]] + place]
    kept = (tail[later] != graph.start) & (head[earlier] != graph.start) & (head[later] != graph.start) & (tail[earlier] != head[later])
    leaving = numbers[tail == graph.start]
    earlier = np.concatenate([earlier[kept], np.full(len(leaving), -1)])
    later = np.concatenate([later[kept], leaving])
    before = np.where(earlier >= 0, tail[earlier] if len(tail) else -1, -1)
    elements = graph.elements if among is None else among
    hazard, begin = np.zeros(len(later)), 0.0
    for element in elements:
        with np.errstate(divide="ignore"):
            hazard -= np.log1p(-graph.least_risks(element, before, tail[later], head[later]))
        first = float(graph.least_risks(element, [-1], [-1], [graph.start])[0])
        begin += -math.log1p(-first) if first < 1.0 else math.inf
    return FollowingMoves(earlier, later, hazard, begin)
