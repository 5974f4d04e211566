"""PyVRP: iterated local search for rich vehicle routing problems."""

from __future__ import annotations

import itertools
import math
import time
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.routes import Route, Routes
from ....formulations.routing.schedule import schedule
from ....formulations.tolerance import widened
from ....instances.errors import UsageError
from ...backend import BACKENDS, Control, Options, RawResult
from ...own_options import own_options
from .bisection import USUAL_FEATURES, Bisecting
from .integer_scales import UNLIMITED, Integers
from .pace import Pace
from .routing_integers import IntegerRouting, entangled, integer_routing, with_slope
from .routing_objective import claimed_objective, unscalable

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

LARGEST_WITHIN = 1_500
"""Sites up to which it runs in our own process: it looks for their neighbours in a quarter of a second, during which nothing else runs."""

GROUPS = ("ils", "penalty", "neighbourhood", "perturbation")
"""Groups of parameters of ``pyvrp.SolveParams``."""

MAX_PENALTY = 100_000
"""Largest price of a unit of violation in PyVRP."""


@BACKENDS.register("pyvrp")
class PyVRP(Bisecting):
    """PyVRP (Wouda, Lan & Kool 2024): iterated local search with late acceptance and penalised constraints.

    ``iterations`` counts its iterations. Extra options are fields of ``SolveParams`` by group: ``ils.history_length``,
    ``penalty.target_feasible``, ``neighbourhood.num_neighbours``, ...
    """

    name = "pyvrp"
    package = "pyvrp"
    modules = ("pyvrp",)
    summary = "PyVRP: iterated local search for vehicle routing"
    options = None
    order = 10
    honours = frozenset({"iterations", "no_improvement", "gap"})  # a gap by the bounds that ``solve`` verifies meanwhile
    one_thread = True
    bytes_a_move, seconds_a_move = 35.0, 2.2e-7
    features = USUAL_FEATURES | {"overtime", "groups", "reloads", "forbidden-moves"}

    def apart(self, problem: Problem) -> bool:
        """See ``Engine.apart``: the library holds Python's global lock while it looks for neighbours."""
        return problem.size > LARGEST_WITHIN

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        lacking = unscalable(problem) | entangled(problem)
        driven = [v.energy is not None and v.energy.charge == "travel" for v in problem.fleet]
        if any(d and problem.travel_of(k).own_durations for k, d in enumerate(driven)):
            # Time on the move can only be limited as a distance.
            lacking |= {"energy:travel with separate-durations"}
        if {"shipments", "reloads"} <= problem.features():
            lacking |= {"shipments with reloads"}
        several = problem.sites.windows
        if several and any(several[site] for s in problem.sites.shipments for site in (s.pickup, s.delivery)):
            lacking |= {"several-windows of shipments"}
        if several and any(several[site] for v in problem.fleet for site in v.reloads):
            lacking |= {"several-windows of reloads"}
        return lacking

    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        params = _parameters(options.extra)
        control.begin_set_up()
        began = time.perf_counter()
        data = integer_routing(problem)
        result = _Search(problem, data, options, control, began).run(params)
        return replace(result, holds=data.holds, links=(data.link,))


