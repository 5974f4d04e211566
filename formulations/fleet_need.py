"""How many vehicles the data ask for at least: arguments that need no solver, in the problem's words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .tolerance import LIMIT

if TYPE_CHECKING:
    from .problems.routing import RoutingProblem

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

LARGEST_CLIQUE_DATA = 1500
"""Sites up to which pairs are compared (all shortest paths take cubic time)."""

_SEEDS = 50


def fleet_conflicts(problem: RoutingProblem) -> list[str]:
    """Reasons, if any, why the fleet is too small for the required sites, or the number of routes asked for too large.

    Each is a proof from the data: total load, the bin packing bound L2 (Martello and Toth 1990, *Knapsack Problems*,
    section 8.3), a set of sites of which no two fit on one route, and the count of sites.
    """
    found = []
    sites = problem.sites
    wanted = np.nonzero(sites.required)[0]
    visitable = len(problem.customers)
    if problem.min_vehicles > visitable:
        found.append(f"at least {problem.min_vehicles} routes are asked for, but only {visitable} sites can be visited")
    limit = problem.vehicle_limit
    if limit is None or len(wanted) == 0:
        return found
    demand = sites.demand[wanted]
    total, room = float(math.fsum(demand)), math.fsum(v.capacity * (v.count or 0) for v in problem.fleet)
    if total > room * (1.0 + LIMIT):
        found.append(f"the required sites demand {total:g} in total, {_vehicles(limit)} can carry {room:g}")
    else:
        largest = max(v.capacity for v in problem.fleet)
        need = _bin_packing_bound(demand, largest * (1.0 + LIMIT)) if math.isfinite(largest) else 0
        if need > limit:
            found.append(f"the demands need at least {need} vehicles of capacity {largest:g} (bin packing bound L2), the fleet has {limit}")
    if len(sites) <= LARGEST_CLIQUE_DATA:
        apart = wanted[_largest_clique(~_compatible(problem, wanted))]
        if len(apart) > limit:
            names = ", ".join(sites.ids[k] for k in apart)
            found.append(f"no two of these {len(apart)} sites fit on one route, and the fleet has {_vehicles(limit)}: {names}")
    return found


def _vehicles(count: int) -> str:
    return "1 vehicle" if count == 1 else f"{count} vehicles"


def _bin_packing_bound(demand: Floats, capacity: float) -> int:
    """Bound L2: items above ``capacity - k`` keep a bin each, and share it with nothing of size ``k`` or more."""
    best = math.ceil(math.fsum(demand) / capacity - 1e-9) if capacity > 0 else len(demand)
    for k in np.unique(demand[demand <= capacity / 2.0]):
        huge, large = demand > capacity - k, (demand > capacity / 2.0) & (demand <= capacity - k)
        small = (demand >= k) & (demand <= capacity / 2.0)
        rest = math.fsum(demand[small]) - (int(large.sum()) * capacity - math.fsum(demand[large]))
        best = max(best, int(huge.sum() + large.sum()) + max(0, math.ceil(rest / capacity - 1e-9)))
    return max(best, int((demand > capacity / 2.0).sum()))


def _compatible(problem: RoutingProblem, wanted: NDArray[np.int64]) -> Flags:
    """Whether two sites can be on one route of some vehicle, shape (wanted, wanted); True wherever in doubt.

    Times between sites are those of shortest paths without service on the way, so that no other visit can make a pair fit.
    """
    from scipy.sparse.csgraph import floyd_warshall

    sites, travel = problem.sites, problem.travel
    time, length = floyd_warshall(travel.durations), floyd_warshall(travel.distances)
    demand, service, ready, due = (a[wanted] for a in (sites.demand, sites.service, sites.ready, sites.due))
    between_time, between_length = time[np.ix_(wanted, wanted)], length[np.ix_(wanted, wanted)]
    fits = np.zeros((len(wanted), len(wanted)), dtype=bool)
    for v in problem.fleet:
        out, back = time[v.start, wanted], time[wanted, v.end]
        begin = np.maximum(ready, sites.ready[v.start] + out)
        arrival = (begin + service)[:, None] + between_time
        finish = np.maximum(arrival, ready[None, :]) + (service + back)[None, :]
        spent = (out + service)[:, None] + between_time + (service + back)[None, :]
        driven = length[v.start, wanted][:, None] + between_length + length[wanted, v.end][None, :]
        wide = 1.0 + LIMIT
        ordered = (
            (arrival <= (due + LIMIT * np.abs(due))[None, :])
            & (finish <= sites.due[v.end] * wide)
            & (spent <= v.max_duration * wide)
            & (driven <= v.max_distance * wide)
        )
        fits |= (ordered | ordered.T) & (demand[:, None] + demand[None, :] <= v.capacity * wide)
    return fits


def _largest_clique(edges: Flags) -> NDArray[np.int64]:
    """A large set of which all pairs are joined: greedy from the nodes of highest degree."""
    edges = edges.copy()
    np.fill_diagonal(edges, False)
    degree = edges.sum(axis=1)
    best: list[int] = []
    for seed in np.argsort(-degree, kind="stable")[:_SEEDS].tolist():
        if degree[seed] < len(best):
            break
        clique, left = [seed], edges[seed].copy()
        while left.any():
            inside = np.where(left, edges[:, left].sum(axis=1), -1)
            node = int(np.argmax(inside))
            clique.append(node)
            left &= edges[node]
        if len(clique) > len(best):
            best = clique
    return np.sort(np.array(best, dtype=np.int64))
