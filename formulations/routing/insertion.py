"""Routes with one site more: every place for it at once, for many sites.

Times at a place follow from the clock of the stops before, the latest arrival at those after it, and the shortest durations of both
(segments of routes: Vidal, Crainic, Gendreau and Prins 2013, A hybrid genetic algorithm with adaptive diversity management, section 4).
With several windows, closing moves, risks and shipments each place is judged by itself.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..evaluation import Checklist
from ..tolerance import ROUNDING, allowance
from .judge import check_route
from .routes import Floats, Integers, Route
from .schedule import closing, opening, schedule

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import Energy
    from .problem import RoutingProblem


LIMITS = ("skills", "moves", "load", "time-windows", "closing-moves", "distance", "duration", "energy", "route-risk")
"""Checks of the judge that a further site may break."""


@dataclass(frozen=True)
class Places:
    """Routes with a further site, arrays of shape (sites, places).

    ``excess`` is by how much each check is broken; where a window is missed, durations are those without waiting, and times are not
    right.
    """

    excess: dict[str, Floats]
    distance: Floats
    duration: Floats
    finish: Floats


def is_plain(problem: RoutingProblem) -> bool:
    """Whether ``Insertions`` are right for the routes of a problem; else each place is judged."""
    return not {"several-windows", "closing-moves", "route-risk"} & problem.features()


class Insertions:
    """Places of a feasible route, which may have no stops, of a problem for which ``is_plain`` holds."""

    def __init__(self, problem: RoutingProblem, route: Route) -> None:
        s, vehicle, travel = problem.sites, problem.fleet[route.vehicle], problem.travel_of(route.vehicle)
        stops = np.array([vehicle.start, *route.visits, vehicle.end], dtype=np.int64)
        ready, due, service = s.ready[stops], s.due[stops], np.concatenate([[0.0], s.service[stops[1:-1]], [0.0]])
        ready[0], due[-1], ready[-1] = opening(problem, vehicle), closing(problem, vehicle), -np.inf
        due[0] = max(due[0], ready[0])
        self.problem, self.route, self.plan = problem, route, schedule(problem, route, opening(problem, vehicle))
        self.tail, self.head, self.ready, self.due, self.service = stops[:-1], stops[1:], ready, due, service
        self.gone = travel.duration(self.tail, self.head)
        self.times = _Times(ready, due, service, self.gone)

    def of(self, sites: Integers) -> Places:
        """Routes with each of ``sites``, customers that it does not visit and that are in no shipment, from before the first stop to
        behind the last one."""
        problem, plan, tail, head, ready, gone = self.problem, self.plan, self.tail, self.head, self.ready, self.gone
        s, vehicle, travel, at = problem.sites, problem.fleet[self.route.vehicle], problem.travel_of(self.route.vehicle), sites[:, None]
        into, out = travel.duration(tail, at), travel.duration(at, head)
        distance = plan.total_distance + (travel.distance(tail, at) + travel.distance(at, head) - travel.distance(tail, head))
        busy, opens, closes = s.service[at], s.ready[at], s.due[at]
        arrival = plan.leaves + into
        onward = np.maximum(arrival, opens) + busy + out
        latest, last = self.times.latest[1:], np.abs(self.due[np.isfinite(self.due)]).max(initial=abs(ready[0]))
        missed = np.maximum(_beyond(arrival, closes, size=abs(ready[0])), _beyond(onward, latest, size=last))
        finish = np.maximum(onward + self.times.rest[1:], self.times.after[1:])
        working = float(self.service.sum() + gone.sum()) + (into + busy + out - gone)
        duration = np.where(missed > 0.0, working, self.times.shortest(into, busy, opens, closes, out))
        rounding = ROUNDING * (len(head) + 2) * np.abs(finish)
        excess = {
            "load": self._overload(sites), "time-windows": missed, "distance": _beyond(distance, vehicle.max_distance),
            "duration": _beyond(duration, vehicle.max_duration, rounding),
        }  # fmt: skip
        if s.skills:
            lacking = [float(len(s.skills[k] - vehicle.skills)) for k in sites.tolist()]
            excess["skills"] = np.broadcast_to(np.array(lacking)[:, None], distance.shape)
        if problem.forbidden is not None:
            excess["moves"] = (problem.forbidden[tail, at] | problem.forbidden[at, head]).astype(np.float64)
        if vehicle.energy is not None:
            elapsed = duration if vehicle.energy.charge == "elapsed" else np.where(missed > 0.0, working, finish - ready[0])
            charged = (into, busy, out, opens, elapsed)
            excess["energy"] = self._overdrawn(vehicle.energy, *charged, vehicle.energy.rate * rounding)
        return Places(excess, distance, duration, finish)

    def _overdrawn(
        self, energy: Energy, into: Floats, busy: Floats, out: Floats, opens: Floats, elapsed: Floats, rounding: Floats
    ) -> Floats:
        plan, ready, gone, before = self.plan, self.ready, self.gone, self.ready[:-1] + self.service[:-1]
        store: Floats | float = energy.at_departure
        if energy.stations:
            stretch = np.cumsum([0, *(k in energy.stations for k in self.route.visits)])
            drawn = np.array(plan.stretches)[stretch] + (into + out - gone)
            store = np.where(stretch == 0, energy.at_departure, energy.capacity)
        elif energy.charge == "travel":
            drawn = plan.charged["travel"] + (into + out - gone)
        elif energy.charge == "windows":
            direct = np.maximum(gone, ready[1:] - before)
            drawn = plan.charged["windows"] + (np.maximum(into, opens - before) + np.maximum(busy + out, ready[1:] - opens) - direct)
        else:
            drawn = elapsed
        return _beyond(energy.rate * drawn, store, rounding)

    def _overload(self, sites: Integers) -> Floats:
        """Excess of load: a delivery is on board from the begin of its trip, a pickup to its end."""
        s, vehicle, n = self.problem.sites, self.problem.fleet[self.route.vehicle], len(self.head)
        pauses = [0, *(k for k, stop in enumerate(self.route.visits, start=1) if stop in vehicle.reloads), n]
        delivered = np.column_stack([s.demand[sites], s.further_demand[sites]])
        collected = np.column_stack([s.pickup[sites], s.further_pickup[sites]])
        worst = np.zeros((len(sites), n))
        for dimension, capacity in enumerate(vehicle.capacities):
            level = self.plan.on_board[dimension]
            until, since = np.empty(n), np.full(n, -np.inf)
            for first, last in itertools.pairwise(pauses):
                until[first:last] = np.maximum.accumulate(level[first:last])
                since[first : last - 1] = np.maximum.accumulate(level[first + 1 : last][::-1])[::-1]
            gives, takes = delivered[:, dimension, None], collected[:, dimension, None]
            worst = np.maximum(worst, _beyond(np.maximum(until + gives, np.maximum(level, since) + takes), capacity))
        return worst


def judged(problem: RoutingProblem, routes: Sequence[Route]) -> Places:
    """Places of routes one by one, as the judge has it; arrays of shape (1, routes)."""
    excess = {name: np.zeros((1, len(routes))) for name in LIMITS}
    sums = np.zeros((3, 1, len(routes)))
    for k, route in enumerate(routes):
        checklist = Checklist()
        plan = check_route(problem, "it", route, checklist)
        sums[:, 0, k] = plan.total_distance, plan.duration, plan.finish
        for violation in checklist.violations:
            if violation.check in excess:
                excess[violation.check][0, k] = max(excess[violation.check][0, k], violation.amount)
    return Places(excess, *sums)


def orders(visits: tuple[int, ...], sites: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All ways to put ``sites``, in this order, among the stops of a route."""
    for where in itertools.combinations_with_replacement(range(len(visits) + 1), len(sites)):
        order = list(visits)
        for site, place in zip(reversed(sites), reversed(where), strict=True):
            order.insert(place, site)
        yield tuple(order)


