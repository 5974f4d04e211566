"""Capacity cuts: routes enter a set of customers as often as its loads take vehicles (Laporte, Nobert 1983)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ....formulations.routing.checking.vehicle_moves import needed_routes
from ....formulations.stop import Stop
from .arcs import Flags, Floats
from .restricted_master import Pool

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

LEAST = 0.02
"""Least violation."""

MOST, LARGEST = 40, 100
"""Most cuts that are added at once, and the largest set."""


@dataclass(frozen=True, eq=False)
class LoadCut:
    """Moves into ``inside`` (nodes,) are ``right`` or more."""

    inside: Flags
    right: float
    sign: int = 1

    def missing(self, nodes: int) -> Floats:
        return self.inside[1:].astype(np.float64)

    @staticmethod
    def coefficients(cuts: Sequence[LoadCut], pool: Pool, first: int) -> Floats:
        return np.array([pool.sums(cut.moves, first) for cut in cuts]).T

    @property
    def moves(self) -> Flags:
        """Moves into the set, shape (nodes, nodes)."""
        return ~self.inside[:, None] & self.inside[None, :]


def overloaded(problem: RoutingProblem, flow: Floats, known: set[bytes], stop: Stop) -> list[LoadCut]:
    """Violated cuts of a flow over moves, shape (nodes, nodes), that are not ``known`` yet, which then they are."""
    from .cut_kernels import overloaded_sets

    largest = max(v.capacity for v in problem.fleet)
    demand = np.append(0.0, problem.sites.demand[problem.customers])
    if not 0.0 < largest < np.inf or not demand.any():
        return []
    both = flow + flow.T
    tail, head = (np.ascontiguousarray(ends) for ends in np.nonzero(both > 1e-9))
    starts = np.searchsorted(tail, np.arange(len(flow) + 1))
    inside = np.zeros((MOST, len(flow)), dtype=bool)
    keys = np.random.default_rng(1).random(len(flow))
    count = overloaded_sets(stop.flag, starts, head, both[tail, head], demand, keys, largest, 2.0 * LEAST, LARGEST, inside)
    if not count:
        return []
    cuts = []
    for members, right in zip(inside[:count], needed_routes(problem, inside[:count, 1:]).tolist(), strict=True):
        if members.tobytes() not in known and flow[~members][:, members].sum() < right - LEAST:
            known.add(members.tobytes())
            cuts.append(LoadCut(members.copy(), float(right)))
    return cuts
