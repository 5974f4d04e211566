"""Evidence that there is no answer because the fleet is too small, or too many routes are asked for.

``too-few-vehicles``  the required demands exceed all capacities
``bin-packing``       the bound L2 on the vehicles for the required demands exceeds the fleet
``too-little-range``  driving, driving and service, or distance of all required sites exceed what the fleet has
``too-little-time``   the named sites can only be begun between two moments, and keep the fleet busy for longer than that
``sites-apart``       no two of the named sites fit on one route, and there are fewer vehicles that can serve them
``sites-beyond-fleet``  no choice of routes serves the few sites named
``too-few-sites``     more routes are asked for than there are sites within reach

The bound that proves infeasibility is infinity for ``min`` and minus infinity for ``max``. In formulas:
docs/formulations/routing.md#proofs-that-there-is-no-answer.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS
from .infeasible_site import out_of_reach, verdict
from .known_features import least_moves
from .route_limits import Limits, Nodes, allowed, clocks, limits_of, named_customers, servable_sets, summable, within_reach

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem

MOST_ORDERS = 200_000
"""Orders of the named sites, times types of vehicle, up to which every choice of routes is tried: 8 sites of 4 types, 7 of 39."""

MOST_COVERS = 100_000
"""Ways of using the fleet that are kept at most."""

MOST_APART = 500
"""Sites of which all pairs are tried."""

RESOURCES = ("travel", "duration", "distance")


def _refuse_others(problem: RoutingProblem) -> None:
    if problem.family != "routing":
        raise InputError("a fleet too small is evidence for routing problems", found=problem.family)


def _types(problem: RoutingProblem) -> dict[VehicleType, int]:
    """Types of vehicle that differ in what they can do, and how many of each can be on a route at once."""
    n = len(problem.sites.customers)
    found: dict[VehicleType, int] = {}
    for v in problem.fleet:
        kind = replace(v, count=None, name="", fixed_cost=0.0, unit_cost=1.0, committed=False)
        found[kind] = min(n, found.get(kind, 0) + (n if v.count is None else v.count))
    return found


@CHECKERS.register("too-few-vehicles")
def check_too_few_vehicles(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether all vehicles together cannot carry the demand of the required sites; nothing of ``data`` is read."""
    _refuse_others(problem)
    if not summable(problem):
        return verdict(problem, proved=False)
    total = math.fsum(problem.sites.demand[problem.sites.required])
    room = math.fsum(count * allowed(v.capacity) for v, count in _types(problem).items())
    return verdict(problem, proved=total * (1 - 1e-12) > room)


