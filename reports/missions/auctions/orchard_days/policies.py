"""Rules of robots in the orchard, decided step by step: which bins they fetch, and where they bring new ones."""

from collections.abc import Callable, Mapping

import numpy as np

from .....instances.auctions.orchard_rules import NONE, Trip
from .....instances.auctions.worlds.orchard import OrchardObservation
from .....instances.number_arrays import Integers

CHOICES = ("greedy", "auction", "auction-immediate", "assignment")
"""Which idle robot fetches which bin: each in turn the nearest full one, or the soonest full; the deferred and the immediate conflict
auction; the assignment of the least sum."""

DELIVERIES = ("baseline", "proposed")
"""Rules for new bins: robots without a bin to fetch bring one to the earliest request; or any robot at the repository brings one to the
cell of the bin that it will fetch, or to the request nearest to it."""

COSTS = ("later", "sum")
"""Cost of a bin: travel or filling, whichever ends later; or their sum."""


def costs(o: OrchardObservation, cost: str) -> Integers:
    """Steps until each idle robot has each bin, full, on board; shape (idle, bins)."""
    travel, remaining = o.rules.grid.empty_times[np.ix_(o.cells, o.bin_cells)], o.remaining[None, :]
    return np.asarray(travel + remaining if cost == "sum" else np.maximum(travel, remaining))


def _greedy(o: OrchardObservation, cost: str) -> dict[int, int]:
    chosen: dict[int, int] = {}
    for robot, cell in zip(o.robots.tolist(), o.cells.tolist(), strict=True):
        distance = o.rules.grid.distances[cell, o.bin_cells]
        rows = np.array([row not in chosen.values() for row in range(len(o.bins))], bool).nonzero()[0]
        if len(rows):
            chosen[robot] = int(min(rows, key=lambda row: (o.remaining[row], distance[row], row)))
    return chosen


def _auction(o: OrchardObservation, cost: str) -> dict[int, int]:
    """The cheapest pairs first, which is the outcome of the deferred auction."""
    matrix = costs(o, cost)
    chosen: dict[int, int] = {}
    taken: set[int] = set()
    for flat in np.argsort(matrix, axis=None, kind="stable").tolist():
        i, j = divmod(flat, len(o.bins))
        if int(o.robots[i]) not in chosen and j not in taken:
            chosen[int(o.robots[i])] = int(j)
            taken.add(j)
    return chosen


def _immediate(o: OrchardObservation, cost: str) -> dict[int, int]:
    matrix = costs(o, cost)
    chosen: dict[int, int] = {}
    open_bins = list(range(len(o.bins)))
    while open_bins and len(chosen) < len(o.robots):
        bids: dict[int, list[tuple[int, int]]] = {}
        for i, robot in enumerate(o.robots.tolist()):
            if robot not in chosen:
                best = min(open_bins, key=lambda j: (matrix[i, j], j))
                bids.setdefault(best, []).append((int(matrix[i, best]), robot))
        for j, bidders in bids.items():
            chosen[min(bidders)[1]] = int(j)
            open_bins.remove(j)
    return chosen


def _assignment(o: OrchardObservation, cost: str) -> dict[int, int]:
    from .choice_kernels import assignment

    matrix = costs(o, cost)
    plan = assignment(matrix) if matrix.size else np.full(len(o.robots), NONE)
    return {int(robot): int(j) for robot, j in zip(o.robots, plan, strict=True) if j >= 0}


CHOOSING: Mapping[str, Callable[[OrchardObservation, str], dict[int, int]]] = {
    "greedy": _greedy, "auction": _auction, "auction-immediate": _immediate, "assignment": _assignment,
}  # fmt: skip
"""Functions by name, from an observation to a row of its bins for each robot that fetches one."""


def trips(o: OrchardObservation, chosen: Mapping[int, int], delivery: str, returning: bool = True) -> dict[int, Trip]:
    """The trip of each idle robot, in the order of their numbers; ``chosen`` are rows of ``o.bins`` by robot.

    Without ``returning``, robots without a bin stay where they are instead of going home.
    """
    home, empty = o.rules.grid.home, o.rules.grid.empty_times
    wanting, requests = o.wanting.copy(), o.requests.tolist()
    trips_of_robots: dict[int, Trip] = {}
    for robot, cell in zip(o.robots.tolist(), o.cells.tolist(), strict=True):
        row = chosen.get(robot, NONE)
        fetch, near = (NONE, home) if row < 0 else (int(o.bins[row]), int(o.bin_cells[row]))
        deliver = NONE
        if cell == home and (row < 0 or delivery == "proposed"):
            if row >= 0 and wanting[near]:
                deliver = near
            elif requests:
                deliver = min(requests, key=lambda request: empty[near, request]) if delivery == "proposed" else requests[0]
        if deliver != NONE:
            wanting[deliver] = False
            requests = [request for request in requests if request != deliver]
        if deliver != NONE or fetch != NONE or returning:
            trips_of_robots[robot] = Trip(deliver, fetch)
    return trips_of_robots
