"""Routing problems as PyVRP's own data."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.routes import Route, Routes
from ....formulations.routing.schedule import schedule
from ....formulations.tolerance import widened
from .integer_scales import UNLIMITED, Integers
from .routing_integers import IntegerRouting

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

MAX_PENALTY = 100_000
"""Largest price of a unit of violation in PyVRP."""


class Model:
    """A routing problem as PyVRP's ``ProblemData``.

    Each skill is a load dimension: a site that asks for it takes one unit, a vehicle that lacks it has no room for any. A site is a client
    for each of its windows, of which one at most is visited. ``data`` is None if no vehicle can be used at all; ``types`` is the fleet's
    type of each of its vehicle types, without those that no route can use.
    """

    def __init__(self, problem: RoutingProblem, integers: IntegerRouting) -> None:
        import pyvrp

        self.problem, self.integers = problem, integers
        sites, fleet = problem.sites, problem.fleet
        ends = {site for s in sites.shipments for site in (s.pickup, s.delivery)}
        once = [site for site in problem.customers.tolist() if site not in ends]
        self.clients = [site for site in once for _ in integers.windows[site]]
        firsts = itertools.accumulate((len(integers.windows[site]) for site in once), initial=0)
        self.places = {site: range(k, k + len(integers.windows[site])) for site, k in zip(once, firsts, strict=False)}
        self.types = [k for k in range(len(fleet)) if integers.closes[k] >= integers.opens[k]]
        self.factor = load_factor(integers)
        self.words = sorted({word for asked in sites.skills for word in asked})
        turns = sorted({site for v in fleet for site in v.reloads})
        # A depot on the way has a window and a service of its own, which do not hold at departure and return.
        self.depots = [*sites.depots.tolist(), *turns]
        self.turn = {site: len(sites.depots) + k for k, site in enumerate(turns)}
        self.data = None
        if not self.types:
            return
        xy = sites.coordinates if sites.coordinates is not None else np.zeros((len(sites), 2))
        alone = [site for site, copies in self.places.items() if len(copies) > 1 and not any(site in g.sites for g in sites.groups)]
        exclusive = [*((g.sites, g.required) for g in sites.groups), *(((site,), bool(sites.required[site])) for site in alone)]
        groups = [pyvrp.ClientGroup([k for site in members for k in self.places[site]], required) for members, required in exclusive]
        member = {site: number for number, (members, _) in enumerate(exclusive) for site in members}
        types = [self._type(pyvrp, k) for k in self.types]
        distances = []
        for k, moves in enumerate(integers.moves):
            # One matrix serves as cost and as distance limit; only where there is a limit does it have to be rounded up.
            limited = any(t.max_distance != UNLIMITED for t in types if t.profile == k)
            distances.append(self._dear(moves.distance_up if limited else moves.distance))
        # Where no time is limited or priced, any durations do: one matrix less to make.
        self.data = pyvrp.ProblemData(
            locations=[pyvrp.Location(float(x), float(y)) for x, y in xy],
            clients=[self._client(pyvrp, site, window, member.get(site)) for site in self.places for window in integers.windows[site]],
            depots=[
                *(pyvrp.Depot(site) for site in sites.depots.tolist()),
                *(pyvrp.Depot(site, *self._window(site), int(integers.service[site])) for site in turns),
            ],
            vehicle_types=types,
            distance_matrices=distances,
            duration_matrices=[self._dear(moves.duration) for moves in integers.moves] if _timed(integers) else distances,
            groups=groups,
            shipments=[self._shipment(pyvrp, k) for k in range(len(sites.shipments))],
        )

    def _dear(self, moves: Integers) -> Integers:
        """Moves with a price for forbidden ones above anything that they could save; PyVRP has no other way to forbid them."""
        shut = self.problem.forbidden
        if shut is None:
            return moves
        data, most = self.integers, 4 * len(moves)
        price = max(1, int(data.unit.max()), int((data.time + data.overtime).max()))
        gain = int(data.fixed.max()) * len(moves) + int(data.prize.sum()) + most * int(moves.max(initial=0)) * price
        return np.where(shut, min(max(2 * gain, 10 * int(moves.max(initial=0)) * most), UNLIMITED // (most * price)), moves)

    def keeps_to_moves(self, solution: Any) -> bool:
        """Whether a solution makes no move that is forbidden."""
        shut = self.problem.forbidden
        if shut is None:
            return True
        for route in self.routes(solution):
            vehicle = self.problem.fleet[route.vehicle]
            stops = [vehicle.start, *route.visits, vehicle.end]
            if shut[stops[:-1], stops[1:]].any():
                return False
        return True

    def routes(self, solution: Any) -> Routes:
        """The routes of a solution."""
        return Routes.of(Route(tuple(self._stops(route)), self.types[route.vehicle_type()]) for route in solution.routes())

    def _stops(self, route: Any) -> list[int]:
        shipments, stops = self.problem.sites.shipments, []
        for a in route.schedule()[1:-1]:
            if a.is_client():
                stops.append(self.clients[a.idx])
            elif a.is_depot():
                stops.append(self.depots[a.idx])
            else:
                stops.append(shipments[a.idx].pickup if a.is_pickup() else shipments[a.idx].delivery)
        return stops

    def solution(self, answer: Routes) -> Any:
        """An answer as PyVRP's, feasible or not; None if it cannot represent it."""
        import pyvrp

        kinds = pyvrp.ActivityType
        activity = {site: pyvrp.Activity(kinds.CLIENT, copies[0]) for site, copies in self.places.items()}
        activity |= {site: pyvrp.Activity(kinds.DEPOT, k) for site, k in self.turn.items()}
        for k, shipment in enumerate(self.problem.sites.shipments):
            activity |= {shipment.pickup: pyvrp.Activity(kinds.PICKUP, k), shipment.delivery: pyvrp.Activity(kinds.DELIVERY, k)}
        number = {k: at for at, k in enumerate(self.types)}
        for route in answer if any(len(copies) > 1 for copies in self.places.values()) else ():
            for site, begin in zip(route.visits, schedule(self.problem, route).begin.tolist(), strict=True):
                at = [k for k, (_, closes) in enumerate(self.problem.sites.windows[site]) if begin <= widened(closes)]
                if len(self.places.get(site, ())) > 1 and at:
                    activity[site] = pyvrp.Activity(kinds.CLIENT, self.places[site][at[0]])
        try:
            routes = [pyvrp.Route(self.data, [activity[site] for site in route.visits], number[route.vehicle]) for route in answer]
            return pyvrp.Solution(self.data, routes)
        except (KeyError, RuntimeError, ValueError, IndexError):
            return None

    def _window(self, site: int) -> tuple[int, int]:
        return int(self.integers.ready[site]), int(self.integers.due[site])

    def _loads(self, values: Integers, skills: frozenset[str]) -> list[int]:
        return [int(v) * self.factor for v in values[self.integers.limited]] + [self.factor * (word in skills) for word in self.words]

    def _skills(self, *sites: int) -> frozenset[str]:
        return frozenset().union(*(self.problem.sites.skills[site] for site in sites)) if self.words else frozenset()

    def _client(self, pyvrp: Any, site: int, window: tuple[int, int], group: int | None) -> Any:
        data = self.integers
        return pyvrp.Client(
            site, delivery=self._loads(data.demand[site], self._skills(site)), pickup=self._loads(data.pickup[site], frozenset()),
            service_duration=int(data.service[site]), tw_early=window[0], tw_late=window[1], prize=int(data.prize[site]),
            required=group is None and bool(self.problem.sites.required[site]), group=group,
        )  # fmt: skip

    def _shipment(self, pyvrp: Any, number: int) -> Any:
        shipment, data = self.problem.sites.shipments[number], self.integers
        first, last = shipment.pickup, shipment.delivery
        return pyvrp.Shipment(
            first, last, *self._window(first), int(data.service[first]), *self._window(last), int(data.service[last]),
            amount=self._loads(data.shipped[number], self._skills(first, last)), prize=int(data.prize[first] + data.prize[last]),
            required=bool(self.problem.sites.required[first]),
        )  # fmt: skip

    def _type(self, pyvrp: Any, k: int) -> Any:
        data, vehicle, most = self.integers, self.problem.fleet[k], len(self.problem.customers)
        room = [min(int(data.capacity[k, dimension]) * self.factor, UNLIMITED) for dimension in data.limited]
        room += [self.factor * 2 * most if word in vehicle.skills else 0 for word in self.words]
        longest, regular = int(data.max_duration[k]), int(min(data.regular_duration[k], data.max_duration[k]))
        turns = [self.turn[site] for site in vehicle.reloads]
        return pyvrp.VehicleType(
            num_available=most if vehicle.count is None else min(vehicle.count, most),
            capacity=room,
            start_depot=self.depots.index(vehicle.start), end_depot=self.depots.index(vehicle.end),
            fixed_cost=int(data.fixed[k]), unit_distance_cost=int(data.unit[k]), unit_duration_cost=int(data.time[k]),
            tw_early=int(data.opens[k]), tw_late=int(data.closes[k]), start_late=int(data.leaves[k]),
            shift_duration=regular, max_overtime=longest - regular, unit_overtime_cost=int(data.overtime[k]),
            max_distance=int(min(data.max_distance[k], data.travel_reach[k])),
            profile=int(data.profile[k]), reload_depots=turns,
            **({} if vehicle.max_reloads is None else {"max_reloads": vehicle.max_reloads}),
        )  # fmt: skip


def _timed(data: IntegerRouting) -> bool:
    """Whether any time is limited or priced."""
    limits = (data.due, data.closes, data.leaves, data.max_duration, data.regular_duration)
    priced = data.time.any() or data.overtime.any()
    several = any(len(listed) > 1 for listed in data.windows)
    return bool(priced or several or data.ready.any() or any((limit != UNLIMITED).any() for limit in limits))


def load_factor(data: IntegerRouting) -> int:
    """Power of ten by which loads are multiplied, so that too much load can never pay.

    PyVRP prices a unit of excess load at 1e5 at most; where costs count in millionths that is next to nothing.
    """
    dear = int((data.time + data.overtime).max())
    moved = [m.longest * int(data.unit.max()) + (m.slowest * dear if dear else 0) for m in data.moves]
    gain = max(*moved, int(data.fixed.max()), int(data.prize.max()))
    carried = max(int(values.sum()) for values in (data.demand, data.pickup, data.shipped))
    factor, most = 1, UNLIMITED // max(1, 10 * max(carried, len(data.demand)))
    while factor * MAX_PENALTY < 10 * gain and factor <= most:
        factor *= 10
    return factor
