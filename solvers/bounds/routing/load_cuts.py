"""Capacity cuts: routes enter a set of customers as often as its loads take vehicles (Laporte, Nobert 1983)."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import Stop
from .arcs import Flags, Floats
from .restricted_master import Pool

LEAST = 0.02
"""Least violation."""

ROUNDED = 1e-9
"""Part of the vehicles needed by which sums of loads may have been rounded."""

MOST, LARGEST = 40, 100
"""Most cuts that are added at once, and the largest set."""


@dataclass(frozen=True, eq=False)
class LoadCut:
    """Moves into ``inside`` (nodes,) are ``right`` or more; ``due``: because of windows."""

    inside: Flags
    right: float
    sign: int = 1
    due: bool = False

    def missing(self, nodes: int) -> Floats:
        return self.inside[1:].astype(np.float64)

    @staticmethod
    def coefficients(cuts: "Sequence[LoadCut]", pool: Pool, first: int) -> Floats:
        return np.array([pool.sums(cut.moves, first) for cut in cuts]).T

    @property
    def moves(self) -> Flags:
        """Moves into the set, shape (nodes, nodes)."""
        return ~self.inside[:, None] & self.inside[None, :]


def overloaded(problem: RoutingProblem, flow: Floats, known: set[bytes], stop: Stop) -> list[LoadCut]:
    """Violated cuts of a flow over moves, shape (nodes, nodes), that are not ``known`` yet, which then they are."""
    from .cut_kernels import overloaded_sets

    both = flow + flow.T
    tail, head = (np.ascontiguousarray(ends) for ends in np.nonzero(both > 1e-9))
    starts, value = np.searchsorted(tail, np.arange(len(flow) + 1)), both[tail, head]
    keys = np.random.default_rng(1).random(len(flow))
    cuts = []
    for load, largest in _carried(problem):
        inside = np.zeros((MOST, len(flow)), dtype=bool)
        amounts = np.append(0.0, load)
        count = overloaded_sets(stop.flag, starts, head, value, amounts, keys, largest, 2.0 * LEAST, LARGEST, inside)
        needed = np.ceil(inside[:count] @ amounts / largest * (1.0 - ROUNDED))
        for members, right in zip(inside[:count], needed.tolist(), strict=True):
            if members.tobytes() not in known and flow[~members][:, members].sum() < right - LEAST:
                known.add(members.tobytes())
                cuts.append(LoadCut(members.copy(), right))
    return cuts


def _carried(problem: RoutingProblem) -> Iterator[tuple[Floats, float]]:
    """Loads that are delivered, and those that are collected, of customers who must be visited; with the largest capacity for each."""
    sites, at = problem.sites, problem.customers
    for k, largest in enumerate(max(capacities) for capacities in zip(*(v.capacities for v in problem.fleet), strict=False)):
        for first, further in ((sites.demand, sites.further_demand), (sites.pickup, sites.further_pickup)):
            load = np.where(sites.required[at], first[at] if k == 0 else further[at, k - 1], 0.0)
            if 0.0 < largest < np.inf and load.any():
                yield load, largest
