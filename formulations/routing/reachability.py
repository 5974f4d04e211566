"""Sites that no route can serve, with the proof, and the least number of routes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...instances.clock import moment_told
from ...instances.routing.reach import Use, least_use, shortest_ways, ways_alone
from ..tolerance import LIMIT, widened
from .overrun import quantile
from .routes import Flags, Floats

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem


MOST_DETOURS = 5_000
"""Customers up to which ways through others are looked at: each pass looks at all pairs."""

WORDS = {
    "load": "its demand is {:g}, the capacity {:g}",
    "pickup": "{:g} is collected there, the capacity is {:g}",
    "arrival": "it is reached at {} at the earliest, due {}",
    "return": "the return from it is at {} at the earliest, due {}",
    "duration": "a route to it lasts {:.6g} at least, the longest duration is {:g}",
    "distance": "a route to it is {:.6g} long at least, the longest distance is {:g}",
    "energy": "a route to it draws {:.6g} of energy at least ({charge}), the store holds {:g}",
    "skills": "the vehicle lacks {}",
    "store": "a way to it from one filling of the store to the next draws {:.6g} of energy at least, the store holds {:g}",
    "shipment": "the shipment from {} to {} weighs {:g}, the capacity is {:g}",
    "risk": "to keep the risk of {:g} a route to it needs {:.6g} of {} at least, the limit is {:g}",
}


def unreachable(problem: RoutingProblem) -> dict[int, str]:
    """Customers that no vehicle can serve, not even alone, and why, by site index; with several vehicle types, the reason of each.

    Ways are shortest ways through any other customers, services on the way included, and over depots where the vehicle reloads or
    recharges; only sites are named that the checker confirms to be out of reach. Beyond ``MOST_DETOURS`` customers, only those whose
    demand is too large are looked for. The mathematics: docs/formulations/routing.md#proofs-that-there-is-no-answer.
    """
    from .checking.known_features import without_stops

    relaxed = without_stops(problem)
    with np.errstate(over="ignore", invalid="ignore"):  # sums that overflow are for the checker to judge
        verdicts = [_reasons(relaxed, kind) for kind in range(len(problem.fleet))]
    for kind, reasons in enumerate(verdicts):
        for k, why in _unable(problem, kind):
            reasons[k] = reasons[k] or why
    customers = problem.customers
    reasons_by_site = {}
    for k, site in enumerate(customers.tolist()):
        reasons = [v[k] for v in verdicts]
        if all(r is not None for r in reasons):
            named = zip(problem.fleet, reasons, strict=True)
            reasons_by_site[site] = str(reasons[0]) if len(reasons) == 1 else "; ".join(f"{kind.name}: {r}" for kind, r in named)
    if not reasons_by_site:
        return {}
    from .checking.no_answer import out_of_reach

    confirmed = out_of_reach(problem)
    return {site: why for site, why in reasons_by_site.items() if confirmed[site]}


def minimum_vehicles(problem: RoutingProblem) -> int:
    """A lower bound on the number of routes of any feasible answer; one more than the fleet has where it cannot carry the demands.

    The largest vehicles together must carry all required demands, rounding and the checker's tolerance granted; every answer has at least
    ``min_vehicles`` routes, and one if any customer is required. Where vehicles reload, loads tell nothing.
    """
    sites, customers = problem.sites, problem.customers
    must = customers[sites.required[customers]]
    if len(must) == 0:
        return problem.min_vehicles
    if any(v.reloads for v in problem.fleet):
        return max(problem.min_vehicles, 1)
    with np.errstate(over="ignore"):
        if not math.isfinite(float(sites.demand[must].sum())):
            return max(problem.min_vehicles, 1)
    total = math.fsum(sites.demand[must]) * (1.0 - 1e-12)
    room, routes = 0.0, 0
    for kind in sorted(problem.fleet, key=lambda v: -v.capacity):
        capacity = float(widened(kind.capacity))
        count = len(customers) if kind.count is None else kind.count
        lacking = max(0.0, total - room)
        if lacking <= 0.0 or math.isinf(capacity):
            needed = int(lacking > 0.0)
        else:
            needed = math.ceil(lacking / capacity) if lacking <= capacity * count else count + 1
        if needed <= count:
            return max(routes + needed, problem.min_vehicles, 1)
        room, routes = room + count * capacity, routes + count
    return max(routes + 1, problem.min_vehicles)


def servable_alone(problem: RoutingProblem) -> Flags:
    """Customers that some vehicle can serve on a direct route of their own, limits compared exactly; shape (customers,)."""
    good = np.zeros(len(problem.customers), dtype=bool)
    with np.errstate(over="ignore", invalid="ignore"):
        for kind in range(len(problem.fleet)):
            safe = [least <= most for *_, least, most in _needs(problem, kind, detours=False)]
            good |= np.all([*(use.least <= use.most for use in _uses(problem, kind, detours=False)), *safe], axis=0)
    return good


def _uses(problem: RoutingProblem, kind: int, *, detours: bool) -> Iterator[Use]:
    sites, travel, at, vehicle = problem.sites, problem.travel_of(kind), problem.customers, problem.fleet[kind]
    return least_use(sites, vehicle, [at], ways_alone(vehicle, at, travel.duration, travel.distance, sites.service[at], detours=detours))


def _reasons(problem: RoutingProblem, kind: int) -> list[str | None]:
    """Why a vehicle of this type cannot serve each customer; None where nothing forbids it.

    No detour is longer than the direct way, so that shortest ways need not be known where the direct ones do.
    """
    reasons = _broken(problem, kind, detours=False)
    too_large = problem.sites.demand[problem.customers] > widened(problem.fleet[kind].capacity)
    if not any(reason is not None and not large for reason, large in zip(reasons, too_large, strict=True)):
        return reasons
    if len(reasons) > MOST_DETOURS:
        return [reason if large else None for reason, large in zip(reasons, too_large, strict=True)]
    return _broken(problem, kind, detours=True)


def _unable(problem: RoutingProblem, kind: int) -> Iterator[tuple[int, str]]:
    """Customers, by their number, that a vehicle cannot serve wherever it is, or wherever it stops on the way, and why."""
    vehicle = problem.fleet[kind]
    sites, place = problem.sites, {site: k for k, site in enumerate(problem.customers.tolist())}
    for site, k in place.items() if sites.skills else ():
        if lacking := sorted(sites.skills[site] - vehicle.skills):
            yield k, WORDS["skills"].format(", ".join(lacking))
    for shipment in sites.shipments:
        ends = (shipment.pickup, shipment.delivery)
        for load, capacity in zip(shipment.load, vehicle.capacities, strict=False):
            if load > widened(capacity):
                why = WORDS["shipment"].format(*(sites.ids[end] for end in ends), load, capacity)
                yield from ((place[end], why) for end in ends)
    yield from _unloaded(problem, vehicle) if vehicle.reloads else ()
    yield from _unlasting(problem, kind) if vehicle.stations else ()
    yield from _unsafe(problem, kind)


def _unloaded(problem: RoutingProblem, vehicle: VehicleType) -> Iterator[tuple[int, str]]:
    """Customers whose load is too large for an empty vehicle."""
    sites, at = problem.sites, problem.customers
    for word, first, further in (("load", sites.demand, sites.further_demand), ("pickup", sites.pickup, sites.further_pickup)):
        for loads, capacity in zip(np.column_stack([first, further])[at].T, vehicle.capacities, strict=False):
            for k in np.nonzero(loads > widened(capacity))[0].tolist():
                yield k, WORDS[word].format(loads[k], capacity)


def _unlasting(problem: RoutingProblem, kind: int) -> Iterator[tuple[int, str]]:
    """Customers that lie too far from start and stations."""
    vehicle, at, durations = problem.fleet[kind], problem.customers, problem.travel_of(kind).durations
    energy = vehicle.energy
    assert energy is not None
    stations = np.array(energy.stations)
    for detours in (False, True) if len(at) <= MOST_DETOURS else ():
        ways = shortest_ways(durations, at) if detours else durations
        filled = ways[np.ix_(stations, at)].min(axis=0)
        last = energy.rate * np.minimum(ways[np.ix_(at, stations)].min(axis=1), ways[at, vehicle.end])
        lacking = energy.capacity - energy.at_departure  # as if it were drawn on the way from the start
        least = last + np.minimum(energy.rate * filled, energy.rate * ways[vehicle.start, at] + lacking)
        beyond = np.nonzero(least > widened(energy.capacity) + LIMIT * least)[0].tolist()
        if not beyond:
            return
    for k in beyond if len(at) <= MOST_DETOURS else ():
        yield k, WORDS["store"].format(least[k], energy.capacity)


def _unsafe(problem: RoutingProblem, kind: int) -> Iterator[tuple[int, str]]:
    """Customers that no route serves which keeps the risk."""
    if len(problem.customers) > MOST_DETOURS:
        return
    for detours in (False, True):
        needs = list(_needs(problem, kind, detours=detours))
        beyond = [np.nonzero(least > widened(most) + LIMIT * least)[0].tolist() for *_, least, most in needs]
        if not any(beyond):
            return
    for (risk, name, least, most), sites in zip(needs, beyond, strict=True):
        yield from ((k, WORDS["risk"].format(risk, least[k], name, most)) for k in sites)


def _needs(problem: RoutingProblem, kind: int, *, detours: bool) -> Iterator[tuple[float, str, Floats, float]]:
    """Risk, name, what a route to each customer needs at least of a limit on uncertain durations, and that limit."""
    vehicle, travel, at = problem.fleet[kind], problem.travel_of(kind), problem.customers
    risks = [risk for risk in (vehicle.risk, problem.team_risk) if risk is not None]
    if not risks or travel.variances is None or not travel.uncertain or vehicle.stations:
        return

    def there_and_back(moves: Floats) -> Floats:
        ways = shortest_ways(moves, at) if detours else moves
        return np.asarray(ways[vehicle.start, at] + ways[at, vehicle.end])

    moving, risk = there_and_back(travel.durations), min(risks)
    lasting, deviation = moving + problem.sites.service[at], quantile(risk) * np.sqrt(there_and_back(travel.variances))
    if math.isfinite(vehicle.max_duration):
        yield risk, "duration", lasting + deviation, vehicle.max_duration
    energy = vehicle.energy
    if energy is not None:
        drawn = moving if energy.charge == "travel" else lasting
        yield risk, "energy", energy.rate * (drawn + deviation), energy.at_departure


def _broken(problem: RoutingProblem, kind: int, *, detours: bool) -> list[str | None]:
    reasons: list[str | None] = [None] * len(problem.customers)
    energy = problem.fleet[kind].energy
    charge = "" if energy is None else energy.charge
    for use in _uses(problem, kind, detours=detours):
        most = np.broadcast_to(np.asarray(use.most, dtype=np.float64), len(reasons))
        for k in np.nonzero(use.least > widened(most) + LIMIT * np.abs(use.least))[0].tolist():
            amounts = float(use.least[k]), float(most[k])
            shown = [moment_told(problem.clock, at) for at in amounts] if use.limit in ("arrival", "return") else amounts
            reasons[k] = reasons[k] or WORDS[use.limit].format(*shown, charge=charge)
    return reasons
