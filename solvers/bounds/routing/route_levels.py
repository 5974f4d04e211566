"""Levels that grow along a route (time, loads, distances), as searches for routes by labels take them, and the codes of these searches."""

from dataclasses import dataclass, replace

import numpy as np

from .arcs import Flags, Floats

DONE, STOPPED, FULL = 0, 1, 2

EXACT, NEARBY, FORGETFUL, SINGLE = 0, 1, 2, 3
"""Labels give way to those that remember no more and owe no cut more than they save; to those that remember no more of the few nearest; to
any that are no worse in cost and levels; to the cheapest of their bucket."""

NONE = 1 << 60
"""More than any sum of costs."""

WORD = 56
"""Bits of a word that are used: whole bytes, and never the sign."""


@dataclass(frozen=True, eq=False)
class Level:
    """One level: the ``weight`` that moves add (nodes, nodes), the ``start`` on leaving the depot, and its range at each node, in entry 0
    on return. It is never below the level ``above``, a position in the list, -1 for none; the ranges of both end at the same number.
    ``due``: it is the time of day, and something has to be in time."""

    weight: Floats
    start: float
    lower: Floats
    upper: Floats
    above: int = -1
    due: bool = False

    def grows(self, usable: Flags) -> bool:
        """Whether no cycle of customers adds nothing."""
        idle = usable[1:, 1:] & (self.weight[1:, 1:] <= 0.0)
        for _ in range(len(idle)):  # a move to a customer with no such move onwards is on no such cycle
            left = idle & np.atleast_1d(idle.any(axis=1))[None, :]
            if (left == idle).all():
                break
            idle = left
        return not idle.any()

    def finite(self, usable: Flags) -> "Level":
        """The same level with finite ranges that limit nothing more."""
        lower = np.where(np.isfinite(self.lower), self.lower, self.start)
        known = np.concatenate([lower, self.upper[np.isfinite(self.upper)], [self.start]])
        beyond = float(known.max()) + len(lower) * float(self.weight[usable].max(initial=0.0))
        return replace(self, lower=lower, upper=np.where(np.isfinite(self.upper), self.upper, beyond))


def levels_of(levels: list[Level], usable: Flags) -> list[Level]:
    """Levels as they limit routes; the number of visits too where some cycle adds to none of them, so that walks end."""
    if not any(level.grows(usable) for level in levels):
        nodes = len(usable)
        levels = [*levels, Level(usable.astype(np.float64), 0.0, np.zeros(nodes), np.full(nodes, float(nodes)))]
    return [level.finite(usable) for level in levels]
