"""Evidence ``customer-sets``: the cheapest route of each type of vehicle through each set of a few customers, and the best of all ways to
divide the customers among routes.

Routes are relaxed one limit at a time: a set is ruled out where the least level of some resource, over all orders of its members, breaks
a limit, and its cost is the least over all orders that no level by itself rules out. Where the objective weighs the largest of all routes
with other terms, limits on the largest route divide the answers: of those whose largest route lies between two of them, it costs the
lower at least, and no route is beyond the upper. docs/formulations/routing.md#customer-sets.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.routing.vehicle_type import VehicleType
from ...checking.granularity import lift
from ...stop import current_stop
from ..problem import RoutingProblem
from .known_features import EPS, Floats, Integers, departure, own_moves, routing_evidence, unknown_features, with_fleet, without_stops
from .relaxation import with_depot
from .round_trips import least_peak
from .vehicle_moves import Terms, VehicleMoves, alike, constants, terms_of, value_grain

CUSTOMERS = 16
"""More are not looked at: their sets are too many."""

WORK = 4_000_000_000
"""Sets of customers that are joined in one proof at most, some 5 s."""

LIMITS = 64
"""On the largest route, at most."""

JOINED = ("longest-route", "makespan")
"""Maxima that are told set by set."""


def joined_peak(terms: Terms) -> str:
    """The maximum that is counted set by set; empty if there is none."""
    return next((name for name in JOINED if name in terms.peaks), "")


@dataclass(frozen=True, eq=False)
class CustomerSets:
    """Least costs of routes through sets of customers; a set is a bit mask over the customers in site order.

    ``types`` has for each type of vehicle its sets, what each adds to the objective at least, its least length or duration (by which the
    largest route is told), and the number of vehicles. ``ends`` are the sets that an answer may visit in all, ``fewest`` its least number
    of routes, ``fixed`` what routes do not change, ``weight`` and ``least`` those of the largest route in the objective; sums of values
    are wrong by ``error`` at most, one peak by ``blur``.
    """

    types: list[tuple[Integers, Floats, Floats, int]]
    ends: Integers
    fewest: int
    fixed: float
    weight: float
    least: float
    error: float
    blur: float
    customers: int

    @classmethod
    def of(cls, problem: RoutingProblem, terms: Terms) -> "CustomerSets | None":
        """None where a search for routes was stopped, or numbers are too large to add up."""
        relaxed, sites, customers = without_stops(problem), problem.sites, problem.sites.customers
        n = len(customers)
        peak = joined_peak(terms)
        others = replace(terms, peaks={name: w for name, w in terms.peaks.items() if name != peak})
        node = {site: k for k, site in enumerate(customers.tolist())}
        masks = np.arange(1 << n)
        whole, ends = np.ones(1 << n, dtype=bool), np.ones(1 << n, dtype=bool)
        before = np.zeros(n, np.int64)
        for s in sites.shipments:
            first, then = node[s.pickup], node[s.delivery]
            before[then] |= 1 << first
            whole &= (masks >> first & 1) == (masks >> then & 1)
        for group in sites.groups:
            visits = sum(masks >> node[site] & 1 for site in group.sites)
            whole &= visits <= 1
            ends &= (visits == 1) if group.required else (visits <= 1)
        must = sum(1 << node[site] for site in customers[sites.required[customers]].tolist())
        ends &= masks & must == must
        kinds = alike(problem)
        if not all(_opens_at_once(problem, v) for v in kinds if v.reloads):
            return None
        if len(kinds) * max(n * n << n, max(_work_of_trips(n, v) for v in kinds)) > WORK or problem.min_vehicles > n:
            return None
        types, size, largest = [], 0.0, 0.0
        for vehicle, count in kinds.items():
            alone = without_stops(with_fleet(problem, (vehicle,)))
            values, sizes = _values(alone, others, peak, before)
            if vehicle.reloads:
                trips, more = _of_trips(problem, vehicle, others, peak)
                values, sizes = np.maximum(values, trips), np.maximum(sizes, more)
            if np.isnan(values).any() or not np.isfinite(sizes).all():
                return None
            kept = np.flatnonzero(np.isfinite(values[0]) & whole)
            types.append((kept, values[0, kept], values[1, kept], min(count, n)))
            size, largest = max(size, float(sizes[0])), max(largest, float(sizes[1]))
        parts = constants(relaxed, others)
        size += max((abs(part) for part in parts), default=0.0)
        # Each route is added up from its first move on, so that no sum is larger than nodes sizes; there are n routes at most.
        rounding = 16.0 * EPS * (n + 2) ** 2
        weight, least = terms.peaks.get(peak, 0.0), least_peak(relaxed, peak) if peak else 0.0
        if not math.isfinite(64.0 * (n + 2) ** 2 * (size + largest) * max(1.0, abs(weight))):
            return None
        fixed = math.fsum(parts)
        return cls(types, np.flatnonzero(ends), problem.min_vehicles, fixed, weight, least, rounding * size, rounding * largest, n)

    def cheapest(self, limit: float = math.inf, work: float = WORK) -> tuple[float, float]:
        """Least value without the largest route, where none is beyond ``limit``, and the work it took; NaN where that is too much."""
        from .customer_set_kernels import with_route

        best = np.full((self.fewest + 1, 1 << self.customers), math.inf)
        best[0, 0] = 0.0
        done = 0.0
        for sets, values, peaks, count in self.types:
            kept = peaks <= limit + self.blur
            mine, worth = sets[kept], values[kept]
            others = sum((~mine >> k) & 1 for k in range(self.customers))
            each = float(np.exp2(others).sum()) * len(best)
            for _ in range(count):
                done += each
                if done > work:
                    return math.nan, done
                more = with_route(current_stop().flag, best, mine, worth)
                if math.isnan(more[0, 0]):
                    return math.nan, done
                if (more == best).all():
                    break
                best = more
        return float(best[-1, self.ends].min(initial=math.inf)), done

    def bound(self, limits: Sequence[float]) -> float:
        """Bound of a minimisation whose answers are divided by ``limits`` on the largest route, in ascending order."""
        work, least = float(WORK), math.inf
        for low, high in zip([self.least, *limits], [*limits, math.inf], strict=True):
            value, done = self.cheapest(high, work)
            if math.isnan(value):
                return -math.inf
            work -= done
            least = min(least, value + self.weight * max(low, self.least))
        total = self.fixed + least
        return total - self.error - 4.0 * EPS * (abs(total) + abs(self.fixed)) if math.isfinite(total) else total


def _values(alone: RoutingProblem, terms: Terms, peak: str, before: Integers) -> tuple[Floats, Floats]:
    """Value, and length or duration, of the routes of a fleet of one through each set, and the sizes of what they are added up from."""
    from .customer_set_kernels import set_values

    (vehicle,), sites, n = alone.fleet, alone.sites, len(alone.sites.customers)
    moves = VehicleMoves.of(alone, vehicle, terms, np.zeros(n), {})
    far, move = own_moves(alone, vehicle)
    service = np.concatenate([[0.0], sites.service[sites.customers]])
    lengths = with_depot(alone, move, service) if peak == "makespan" else with_depot(alone, far if peak else 0.0 * far, 0.0 * service)
    limits = [r for name, r in moves.resources.items() if name != "order"]
    usable = np.isfinite(moves.cost)
    nothing = np.where(usable, 0.0, math.inf)
    values = set_values(
        current_stop().flag, np.ascontiguousarray([moves.cost, np.where(usable, lengths, math.inf)]),
        np.ascontiguousarray([r.weight + nothing for r in limits]).reshape(len(limits), *usable.shape),
        np.array([r.start for r in limits]), np.ascontiguousarray([r.lower for r in limits]),
        np.ascontiguousarray([r.upper + r.slack for r in limits]), before,
    )  # fmt: skip
    return values, np.array([moves.size, float(np.abs(lengths).max())])


def _work_of_trips(n: int, vehicle: VehicleType) -> float:
    """Number of sets that are joined for a vehicle that reloads."""
    stops = set(vehicle.reloads)
    return len(stops | {vehicle.start, vehicle.end}) * len(stops | {vehicle.end}) * (n + 1) * 3.0**n if stops else 0.0


def _opens_at_once(problem: RoutingProblem, vehicle: VehicleType) -> bool:
    """Whether trips count their time from one moment, as the judge counts the route's."""
    return len({departure(problem, replace(vehicle, start=depot)) for depot in (vehicle.start, *vehicle.reloads)}) == 1


