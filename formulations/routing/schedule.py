"""The schedule of a route, its loads and energy, recomputed from the data alone: what every output shows.

Part of the judge: it walks each route stop by stop, knows no program and no solver, and shares no code with the forms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..tolerance import allowance, widening
from .routes import Astray, Floats, Route, Timetable

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem


@dataclass(frozen=True)
class Schedule:
    """The one schedule by which a route's limits and the objective are judged, and which every output shows.

    Arrays have one entry per stop between start and end, ``leaves`` and ``closing`` one a move: when it begins, and when it must have
    begun. ``charged`` holds the time charged under each of the four ways, before it is multiplied by the rate of the store, ``stretches``
    the time on the move between recharging stops. ``load`` adds up the demands, of the first load dimension; ``on_board`` of shape (load
    dimensions, stops + 1) is the load on leaving start and stops. ``variance`` is that of the time on the move, ``astray`` what a stated
    timetable says that does not go with the data.
    """

    arrival: Floats
    begin: Floats
    load: Floats
    distance: Floats
    departure: float
    finish: float
    total_distance: float
    total_load: float
    duration: float
    waiting: float
    charged: dict[str, float]
    stretches: tuple[float, ...]
    leaves: Floats
    closing: Floats
    on_board: Floats
    peak: tuple[float, ...]
    variance: float
    astray: tuple[Astray, ...] = ()

    def cost(self, vehicle: VehicleType) -> float:
        """Part of the total cost that is the route's."""
        paid = vehicle.fixed_cost + vehicle.unit_cost * self.total_distance
        if vehicle.unit_duration_cost or vehicle.unit_overtime_cost:
            over = max(0.0, self.duration - vehicle.regular_duration)
            paid += vehicle.unit_duration_cost * self.duration + vehicle.unit_overtime_cost * over
        return paid

    @property
    def ends(self) -> Floats:
        """Times at which service is done at each stop, and the vehicle leaves it."""
        return self.leaves[1:]


def opening(problem: RoutingProblem, vehicle: VehicleType) -> float:
    """Earliest departure of a vehicle of this type."""
    return max(float(problem.sites.ready[vehicle.start]), vehicle.shift[0])


def closing(problem: RoutingProblem, vehicle: VehicleType) -> float:
    """Latest return of a vehicle of this type."""
    return min(float(problem.sites.due[vehicle.end]), vehicle.shift[1])


