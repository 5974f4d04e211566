"""Evidence that there is no answer; and ``vehicles-needed``, the routes that loads ask for at least.

``infeasible-site``   no vehicle of any type can serve a required site
``too-few-vehicles``  the required demands exceed all capacities
``bin-packing``       the bound L2 on the vehicles for the required demands exceeds the fleet
``too-little-range``  driving, driving and service, or distance of all required sites exceed what the fleet has
``too-little-time``   the named sites can only be begun between two moments, and keep the fleet busy for longer than that
``sites-apart``       no two of the named sites fit on one route, and there are fewer vehicles that can serve them
``sites-beyond-fleet``  no choice of routes serves the few sites named
``too-few-sites``     more routes are asked for than there are sites within reach

In formulas: docs/formulations/routing.md#proofs-that-there-is-no-answer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ...checking.evidence_numbers import number
from .known_features import Flags, Integers, least_moves, routing_evidence, unknown_features, without_stops
from .round_trips import least_peak
from .route_limits import Limits, able, allowed, clocks, limits_of, named_customers, servable_sets, summable, within_reach, within_stores
from .vehicle_moves import terms_of

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


MOST_DETOURS = 5_000
"""Customers among whom ways over others are looked for."""


@routing_evidence("infeasible-site", "an unreachable site is")
def check_infeasible_site(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if no route of any vehicle can visit the required ``site`` (its id) of ``data``; else nothing is proved."""
    name = data.get("site")
    index = problem.sites.index()
    if not isinstance(name, str) or name not in index:
        raise InputError("evidence names an unknown site", "unknown-name", expected="the id of a site", found=str(name)[:80])
    if not problem.sites.required[index[name]] or not summable(without_stops(problem)):
        return verdict(proved=False)
    return verdict(proved=not _can_be_served(problem, named_customers(problem, [name])[0]))


def out_of_reach(problem: RoutingProblem) -> Flags:
    """Sites that are shown here to be on no route of any vehicle, required or not; shape (sites,)."""
    beyond, customers, relaxed = np.zeros(len(problem.sites), dtype=bool), problem.sites.customers, without_stops(problem)
    if unknown_features(relaxed):
        return beyond
    if len(customers) > MOST_DETOURS:  # no matrix of moves: the demand alone tells
        beyond[customers] = problem.sites.demand[customers] > max(allowed(v.capacity) for v in problem.fleet)
    elif summable(relaxed):
        beyond[customers] = ~np.any([near for _, near in _reached(problem, relaxed)], axis=0)
    return beyond


def verdict(*, proved: bool) -> float:
    """Bound of a proof that there is no answer, and of no proof."""
    return math.inf if proved else -math.inf


def _reached(problem: RoutingProblem, relaxed: RoutingProblem) -> Iterator[tuple[Limits, Flags]]:
    """The limits of each vehicle type ``without_stops``, and the customers that it may be able to visit."""
    for vehicle, unstopped in zip(problem.fleet, relaxed.fleet, strict=True):
        limits = limits_of(relaxed, unstopped)
        yield limits, within_reach(limits) & able(problem, vehicle) & within_stores(problem, vehicle)


def _can_be_served(problem: RoutingProblem, node: int) -> bool:
    for limits, near in _reached(problem, without_stops(problem)):
        if near[node - 1]:
            others = np.nonzero(near)[0] + 1
            if servable_sets(limits, np.array([node]), others[others != node], 1):
                return True
    return False


MOST_ORDERS = 200_000
"""Orders of the named sites, times types of vehicle, up to which every choice of routes is tried: 8 sites of 4 types, 7 of 39."""

MOST_COVERS = 100_000
"""Ways of using the fleet that are kept at most."""

MOST_APART = 500
"""Sites of which all pairs are tried."""

RESOURCES = ("travel", "duration", "distance")

SUBJECT = "a fleet too small is"


