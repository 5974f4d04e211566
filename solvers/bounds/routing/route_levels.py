"""Levels that grow along a route (time, loads, distances), as searches for routes by labels take them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .arcs import Arcs, Flags, Floats

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem


@dataclass(frozen=True, eq=False)
class Level:
    """One level: the ``weight`` that moves add (nodes, nodes), the ``start`` on leaving the depot, and its range at each node, in entry 0
    on return."""

    weight: Floats
    start: float
    lower: Floats
    upper: Floats

    def grows(self, usable: Flags) -> bool:
        """Whether no cycle of customers adds nothing."""
        idle = usable[1:, 1:] & (self.weight[1:, 1:] <= 0.0)
        for _ in range(len(idle)):  # a move to a customer with no such move onwards is on no such cycle
            left = idle & np.atleast_1d(idle.any(axis=1))[None, :]
            if (left == idle).all():
                break
            idle = left
        return not idle.any()

    def finite(self, usable: Flags) -> Level:
        """The same level with finite ranges that limit nothing more."""
        lower = np.where(np.isfinite(self.lower), self.lower, self.start)
        known = np.concatenate([lower, self.upper[np.isfinite(self.upper)], [self.start]])
        beyond = float(known.max()) + len(lower) * float(self.weight[usable].max(initial=0.0))
        return Level(self.weight, self.start, lower, np.where(np.isfinite(self.upper), self.upper, beyond))


def route_levels(problem: RoutingProblem, arcs: Arcs, usable: Flags) -> list[Level]:
    """The levels that limit routes, time first; the number of visits too where some cycle adds to none of them, so that walks end."""
    due = problem.sites.due[[*arcs.customers, *(v.end for v in problem.fleet)]]
    # Where nothing limits time, its level only keeps labels apart that are alike.
    kept = [r for name, r in arcs.resources.items() if name != "time" or np.isfinite(due).any()] or [arcs.resources["time"]]
    kept.sort(key=lambda r: r is not arcs.resources["time"])

    def grid(weight: Floats) -> Floats:
        square = weight[:-1, :-1].copy()
        square[:, 0] = weight[:-1, -1]
        return np.where(usable, square, 0.0)

    levels = [
        Level(grid(r.weight), float(r.lower[0]), r.lower[:-1], np.append(r.upper[-1], r.upper[1:-1]) + r.tolerance)
        for r in kept
        if np.isfinite(r.upper).any()
    ]
    if not any(level.grows(usable) for level in levels):
        nodes = len(usable)
        levels.append(Level(usable.astype(np.float64), 0.0, np.zeros(nodes), np.full(nodes, float(nodes))))
    return [level.finite(usable) for level in levels]
