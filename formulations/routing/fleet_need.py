"""Why a fleet is too small, or too many routes are asked for: arguments that need no solver, in the problem's words.

They are suspicions with their evidence; ``formulations.checking`` says which of them are proofs.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...instances.clock import moment_told
from ...instances.routing.reach import Use, least_use, shortest_ways
from ..evidence import Evidence
from ..tolerance import widened
from ..verified_bounds import verified_bound
from .reachability import unreachable
from .routes import Flags, Floats, Integers

if TYPE_CHECKING:
    from .problem import RoutingProblem


LARGEST_CLIQUE_DATA = 1500
"""Sites up to which pairs are compared (all shortest paths take cubic time)."""

MOST_ENUMERATED = 8
"""Sites of which every choice of routes is tried."""

_SEEDS = 50
_MOST_TYPES = 6


def fleet_conflicts(
    problem: RoutingProblem, stopped: Callable[[], bool] = lambda: False, most_enumerated: int = MOST_ENUMERATED
) -> Iterator[Evidence]:
    """Proofs that the fleet is too small for the required sites, or the number of routes asked for too large.

    Each was checked, and is looked for only where no simpler kind was found: total load, the bin packing bound L2 (Martello and Toth
    1990, *Knapsack Problems*, section 8.3), total range, a set of sites of which no two fit on one route; then up to ``most_enumerated``
    sites for which no choice of routes is left; then the time between two moments. ``stopped`` is asked between arguments whether to give
    up.
    """
    small_groups = partial(_small_groups, stopped=stopped, most=most_enumerated)
    for tier in ((_routes_asked_for, _loads, _ranges, _sites_apart), (small_groups,), (_hours,)):
        proved = False
        for argue in tier:
            for evidence in argue(problem):
                if proves(problem, evidence):
                    proved = True
                    yield evidence
            if stopped():
                return
        if proved:
            return


def proves(problem: RoutingProblem, evidence: Evidence) -> bool:
    """Whether the checker confirms that ``evidence`` leaves no answer."""
    return verified_bound(problem, evidence) == infeasible_bound(problem)


def infeasible_bound(problem: RoutingProblem) -> float:
    """The bound that says that there is no answer."""
    return math.inf if problem.sense == "min" else -math.inf


def _evidence(problem: RoutingProblem, kind: str, why: str, **data: object) -> Evidence:
    return Evidence(kind, why, infeasible_bound(problem), data)


def suspicions(problem: RoutingProblem) -> Iterator[Evidence]:
    """All arguments but that of small groups, confirmed or not."""
    for argue in (_routes_asked_for, _loads, _ranges, _sites_apart, _hours):
        yield from argue(problem)


def _routes_asked_for(problem: RoutingProblem) -> Iterator[Evidence]:
    visitable = len(problem.customers)
    if problem.min_vehicles > visitable - (len(unreachable(problem)) if problem.min_vehicles else 0):
        why = f"at least {problem.min_vehicles} routes are asked for, but only {visitable} sites can be visited"
        if problem.min_vehicles <= visitable:
            why = f"at least {problem.min_vehicles} routes are asked for, but fewer sites than that are within reach of a vehicle"
        yield _evidence(problem, "too-few-sites", why)


def _loads(problem: RoutingProblem) -> Iterator[Evidence]:
    limit, demand = problem.vehicle_limit, problem.sites.demand[problem.sites.required]
    if limit is None or not len(demand):
        return
    with np.errstate(over="ignore"):
        total, room = float(demand.sum()), sum(v.capacity * (v.count or 0) for v in problem.fleet)
    if total > room:
        yield _evidence(problem, "too-few-vehicles", f"the required sites demand {total:g} in total, {_vehicles(limit)} can carry {room:g}")
        return
    largest = max(v.capacity for v in problem.fleet)
    if math.isfinite(largest) and math.isfinite(total):
        need, threshold = bin_packing_bound(demand, float(widened(largest)))
        if need > limit:
            why = f"the demands need at least {need} vehicles of capacity {largest:g} (bin packing bound L2), the fleet has {limit}"
            yield _evidence(problem, "bin-packing", why, threshold=threshold)


def _ranges(problem: RoutingProblem) -> Iterator[Evidence]:
    if problem.vehicle_limit is None:
        return
    words = {"travel": "driving", "duration": "driving and service", "distance": "distance"}
    for resource, word in words.items():
        who = _vehicles(problem.vehicle_limit)
        why = f"even by the shortest move to each, the required sites take more {word} in total than {who} may spend"
        yield _evidence(problem, "too-little-range", why, resource=resource)


def _hours(problem: RoutingProblem) -> Iterator[Evidence]:
    """The two moments between which the required sites ask for most more time than the fleet has."""
    vehicles, sites, customers = problem.vehicle_limit, problem.sites, problem.customers
    wanted = customers[sites.required[customers]]
    if vehicles is None or len(wanted) <= vehicles:
        return
    times, worst, at = problem.travel.durations, 0.0, (0.0, 0.0)
    with np.errstate(over="ignore", invalid="ignore"):
        begin = np.min([np.maximum(sites.ready[wanted], sites.ready[v.start] + times[v.start, wanted]) for v in problem.fleet], axis=0)
        close = [np.minimum(sites.due[wanted], sites.due[v.end] - sites.service[wanted] - times[wanted, v.end]) for v in problem.fleet]
        end, moves = np.max(close, axis=0), times[np.ix_(customers, wanted)] + np.where(customers[:, None] == wanted, math.inf, 0.0)
        work, reach = sites.service[wanted], moves.min(axis=0)
        order = np.argsort(end, kind="stable")
        for low in np.unique(begin).tolist():
            inside = order[(begin[order] >= low) & np.isfinite(end[order])]
            free = np.sort(work[inside])[-vehicles:].sum() + np.sort(reach[inside])[-vehicles:].sum()
            excess = np.cumsum(work[inside] + reach[inside]) - free - vehicles * (end[inside] - low)
            if len(inside) and excess.max() > worst:
                worst, at = float(excess.max()), (float(low), float(end[inside[np.argmax(excess)]]))
    if worst > 0.0:
        low, high = at
        names = [sites.ids[k] for k in wanted[(begin >= low) & (end <= high)].tolist()]
        why = (
            f"these {len(names)} sites can only be begun from {moment_told(problem.clock, low)} to {moment_told(problem.clock, high)}, "
            f"and keep {_vehicles(vehicles)} busy for longer than that"
        )
        yield _evidence(problem, "too-little-time", f"{why}: {', '.join(names)}", sites=names, **{"from": low, "until": high})


def _sites_apart(problem: RoutingProblem) -> Iterator[Evidence]:
    """Sets of sites of which no two fit on one route, for each choice of vehicle types that alone can serve them."""
    wanted, fleet = np.nonzero(problem.sites.required)[0], problem.fleet
    if len(wanted) < 2 or len(problem.sites) > LARGEST_CLIQUE_DATA or all(v.count is None for v in fleet):
        return
    alone, fits = _compatible(problem, wanted)
    everyone = tuple(range(len(fleet)))
    choices = [c for k in range(1, len(fleet)) for c in itertools.combinations(everyone, k)] if len(fleet) <= _MOST_TYPES else []
    for kinds in [everyone, *choices]:
        counts = [fleet[k].count for k in kinds]
        if any(c is None for c in counts):
            continue
        count = sum(c or 0 for c in counts)
        theirs = np.nonzero(~alone[[k for k in everyone if k not in kinds]].any(axis=0))[0]
        apart = wanted[theirs[_largest_clique(~fits[np.ix_(theirs, theirs)])]]
        if len(apart) > count:
            names = [problem.sites.ids[k] for k in apart]
            have = (
                f"the fleet has {_vehicles(count)}"
                if kinds == everyone
                else f"only {_named(problem, kinds)}, of which there {'is 1' if count == 1 else f'are {count}'}, can serve any of them"
            )
            why = f"no two of these {len(apart)} sites fit on one route, and {have}: {', '.join(names)}"
            yield _evidence(problem, "sites-apart", why, sites=names)
            return


def _small_groups(problem: RoutingProblem, stopped: Callable[[], bool], most: int) -> Iterator[Evidence]:
    """A smallest group of sites that no choice of routes serves: of all sites where they are few, else of those with the least freedom."""
    customers = problem.customers
    wanted = customers[problem.sites.required[customers]]
    group = customers
    if len(customers) > most:
        if len(customers) > LARGEST_CLIQUE_DATA or not len(wanted):
            return
        _, fits = _compatible(problem, wanted)
        group = np.sort(wanted[np.argsort(fits.sum(axis=1), kind="stable")[:most]])
    if stopped() or not _beyond(problem, group):
        return
    for site in group.tolist():
        if stopped():
            break
        fewer = group[group != site]
        if len(fewer) and _beyond(problem, fewer):
            group = fewer
    names = [problem.sites.ids[k] for k in group]
    if len(names) == 1 and problem.sites.required[group[0]]:
        alone = _evidence(problem, "infeasible-site", f"no vehicle can serve site {names[0]}", site=names[0])
        if proves(problem, alone):
            yield alone
            return
    least = f" on at least {problem.min_vehicles} routes" if problem.min_vehicles > 1 else ""
    who = "the fleet" if problem.vehicle_limit is None else _vehicles(problem.vehicle_limit)
    what = f"these {len(names)} sites" if len(names) > 1 else "this site"
    yield _evidence(problem, "sites-beyond-fleet", f"no choice of routes lets {who} serve {what}{least}: {', '.join(names)}", sites=names)


def _beyond(problem: RoutingProblem, group: Integers) -> bool:
    return proves(problem, _evidence(problem, "sites-beyond-fleet", "", sites=[problem.sites.ids[k] for k in group]))


def _vehicles(count: int) -> str:
    return "1 vehicle" if count == 1 else f"{count} vehicles"


def _named(problem: RoutingProblem, kinds: tuple[int, ...]) -> str:
    return "vehicles of type " + " and ".join(problem.fleet[k].name for k in kinds)


def bin_packing_bound(demand: Floats, capacity: float) -> tuple[int, float]:
    """Bound L2 and its threshold ``k``: items above ``capacity - k`` share a bin with nothing of size ``k`` or more."""
    if capacity <= 0:
        return len(demand), 0.0
    if capacity == math.inf:
        return min(len(demand), 1), 0.0
    best, at = math.ceil(math.fsum(demand) / capacity - 1e-9), 0.0
    for k in [*np.unique(demand[demand <= capacity / 2.0]).tolist(), capacity / 2.0]:
        huge, large = demand > capacity - k, (demand > capacity / 2.0) & (demand <= capacity - k)
        small = (demand >= k) & (demand <= capacity / 2.0)
        rest = math.fsum(demand[small]) - (int(large.sum()) * capacity - math.fsum(demand[large]))
        need = int(huge.sum() + large.sum()) + max(0, math.ceil(rest / capacity - 1e-9))
        if need > best:
            best, at = need, k
    return best, at


def _compatible(problem: RoutingProblem, wanted: Integers) -> tuple[Flags, Flags]:
    """Which vehicle type may serve each site, shape (types, wanted), and whether two sites may share a route of some vehicle.

    Times between sites are those of shortest ways without service on the way, so that no other visit can make a pair fit.
    """
    travel, alone, fits = problem.travel, [], np.zeros((len(wanted), len(wanted)), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        time = shortest_ways(travel.durations, problem.customers)
        ways = {"time": time, "travel": time}
        ways["distance"] = time if not travel.own_durations else shortest_ways(travel.distances, problem.customers)
        grid = np.ix_(wanted, wanted)
        for v in problem.fleet:
            one = {name: (w[v.start, wanted], w[wanted, v.end]) for name, w in ways.items()}
            two = {name: (w[v.start, wanted, None], w[grid], w[None, wanted, v.end]) for name, w in ways.items()}
            single = _keeps(least_use(problem.sites, v, [wanted], one.__getitem__))
            ordered = _keeps(least_use(problem.sites, v, [wanted[:, None], wanted[None, :]], two.__getitem__))
            alone.append(single)
            fits |= (ordered | ordered.T) & single[:, None] & single[None, :]
    return np.array(alone), fits


def _keeps(uses: Iterable[Use]) -> Flags:
    """Mask of the entries for which no limit is exceeded."""
    return functools.reduce(np.logical_and, (use.least <= widened(use.most) for use in uses))


def _largest_clique(edges: Flags) -> Integers:
    """A large set of which all pairs are joined: greedy from the nodes of highest degree."""
    edges = edges.copy()
    np.fill_diagonal(edges, False)
    degree = edges.sum(axis=1)
    best: list[int] = []
    for seed in np.argsort(-degree, kind="stable")[:_SEEDS].tolist():
        if degree[seed] < len(best):
            break
        clique, candidates = [seed], edges[seed].copy()
        while candidates.any():
            inside = np.where(candidates, edges[:, candidates].sum(axis=1), -1)
            node = int(np.argmax(inside))
            clique.append(node)
            candidates &= edges[node]
        if len(clique) > len(best):
            best = clique
    return np.sort(np.array(best, dtype=np.int64))
