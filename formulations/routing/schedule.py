"""When a route is where, what it carries and what it draws, recomputed from the data alone.

Part of the judge: it walks each route stop by stop, knows no program and no solver, and shares no code with the forms.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..tolerance import allowance
from .routes import Route

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Schedule:
    """Earliest schedule of one route; arrays have one entry a stop between start and end.

    ``duration`` is the shortest possible: where each site has one window, from the latest departure that delays nothing, to the return
    (Savelsbergh 1992); where some have several, the shortest over all departures. ``duration_from`` is the departure that it counts from:
    of those with this duration the one that returns first. ``charged`` holds the time charged under each of the four ways, before it is
    multiplied by the rate of the store, ``stretches`` the time on the move between recharging stops. ``leaves`` and ``closing`` have one
    entry a move: when it begins, and when it must have begun. ``load`` adds up the demands, of the first load dimension; ``on_board`` of
    shape (load dimensions, stops + 1) is what the vehicle carries on leaving start and stops.
    ``variance`` is that of the time on the move.
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
    duration_from: float
    waiting: float
    charged: dict[str, float]
    stretches: tuple[float, ...]
    leaves: Floats
    closing: Floats
    on_board: Floats
    peak: tuple[float, ...]
    variance: float


def opening(problem: RoutingProblem, vehicle: VehicleType) -> float:
    """Earliest departure of a vehicle of this type."""
    return max(float(problem.sites.ready[vehicle.start]), vehicle.shift[0])


def closing(problem: RoutingProblem, vehicle: VehicleType) -> float:
    """Latest return of a vehicle of this type."""
    return min(float(problem.sites.due[vehicle.end]), vehicle.shift[1])


def schedule(problem: RoutingProblem, route: Route, departure: float | None = None) -> Schedule:
    """Earliest schedule of ``route``, or that from a given ``departure``, whose duration then counts from there.

    Late visits begin on arrival, so that lateness is not forgiven further on.
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
    ready[0], due[-1] = opening(problem, vehicle), closing(problem, vehicle)
    closes = np.full(len(leg), math.inf) if travel.closing is None else travel.closing[stops[:-1], stops[1:]]
    several = {k: sites.windows[site] for k, site in enumerate(route.visits, start=1) if sites.windows[site]} if sites.windows else {}

    arrival, begin = np.empty(len(stops)), np.empty(len(stops))
    arrival[0] = begin[0] = ready[0] if departure is None else departure
    last = np.minimum(due[:-1], closes - service[:-1])  # begin of service that lets the next move begin in time
    waiting, slack = 0.0, max(0.0, last[0] - begin[0])
    for k in range(1, len(stops)):
        arrival[k] = begin[k - 1] + service[k - 1] + time[k - 1]
        # The return to a depot is the end of the route: nobody waits for the depot to open.
        begin[k] = arrival[k] if k == len(stops) - 1 else max(arrival[k], _opens(several[k], arrival[k]) if k in several else ready[k])
        waiting += begin[k] - arrival[k]
        slack = min(slack, waiting + max(0.0, (last[k] if k < len(last) else due[k]) - begin[k]))
    finish = float(arrival[-1])
    busy = math.fsum([*time, *service])  # no route takes less, whatever cancels where its clock is far from zero
    elapsed = max(finish - float(begin[0]), busy)
    duration, leaves = elapsed, float(begin[0])
    if departure is None and several:
        shortest, best = _shortest(leaves, ready, due, last, service + np.append(time, 0.0), several)
        duration, leaves = (max(shortest, busy), best) if math.isfinite(shortest) else (elapsed, leaves)
    elif departure is None:
        later = min(waiting, slack)
        duration, leaves = max(elapsed - later, busy), leaves + later
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
        duration=float(duration),
        duration_from=leaves,
        waiting=float(waiting),
        charged={
            "travel": float(math.fsum(time)),
            "elapsed": float(duration),
            "elapsed-fixed-start": float(elapsed),
            "windows": float(math.fsum(charge)),
        },
        stretches=tuple(math.fsum(part) for part in np.split(time, refills)),
        leaves=begin[:-1] + service[:-1],
        closing=closes,
        on_board=on_board,
        peak=tuple(on_board.max(axis=1).tolist()),
        variance=0.0 if travel.variances is None else math.fsum(travel.variances[stops[:-1], stops[1:]]),
    )


def _opens(windows: tuple[tuple[float, float], ...], arrival: float) -> float:
    """Opening of the first window that is not over on arrival; the arrival itself where all are."""
    for opens, closes in windows:
        if arrival - closes <= float(allowance(closes, arrival)):
            return opens
    return arrival


def _shortest(
    opens: float, ready: Floats, due: Floats, last: Floats, busy: Floats, several: dict[int, tuple[tuple[float, float], ...]]
) -> tuple[float, float]:
    """Least time from departure to return over all departures, and the departure; infinite where none keeps all windows.

    Begin of service, as a function of the departure t, is max(c, t + w) on each of a few intervals of t, one for each choice of
    windows: (from, to, c, w). Who comes before a window is over begins in it, and is late for the next move if that closes before the
    window opens.
    """
    pieces = [(opens, max(opens, float(last[0])), -math.inf, 0.0)]
    for k in range(1, len(due)):
        step, returns = float(busy[k - 1]), k == len(due) - 1
        windows = several.get(k) or ((-math.inf if returns else float(ready[k]), float(due[k])),)
        made = []
        for low, high, c, w in pieces:
            c, w, over = c + step, w + step, -math.inf
            for begins, ends in windows:
                end, first = ends if returns else min(ends, float(last[k])), low if c > over else max(low, over - w)
                begun = max(begins, c, first + w)
                if first <= high and begun - end <= float(allowance(end, begun, abs(opens))):
                    made.append((first, max(min(high, end - w), first), max(c, begins), w))
                over = ends
        pieces = made
    # The longer it takes to leave, the less is waited for, until the end of the piece, or the first return without waiting.
    found = [(max(c - high, w), max(c, low + w), min(high, max(low, c - w))) for low, high, c, w in pieces]
    duration, _, departure = min(found, default=(math.inf, math.inf, opens))
    return duration, departure


def _on_board(problem: RoutingProblem, route: Route) -> Floats:
    """What the vehicle carries on leaving its start and each stop, shape (load dimensions, stops + 1).

    It leaves with what it delivers until it reloads or returns, and keeps what it picks up for as long; shipments stay on board from
    their pickup to their delivery.
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
        left = delivered[:, low:high]
        aboard[:, low] = [math.fsum(row) for row in left]
        aboard[:, low + 1 : high + 1] = left[:, ::-1].cumsum(axis=1)[:, ::-1] - left + collected[:, low:high].cumsum(axis=1)
    place = {site: k for k, site in reversed(list(enumerate(route.visits, start=1)))}
    for shipment in sites.shipments:
        first, end = place.get(shipment.pickup), place.get(shipment.delivery)
        if first is not None and end is not None and first < end:
            aboard[: len(shipment.load), first:end] += np.array(shipment.load)[:, None]
    return aboard