def _of_trips(problem: RoutingProblem, vehicle: VehicleType, terms: Terms, peak: str) -> tuple[Floats, Floats]:
    """``_values`` of a vehicle that reloads: as many trips between depots as it may make, each with its own load.

    What is carried over a stop may be delivered on a later trip.
    """
    from .customer_set_kernels import with_route

    n = len(problem.sites.customers)
    stops, depots = set(vehicle.reloads), sorted({vehicle.start, vehicle.end, *vehicle.reloads})
    free, sizes, energy = replace(terms, vehicles=0.0), np.zeros(2), vehicle.energy
    if energy and energy.charge == "elapsed-fixed-start":  # later trips begin later, where the store has lost nothing more
        energy = replace(energy, charge="elapsed")
    table: dict[tuple[int, int], tuple[Integers, Floats]] = {}
    for a in depots:
        for b in stops | {vehicle.end}:
            trip = replace(vehicle, count=1, start=a, end=b, reloads=(), max_reloads=None, fixed_cost=0.0, energy=energy)
            values, size = _values(without_stops(with_fleet(problem, (trip,))), free, peak, np.zeros(n, np.int64))
            if np.isnan(values[0, 0]):
                return values, size
            kept = np.flatnonzero(np.isfinite(values[0]))
            table[a, b] = kept, values[:, kept]
            sizes = np.maximum(sizes, size)
    far, move = (matrix[np.ix_(depots, depots)] for matrix in own_moves(problem, vehicle))
    paid = terms.cost * vehicle.unit_cost * far + (terms.cost * vehicle.unit_duration_cost + terms.duration) * move
    least = np.full((2, 1 << n), math.inf)
    for c, between in enumerate((paid, move if peak == "makespan" else far)):
        sizes[c] = max(sizes[c], float(between.max()))
        at = np.full((len(depots), 1 << n), math.inf)  # least by where the next trip begins, and who was visited
        at[depots.index(vehicle.start), 0] = 0.0
        for trips in itertools.count(1):
            after = at.copy()
            for (a, b), (sets, values) in table.items():
                i, k = depots.index(a), depots.index(b)
                joined = with_route(current_stop().flag, at[i][None, :], sets, np.ascontiguousarray(values[c]))[0]
                if math.isnan(joined[0]):
                    return np.full((2, 1 << n), math.nan), sizes
                np.minimum(joined, at[i] + between[i, k], out=joined)  # a trip may visit nobody
                if b == vehicle.end:
                    np.minimum(least[c], joined, out=least[c])
                if b in stops:
                    np.minimum(after[k], joined, out=after[k])
            if trips - 1 == vehicle.max_reloads or (after == at).all():
                break
            at = after
    least[0] += terms.cost * vehicle.fixed_cost + terms.vehicles
    least[:, 0] = math.inf  # a route visits somebody
    return least, sizes + abs(terms.cost * vehicle.fixed_cost + terms.vehicles)