def bins_needed(demand: list[float], capacity: float, k: float) -> int:
    """The bound L2 on bins at a threshold k: what is above ``capacity - k`` shares its bin with nothing of size k or more.

    Source: Martello and Toth 1990, *Knapsack Problems*, section 8.3.
    """
    huge = [d for d in demand if d > capacity - k]
    large = [d for d in demand if capacity / 2 < d <= capacity - k]
    small = [d for d in demand if k <= d <= capacity / 2]
    rest = math.fsum([*small, *large]) - len(large) * capacity
    return len(huge) + len(large) + max(0, math.ceil(rest / capacity - 1e-9))


def _types(problem: RoutingProblem) -> dict[VehicleType, int]:
    """Types of vehicle that differ in what they can do, and how many of each can be on a route at once."""
    n = len(problem.sites.customers)
    types: dict[VehicleType, int] = {}
    for v in problem.fleet:
        kind = replace(v, count=None, name="", fixed_cost=0.0, unit_cost=1.0, committed=False)
        types[kind] = min(n, types.get(kind, 0) + (n if v.count is None else v.count))
    return types


@routing_evidence("too-few-vehicles", SUBJECT)
def check_too_few_vehicles(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if all vehicles together cannot carry the demand of the required sites; nothing of ``data`` is read."""
    if not summable(problem):
        return verdict(proved=False)
    total = math.fsum(problem.sites.demand[problem.sites.required])
    room = math.fsum(count * allowed(v.capacity) for v, count in _types(problem).items())
    return verdict(proved=total * (1 - 1e-12) > room)


@routing_evidence("bin-packing", SUBJECT)
def check_bin_packing(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if the required demands need more vehicles than there are, by the bound L2 at ``data``'s ``threshold``."""
    k = data.get("threshold")
    if isinstance(k, bool) or not isinstance(k, int | float) or not math.isfinite(k):
        raise InputError("evidence of bin packing has no finite threshold", "out-of-range", found=str(k)[:80])
    largest = allowed(max(v.capacity for v in problem.fleet))
    if not summable(problem) or not 0 < largest < math.inf or not 0 <= k <= largest / 2:
        return verdict(proved=False)
    demand = problem.sites.demand[problem.sites.required].tolist()
    return verdict(proved=bins_needed(demand, largest, k) > sum(_types(problem).values()))


@routing_evidence("too-little-range", SUBJECT)
def check_too_little_range(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if the required sites use more of ``resource``, each counted with the shortest move to it, than the fleet has.

    ``data``: ``resource``, one of ``travel`` (time on the move), ``duration`` (and service) and ``distance``.
    """
    resource = data.get("resource")
    if resource not in RESOURCES:
        raise InputError("evidence names an unknown resource", "unknown-name", expected=", ".join(RESOURCES), found=str(resource)[:80])
    sites, customers = problem.sites, problem.sites.customers
    if not summable(problem) or not sites.required.any():
        return verdict(proved=False)
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
    return verdict(proved=math.fsum(used) * (1 - 1e-12) > room)


@routing_evidence("too-little-time", SUBJECT)
def check_too_little_time(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if the required ``sites`` must be begun between ``from`` and ``until``, and ask for more time than there is.

    Of a vehicle's sites among them, all but the last are served, and all but the first driven to, before the last one begins.
    """
    moments = [data.get("from"), data.get("until")]
    low, high = (float(x) if isinstance(x, int | float) and not isinstance(x, bool) else math.nan for x in moments)
    if not math.isfinite(low) or not math.isfinite(high):
        raise InputError("evidence names no two moments", expected="numbers from and until", found=str(moments)[:80])
    named = np.array(named_customers(problem, data.get("sites"))) - 1
    sites, at = problem.sites, problem.sites.customers
    earliest, latest, size, rounding = np.full(len(at), math.inf), np.full(len(at), -math.inf), 0.0, 0.0
    if not summable(problem) or len(at) < 2:
        return verdict(proved=False)
    for vehicle in _types(problem):
        limits = limits_of(problem, vehicle)
        reached, home = clocks(limits)
        earliest = np.minimum(earliest, reached)
        latest = np.maximum(latest, np.minimum(limits.due[1:-1], limits.due[-1] - home))
        size, rounding = max(size, limits.horizon), max(rounding, limits.rounding)
    if not (sites.required[at] & (earliest >= low) & (latest <= high))[named].all():
        return verdict(proved=False)
    moves = least_moves(problem)[1][np.ix_(at, at)].copy()
    np.fill_diagonal(moves, math.inf)
    vehicles = min(sum(_types(problem).values()), len(named))
    service, reach = np.sort(sites.service[at[named]]), np.sort(moves[:, named].min(axis=0))
    kept = len(named) - vehicles
    need = math.fsum([*service[:kept].tolist(), *reach[:kept].tolist()])
    room = vehicles * max(0.0, allowed(high, size, rounding) - low)
    return verdict(proved=need * (1 - 1e-12) > room)


@routing_evidence("sites-apart", SUBJECT)
def check_sites_apart(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if no two of the required ``sites`` fit on one route, and fewer vehicles than sites can serve any of them."""
    named = np.array(named_customers(problem, data.get("sites")))
    if not summable(problem) or len(named) > MOST_APART or not problem.sites.required[problem.sites.customers[named - 1]].all():
        return verdict(proved=False)
    vehicles = 0
    for vehicle, count in _types(problem).items():
        limits = limits_of(problem, vehicle)
        near = within_reach(limits)
        mine = named[near[named - 1]]
        # Ways lead over all customers within reach, the named ones too: what joins two of them may be a third.
        sets = servable_sets(limits, mine, np.nonzero(near)[0] + 1, 2) if len(mine) else set()
        if any(mask & (mask - 1) for mask in sets):
            return verdict(proved=False)
        vehicles += count if sets else 0
    return verdict(proved=len(named) > vehicles)


@routing_evidence("sites-beyond-fleet", SUBJECT)
def check_sites_beyond_fleet(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if no choice of routes serves the few ``sites``; where all customers are named, ``min_vehicles`` counts too."""
    named, types = np.array(named_customers(problem, data.get("sites"))), _types(problem)
    if not summable(problem) or len(named) > 10 or math.factorial(len(named)) * len(types) > MOST_ORDERS:
        return verdict(proved=False)
    sets, reached = [], np.zeros(len(problem.sites.customers), dtype=bool)
    for vehicle in types:
        limits = limits_of(problem, vehicle)
        near = within_reach(limits)
        reached |= near
        sets.append(_spread(limits, named, near))
    reached[named - 1] = False
    least = 0 if reached.any() else problem.min_vehicles
    required = problem.sites.required[problem.sites.customers[named - 1]].tolist()
    return verdict(proved=not _can_cover(sets, list(types.values()), required, least))


def _spread(limits: Limits, named: Integers, near: Flags) -> list[int]:
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


@routing_evidence("too-few-sites", SUBJECT)
def check_too_few_sites(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if more routes are asked for than sites can be visited; nothing of ``data`` is read."""
    visitable = len(problem.sites.customers) - int(out_of_reach(problem).sum())
    return verdict(proved=problem.min_vehicles > visitable)


@routing_evidence("vehicles-needed")
def check_vehicles_needed(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on a level of the number of vehicles and maxima, beside costs and durations, by bin packing.

    ``data``: ``threshold``, a size of the bound L2; all vehicles are taken for as large as the largest.
    docs/formulations/routing.md#vehicles.
    """
    k, relaxed, terms = number(data, "threshold"), without_stops(problem), terms_of(problem)
    sites = problem.sites
    if problem.sense != "min" or terms is None or unknown_features(relaxed) or terms.vehicles < 0 or terms.reward or terms.penalties < 0:
        return -math.inf
    need, capacity = int(sites.required.any()), allowed(max(v.capacity for v in relaxed.fleet))
    if 0 < capacity < math.inf and 0 <= k <= capacity / 2:
        demand = sites.demand[sites.required].tolist()
        need = max(need, bins_needed(demand, capacity, k))
    fixed = min(v.fixed_cost for v in problem.fleet)
    peaks = math.fsum(w * least_peak(relaxed, peak) for peak, w in terms.peaks.items())
    return ((terms.vehicles + terms.cost * fixed) * max(need, problem.min_vehicles) + peaks) * (1.0 - 1e-15 * (terms.cost > 0 or peaks > 0))