class _Search:
    """One run: stops it, publishes its incumbents, and translates its answers."""

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, options: Options, control: Control, began: float) -> None:
        self.problem, self.data, self.options, self.control, self.began = problem, with_slope(problem, data), options, control, began
        self.sloped = self.data is not data
        self.timed = bool(data.time.any() or data.overtime.any())
        self.iterations = 0
        self.limit = "none"
        self.pending: Any = None
        self.ends = began + options.time_limit
        self.pace = Pace()
        self.best_cost, self.best_at = math.inf, 0

    def run(self, params: Any) -> RawResult:
        import pyvrp

        if not len(self.problem.customers):
            return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
        self.model = Model(self.problem, self.data)
        if self.model.data is None:
            message = "no vehicle can leave its depot and return in time"
            return RawResult("infeasible" if self.problem.sites.required.any() else "unknown", message=message)
        for moves in self.data.moves:
            moves.forget()  # PyVRP has copied them
        params.ils.callbacks = self._callbacks()
        start = None if self.options.start is None else self.model.solution(self.options.start)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pyvrp.exceptions.PenaltyBoundWarning)
            result = pyvrp.solve(
                self.model.data, self._stop, seed=self.options.seed % 2**32, collect_stats=False, display=False, params=params,
                initial_solution=start,
            )  # fmt: skip
        self.control.end_set_up(time.perf_counter() - self.began)
        statistics: dict[str, Any] = {"iterations": result.num_iterations, "scale": self.data.scales}
        if self.options.start is not None:
            statistics["start"] = "refused" if start is None else "used"
        if not result.is_feasible() or not self.model.keeps_to_moves(result.best):
            return RawResult("unknown", self.limit, statistics=statistics, message="PyVRP found no feasible answer")
        answer = self.model.routes(result.best)
        return RawResult("feasible", self.limit, answer, self._claim(result.best, answer), statistics=statistics)

    def _stop(self, best_cost: float) -> bool:
        now = time.perf_counter()
        self.control.end_set_up(now - self.began)
        if self.pending is not None and self.pace.due:
            with self.pace.handing_out():
                answer = self.model.routes(self.pending)
                self.control.publish(answer, self._claim(self.pending, answer))
            self.pending = None
        if self.control.stopped:
            self.limit = "interrupt"
        elif (self.options.iterations is not None and self.iterations >= self.options.iterations) or (
            self.options.no_improvement is not None and self._idle(best_cost) >= self.options.no_improvement
        ):
            self.limit = "iterations"
        elif now >= self.ends:
            self.limit = "time"
        else:
            self.iterations += 1
            return False
        return True

    def _idle(self, best_cost: float) -> int:
        """Iterations since the best cost last fell."""
        if best_cost < self.best_cost:
            self.best_cost, self.best_at = best_cost, self.iterations
        return self.iterations - self.best_at

    def _callbacks(self) -> Any:
        from pyvrp import IteratedLocalSearchCallbacks

        class Incumbents(IteratedLocalSearchCallbacks):  # type: ignore[misc]
            def on_start(this, ils: Any) -> None:
                this.on_best(ils.initial_solution)

            def on_best(this, best: Any) -> None:
                if best.is_feasible() and self.model.keeps_to_moves(best):
                    self.pending = best

        return Incumbents()

    def _claim(self, solution: Any, answer: Routes) -> float | None:
        if self.sloped or (self.timed and not self.data.scales["exact"]):  # durations are rounded up, move by move
            return self.problem.evaluate(answer).values[0] if len(self.problem.senses) == 1 else None
        cost = solution.distance_cost() + solution.duration_cost() + solution.fixed_vehicle_cost() - solution.prizes()
        return claimed_objective(self.problem, cost / self.data.cost_factor)


def _parameters(extra: dict[str, Any]) -> Any:
    """``SolveParams`` with the user's changes, each checked against the fields there are."""
    import pyvrp
    from pyvrp.IteratedLocalSearch import IteratedLocalSearchParams
    from pyvrp.PenaltyManager import PenaltyParams
    from pyvrp.search import NeighbourhoodParams, PerturbationParams

    kinds = dict(zip(GROUPS, (IteratedLocalSearchParams, PenaltyParams, NeighbourhoodParams, PerturbationParams), strict=True))
    defaults = {group: kind() for group, kind in kinds.items()}
    known = {
        f"{group}.{field}": getattr(default, field)
        for group, default in defaults.items()
        for field in dir(default)
        if not field.startswith("_") and isinstance(getattr(default, field), bool | int | float)
    }
    chosen: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for name, value in own_options("pyvrp", extra, known).items():
        group, _, field = name.partition(".")
        chosen[group][field] = value
    try:
        return pyvrp.SolveParams(**{group: kinds[group](**chosen[group]) for group in GROUPS})
    except (TypeError, ValueError) as fault:
        raise UsageError(f"pyvrp: {fault}", "out-of-range") from None


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

    PyVRP prices a unit of excess load at 1e5 at most; where costs count in millionths that is next to nothing. What it prices stays within
    64 bits: beyond, its search does not end.
    """
    dear = int((data.time + data.overtime).max())
    moved = [m.longest * int(data.unit.max()) + (m.slowest * dear if dear else 0) for m in data.moves]
    gain = max(*moved, int(data.fixed.max()), int(data.prize.max()))
    carried = max(int(values.sum()) for values in (data.demand, data.pickup, data.shipped))
    factor, most = 1, UNLIMITED // (100 * MAX_PENALTY * max(carried, len(data.demand), 1))
    while factor * MAX_PENALTY < 10 * gain and factor <= most:
        factor *= 10
    return factor
