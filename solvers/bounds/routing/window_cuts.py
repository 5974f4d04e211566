"""Cuts where windows bind: at least two routes enter a set of customers that no route serves.

They are ``LoadCut``s, of which only the right side comes from elsewhere. Source: Kohl, Desrosiers, Madsen, Solomon, Soumis (1999).
"""

import itertools
from functools import cached_property

import numpy as np

from ....formulations.stop import NEVER, Stop
from .arcs import Flags, Floats
from .load_cuts import LEAST, MOST, LoadCut
from .route_levels import Level

LARGEST = 7
"""The largest set."""


class WindowCuts:
    """Searches for violated cuts; ``level`` is the one that windows limit, over the moves that are ``usable``."""

    def __init__(self, level: Level, usable: Flags) -> None:
        self.level, self.usable, self.known = level, usable, dict[tuple[int, ...], bool]()

    @cached_property
    def way(self) -> Floats:
        """Times of the shortest ways over any customers, shape (nodes, nodes)."""
        way = np.where(self.usable, self.level.weight, np.inf)
        for k in range(1, len(way)):
            np.minimum(way, way[:, k, None] + way[None, k], out=way)
        return way

    def violated(self, flow: Floats, known: set[bytes], stop: Stop = NEVER) -> list[LoadCut]:
        """Cuts that a flow over moves, shape (nodes, nodes), violates and that are not ``known`` yet, which then they are."""
        both, sets = flow + flow.T, dict[tuple[int, ...], float]()
        for first in range(1, len(flow)):
            if stop.reached():
                break
            members, entering, link = [first], 1.0, both[first].copy()
            while len(members) < LARGEST and entering < 2.0 - LEAST:
                link[[0, *members]] = 0.0
                best = int(np.argmax(link))
                if not link[best]:
                    break
                members, entering, link = [*members, best], entering + 1.0 - link[best], link + both[best]
                key = tuple(sorted(members))
                if entering < 2.0 - LEAST and not self.served(key):
                    sets[key] = entering
                    break
        cuts = []
        for key in itertools.islice(sorted(sets, key=lambda members: sets[members]), MOST):
            inside = np.zeros(len(flow), dtype=bool)
            inside[list(key)] = True
            if inside.tobytes() not in known:
                known.add(inside.tobytes())
                cuts.append(LoadCut(inside, 2.0, due=True))
        return cuts

    def served(self, members: tuple[int, ...]) -> bool:
        """Whether some order of the members keeps the level's range at each."""
        if members not in self.known:
            self.known[members] = self._in_some_order(frozenset(members))
        return self.known[members]

    def _in_some_order(self, members: frozenset[int]) -> bool:
        """Set by set, with the least level at each last member."""
        sets = {frozenset[int](): {0: self.level.start}}
        for _ in members:
            grown: dict[frozenset[int], dict[int, float]] = {}
            for seen, ends in sets.items():
                for j in members - seen:
                    least = max(min(level + float(self.way[i, j]) for i, level in ends.items()), float(self.level.lower[j]))
                    if least <= self.level.upper[j]:
                        grown.setdefault(seen | {j}, {})[j] = least
            sets = grown
        return any(level + self.way[i, 0] <= self.level.upper[0] for ends in sets.values() for i, level in ends.items())