def schedule(problem: RoutingProblem, route: Route, departure: float | None = None) -> Schedule:
    """The schedule of ``route`` that it is judged by, or the earliest one from a given ``departure``.

    A vehicle departs as late as delays nothing (Savelsbergh 1992), or where nobody waits as early as it may. Where sites have several
    windows, a later return may make a route shorter: of the departures that keep the longest duration and the store it is then the one
    with the shortest duration, and where the objective holds the latest return the one that returns first. A timetable that is stated
    with the route counts in place of all this. Late visits begin on arrival, so that lateness is not forgiven further on.
    """
    sites, vehicle = problem.sites, problem.fleet[route.vehicle]
    travel = problem.travel_of(route.vehicle)
    visits = np.array(route.visits, dtype=np.int64)
    stops = np.concatenate([[vehicle.start], visits, [vehicle.end]])
    leg = travel.distance(stops[:-1], stops[1:])
    time = travel.duration(stops[:-1], stops[1:])
    # A depot's window bounds departure and return; only on the way it asks for service.
    service = np.concatenate([[0.0], sites.service[visits], [0.0]])
    ready, due = sites.ready[stops], sites.due[stops]
    opens = ready[0] = opening(problem, vehicle)
    due[-1] = closing(problem, vehicle)
    closes = np.full(len(leg), math.inf) if travel.closing is None else travel.closing[stops[:-1], stops[1:]]
    several = {k: sites.windows[site] for k, site in enumerate(route.visits, start=1) if sites.windows[site]} if sites.windows else {}
    busy = math.fsum([*time, *service])  # no route takes less, whatever cancels where its clock is far from zero

    def run(departure: float, stated: Timetable | None = None) -> tuple[Floats, Floats, Floats]:
        """Arrival, begin and end of service at each stop, start and end among them."""
        arrival, begin = np.empty(len(stops)), np.empty(len(stops))
        arrival[0] = begin[0] = departure
        ends = begin.copy()
        for k in range(1, len(stops)):
            arrival[k] = begin[k] = ends[k - 1] + time[k - 1]
            if k < len(stops) - 1:  # the return to a depot is the end of the route: nobody waits for it to open
                at = arrival[k] if stated is None else max(arrival[k], _or(stated.begin[k - 1]))
                begin[k] = max(at, _opens(several[k], at) if k in several else ready[k])
            ends[k] = begin[k] + service[k]
            if stated is not None and k < len(stops) - 1:
                ends[k] = max(ends[k], _or(stated.ends[k - 1]))
        return arrival, begin, ends

    clock = run(opens if departure is None else departure)
    duration: float | None = None
    if departure is None:
        last = np.minimum(due[:-1], closes - service[:-1])  # begin of service that lets the next move begin in time
        if several:
            departures = _departures(opens, ready, due, last, service + np.append(time, 0.0), several)
            chosen = _best(problem, vehicle, opens, departures)
        else:
            chosen = _latest(*clock[:2], last, due, busy)
        if chosen is not None:
            duration = chosen.duration
            clock = run(chosen.departure) if chosen.departure > opens else clock
    astray: tuple[Astray, ...] = ()
    if departure is None and route.timetable is not None and not route.timetable.tells(*clock):
        leaves = route.timetable.leaves(float(time[0]), float(clock[0][0]))
        clock, duration = run(leaves, route.timetable), None
        astray = route.timetable.astray(*clock)
    arrival, begin, ends = clock
    finish = float(arrival[-1])
    waits = begin - arrival + (ends - (begin + service))  # a timetable may have a vehicle wait after its service
    if duration is None:
        duration = finish - float(begin[0])
    duration = max(float(duration), busy)
    charge = np.maximum(service[:-1] + time, np.append(ready[1:-1], -math.inf) - ready[:-1])
    on_board = _on_board(problem, route)
    refills = [k for k, site in enumerate(route.visits, start=1) if site in vehicle.stations]
    return Schedule(
        arrival=arrival[1:-1],
        begin=begin[1:-1],
        load=np.cumsum(sites.demand[visits]),
        distance=np.cumsum(leg)[:-1],
        departure=float(begin[0]),
        finish=finish,
        total_distance=float(math.fsum(leg)),
        total_load=float(math.fsum(sites.demand[visits])),
        duration=duration,
        waiting=float(waits.sum()),
        charged={
            "travel": float(math.fsum(time)),
            "elapsed": duration,
            "elapsed-fixed-start": max(finish - opens, busy),
            "windows": float(math.fsum(charge)),
        },
        stretches=tuple(math.fsum(part) for part in np.split(time, refills)),
        leaves=ends[:-1],
        closing=closes,
        on_board=on_board,
        peak=tuple(on_board.max(axis=1).tolist()),
        variance=0.0 if travel.variances is None else math.fsum(travel.variances[stops[:-1], stops[1:]]),
        astray=astray,
    )


class Departure(NamedTuple):
    """Duration of a route from a moment on, and its return."""

    duration: float
    finish: float
    departure: float


def _or(moment: float | None) -> float:
    return -math.inf if moment is None else moment


def _latest(arrival: Floats, begin: Floats, last: Floats, due: Floats, busy: float) -> Departure:
    """The latest departure that delays nothing, where each site has one window; of what is waited for no more than that is saved."""
    waiting, slack = 0.0, max(0.0, float(last[0] - begin[0]))
    for k in range(1, len(begin)):
        waiting += begin[k] - arrival[k]
        slack = min(slack, waiting + max(0.0, float((last[k] if k < len(last) else due[k]) - begin[k])))
    later, finish = min(waiting, slack), float(arrival[-1])
    return Departure(max(finish - float(begin[0]), busy) - later, finish, float(begin[0]) + later)


