"""The brute force of routing: all routes of all vehicle types, and all ways to put them together, in whole numbers.

All tests that ask for the truth of a small routing problem ask here. It shares no code with the package's judge, forms and checkers.
Besides what keeps every limit exactly it knows what exceeds none by more than 1e-9 of it, for sums of doubles that meet a limit may
come out a rounding above.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from statistics import NormalDist
from typing import Any

import numpy as np

from waybound import Route, Routes, RoutingProblem, Travel, VehicleType

from .base import PARTS, Truth, Values, ints, scale_of


def nearly(test: tuple[int, int | None, int]) -> bool:
    """Check that a value is within a limit (None: there is none) but for 1e-9 of it, or of the size of what was added up."""
    value, limit, size = test
    return limit is None or value <= limit or (value - limit) * PARTS <= max(abs(limit), size)


@dataclass(frozen=True)
class Driven:
    """The totals of one route, in whole units; ``strict`` tells whether it keeps every limit exactly."""

    strict: bool
    cost: int
    reward: int
    distance: int
    duration: int
    finish: int
    overrun: float = 0.0


def unit_of(problem: RoutingProblem, ways: list[Travel], speeds: list[Any]) -> int:
    """The least power of two of which all numbers of a problem, times it, are whole."""
    s = problem.sites
    limits = [
        (
            *v.capacities, v.max_duration, v.max_distance, v.regular_duration, v.fixed_cost, v.unit_cost, v.unit_duration_cost,
            v.unit_overtime_cost, *v.shift,
        )
        for v in problem.fleet
    ]  # fmt: skip
    stores = [(v.energy.capacity, v.energy.rate, v.energy.at_departure) for v in problem.fleet if v.energy]
    loads = [x.load for x in s.shipments]
    windows = [t for w in s.windows for pair in w for t in pair]
    weights = [w for level in problem.objective.levels() for w, _ in level.terms]
    closes = [w.closing for w in ways if w.closing is not None]
    return scale_of(
        s.demand, s.further_demand, s.pickup, s.further_pickup, s.ready, s.due, s.service, s.reward, s.penalty, windows,
        *[x for row in (*limits, *stores, *loads) for x in row], weights, *[w.distances for w in ways], *speeds, *closes,
    )  # fmt: skip


class Roads:
    """The data of a problem in whole numbers, and the routes that its vehicles can drive.

    Between two customers, and at its ends, a route is tried with no stop at the same depot twice: a way through depots may be shorter than
    the move, where the triangle inequality fails. ``drive`` knows more stops.
    """

    def __init__(self, problem: RoutingProblem) -> None:
        s, fleet = problem.sites, problem.fleet
        ways = [problem.travel if v.travel is None else v.travel for v in fleet]
        speeds = [w.durations / v.speed for w, v in zip(ways, fleet, strict=True)]
        self.unit = u = unit_of(problem, ways, speeds)
        self.d, self.t = [ints(w.distances, u) for w in ways], [ints(t, u) for t in speeds]
        self.variances = [
            None if w.variances is None else [[Fraction(x) for x in row] for row in (w.variances / v.speed / v.speed).tolist()]
            for w, v in zip(ways, fleet, strict=True)
        ]
        self.team_risk = problem.team_risk
        self.closes: list[Any] = [None if w.closing is None else ints(w.closing, u) for w in ways]
        self.demand = [ints(a, u) for a in (s.demand, *s.further_demand.T)]
        self.pickup = [ints(a, u) for a in (s.pickup, *s.further_pickup.T)]
        self.reward, self.service, self.penalty = (ints(a, u) for a in (s.reward, s.service, s.penalty))
        self.ready, self.due = ints(s.ready, u), ints(s.due, u)
        self.windows = [[(ints(a, u), ints(b, u)) for a, b in w] for w in s.windows] or [[] for _ in s.ids]
        self.windows = [w or [(a, b)] for w, a, b in zip(self.windows, self.ready, self.due, strict=True)]
        self.shipments = [(x.pickup, x.delivery, [ints(v, u) for v in x.load]) for x in s.shipments]
        self.loaded = {
            k for k, both in enumerate(zip(self.demand, self.pickup, strict=True)) if any(any(a) for a in both) or self.shipments
        }
        self.skills: Sequence[frozenset[str]] = s.skills or [frozenset()] * len(s)
        self.fleet, self.depot, self.forbidden = fleet, s.depot, problem.forbidden
        self.customers = [k for k in range(len(s)) if not s.depot[k]]
        self.clock, self.early = 0, "objective:latest-return" in problem.features()

    def routes(self, kind: int) -> Iterator[tuple[tuple[int, ...], Driven]]:
        """Every route that vehicles of type ``kind`` can drive, and no part of one that distance or a window rules out already.

        That of a committed vehicle without any site comes first.
        """
        vehicle = self.fleet[kind]
        pauses = sorted({*vehicle.reloads, *vehicle.stations})
        if vehicle.committed:
            driven = self._drive(kind, ())
            if driven is not None:
                yield (), driven
        begun: list[tuple[int, ...]] = [()]
        while begun:
            visits = begun.pop()
            since = list(itertools.takewhile(lambda k: self.depot[k], reversed(visits)))
            for site in [*self.customers, *(k for k in pauses if k not in since)]:
                if self.depot[site] or (site not in visits and self.skills[site] <= vehicle.skills):
                    longer = (*visits, site)
                    if self._on_the_way(kind, longer):
                        begun.append(longer)
                        driven = self.drive(kind, longer)
                        if driven is not None:
                            yield longer, driven

    def drive(self, kind: int, visits: tuple[int, ...]) -> Driven | None:
        """The totals of a route with these stops; None where it serves nobody, or may not be driven."""
        vehicle = self.fleet[kind]
        served = [k for k in visits if not self.depot[k]]
        allowed = all(k in (*vehicle.reloads, *vehicle.stations) for k in visits if self.depot[k])
        allowed &= all(self.skills[k] <= vehicle.skills for k in visits)
        order = all(p not in visits or q not in visits or visits.index(p) < visits.index(q) for p, q, _ in self.shipments)
        return self._drive(kind, visits) if served and allowed and order else None

    def _on_the_way(self, kind: int, visits: tuple[int, ...]) -> bool:
        """Check that a route may begin so: none of these totals grows less by going on."""
        vehicle = self.fleet[kind]
        stops = (vehicle.start, *visits)
        if self.forbidden is not None and any(self.forbidden[i, j] for i, j in itertools.pairwise(stops)):
            return False
        if any(last in visits and first not in visits[: visits.index(last)] for first, last, _ in self.shipments):
            return False
        tests = [(sum(self.d[kind][i][j] for i, j in itertools.pairwise(stops)), ints(vehicle.max_distance, self.unit), 0)]
        if not vehicle.reloads:
            tests.append((sum(self.demand[0][i] for i in visits if not self.depot[i]), ints(vehicle.capacity, self.unit), 0))
        return all(nearly(test) for test in [*tests, *self._run(kind, stops, self._opening(vehicle))[1]])

    def _opening(self, vehicle: VehicleType) -> int:
        shift, ready = ints(vehicle.shift[0], self.unit), int(self.ready[vehicle.start])
        return ready if shift is None else max(ready, shift)

    def _run(self, kind: int, stops: tuple[int, ...], departure: int, home: bool = False) -> tuple[int, list[Any]]:
        """Clock at the last stop, service not begun if it is the return, and what the times are compared with."""
        tests: list[Any] = []
        clock, largest = departure, abs(departure)
        for k, (i, j) in enumerate(itertools.pairwise(stops)):
            leaves = clock + (self.service[i] if k else 0)
            largest = max(largest, abs(leaves))
            if self.closes[kind] is not None:
                tests.append((leaves, self.closes[kind][i][j], largest))
            clock = leaves + self.t[kind][i][j]
            largest = max(largest, abs(clock))
            if home and k == len(stops) - 2:
                shift = ints(self.fleet[kind].shift[1], self.unit)
                tests += [(clock, self.due[j], largest), (clock, shift, largest)]
                break
            # The first window that is not over; where all are, the last one is missed.
            opens, ends = next((w for w in self.windows[j] if nearly((clock, w[1], largest))), (None, self.windows[j][-1][1]))
            tests.append((clock, ends, largest))
            clock = clock if opens is None else max(clock, opens)
            largest = max(largest, abs(clock))
        self.clock = max(self.clock, largest)
        return clock, tests

    def _departures(self, kind: int, stops: tuple[int, ...], busy: list[int]) -> list[int]:
        """Among them is one from which the route takes least time: the earliest, and those that meet an end of a window exactly."""
        vehicle = self.fleet[kind]
        opens, latest = self._opening(vehicle), self.due[vehicle.start]
        times, before = {opens, latest}, 0
        for k, j in enumerate(stops[:-1]):
            ends = [t for w in self.windows[j] for t in w] if k else [self.due[j]]
            if self.closes[kind] is not None:
                close = self.closes[kind][j][stops[k + 1]]
                ends.append(None if close is None else close - (self.service[j] if k else 0))
            times |= {t - before for t in ends if t is not None}
            before += busy[k]
        ends = [self.due[stops[-1]], ints(vehicle.shift[1], self.unit)]
        times |= {t - before for t in ends if t is not None}
        return [t for t in times if t is not None and t >= opens and (latest is None or t <= latest)]

    def _carried(self, kind: int, visits: tuple[int, ...]) -> list[list[int]]:
        """The load on leaving the start and each stop, by load dimension."""
        carried = []
        for dimension in range(len(self.demand)):
            if dimension not in self.loaded:
                carried.append([0])
                continue
            reloads = [k for k, i in enumerate(visits) if i in self.fleet[kind].reloads]
            levels = []
            for at in range(len(visits) + 1):
                first = max([0, *(k + 1 for k in reloads if k < at)])
                last = min([len(visits), *(k for k in reloads if k >= at)])
                level = sum(self.demand[dimension][i] for i in visits[at:last] if not self.depot[i])
                level += sum(self.pickup[dimension][i] for i in visits[first:at] if not self.depot[i])
                level += sum(
                    load[dimension] for p, q, load in self.shipments if dimension < len(load) and p in visits[:at] and q in visits[at:]
                )
                levels.append(level)
            carried.append(levels)
        return carried

    def _drive(self, kind: int, visits: tuple[int, ...]) -> Driven | None:
        vehicle, u = self.fleet[kind], self.unit
        if any((p in visits) != (q in visits) for p, q, _ in self.shipments):
            return None
        stops = (vehicle.start, *visits, vehicle.end)
        legs = list(itertools.pairwise(stops))
        if self.forbidden is not None and any(self.forbidden[i, j] for i, j in legs):
            return None
        distance, moving = sum(self.d[kind][i][j] for i, j in legs), [self.t[kind][i][j] for i, j in legs]
        busy = [m + (self.service[i] if k else 0) for k, ((i, _), m) in enumerate(zip(legs, moving, strict=True))]
        tests = [(max(levels), ints(limit, u), 0) for levels, limit in zip(self._carried(kind, visits), vehicle.capacities, strict=False)]
        tests.append((distance, ints(vehicle.max_distance, u), 0))
        opens = self._opening(vehicle)
        finish, times = self._run(kind, stops, opens, home=True)
        tests += times
        largest = max(abs(v) for v, _, _ in times)
        if vehicle.reloads and vehicle.max_reloads is not None and sum(i in vehicle.reloads for i in visits) > vehicle.max_reloads:
            return None
        elapsed = finish - opens
        shortest = elapsed
        if elapsed > sum(busy):  # somebody waits
            runs = [(t, *self._run(kind, stops, t, home=True)) for t in self._departures(kind, stops, busy)]
            good = [(elapsed, finish), *((end - t, end) for t, end, kept in runs if all(nearly(test) for test in kept))]
            shortest, finish = self._driven_best(vehicle, good, largest)
            elapsed = finish - opens
        tests.append((shortest, ints(vehicle.max_duration, u), largest))
        if vehicle.energy is not None:
            tests += self._energy(kind, visits, moving, busy, shortest, elapsed, largest)
        overrun = 0.0
        if self.variances[kind] is not None:
            risky, overrun = self._overrun(kind, legs, sum(moving), shortest, elapsed, largest)
            tests += risky
        if not all(nearly(test) for test in tests) or not self.within_risk([overrun]):
            return None
        strict = all(limit is None or value <= limit for value, limit, _ in tests)
        cost = ints(vehicle.fixed_cost, u) * u + ints(vehicle.unit_cost, u) * distance + ints(vehicle.unit_duration_cost, u) * shortest
        if not math.isinf(vehicle.regular_duration):
            cost += ints(vehicle.unit_overtime_cost, u) * max(0, shortest - ints(vehicle.regular_duration, u))
        return Driven(strict, cost, sum(self.reward[i] for i in visits if not self.depot[i]), distance, shortest, finish, overrun)

    def _driven_best(self, vehicle: VehicleType, runs: list[tuple[int, int]], largest: int) -> tuple[int, int]:
        """Choose among durations and returns those that the route is driven by: within the limits if any are, the shortest, or where the
        latest return counts the first to be back."""
        u, energy = self.unit, vehicle.energy

        def kept(lasts: int, end: int) -> bool:
            tests = [(lasts, ints(vehicle.max_duration, u), largest)]
            if energy is not None and energy.charge in ("elapsed", "elapsed-fixed-start"):
                drawn, rate = lasts if energy.charge == "elapsed" else end - self._opening(vehicle), ints(energy.rate, u)
                tests.append((rate * drawn, ints(energy.at_departure, u) * u, rate * largest))
            return all(nearly(test) for test in tests)

        able = [run for run in runs if kept(*run)] or runs
        key, other = int(self.early), 1 - int(self.early)
        least = min(run[key] for run in able)
        return min((run for run in able if nearly((run[key], least, largest))), key=lambda run: run[other])

    def within_risk(self, overruns: list[float]) -> bool:
        """Check that routes together, which overrun a limit with these probabilities, keep all as likely as is asked."""
        return self.team_risk is None or 1.0 - math.prod(1.0 - p for p in overruns) <= self.team_risk * (1.0 + 1.0 / PARTS)

    def _overrun(
        self, kind: int, legs: list[tuple[int, int]], moving: int, shortest: int, elapsed: int, largest: int
    ) -> tuple[list[Any], float]:
        """Tests of the limits that hold with the route's risk, and how likely it overruns one."""
        vehicle, u = self.fleet[kind], self.unit
        spread = self.variances[kind]
        assert spread is not None
        variance = sum((spread[i][j] for i, j in legs), Fraction(0))
        if not variance or (vehicle.risk is None and self.team_risk is None):
            return [], 0.0
        limits = [(shortest * u, u, ints(vehicle.max_duration, u))]
        if vehicle.energy is not None:
            drawn = {"travel": moving, "elapsed": shortest, "elapsed-fixed-start": elapsed}[vehicle.energy.charge]
            rate = ints(vehicle.energy.rate, u)
            limits.append((drawn * rate, rate, ints(vehicle.energy.at_departure, u)))
        tests, overrun, fine = [], 0.0, 1 << 40
        for mean, rate, limit in limits:
            if limit is None:
                continue
            slack = Fraction(limit * u - mean)
            away = math.sqrt(min(slack**2 / (2 * variance * (rate * u) ** 2), Fraction(10**6)))  # far out the tail is 0 or 1
            overrun = max(overrun, 0.5 * math.erfc(away if slack > 0 else -away))
            if vehicle.risk is not None:
                share = Fraction(-NormalDist().inv_cdf(vehicle.risk)) * rate * u * fine
                needed = Fraction(math.isqrt(math.ceil(variance * share**2)), fine)
                tests.append((mean + needed, limit * u, largest * rate))
        return tests, overrun

    def _energy(
        self, kind: int, visits: tuple[int, ...], moving: list[int], busy: list[int], shortest: int, elapsed: int, largest: int
    ) -> list[Any]:
        vehicle, u = self.fleet[kind], self.unit
        energy = vehicle.energy
        rate, capacity, store = ints(energy.rate, u), ints(energy.capacity, u) * u, ints(energy.at_departure, u) * u
        if energy.stations:
            tests, drawn = [], 0
            for k, m in enumerate(moving):
                drawn += rate * m
                tests.append((drawn, store, rate * largest))
                if k < len(visits) and visits[k] in energy.stations:
                    drawn, store = 0, capacity
            return tests
        opens = self._opening(vehicle)
        ready = [opens, *(self.ready[i] for i in visits)]
        waits = [b if k == len(visits) else max(b, ready[k + 1] - ready[k]) for k, b in enumerate(busy)]
        drawn = {"travel": sum(moving), "elapsed": shortest, "elapsed-fixed-start": elapsed, "windows": sum(waits)}[energy.charge]
        return [(rate * drawn, store, rate * largest)]


