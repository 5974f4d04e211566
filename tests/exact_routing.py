"""The brute force of routing: all routes of all vehicle types, and all ways to put them together, in whole numbers.

All tests that ask for the truth of a small routing problem ask here. It shares no code with the package's judge, forms and checkers.
Besides what keeps every limit exactly it knows what exceeds none by more than 1e-9 of it, for sums of doubles that meet a limit may
come out a rounding above.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from exact_base import PARTS, Truth, Values

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.routing.instance import VehicleType


def scale_of(*arrays: Any) -> int:
    """The least power of two of which all finite numbers, times it, are whole."""
    flat = [float(v) for a in arrays for v in np.asarray(a, dtype=np.float64).ravel().tolist()]
    return max((v.as_integer_ratio()[1] for v in flat if math.isfinite(v)), default=1)


def ints(values: Any, scale: int) -> Any:
    """As nested lists of whole numbers; None for infinity."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, list):
        return [ints(v, scale) for v in values]
    return None if math.isinf(values) else int(Fraction(values) * scale)


def nearly(test: tuple[int, int | None, int]) -> bool:
    """Whether a value is within a limit (None: there is none) but for 1e-9 of it, or of the size of what was added up."""
    value, limit, size = test
    return limit is None or value <= limit or (value - limit) * PARTS <= max(abs(limit), size)


@dataclass(frozen=True)
class Driven:
    """What one route adds up to, in whole units; ``strict`` tells whether it keeps every limit exactly."""

    strict: bool
    cost: int
    reward: int
    distance: int
    duration: int


class Roads:
    """The data of a problem in whole numbers, and the routes that its vehicles can drive."""

    def __init__(self, problem: RoutingProblem) -> None:
        s, fleet = problem.sites, problem.fleet
        d, t = problem.travel.distances, problem.travel.durations
        weights = [w for level in problem.objective.levels() for w, _ in level.terms]
        limits = [(v.capacity, v.max_duration, v.max_distance, v.fixed_cost, v.unit_cost) for v in fleet]
        stores = [(v.energy.capacity, v.energy.rate) for v in fleet if v.energy]
        self.unit = scale_of(s.demand, s.ready, s.due, s.service, s.reward, d, t, weights, limits, stores)
        self.d, self.t = ints(d, self.unit), ints(t, self.unit)
        self.demand, self.reward, self.service = (ints(a, self.unit) for a in (s.demand, s.reward, s.service))
        self.ready, self.due = ints(s.ready, self.unit), ints(s.due, self.unit)
        self.customers = [k for k in range(len(s)) if not s.depot[k]]
        self.clock = 0

    def routes(self, vehicle: VehicleType) -> Iterator[tuple[tuple[int, ...], Driven]]:
        """Every route that ``vehicle`` can drive, and no part of one that load, distance or a window rules out already."""
        begun: list[tuple[int, ...]] = [()]
        while begun:
            visits = begun.pop()
            for site in self.customers:
                if site not in visits:
                    longer = (*visits, site)
                    if self._on_the_way(vehicle, longer):
                        begun.append(longer)
                        found = self._drive(vehicle, longer)
                        if found is not None:
                            yield longer, found

    def _on_the_way(self, vehicle: VehicleType, visits: tuple[int, ...]) -> bool:
        """Whether a route may begin so: none of these grows less by going on."""
        legs = list(itertools.pairwise((vehicle.start, *visits)))
        tests = [(sum(self.demand[i] for i in visits), ints(vehicle.capacity, self.unit), 0)]
        tests.append((sum(self.d[i][j] for i, j in legs), ints(vehicle.max_distance, self.unit), 0))
        clock = self.ready[vehicle.start]
        largest = abs(clock)
        for k, (i, j) in enumerate(legs):
            clock += self.t[i][j] + (self.service[i] if k else 0)
            largest = max(largest, abs(clock))
            tests.append((clock, self.due[j], largest))
            clock = max(clock, self.ready[j])
            largest = max(largest, abs(clock))
        return all(nearly(test) for test in tests)

    def _drive(self, vehicle: VehicleType, visits: tuple[int, ...]) -> Driven | None:
        stops = (vehicle.start, *visits, vehicle.end)
        legs = list(itertools.pairwise(stops))
        distance, moving = sum(self.d[i][j] for i, j in legs), [self.t[i][j] for i, j in legs]
        busy = [m + (self.service[i] if k else 0) for k, ((i, _), m) in enumerate(zip(legs, moving, strict=True))]
        tests = [(sum(self.demand[i] for i in visits), ints(vehicle.capacity, self.unit), 0)]
        tests.append((distance, ints(vehicle.max_distance, self.unit), 0))
        opens = clock = self.ready[vehicle.start]
        largest = abs(opens)
        for k, j in enumerate(stops[1:]):
            clock += busy[k]
            largest = max(largest, abs(clock))
            tests.append((clock, self.due[j], largest))
            if k < len(visits):
                clock = max(clock, self.ready[j])
                largest = max(largest, abs(clock))
        self.clock = max(self.clock, largest)
        # The latest departure that keeps the windows; a route that misses one leaves at once.
        latest = self.due[vehicle.end]
        for k in range(len(stops) - 2, -1, -1):
            ends = [v for v in (self.due[stops[k]], None if latest is None else latest - busy[k]) if v is not None]
            latest = min(ends) if ends else None
        elapsed = clock - opens
        shortest = sum(busy) if latest is None else max(clock - max(latest, opens), sum(busy))
        tests.append((shortest, ints(vehicle.max_duration, self.unit), largest))
        if vehicle.energy is not None:
            waits = [
                b if k == len(visits) else max(b, self.ready[j] - self.ready[i])
                for k, ((i, j), b) in enumerate(zip(legs, busy, strict=True))
            ]
            drawn = {"travel": sum(moving), "elapsed": shortest, "elapsed-fixed-start": elapsed, "windows": sum(waits)}[
                vehicle.energy.charge
            ]
            rate = ints(vehicle.energy.rate, self.unit)
            tests.append((rate * drawn, ints(vehicle.energy.capacity, self.unit) * self.unit, rate * largest))
        if not all(nearly(test) for test in tests):
            return None
        strict = all(limit is None or value <= limit for value, limit, _ in tests)
        cost = ints(vehicle.fixed_cost, self.unit) * self.unit + ints(vehicle.unit_cost, self.unit) * distance
        return Driven(strict, cost, sum(self.reward[i] for i in visits), distance, shortest)