def _best(problem: RoutingProblem, vehicle: VehicleType, opens: float, found: Sequence[Departure]) -> Departure | None:
    """The schedule to be driven, among the shortest for each choice of windows; None where none keeps all windows."""
    longest, latest, energy = vehicle.max_duration, math.inf, vehicle.energy
    if energy is not None and energy.rate > 0.0:
        if energy.charge == "elapsed":
            longest = min(longest, energy.at_departure / energy.rate)
        elif energy.charge == "elapsed-fixed-start":
            latest = opens + energy.at_departure / energy.rate

    def within(value: float, limit: float, finish: float) -> bool:
        return value - limit <= float(widening(limit, max(abs(opens), abs(finish))))

    kept = [one for one in found if within(one.duration, longest, one.finish) and within(one.finish, latest, one.finish)] or found
    if not kept:
        return None
    # What differs by rounding alone is the same.
    if "objective:latest-return" in problem.features():
        first = min(one.finish for one in kept)
        return min(one for one in kept if within(one.finish, first, one.finish))
    least = min(one.duration for one in kept)
    return min((one for one in kept if within(one.duration, least, one.finish)), key=lambda one: (one.finish, one.duration, one.departure))


def _opens(windows: tuple[tuple[float, float], ...], arrival: float) -> float:
    """Opening of the first window that is not over on arrival; the arrival itself where all are."""
    for opens, closes in windows:
        if arrival - closes <= float(allowance(closes, arrival)):
            return opens
    return arrival


def _departures(
    opens: float, ready: Floats, due: Floats, last: Floats, busy: Floats, several: dict[int, tuple[tuple[float, float], ...]]
) -> list[Departure]:
    """Departures of least duration for each choice of several windows, which are those of first return too.

    Begin of service, as a function of the departure t, is max(c, t + w) on each of a few intervals of t, one for each choice of
    windows: (from, to, c, w). Who comes before a window is over begins in it, and is late for the next move if that closes before the
    window opens.
    """
    pieces = [(opens, max(opens, float(last[0])), -math.inf, 0.0)]
    for k in range(1, len(due)):
        step, returns = float(busy[k - 1]), k == len(due) - 1
        windows = several.get(k) or ((-math.inf if returns else float(ready[k]), float(due[k])),)
        later = []
        for low, high, c, w in pieces:
            c, w, over = c + step, w + step, -math.inf
            for begins, ends in windows:
                end, first = ends if returns else min(ends, float(last[k])), low if c > over else max(low, over - w)
                begun = max(begins, c, first + w)
                if first <= high and begun - end <= float(allowance(end, begun, abs(opens))):
                    later.append((first, max(min(high, end - w), first), max(c, begins), w))
                over = ends
        pieces = later
    # The longer it takes to leave, the less is waited for, until the end of the piece, or the first return without waiting.
    return [Departure(max(c - high, w), max(c, low + w), min(high, max(low, c - w))) for low, high, c, w in pieces]


def _on_board(problem: RoutingProblem, route: Route) -> Floats:
    """Load on leaving the start and each stop, shape (load dimensions, stops + 1).

    A vehicle leaves with what it delivers until it reloads or returns, and keeps what it picks up for as long; shipments stay on board
    from their pickup to their delivery.
    """
    sites, vehicle = problem.sites, problem.fleet[route.vehicle]
    visits = np.array(route.visits, dtype=np.int64)
    served = ~sites.depot[visits]
    delivered = np.vstack([sites.demand[visits], sites.further_demand[visits].T]) * served
    collected = np.vstack([sites.pickup[visits], sites.further_pickup[visits].T]) * served
    reloads = [k for k, site in enumerate(route.visits) if site in vehicle.reloads]
    aboard = np.zeros((len(delivered), len(visits) + 1))
    for low, high in zip([0, *(k + 1 for k in reloads)], [*reloads, len(visits)], strict=True):
        # Position 0 is the start; a trip from stop ``low`` on begins at position ``low``, which is its depot.
        undelivered = delivered[:, low:high]
        aboard[:, low] = [math.fsum(row) for row in undelivered]
        aboard[:, low + 1 : high + 1] = undelivered[:, ::-1].cumsum(axis=1)[:, ::-1] - undelivered + collected[:, low:high].cumsum(axis=1)
    place = {site: k for k, site in reversed(list(enumerate(route.visits, start=1)))}
    for shipment in sites.shipments:
        first, end = place.get(shipment.pickup), place.get(shipment.delivery)
        if first is not None and end is not None and first < end:
            aboard[: len(shipment.load), first:end] += np.array(shipment.load)[:, None]
    return aboard
