"""Sets of customers that no vehicle serves on one route, because of windows: whatever else a route visits, two must enter such a set."""

import math
from collections.abc import Sequence

import numpy as np

from ...stop import current_stop
from ..problem import RoutingProblem
from .known_features import Flags, Floats, Integers
from .route_limits import Limits, limits_of, summable

MOST = 8
"""Larger sets are not looked at: all subsets are gone through."""


def beyond_one_route(problem: RoutingProblem, groups: Sequence[Integers]) -> Flags:
    """Whether no vehicle serves all customers of each group, given as nodes from 1 on, within their windows, by any ways over others.

    False where that is not known: for groups of one, or of more than ``MOST``, and where vehicles stop on the way.
    """
    asked = [k for k, group in enumerate(groups) if 1 < len(group) <= MOST]
    beyond = np.zeros(len(groups), dtype=bool)
    if not asked or not summable(problem) or any(v.reloads or (v.energy and v.energy.stations) for v in problem.fleet):
        return beyond
    beyond[asked] = True
    for vehicle in dict.fromkeys(problem.fleet):
        limits = limits_of(problem, vehicle)
        ways = limits.busy.copy()
        for k in range(1, len(ways) - 1):
            np.minimum(ways, ways[:, k, None] + ways[None, k], out=ways)
        for k in asked:
            if current_stop().reached():
                return np.zeros(len(groups), dtype=bool)
            beyond[k] = beyond[k] and not _in_time(limits, ways, groups[k])
    return beyond


def _in_time(limits: Limits, ways: Floats, group: Integers) -> bool:
    """Whether some order of a group keeps its windows and comes back in time."""
    size = len(group)
    ready, due = limits.ready[group], np.array([limits.latest(d) for d in limits.due[group].tolist()])
    if np.isinf([*due, limits.due[-1]]).all():
        return True
    between, bit = ways[np.ix_(group, group)], 1 << np.arange(size)
    at = np.full((1 << size, size), math.inf)  # the earliest time at the last customer of a set

    def come(mask: int, times: Floats) -> None:
        fresh = (bit & mask) == 0
        fresh &= times <= due
        for j in np.flatnonzero(fresh).tolist():
            at[mask | 1 << j, j] = min(at[mask | 1 << j, j], max(times[j], ready[j]))

    come(0, limits.ready[0] + ways[0, group])
    for mask in range(1, (1 << size) - 1):
        if np.isfinite(at[mask]).any():
            come(mask, (at[mask][:, None] + between).min(axis=0))
    return bool((at[-1] + ways[group, -1]).min() <= limits.latest(float(limits.due[-1])))