class _Times:
    """Times that the stops before and after each place allow; arrays with one entry per stop, start and end among them.

    ``latest`` arrival, ``rest`` of the way to the end without waiting, and the finish ``after`` a stop that is reached however early.
    """

    def __init__(self, ready: Floats, due: Floats, service: Floats, gone: Floats) -> None:
        n = len(ready)
        busy = service[:-1] + gone
        self.latest, self.rest, self.after = due.copy(), np.zeros(n), np.full(n, -np.inf)
        # Segments: duration, and the earliest and latest begin with which it lasts no longer.
        self._before = np.empty((3, n - 1))
        self._behind = np.empty((3, n))
        self._before[:, 0] = 0.0, ready[0], due[0]
        self._behind[:, n - 1] = 0.0, -np.inf, due[n - 1]
        for k in range(n - 2, 0, -1):
            self.latest[k] = min(due[k], self.latest[k + 1] - busy[k])
            self.rest[k] = busy[k] + self.rest[k + 1]
            self.after[k] = max(ready[k] + self.rest[k], self.after[k + 1])
            self._behind[:, k] = _joined((service[k], ready[k], due[k]), gone[k], self._behind[:, k + 1])
        for k in range(1, n - 1):
            self._before[:, k] = _joined(self._before[:, k - 1], gone[k - 1], (service[k], ready[k], due[k]))

    def shortest(self, into: Floats, busy: Floats, opens: Floats, closes: Floats, out: Floats) -> Floats:
        """Shortest durations with a site between; right where nobody is late."""
        return _joined(_joined(self._before, into, (busy, opens, closes)), out, self._behind[:, 1:])[0]


def _joined(first: Sequence[Floats] | Floats, move: Floats, then: Sequence[Floats] | Floats) -> tuple[Floats, Floats, Floats]:
    lasts, early, late = first
    delta = lasts + move
    waits = np.maximum(then[1] - delta - late, 0.0)
    return delta + then[0] + waits, np.maximum(then[1] - delta, early) - waits, np.minimum(then[2] - delta, late)


def _beyond(value: Floats, limit: Floats | float, rounding: Floats | float = 0.0, size: float = 0.0) -> Floats:
    """Amount by which a limit is exceeded, 0 where the judge would let it pass."""
    slack, over = allowance(limit, value, size), value - limit
    return np.where(over > slack + np.where(slack > 0.0, rounding, 0.0), over, 0.0)