@CHECKERS.register("bin-packing")
def check_bin_packing(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether the required demands need more vehicles than the fleet has, by the bound L2, all as large as the largest.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``threshold``: a size k. Demands above capacity - k share no vehicle with one of k or more.

    Notes
    -----
    Source: Martello and Toth 1990, *Knapsack Problems*, section 8.3.
    """
    _refuse_others(problem)
    k = data.get("threshold")
    if isinstance(k, bool) or not isinstance(k, int | float) or not math.isfinite(k):
        raise InputError("evidence of bin packing has no finite threshold", found=str(k)[:80])
    largest = allowed(max(v.capacity for v in problem.fleet))
    if not summable(problem) or not 0 < largest < math.inf or not 0 <= k <= largest / 2:
        return verdict(problem, proved=False)
    demand = problem.sites.demand[problem.sites.required].tolist()
    huge = [d for d in demand if d > largest - k]
    large = [d for d in demand if largest / 2 < d <= largest - k]
    small = [d for d in demand if k <= d <= largest / 2]
    rest = math.fsum([*small, *large]) - len(large) * largest
    need = len(huge) + len(large) + max(0, math.ceil(rest / largest - 1e-9))
    return verdict(problem, proved=need > sum(_types(problem).values()))


@CHECKERS.register("too-little-range")
def check_too_little_range(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether the required sites use more of a resource, each counted with the shortest move to it, than the fleet has.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``resource``: ``travel`` (time on the move), ``duration`` (and service) or ``distance``.
    """
    _refuse_others(problem)
    resource = data.get("resource")
    if resource not in RESOURCES:
        raise InputError("evidence names an unknown resource", expected=", ".join(RESOURCES), found=str(resource)[:80])
    sites, customers = problem.sites, problem.sites.customers
    if not summable(problem) or not sites.required.any():
        return verdict(problem, proved=False)
    moves = least_moves(problem)[0 if resource == "distance" else 1].copy()
    np.fill_diagonal(moves, math.inf)
    must = np.nonzero(sites.required)[0]
    tails = np.union1d(customers, np.array([v.start for v in problem.fleet], dtype=np.int64))
    used = moves[np.ix_(tails, must)].min(axis=0).tolist()
    used.append(min(float(moves[customers, v.end].min()) for v in problem.fleet))
    if resource == "duration":
        used.extend(sites.service[must].tolist())
    room = 0.0
    for vehicle, count in _types(problem).items():
        limits, ends = limits_of(problem, vehicle), [allowed(vehicle.max_distance)]
        if resource != "distance":
            ends = [allowed(vehicle.max_duration, 0.0, limits.rounding), limits.latest(float(limits.due[-1])) - float(limits.ready[0])]
            if vehicle.energy is not None and (resource == "travel" or vehicle.energy.charge != "travel"):
                ends.append(allowed(vehicle.energy.capacity) / vehicle.energy.rate + limits.rounding)
        room += count * max(0.0, min(ends))
    return verdict(problem, proved=math.fsum(used) * (1 - 1e-12) > room)


@CHECKERS.register("too-little-time")
def check_too_little_time(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether the required ``sites`` can only be begun between two moments, and ask for more time than all vehicles have between them.

    Of a vehicle's sites among them, all but the last are served, and all but the first driven to, before the last one begins.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``sites``; ``from``, ``until``: the two moments.
    """
    _refuse_others(problem)
    moments = [data.get("from"), data.get("until")]
    low, high = (float(x) if isinstance(x, int | float) and not isinstance(x, bool) else math.nan for x in moments)
    if not math.isfinite(low) or not math.isfinite(high):
        raise InputError("evidence names no two moments", expected="numbers from and until", found=str(moments)[:80])
    named = np.array(named_customers(problem, data.get("sites"))) - 1
    sites, at = problem.sites, problem.sites.customers
    earliest, latest, size, rounding = np.full(len(at), math.inf), np.full(len(at), -math.inf), 0.0, 0.0
    if not summable(problem) or len(at) < 2:
        return verdict(problem, proved=False)
    for vehicle in _types(problem):
        limits = limits_of(problem, vehicle)
        reached, home = clocks(limits)
        earliest = np.minimum(earliest, reached)
        latest = np.maximum(latest, np.minimum(limits.due[1:-1], limits.due[-1] - home))
        size, rounding = max(size, limits.horizon), max(rounding, limits.rounding)
    if not (sites.required[at] & (earliest >= low) & (latest <= high))[named].all():
        return verdict(problem, proved=False)
    moves = least_moves(problem)[1][np.ix_(at, at)].copy()
    np.fill_diagonal(moves, math.inf)
    vehicles = min(sum(_types(problem).values()), len(named))
    service, reach = np.sort(sites.service[at[named]]), np.sort(moves[:, named].min(axis=0))
    kept = len(named) - vehicles
    need = math.fsum([*service[:kept].tolist(), *reach[:kept].tolist()])
    room = vehicles * max(0.0, allowed(high, size, rounding) - low)
    return verdict(problem, proved=need * (1 - 1e-12) > room)


@CHECKERS.register("sites-apart")
def check_sites_apart(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether no two of the required ``sites`` fit on one route, and fewer vehicles than sites can serve any of them."""
    _refuse_others(problem)
    named = np.array(named_customers(problem, data.get("sites")))
    if not summable(problem) or len(named) > MOST_APART or not problem.sites.required[problem.sites.customers[named - 1]].all():
        return verdict(problem, proved=False)
    vehicles = 0
    for vehicle, count in _types(problem).items():
        limits = limits_of(problem, vehicle)
        near = within_reach(limits)
        mine = named[near[named - 1]]
        # Ways lead over all customers within reach, the named ones too: what joins two of them may be a third.
        sets = servable_sets(limits, mine, np.nonzero(near)[0] + 1, 2) if len(mine) else set()
        if any(mask & (mask - 1) for mask in sets):
            return verdict(problem, proved=False)
        vehicles += count if sets else 0
    return verdict(problem, proved=len(named) > vehicles)


@CHECKERS.register("sites-beyond-fleet")
def check_sites_beyond_fleet(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether no choice of routes serves the few ``sites`` named; where all customers are, the least number of routes counts too."""
    _refuse_others(problem)
    named, types = np.array(named_customers(problem, data.get("sites"))), _types(problem)
    if not summable(problem) or len(named) > 10 or math.factorial(len(named)) * len(types) > MOST_ORDERS:
        return verdict(problem, proved=False)
    sets, reached = [], np.zeros(len(problem.sites.customers), dtype=bool)
    for vehicle in types:
        limits = limits_of(problem, vehicle)
        near = within_reach(limits)
        reached |= near
        sets.append(_spread(limits, named, near))
    reached[named - 1] = False
    least = 0 if reached.any() else problem.min_vehicles
    required = problem.sites.required[problem.sites.customers[named - 1]].tolist()
    return verdict(problem, proved=not _can_cover(sets, list(types.values()), required, least))


def _spread(limits: Limits, named: Nodes, near: NDArray[np.bool_]) -> list[int]:
    """Sets of the sites ``named`` that one route can serve, as masks over their positions."""
    place = np.nonzero(near[named - 1])[0].tolist()
    through = np.setdiff1d(np.nonzero(near)[0] + 1, named)
    sets = servable_sets(limits, named[place], through, len(place)) if place else set()
    return [sum(1 << place[k] for k in range(len(place)) if mask >> k & 1) for mask in sets]


def _can_cover(sets: list[list[int]], counts: list[int], required: list[bool], least: int) -> bool:
    """Whether disjoint sets may hold every required position, at most ``counts`` of each type and at least ``least`` in all."""
    states: dict[int, set[tuple[int, ...]]] = {0: {(0,) * len(sets)}}
    everything = (1 << len(required)) - 1
    while states:
        if sum(map(len, states.values())) > MOST_COVERS:
            return True  # for all that is known here
        done = min(states, key=lambda mask: mask.bit_count())
        used = states.pop(done)
        if done == everything:
            return any(sum(u) >= least for u in used)
        first = next(k for k in range(len(required)) if not done >> k & 1)
        if not required[first]:
            states.setdefault(done | 1 << first, set()).update(used)
        for kind, masks in enumerate(sets):
            more = {tuple(c + (j == kind) for j, c in enumerate(u)) for u in used if u[kind] < counts[kind]}
            for mask in masks if more else ():
                if mask >> first & 1 and not mask & done:
                    states.setdefault(done | mask, set()).update(more)
    return False


@CHECKERS.register("too-few-sites")
def check_too_few_sites(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Whether more routes are asked for than sites can be visited; nothing of ``data`` is read."""
    _refuse_others(problem)
    visitable = len(problem.sites.customers) - int(out_of_reach(problem).sum())
    return verdict(problem, proved=problem.min_vehicles > visitable)
