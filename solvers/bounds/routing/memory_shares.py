"""Shares of a limit on memory for each part of branch, price and cut."""

import math
from dataclasses import dataclass

MB = 10**6

KEPT = 250 * MB
"""For the room that checks ask for, most of which they seldom use, and for the integer program over routes at hand."""

A_TYPE, A_NODE, A_MOVE = 100_000, 2_000, 400
"""Bytes for a type of vehicle, and for each of its nodes and moves: costs, levels and memories from both ends, and what is written on the
way to them."""

LABELS, ROUTES = 0.5, 0.25
"""Parts of the rest for labels and for routes at hand; what is left is for the tree."""

LEAST = 20 * MB
"""Least rest with which a search is begun."""

LISTING = 120 * MB
"""For the list of all routes of a better answer, its linear program and its check, if three times as much is there."""

ROUTE, VISIT = 2_500, 150
"""Bytes of a route at hand in the linear program and beside it, and of each of its moves."""

NUMBER = 50
"""Bytes of a number in evidence."""


@dataclass(frozen=True)
class MemoryShares:
    """Bytes for ``labels`` of all types of vehicle, for ``routes`` at hand, and for the ``tree``; ``listing``: whether there is room for
    a list of all routes of a better answer."""

    labels: float = math.inf
    routes: float = math.inf
    tree: float = math.inf
    listing: bool = True

    @classmethod
    def of(cls, limit: float | None, nodes: int, types: int) -> "MemoryShares":
        """The shares of a limit in MB, if there is one."""
        if limit is None:
            return cls()
        rest = max(limit * MB - _beside(nodes, types), 0)
        listing = rest >= 3 * LISTING
        rest -= LISTING * listing
        return cls(LABELS * rest, ROUTES * rest, (1.0 - LABELS - ROUTES) * rest, listing)


def least_limit(nodes: int, types: int) -> int:
    """The least limit, in MB, for a number of nodes and types of vehicle."""
    return math.ceil((_beside(nodes, types) + LEAST) / MB)


def _beside(nodes: int, types: int) -> int:
    return KEPT + types * (A_TYPE + A_NODE * nodes + A_MOVE * nodes * nodes)
