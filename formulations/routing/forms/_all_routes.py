"""All routes that the vehicles of a small problem can drive, and what each adds up to.

It walks every order of stops, and drops a beginning that breaks a limit which going on cannot mend. It shares no code with the judge.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...tolerance import EQUAL, LIMIT
from ..problem import RoutingProblem

MOST_ROUTES = 20_000
"""Orders of stops that may have to be walked."""


@dataclass(frozen=True)
class Priced:
    """A route of a type, or the way straight home of a committed vehicle, and what it adds up to."""

    kind: int
    visits: tuple[int, ...]
    distance: float
    duration: float
    finish: float
    cost: float
    reward: float
    penalty: float
    overrun: float


def orders_of_stops(problem: RoutingProblem) -> int:
    """Number of orders of stops there may be: between two sites any choice of depots, none twice."""
    n, total = len(problem.customers), 0
    for vehicle in problem.fleet:
        depots = len({*vehicle.reloads, *vehicle.stations})
        if n > 20 or depots > 5:
            return MOST_ROUTES + 1
        choices = sum(math.perm(depots, k) for k in range(depots + 1))
        total += sum(math.perm(n, k) * choices ** (k + 1) for k in range(1, n + 1))
    return total


def _within(value: float, limit: float, size: float = 0.0) -> bool:
    return value <= limit or value - limit <= LIMIT * max(abs(limit), size)


class Walk:
    """The data of one vehicle type, and the walks that it can make."""

    def __init__(self, problem: RoutingProblem, kind: int) -> None:
        sites, vehicle, travel = problem.sites, problem.fleet[kind], problem.travel_of(kind)
        self.problem, self.kind, self.vehicle, self.sites = problem, kind, vehicle, sites
        every = len(sites)
        self.length, self.time = travel.distances.tolist(), travel.durations.tolist()
        self.closes = [[math.inf] * every] * every if travel.closing is None else travel.closing.tolist()
        self.timed_store = vehicle.energy is not None and vehicle.energy.charge.startswith("elapsed")
        self.early = "objective:latest-return" in problem.features()
        self.opens = max(float(sites.ready[vehicle.start]), vehicle.shift[0])
        self.last_departure = max(self.opens, float(sites.due[vehicle.start]))
        self.home_by = min(float(sites.due[vehicle.end]), vehicle.shift[1])
        several = sites.windows or ((),) * every
        ends = zip(sites.ready.tolist(), sites.due.tolist(), strict=True)
        self.windows = [w or (one,) for w, one in zip(several, ends, strict=True)]
        self.service = sites.service.tolist()
        limited = vehicle.risk is not None or problem.team_risk is not None
        self.spread = travel.variances.tolist() if limited and travel.variances is not None else None
        self.demand = np.column_stack([sites.demand, sites.further_demand]) * ~sites.depot[:, None]
        self.pickup = np.column_stack([sites.pickup, sites.further_pickup]) * ~sites.depot[:, None]
        able = [not sites.skills or sites.skills[k] <= vehicle.skills for k in range(every)]
        self.customers = [k for k in problem.customers.tolist() if able[k]]
        self.pauses = sorted({*vehicle.reloads, *vehicle.stations})
        self.needs: dict[int, list[int]] = {}
        for s in sites.shipments:
            self.needs.setdefault(s.delivery, []).append(s.pickup)

    # -- all of them -------------------------------------------------------------------------------------------------

    def routes(self) -> Iterator[Priced]:
        """Every route with a site on it."""
        yield from self._further((), frozenset())

    def _further(self, visits: tuple[int, ...], since: frozenset[int]) -> Iterator[Priced]:
        """Routes that begin with ``visits``; ``since`` are the depots since the last site."""
        for site in self.customers:
            if site not in visits and all(p in visits for p in self.needs.get(site, ())) and self.may_begin((*visits, site)):
                route = self.priced((*visits, site))
                if route is not None:
                    yield route
                yield from self._further((*visits, site), frozenset())
        for depot in self.pauses:
            if depot not in since and self.may_begin((*visits, depot)):
                if any(not self.sites.depot[k] for k in visits):
                    route = self.priced((*visits, depot))
                    if route is not None:
                        yield route
                yield from self._further((*visits, depot), since | {depot})

    def may_begin(self, visits: tuple[int, ...]) -> bool:
        """Whether no limit is broken that going on cannot mend."""
        stops = (self.vehicle.start, *visits)
        if not _within(math.fsum(self.length[i][j] for i, j in pairwise(stops)), self.vehicle.max_distance):
            return False
        if self._run(stops, self.opens, home=False) is None:
            return False
        return self._store_lasts(stops) if self.vehicle.stations else True

    def given(self, visits: tuple[int, ...]) -> Priced | None:
        """A route with these stops; None where the vehicle may not drive it."""
        stops = {*self.customers, *self.pauses}
        served = [k for k in visits if 0 <= k < len(self.sites) and not self.sites.depot[k]]
        good = all(k in stops for k in visits) and bool(served) and len(set(served)) == len(served)
        good = good and all(p in visits[:at] for at, k in enumerate(visits) for p in self.needs.get(k, ()))
        return self.priced(visits) if good else None

    # -- one of them -------------------------------------------------------------------------------------------------

    def priced(self, visits: tuple[int, ...]) -> Priced | None:
        """Amounts that the route adds up to; None where it breaks a limit."""
        vehicle, stops = self.vehicle, (self.vehicle.start, *visits, self.vehicle.end)
        moves = list(pairwise(stops))
        distance = math.fsum(self.length[i][j] for i, j in moves)
        finish = self._run(stops, self.opens)
        if finish is None or not _within(distance, vehicle.max_distance) or not self._carries(visits):
            return None
        if vehicle.max_reloads is not None and sum(k in vehicle.reloads for k in visits) > vehicle.max_reloads:
            return None
        size = max(abs(self.opens), abs(finish))
        duration, finish = self._departing(stops, finish, size)
        if not _within(duration, vehicle.max_duration) or not self._energy_lasts(stops, duration, finish - self.opens, size):
            return None
        overrun = self._overrun(moves, duration)
        if overrun is None:
            return None
        served = [k for k in visits if not self.sites.depot[k]]
        cost = vehicle.fixed_cost + vehicle.unit_cost * distance + vehicle.unit_duration_cost * duration
        if vehicle.unit_overtime_cost:
            cost += vehicle.unit_overtime_cost * max(0.0, duration - vehicle.regular_duration)
        reward, penalty = (math.fsum(column[served].tolist()) for column in (self.sites.reward, self.sites.penalty))
        return Priced(self.kind, visits, distance, duration, finish, cost, reward, penalty, overrun)

    def _overrun(self, moves: list[tuple[int, int]], duration: float) -> float | None:
        """Probability that the route takes too long or draws too much; None where it is too large. Nobody waits where durations are
        limited."""
        vehicle, energy = self.vehicle, self.vehicle.energy
        variance = 0.0 if self.spread is None else math.fsum(self.spread[i][j] for i, j in moves)
        if variance == 0.0:
            return 0.0
        from scipy.special import ndtr, ndtri

        limits = [(duration, 1.0, vehicle.max_duration)]
        if energy is not None:
            charged = math.fsum(self.time[i][j] for i, j in moves) if energy.charge == "travel" else duration
            limits.append((energy.rate * charged, energy.rate, energy.at_departure))
        deviation, overrun = math.sqrt(variance), 0.0
        for mean, rate, limit in limits:
            if not rate * deviation > 0.0:
                continue
            if vehicle.risk is not None and not _within(mean - float(ndtri(vehicle.risk)) * rate * deviation, limit):
                return None
            overrun = max(overrun, float(ndtr((mean - limit) / (rate * deviation))))
        team = self.problem.team_risk
        return None if team is not None and overrun > team * (1.0 + EQUAL) else overrun

    def _run(self, stops: tuple[int, ...], departure: float, home: bool = True) -> float | None:
        """Time at which the last stop is reached, or begun where it is not the return; None where somebody is late."""
        clock, size = departure, abs(self.opens)
        for k, (i, j) in enumerate(pairwise(stops)):
            leaves = clock + (self.service[i] if k else 0.0)
            if not _within(leaves, self.closes[i][j], size):
                return None
            clock = leaves + self.time[i][j]
            if home and k == len(stops) - 2:
                return clock if _within(clock, self.home_by, size) else None
            opens = next((a for a, b in self.windows[j] if _within(clock, b, size)), None)
            if opens is None:
                return None
            clock = max(clock, opens)
        return clock

    def _departing(self, stops: tuple[int, ...], finish: float, size: float) -> tuple[float, float]:
        """Duration and return by the schedule that counts: the shortest within the limits, or the first to return where that is asked
        for.

        It departs as early as it may, or such that it meets the end of a window or a closing move, or where stops have several windows
        the begin of one. Where no stop has, it delays nothing.
        """
        busy = math.fsum(self.time[i][j] for i, j in pairwise(stops)) + math.fsum(self.service[k] for k in stops[1:-1])
        if finish - self.opens <= busy:
            return finish - self.opens, finish
        runs = [(finish - self.opens, finish)]
        before, departures = 0.0, {self.last_departure, self.home_by - busy}
        several = any(len(self.windows[k]) > 1 for k in stops[1:-1])
        for k, i in enumerate(stops[:-1]):
            service = self.service[i] if k else 0.0
            ends = [t for opens, closes in self.windows[i] for t in ((opens, closes) if several else (closes,))] if k else []
            departures |= {t - before for t in (*ends, self.closes[i][stops[k + 1]] - service)}
            before += service + self.time[i][stops[k + 1]]
        # The latest departure that waits nowhere after it delays nothing.
        departures |= {finish - busy}
        for departure in departures:
            if self.opens < departure <= self.last_departure and math.isfinite(departure):
                end = self._run(stops, departure)
                runs += [] if end is None else [(max(end - departure, busy), end)]
        vehicle = self.vehicle
        kept = [
            (lasts, end)
            for lasts, end in runs
            if _within(lasts, vehicle.max_duration, size)
            and (not self.timed_store or self._energy_lasts(stops, lasts, end - self.opens, size))
        ]
        eligible, key, other = kept or runs, int(self.early), 1 - int(self.early)
        least = min(run[key] for run in eligible)
        return min((run for run in eligible if _within(run[key], least, size)), key=lambda run: run[other])

    def _carries(self, visits: tuple[int, ...]) -> bool:
        """Whether all that is on board fits in, wherever the route is."""
        at = {k: p for p, k in enumerate(visits)}
        for s in self.sites.shipments:
            if (s.pickup in at) != (s.delivery in at):
                return False
        for dimension, capacity in enumerate(self.vehicle.capacities):
            if math.isinf(capacity):
                continue
            undelivered = [0.0] * (len(visits) + 1)  # to deliver on this trip, on leaving the start and each stop
            for p in range(len(visits) - 1, -1, -1):
                undelivered[p] = 0.0 if visits[p] in self.vehicle.reloads else undelivered[p + 1] + float(self.demand[visits[p], dimension])
            collected = shipped = 0.0
            if not _within(undelivered[0], capacity):
                return False
            for p, k in enumerate(visits):
                collected = 0.0 if k in self.vehicle.reloads else collected + float(self.pickup[k, dimension])
                for s in self.sites.shipments:
                    load = s.load[dimension] if dimension < len(s.load) else 0.0
                    shipped += load * ((s.pickup == k) - (s.delivery == k))
                if not _within(undelivered[p + 1] + collected + shipped, capacity):
                    return False
        return True

    def _store_lasts(self, stops: tuple[int, ...]) -> bool:
        energy = self.vehicle.energy
        assert energy is not None
        store, drawn = energy.at_departure, 0.0
        for i, j in pairwise(stops):
            drawn += energy.rate * self.time[i][j]
            if not _within(drawn, store):
                return False
            if j in energy.stations:
                store, drawn = energy.capacity, 0.0
        return True

    def _energy_lasts(self, stops: tuple[int, ...], duration: float, elapsed: float, size: float) -> bool:
        energy = self.vehicle.energy
        if energy is None:
            return True
        if energy.stations:
            return self._store_lasts(stops)
        moves = list(enumerate(pairwise(stops)))
        if energy.charge == "travel":
            drawn = math.fsum(self.time[i][j] for _, (i, j) in moves)
        elif energy.charge == "windows":
            opens = [self.opens, *(float(self.sites.ready[k]) for k in stops[1:-1]), -math.inf]
            drawn = math.fsum(max((self.service[i] if k else 0.0) + self.time[i][j], opens[k + 1] - opens[k]) for k, (i, j) in moves)
        else:
            drawn = duration if energy.charge == "elapsed" else elapsed
        return _within(energy.rate * drawn, energy.at_departure)


def way_home(problem: RoutingProblem, kind: int) -> Priced | None:
    """The way straight home of a committed vehicle that serves nobody; None where it breaks a limit."""
    return Walk(problem, kind).priced(())
