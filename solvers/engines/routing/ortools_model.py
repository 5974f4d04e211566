"""Routing problems as models of the OR-Tools routing library."""

import itertools
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Route, Routes
from .integer_scales import UNLIMITED, Integers
from .ortools_stops import Stop, add_loads, add_stores, count_routes, stops_on_the_way
from .routing_integers import IntegerRouting
from .routing_objective import stops_between

TIMED = frozenset(
    {
        "time-windows", "several-windows", "depot-windows", "shifts", "max-duration", "energy:elapsed", "energy:elapsed-fixed-start",
        "duration-cost", "overtime", "objective:total-duration",
    }
)  # fmt: skip
"""Features for which the library has to know when a vehicle is where."""


class Model:
    """A routing problem as an OR-Tools routing model, with ``most`` vehicles of each unlimited type, and twice as many stops at a depot.

    With ``droppable``, required customers may be left out at a price above any answer's cost: a search that finds no first answer any other
    way starts from an incomplete one. Such answers are not published. ``types`` is the fleet's type of each vehicle, without those that no
    route can use; ``offset`` is what the library's cost holds besides the objective: prizes of all sites, since it counts those of the
    sites left out.
    """

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, most: int, droppable: bool = False) -> None:
        from ortools.constraint_solver import pywrapcp

        self.problem, self.data = problem, data
        self.types = [
            k for k, v in enumerate(problem.fleet) if data.closes[k] >= data.opens[k]
            for _ in range(most if v.count is None else v.count if v.committed else min(v.count, len(problem.customers)))
        ]  # fmt: skip
        if not {k for k, v in enumerate(problem.fleet) if v.committed} <= set(self.types):
            self.types = []  # one that must drive cannot
        if not self.types:
            return
        fleet = [problem.fleet[k] for k in self.types]
        ends = {site for v in fleet for site in (v.start, v.end)}
        places, self.stops = sorted({*ends, *problem.customers.tolist()}), stops_on_the_way(problem, self.types, 2 * most)
        self.node = {site: k for k, site in enumerate(places)}
        self.sites = np.array([*places, *(stop.site for stop in self.stops)])
        self.ends = [self.node[site] for site in sorted(ends)]
        self.manager = pywrapcp.RoutingIndexManager(
            len(self.sites), len(fleet), [self.node[v.start] for v in fleet], [self.node[v.end] for v in fleet]
        )
        self.routing = pywrapcp.RoutingModel(self.manager)
        self.at_stops = [int(self.manager.NodeToIndex(len(places) + k)) for k in range(len(self.stops))]
        self.visited = [(self.index(site), site) for site in problem.customers.tolist()]
        self.visited += [(index, stop.site) for index, stop in zip(self.at_stops, self.stops, strict=True)]
        self.evaluators: dict[Any, int] = {}
        self.offset = int(data.prize[problem.sites.required].sum())
        dearer = self._choices(self._dear() if droppable else None)
        self._costs(dearer)
        self._loads()
        self._lengths()
        self._times(pywrapcp)
        self._skills()
        self._shipments()
        self._stores()
        self._forbidden()
        customers = [self.index(site) for site in problem.customers.tolist()]
        count_routes(self.routing, len(self.types), customers, problem.min_vehicles, bool(self.stops))

    def index(self, site: int) -> int:
        """The library's index of a customer."""
        return int(self.manager.NodeToIndex(self.node[site]))

    def _dear(self) -> int:
        """More than any visit can save."""
        data = self.data
        moved = max(int(m.distance_up.max(initial=0)) for m in data.moves) * int(data.unit.max() + data.maxima[1])
        priced = int(data.time.max() + data.overtime.max() + data.maxima[0] + data.maxima[2])
        moved *= 1 + stops_between(self.problem)
        return 1 + 2 * moved + int(data.fixed.max() + data.prize.sum()) + (self._horizon() * priced if priced else 0)

    def _choices(self, dear: int | None) -> Integers:
        """Let sites be left out at a price; returns what it costs more to visit one of a group than its best."""
        data, sites = self.data, self.problem.sites
        dearer = np.zeros(len(sites), dtype=np.int64)
        grouped: set[int] = set()
        for group in sites.groups:
            grouped.update(group.sites)
            top = int(data.prize[list(group.sites)].max())
            dearer[list(group.sites)] = top - data.prize[list(group.sites)]
            self.offset += top
            indices = [self.index(site) for site in group.sites]
            if group.required and dear is None:
                self.routing.AddDisjunction(indices)
            else:
                self.routing.AddDisjunction(indices, dear if group.required else top, 1)
        for site in self.problem.customers.tolist():
            if not sites.required[site] and site not in grouped:
                self.offset += int(data.prize[site])
                self.routing.AddDisjunction([self.index(site)], int(data.prize[site]))
            elif sites.required[site] and dear is not None:
                self.routing.AddDisjunction([self.index(site)], dear)
        for index in self.at_stops:
            self.routing.AddDisjunction([index], 0)
        return dearer

    def _matrix(self, kind: int, name: Any, values: Callable[[], Integers], less: Integers | None = None) -> int:
        """The evaluator of a matrix for a vehicle type, from nodes with ``less``. A vehicle that serves nobody stays where it is, wherever
        its route would end, unless it is committed."""
        committed = self.problem.fleet[kind].committed
        key = (name, int(self.data.profile[kind]), committed)
        if key not in self.evaluators:
            matrix = values()[np.ix_(self.sites, self.sites)]
            if less is not None:
                matrix -= less[:, None]
            if not committed:
                matrix[np.ix_(self.ends, self.ends)] = 0
            self.evaluators[key] = int(self.routing.RegisterTransitMatrix(matrix.tolist()))
        return self.evaluators[key]

    def _evaluator(self, name: str, matrices: list[Integers], kind: int, less: Integers | None = None) -> int:
        """The evaluator of a vehicle type, of one matrix for each kind of travel."""
        return self._matrix(kind, name, lambda: matrices[int(self.data.profile[kind])], less)

    def _costs(self, dearer: Integers) -> None:
        for vehicle, k in enumerate(self.types):
            unit, profile = int(self.data.unit[k]), int(self.data.profile[k])
            evaluator = self._matrix(k, ("cost", unit), partial(self._priced, unit, profile, dearer))
            self.routing.SetArcCostEvaluatorOfVehicle(evaluator, vehicle)
            if self.problem.fleet[k].committed:
                self.routing.SetVehicleUsedWhenEmpty(True, vehicle)
                self.offset -= int(self.data.fixed[k])
            elif self.data.fixed[k]:
                self.routing.SetFixedCostOfVehicle(int(self.data.fixed[k]), vehicle)

    def _priced(self, unit: int, profile: int, dearer: Integers) -> Integers:
        return self.data.moves[profile].distance * unit + dearer[None, :]

    def _loads(self) -> None:
        data, shipments = self.data, self.problem.sites.shipments
        for k in data.limited:
            delivered, change = data.demand[:, k], data.pickup[:, k].copy()
            for number, shipment in enumerate(shipments):
                change[shipment.pickup] += data.shipped[number, k]
                change[shipment.delivery] -= data.shipped[number, k]
            most = int(delivered.sum() + data.pickup[:, k].sum() + data.shipped[:, k].sum())
            limits = np.minimum(data.capacity[self.types, k], most).tolist()
            if any(stop.reloads for stop in self.stops):
                shipped = change - data.pickup[:, k]
                carried = delivered[self.sites], data.pickup[:, k][self.sites], shipped[self.sites]
                turns = [(index, node) for index, node, stop in self._numbered() if stop.reloads]
                add_loads(self.routing, carried, limits, str(k), turns)
                continue
            if not change.any():
                self._load(delivered, limits, True, f"load {k}")
                continue
            # What is on board: all that is delivered on the way at first, less what has been, and what has been picked up.
            self._load(change - delivered, limits, not delivered.any(), f"load {k}")
            if delivered.any():
                self._load(delivered, limits, True, f"delivered {k}")
                board, total = (self.routing.GetDimensionOrDie(f"{name} {k}") for name in ("load", "delivered"))
                for vehicle in range(len(self.types)):
                    begins, ends = board.CumulVar(self.routing.Start(vehicle)), total.CumulVar(self.routing.End(vehicle))
                    self.routing.solver().Add(begins == ends)

    def _load(self, values: Integers, limits: list[int], empty: bool, name: str, *, every: bool = False) -> None:
        """A dimension of ``values`` a site, or one of ``every`` node."""
        evaluator = self.routing.RegisterUnaryTransitVector((values if every else values[self.sites]).tolist())
        self.routing.AddDimensionWithVehicleCapacity(evaluator, 0, limits, empty, name)

    def _lengths(self) -> None:
        """Limits on distance, time on the move and charge; the longest distance."""
        data, many = self.data, 2 * len(self.sites)
        for name, limit, attribute in (
            ("distance", data.max_distance, "distance_up"), ("travel", data.travel_limit, "duration"),
            ("charge", data.charge_limit, "charge"),
        ):  # fmt: skip
            counted = name == "distance" and data.maxima[1]
            if not counted and not (limit[self.types] != UNLIMITED).any():
                continue
            matrices = [getattr(moves, attribute) for moves in data.moves]
            matrices = [np.zeros_like(data.moves[0].duration) if m is None else m for m in matrices]
            most = many * max(int(m.max(initial=0)) for m in matrices)
            evaluators = [self._evaluator(name, matrices, k) for k in self.types]
            limits = np.minimum(limit[self.types], most).tolist()
            self.routing.AddDimensionWithVehicleTransitAndCapacity(evaluators, 0, limits, True, name)
            if counted:
                self.routing.GetDimensionOrDie(name).SetGlobalSpanCostCoefficient(int(data.maxima[1]))

    def _numbered(self) -> Iterator[tuple[int, int, Stop]]:
        """Index and node of each stop."""
        return zip(self.at_stops, range(len(self.node), len(self.sites)), self.stops, strict=True)

    def _stores(self) -> None:
        """Dimensions of stores that are filled up on the way; how often vehicles stop to reload; who may stop where."""
        routing, data, fleet = self.routing, self.data, self.problem.fleet
        for index, _, stop in self._numbered():
            able = [vehicle for vehicle, k in enumerate(self.types) if k in stop.kinds]
            if len(able) < len(self.types):
                routing.VehicleVar(index).SetValues([-1, *able])
            routing.NextVar(index).RemoveValues([other for other, _, s in self._numbered() if s.site == stop.site and other != index])
        if any(fleet[k].max_reloads is not None for k in self.types) and self.stops:
            counted = np.zeros(len(self.sites), dtype=np.int64)
            counted[[node for _, node, stop in self._numbered() if stop.reloads]] = 1
            most = [len(self.stops) if (limit := fleet[k].max_reloads) is None else limit for k in self.types]
            self._load(counted, most, True, "reloads", every=True)
        if not any(fleet[k].stations for k in self.types):
            return
        reach = int(max(data.store[k] for k in self.types if fleet[k].stations))
        anew = np.zeros(len(self.sites), dtype=np.int64)
        anew[[node for _, node, stop in self._numbered() if stop.recharges]] = reach
        matrices = [m.duration for m in data.moves]
        idle = int(routing.RegisterUnaryTransitVector((-anew).tolist()))
        evaluators = [self._evaluator("store", matrices, k, anew) if fleet[k].stations else idle for k in self.types]
        stores = [(int(data.store[k]), int(data.store_lacking[k])) if fleet[k].stations else (reach, 0) for k in self.types]
        add_stores(routing, evaluators, stores, [index for index, _, stop in self._numbered() if stop.recharges])

    def _moves(self) -> list[Integers]:
        return [self.data.service[:, None] + m.duration for m in self.data.moves]

    def _horizon(self) -> int:
        """A time after which no earliest schedule ends, and none of least duration."""
        longest = np.max([m.max(axis=1) for m in self._moves()], axis=0)
        latest = max(int(self.data.opens.max()), *(listed[-1][0] for listed in self.data.windows))
        return latest + int(longest[self.sites].sum())

    def _times(self, pywrapcp: Any) -> None:
        """Clocks of three kinds: with any departure, with the earliest, and one that stands still until the departure."""
        data, routing, horizon = self.data, self.routing, self._horizon()
        moves = self._moves()
        ends = np.zeros(len(self.sites), dtype=np.int64)
        ends[self.ends] = data.service[self.sites[self.ends]]  # which depots take on the way alone
        evaluators = [self._evaluator("time", moves, k, ends) for k in self.types]
        if TIMED & self.problem.features():
            routing.AddDimensionWithVehicleTransits(evaluators, horizon, horizon, False, "time")
            time = routing.GetDimensionOrDie("time")
            self._windows(time, 0, horizon)
            for vehicle, k in enumerate(self.types):
                time.CumulVar(routing.Start(vehicle)).SetRange(int(data.opens[k]), int(min(data.leaves[k], horizon)))
                if data.max_duration[k] != UNLIMITED:
                    time.SetSpanUpperBoundForVehicle(int(min(data.max_duration[k], horizon)), vehicle)
                if data.time[k]:
                    time.SetSpanCostCoefficientForVehicle(int(data.time[k]), vehicle)
                if data.overtime[k]:
                    beyond = pywrapcp.BoundCost(int(min(data.regular_duration[k], horizon)), int(data.overtime[k]))
                    time.SetSoftSpanUpperBoundForVehicle(beyond, vehicle)
        closing = data.moves[0].closing
        if data.maxima[2] or closing is not None:
            routing.AddDimensionWithVehicleTransits(evaluators, horizon, horizon, True, "return")
            clock, first = routing.GetDimensionOrDie("return"), int(data.opens.min())
            self._windows(clock, first, horizon)
            for vehicle, k in enumerate(self.types):
                clock.SlackVar(routing.Start(vehicle)).SetMin(int(data.opens[k]) - first)
            if data.maxima[2]:
                clock.SetGlobalSpanCostCoefficient(int(data.maxima[2]))
            if closing is not None:
                self._closing(clock, closing, first, horizon)
        if data.maxima[0]:  # nobody waits: see ``missing``
            routing.AddDimensionWithVehicleTransits(evaluators, 0, horizon, True, "duration")
            routing.GetDimensionOrDie("duration").SetGlobalSpanCostCoefficient(int(data.maxima[0]))

    def _forbidden(self) -> None:
        """Forbid moves; a vehicle that stays at home makes none."""
        shut = self.problem.forbidden
        if shut is None:
            return
        routing = self.routing
        starts, heads = self._starts_and_sites()
        for index in range(routing.Size()):
            free = {index}  # a site that is left out is its own next
            if index in starts and not self.problem.fleet[starts[index]].committed:
                free.update(routing.End(vehicle) for vehicle in range(len(self.types)))
            routing.NextVar(index).RemoveValues([j for j in np.nonzero(shut[heads[index], heads])[0].tolist() if j not in free])

    def _starts_and_sites(self) -> tuple[dict[int, int], Integers]:
        """Vehicle type of each index at which a route starts, and the site of each index."""
        starts = {self.routing.Start(vehicle): k for vehicle, k in enumerate(self.types)}
        nodes = [self.manager.IndexToNode(index) for index in range(self.routing.Size() + len(self.types))]
        return starts, self.sites[nodes]

    def _closing(self, clock: Any, closing: Integers, first: int, horizon: int) -> None:
        """Have moves begin in time; that to the own index, of a site left out, always does."""
        routing, data = self.routing, self.data
        starts, heads = self._starts_and_sites()
        for index in range(routing.Size()):
            site = int(heads[index])
            service = 0 if index in starts else int(data.service[site])
            latest = np.minimum(closing[site, heads], horizon + service) - service - first
            latest[index] = horizon
            if index not in starts:
                routing.solver().Add(clock.CumulVar(index) <= routing.solver().Element(latest.tolist(), routing.NextVar(index)))
                continue
            kind = starts[index]
            late = np.nonzero(latest < int(data.opens[kind]) - first)[0]
            home = () if self.problem.fleet[kind].committed else [routing.End(v) for v in range(len(self.types))]
            routing.NextVar(index).RemoveValues([int(j) for j in late if j not in home])

    def _windows(self, clock: Any, first: int, horizon: int) -> None:
        """Windows of sites and returns on a clock that begins at ``first``."""
        data = self.data
        for index, site in self.visited:
            begins, windows = clock.CumulVar(index), data.windows[site]
            if windows[-1][1] < first:
                self.routing.solver().Add(self.routing.ActiveVar(index) == 0)
                continue
            begins.SetRange(max(0, windows[0][0] - first), int(min(windows[-1][1], horizon)) - first)
            for (_, closes), (opens, _) in itertools.pairwise(windows):
                if closes + 1 < opens and opens > first:
                    begins.RemoveInterval(max(0, closes + 1 - first), opens - 1 - first)
        for vehicle, k in enumerate(self.types):
            clock.CumulVar(self.routing.End(vehicle)).SetRange(0, int(min(data.closes[k], horizon)) - first)

    def _skills(self) -> None:
        for site in self.problem.customers.tolist() if self.problem.sites.skills else ():
            asked = self.problem.sites.skills[site]
            able = [vehicle for vehicle, k in enumerate(self.types) if asked <= self.problem.fleet[k].skills]
            if not able:
                self.routing.solver().Add(self.routing.ActiveVar(self.index(site)) == 0)
            elif len(able) < len(self.types):
                self.routing.VehicleVar(self.index(site)).SetValues([-1, *able])

    def _shipments(self) -> None:
        shipments, solver = self.problem.sites.shipments, self.routing.solver()
        if not shipments:
            return
        self.routing.AddConstantDimension(1, len(self.sites) + 2, True, "position")
        position = self.routing.GetDimensionOrDie("position")
        for shipment in shipments:
            first, last = self.index(shipment.pickup), self.index(shipment.delivery)
            self.routing.AddPickupAndDelivery(first, last)
            solver.Add(self.routing.VehicleVar(first) == self.routing.VehicleVar(last))
            solver.Add(position.CumulVar(first) <= position.CumulVar(last))

    def routes(self, successor: Callable[[int], int]) -> Routes:
        """The routes of ``successor``, a function from an index to the next one."""
        routes = []
        for vehicle, kind in enumerate(self.types):
            at, visits = successor(self.routing.Start(vehicle)), []
            while not self.routing.IsEnd(at):
                visits.append(int(self.sites[self.manager.IndexToNode(at)]))
                at = successor(at)
            routes.append(Route(tuple(visits), kind))
        return Routes.of(routes)

    def assignment(self, answer: Routes) -> Any:
        """A start for the search; None if the library cannot take the answer."""
        free: dict[int, list[int]] = {}
        for vehicle, kind in enumerate(self.types):
            free.setdefault(kind, []).append(vehicle)
        routes: list[list[int]] = [[] for _ in self.types]
        stops = list(zip(self.at_stops, self.stops, strict=True))
        for route in answer:
            if not free.get(route.vehicle) or not set(self.sites.tolist()) >= set(route.visits):
                return None
            indices = []
            for site in route.visits:
                if not self.problem.sites.depot[site]:
                    indices.append(self.index(site))
                    continue
                at = next((k for k, (_, stop) in enumerate(stops) if stop.site == site and route.vehicle in stop.kinds), None)
                if at is None:
                    return None
                indices.append(stops.pop(at)[0])
            routes[free[route.vehicle].pop(0)] = indices
        return self.routing.ReadAssignmentFromRoutes(routes, True)