class RoutingTruth(Truth):
    """The optimum of a tiny routing problem by brute force: every route of every vehicle type, and every combination of routes."""

    def __init__(self, problem: RoutingProblem) -> None:
        super().__init__(problem.senses)
        self.problem = problem
        self.levels = [[(Fraction(w), t.name) for w, t in level.terms] for level in problem.objective.levels()]
        terms = [term for level in self.levels for term in level]
        timed = any(name in ("makespan", "total-duration", "latest-return") for _, name in terms) or any(
            v.unit_duration_cost or v.unit_overtime_cost for v in problem.fleet
        )
        self.mixed = timed or any(w < 0 for w, _ in terms)
        roads, s, fleet = Roads(problem), problem.sites, problem.fleet
        self.roads, self.unit = roads, roads.unit
        self.driven: dict[tuple[int, tuple[int, ...]], Driven] = {}
        self._first: dict[int, list[tuple[int, tuple[int, ...], frozenset[int]]]] = {k: [] for k in roads.customers}
        same: set[Any] = set()  # of routes that serve the same sites and add up to the same, one will do
        for kind, vehicle in enumerate(fleet):
            for visits, driven in roads.routes(kind):
                served = frozenset(k for k in visits if not s.depot[k])
                if not vehicle.stations or (kind, served, driven) not in same:
                    same.add((kind, served, driven))
                    self.driven[kind, visits] = driven
                    if served:
                        self._first[min(served)].append((kind, visits, served))
        if timed:  # a duration is the difference of two clocks
            self.size = Fraction(roads.clock, self.unit)
        self._extend(frozenset(roads.customers), {c for c in roads.customers if s.required[c]}, [], [0] * len(fleet))

    def _extend(self, rest: frozenset[int], must: set[int], routes: list[tuple[int, tuple[int, ...]]], used: list[int]) -> None:
        if not rest:
            every = self._with_committed(routes)
            together = every is not None and self._groups({k for _, v in routes for k in v}) and self._safe(every)
            if len(routes) >= self.problem.min_vehicles and every is not None and together:
                parts = [self.driven[r] for r in every]
                answer = Routes(tuple(Route(visits, kind) for kind, visits in routes))
                self.meet(self.values(every), all(p.strict for p in parts), answer)
            return
        first = min(rest)
        if first not in must:
            self._extend(rest - {first}, must, routes, used)
        for kind, visits, served in self._first[first]:  # as all that serve it and a lower one are taken or left out
            limit = self.problem.fleet[kind].count
            if served <= rest and (limit is None or used[kind] < limit):
                used[kind] += 1
                self._extend(rest.difference(served), must, [*routes, (kind, visits)], used)
                used[kind] -= 1

    def _with_committed(self, routes: list[tuple[int, tuple[int, ...]]]) -> list[tuple[int, tuple[int, ...]]] | None:
        """The routes, and those of committed vehicles that serve nobody; None where one of these cannot be driven."""
        more = []
        for kind, vehicle in enumerate(self.problem.fleet):
            if vehicle.committed:
                more += [(kind, ())] * ((vehicle.count or 0) - sum(k == kind for k, _ in routes))
        return None if any(r not in self.driven for r in more) else [*routes, *more]

    def _safe(self, routes: list[tuple[int, tuple[int, ...]]]) -> bool:
        return self.roads.within_risk([self.driven[route].overrun for route in routes])

    def _groups(self, visited: set[int]) -> bool:
        counts = [(sum(k in visited for k in g.sites), g.required) for g in self.problem.sites.groups]
        return all(n == 1 or (n == 0 and not required) for n, required in counts)

    def values(self, routes: list[tuple[int, tuple[int, ...]]]) -> Values:
        parts = [self.driven[r] for r in routes]
        if self.mixed:  # what is added up may be far larger than what is left of it
            self.size = max(self.size, sum((abs(w * self._term(name, routes, parts)) for w, name in self.levels[0]), Fraction(0)))
        return tuple(sum((w * self._term(name, routes, parts) for w, name in level), Fraction(0)) for level in self.levels)

    def _term(self, name: str, routes: list[tuple[int, tuple[int, ...]]], parts: list[Driven]) -> Fraction:
        """The total of one term of an objective."""
        u, roads = self.unit, self.roads
        match name:
            case "total-cost":
                return Fraction(sum(p.cost for p in parts), u * u)
            case "reward":
                at_home = sum(reward for reward, depot in zip(roads.reward, roads.depot, strict=True) if depot)
                return Fraction(sum(p.reward for p in parts) + at_home, u)
            case "vehicles":
                return Fraction(sum(bool(visits) for _, visits in routes))
            case "longest-route":
                return Fraction(max((p.distance for p in parts), default=0), u)
            case "makespan":
                return Fraction(max((p.duration for p in parts), default=0), u)
            case "total-duration":
                return Fraction(sum(p.duration for p in parts), u)
            case "latest-return":
                opens = min(roads._opening(v) for v in self.problem.fleet)
                return Fraction(max([opens, *(p.finish for p in parts)]), u)
            case "penalties":
                visited = {k for _, visits in routes for k in visits}
                return Fraction(sum(roads.penalty[k] for k in roads.customers if k not in visited), u)
        raise KeyError(name)

    def value(self, answer: Any) -> Values | None:
        routes = [(r.vehicle, tuple(r.visits)) for r in answer if r.visits]
        s, fleet = self.problem.sites, self.problem.fleet
        visited = [i for _, visits in routes for i in visits if not s.depot[i]]
        must = {k for k in range(len(s)) if s.required[k] and not s.depot[k]}
        if len(set(visited)) < len(visited) or must - set(visited):
            return None
        for kind, visits in routes:
            driven = self.driven.get((kind, visits)) or self.roads.drive(kind, visits)
            if driven is None:
                return None
            self.driven[kind, visits] = driven
        counts = [sum(kind == k for kind, _ in routes) for k in range(len(fleet))]
        if any(v.count is not None and c > v.count for v, c in zip(fleet, counts, strict=True)) or len(routes) < self.problem.min_vehicles:
            return None
        every = self._with_committed(routes)
        good = every is not None and self._groups(set(visited)) and self._safe(every)
        return self.values(every) if every is not None and good else None


def best_values(problem: RoutingProblem) -> tuple[float, ...] | None:
    """Values of the best answer, all levels; None if there is none."""
    best = RoutingTruth(problem).lenient
    return None if best is None else tuple(float(v) for v in best)


def routes(problem: RoutingProblem, vehicle: VehicleType) -> list[tuple[int, ...]]:
    """The visits of every route that ``vehicle``, of the fleet of ``problem`` or of any other, can drive."""
    nobody = replace(problem.sites, required=np.zeros(len(problem.sites), dtype=bool))
    roads = Roads(replace(problem, sites=nobody, fleet=(vehicle,), min_vehicles=0))
    return [visits for visits, _ in roads.routes(0)]