@routing_evidence("customer-sets", "customer-sets are")
def check_customer_sets(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective; minus infinity beyond 16 customers, or where it is too much work.

    ``data``: ``longest-route`` or ``makespan``, optional: at most 64 limits on the largest route by which the answers are divided.

    Source: Held, Karp (1962) for the sets.
    """
    terms = terms_of(problem)
    peak = "" if terms is None else joined_peak(terms)
    stated = data.get(peak, []) if peak else []
    if not isinstance(stated, list) or len(stated) > LIMITS or any(isinstance(x, bool) or not isinstance(x, int | float) for x in stated):
        raise InputError("evidence 'limits' must be a list of numbers", expected=f"at most {LIMITS}", found=str(stated)[:80])
    limits = sorted(map(float, stated))
    if not all(map(math.isfinite, limits)):
        raise InputError("evidence 'limits' must be finite", "out-of-range", found=str(stated)[:80])
    if terms is None or unknown_features(without_stops(problem)) or not 0 < len(problem.sites.customers) <= CUSTOMERS:
        return -math.inf
    with np.errstate(over="ignore", invalid="ignore"):
        sets = CustomerSets.of(problem, terms)
        bound = -math.inf if sets is None else sets.bound(limits)
    return lift(bound, "min", value_grain(problem, terms)) if math.isfinite(bound) else bound