class RoutingTruth(Truth):
    """All routes of all vehicle types, and all ways to put them together."""

    def __init__(self, problem: RoutingProblem) -> None:
        super().__init__(problem.senses)
        self.problem = problem
        terms = [(w, t.name) for level in problem.objective.levels() for w, t in level.terms]
        timed = any(name == "makespan" for _, name in terms)
        self.mixed = timed or any(w < 0 for w, _ in terms)
        roads, s, fleet = Roads(problem), problem.sites, problem.fleet
        self.unit = roads.unit
        self.driven = {(kind, visits): found for kind, vehicle in enumerate(fleet) for visits, found in roads.routes(vehicle)}
        if timed:  # a duration is the difference of two clocks
            self.size = Fraction(roads.clock, self.unit)
        self._extend(frozenset(roads.customers), {c for c in roads.customers if s.required[c]}, [], [0] * len(fleet))

    def _extend(self, rest: frozenset[int], must: set[int], routes: list[tuple[int, tuple[int, ...]]], used: list[int]) -> None:
        if not rest:
            if len(routes) >= self.problem.min_vehicles:
                parts = [self.driven[r] for r in routes]
                answer = Routes(tuple(Route(visits, kind) for kind, visits in routes))
                self.meet(self.values(parts), all(p.strict for p in parts), answer)
            return
        first = min(rest)
        if first not in must:
            self._extend(rest - {first}, must, routes, used)
        for kind, visits in self.driven:
            limit = self.problem.fleet[kind].count
            if first in visits and rest.issuperset(visits) and (limit is None or used[kind] < limit):
                used[kind] += 1
                self._extend(rest.difference(visits), must, [*routes, (kind, visits)], used)
                used[kind] -= 1

    def values(self, parts: list[Driven]) -> Values:
        u = self.unit
        terms = {
            "total-cost": sum(p.cost for p in parts), "reward": sum(p.reward for p in parts) * u, "vehicles": len(parts) * u * u,
            "longest-route": max((p.distance for p in parts), default=0) * u, "makespan": max((p.duration for p in parts), default=0) * u,
        }  # fmt: skip
        levels = self.problem.objective.levels()
        return tuple(sum((Fraction(w) * Fraction(terms[t.name], u * u) for w, t in level.terms), Fraction(0)) for level in levels)

    def value(self, answer: Any) -> Values | None:
        routes = [(r.vehicle, tuple(r.visits)) for r in answer if r.visits]
        visited = [i for _, visits in routes for i in visits]
        s, fleet = self.problem.sites, self.problem.fleet
        must = {k for k in range(len(s)) if s.required[k] and not s.depot[k]}
        if len(set(visited)) < len(visited) or must - set(visited) or any(r not in self.driven for r in routes):
            return None
        counts = [sum(kind == k for kind, _ in routes) for k in range(len(fleet))]
        if any(v.count is not None and c > v.count for v, c in zip(fleet, counts, strict=True)) or len(routes) < self.problem.min_vehicles:
            return None
        return self.values([self.driven[r] for r in routes])


def best_values(problem: RoutingProblem) -> tuple[float, ...] | None:
    """Values of the best answer, all levels; None if there is none."""
    found = RoutingTruth(problem).lenient
    return None if found is None else tuple(float(v) for v in found)


def routes(problem: RoutingProblem, vehicle: VehicleType) -> list[tuple[int, ...]]:
    """The visits of every route that ``vehicle`` can drive."""
    return [visits for visits, _ in Roads(problem).routes(vehicle)]
