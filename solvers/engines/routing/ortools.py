"""The OR-Tools routing library: insertion heuristics, local search and guided local search."""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Route, Routes
from ....instances.errors import UsageError
from ...backend import BACKENDS, Control, Options, RawResult
from ...own_options import own_options
from .bisection import USUAL_FEATURES, Bisecting
from .ortools_model import Model
from .pace import Pace
from .routing_integers import IntegerRouting, entangled, integer_routing, with_slope
from .routing_objective import awaited, claimed_objective, stops_between, unscalable

STATUS_MAP = {
    "ROUTING_NOT_SOLVED": ("unknown", "none"),
    "ROUTING_SUCCESS": ("feasible", "none"),
    "ROUTING_PARTIAL_SUCCESS_LOCAL_OPTIMUM_NOT_REACHED": ("feasible", "time"),
    "ROUTING_FAIL": ("unknown", "none"),
    "ROUTING_FAIL_TIMEOUT": ("unknown", "time"),
    "ROUTING_INVALID": ("error", "none"),
    "ROUTING_INFEASIBLE": ("unknown", "none"),
    "ROUTING_OPTIMAL": ("feasible", "none"),
}
"""The library's account of its search. It proves nothing about the problem: its fleet is cut to size, its data rounded."""

MOST_TRIED = 50
"""Customers, and vehicle types for them, that are tried for one more route."""

FIRST = 0.3
"""Part of the time in which routes are found, however few, where a least number of them is asked for."""

DURATIONS = frozenset({"max-duration", "energy:elapsed", "duration-cost", "overtime", "objective:total-duration"})
"""Features that ask for the least duration of a route."""


@BACKENDS.register("ortools")
class ORTools(Bisecting):
    """OR-Tools routing library (Perron & Furnon): cheapest insertion, then guided local search, or tabu search
    where moves cost nothing. Where rewards are all that counts, cheapest arcs and tabu search, the shorter way being the better of two.

    ``iterations`` counts solutions. Extra options are the scalar fields of its search parameters:
    ``first_solution_strategy``, ``local_search_metaheuristic`` (or ``metaheuristic``), ...

    The library holds Python's global lock for the whole search, so nothing else runs in its process: it gets one of
    its own, and publishes its incumbents from there.
    """

    name = "ortools"
    package = "ortools"
    modules = ("ortools.constraint_solver.pywrapcp", "ortools.constraint_solver.routing_enums_pb2")
    summary = "OR-Tools routing library: insertion and guided local search"
    options = None
    order = 20
    interrupts = "ends at its next local optimum, or is ended; the best published answer counts"
    needs_process = True
    own_maxima = True
    iterations_end = False
    one_thread = True
    bytes_a_move, seconds_a_move = 120.0, 4e-7
    features = USUAL_FEATURES | {
        "energy:windows", "overtime", "groups", "reloads", "recharging", "closing-moves", "forbidden-moves", "committed-vehicles",
        "min-vehicles",
    }  # fmt: skip

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        held = problem.features()
        lacking = unscalable(problem) | (entangled(problem) - {"shipments of sites with demands or pickups"})
        if "objective:makespan" in held and awaited(problem):
            # Spans of the library's dimensions are costs one by one; the largest of several is one only where all begin together.
            lacking |= {"objective:makespan with waiting"}
        if "closing-moves" in held:
            ways = [problem.travel_of(k).closing for k in range(len(problem.fleet))]
            closed = [w for w in ways if w is not None]
            if len(closed) < len(ways) or any(not np.array_equal(w, closed[0]) for w in closed):
                lacking |= {"closing-moves of some vehicles"}
            if awaited(problem):  # least durations depart late, and moves close
                lacking |= {f"{name} with closing-moves" for name in held & DURATIONS}
        if "energy:windows" in held and held & {"reloads", "recharging"}:
            lacking |= {"energy:windows with stops at depots"}
        if {"committed-vehicles", "objective:vehicles"} <= held:
            lacking |= {"objective:vehicles with committed-vehicles"}
        return lacking

    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        control.begin_set_up()
        began = time.perf_counter()
        data = integer_routing(problem)
        if not problem.min_vehicles or options.start is not None:
            return replace(_Search(problem, data, options, control, began).run(), holds=data.holds, links=(data.link,))
        # Insertion ends with as few routes as it needs, and no move of the library makes more of them: it begins with enough.
        half = None if options.iterations is None else -(-options.iterations // 2)
        first = replace(options, iterations=half, time_limit=options.time_limit * (1.0 if half else FIRST))
        free, unheard = replace(problem, min_vehicles=0), Control()
        unheard.begin_set_up()
        unheard.on_set_up = control.end_set_up
        control.on_stop(unheard.stop)
        fewer = _Search(free, data, first, unheard, began).run().answer
        start = None if fewer is None else with_more_routes(problem, fewer)
        if start is None:
            return RawResult("unknown", "interrupt" if control.stopped else "none", message="OR-Tools found too few routes")
        rest = replace(options, start=start, iterations=half, time_limit=options.time_limit - (time.perf_counter() - began))
        result = _Search(problem, data, rest, control, time.perf_counter()).run()
        statistics = {name: value for name, value in result.statistics.items() if name != "start"}
        return replace(result, statistics=statistics, holds=data.holds, links=(data.link,))


class _Search:
    """One run: publishes its incumbents and asks for its end from within the library's callback."""

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, options: Options, control: Control, began: float) -> None:
        self.problem, self.options, self.control = problem, options, control
        stops, rewarded = bool(stops_between(problem)), bool(data.prize.any()) and not data.fixed.any()
        self.data = with_slope(problem, data) if stops or rewarded else data
        self.sloped = self.data is not data
        self.rewarded = self.sloped and not stops
        self.began, self.ends = began, began + options.time_limit
        self.solutions = 0
        self.pace = Pace()
        self.cost: int | None = None
        self.answer: Routes | None = None
        self.claim: float | None = None

    def run(self) -> RawResult:
        if not len(self.problem.customers) and not any(v.committed for v in self.problem.fleet):
            return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
        for most, droppable in self._attempts():
            model = Model(self.problem, self.data, most, droppable)
            if not model.types:
                message = "no vehicle can leave its depot and return in time"
                return RawResult("infeasible" if self.problem.sites.required.any() else "unknown", message=message)
            result = self._solve(model)
            if result.answer is not None or result.limit != "none":
                break
        return result

    def _attempts(self) -> list[tuple[int, bool]]:
        """Vehicles of an unlimited type, half of the stops at a depot, and whether customers may be left out, in the order of trial.

        The library's search slows down with every vehicle that it could use: first come a few times what the load asks for, then as many as
        there are customers.
        """
        customers = len(self.problem.customers)
        first = min(customers, max(25, 3 * self.data.fewest()))
        wider = first < customers and any(v.count is None or v.reloads or v.stations for v in self.problem.fleet)
        return [(first, False), *([(customers, False)] if wider else []), (customers, True)]

    def _solve(self, model: Model) -> RawResult:
        from ortools.constraint_solver import routing_enums_pb2

        routing = model.routing
        parameters = _parameters(
            self.options, max(0.0, self.ends - time.perf_counter()), guided=bool(self.data.unit.any()), rewarded=self.rewarded
        )
        routing.solver().ReSeed(self.options.seed % 2**31)
        routing.CloseModelWithParameters(parameters)
        self.control.end_set_up(time.perf_counter() - self.began)

        def at_solution() -> None:
            self.solutions += 1
            cost = routing.CostVar().Max()
            if self.pace.due and (self.cost is None or cost < self.cost):
                with self.pace.handing_out():
                    self._take(cost, model, lambda i: routing.NextVar(i).Value())
            if self.control.stopped:
                routing.solver().FinishCurrentSearch()

        routing.AddAtSolutionCallback(at_solution)
        start = None if self.options.start is None else model.assignment(self.options.start)
        if start is not None:
            last = routing.SolveFromAssignmentWithParameters(start, parameters)
        else:
            last = routing.SolveWithParameters(parameters)
        if last is not None:
            # The clock decides which incumbents were published, so among equals the library's last word counts.
            self._take(last.ObjectiveValue(), model, lambda i: last.Value(routing.NextVar(i)), ties=True)
        said = routing_enums_pb2.RoutingSearchStatus.Value.Name(routing.status())
        status, limit = STATUS_MAP.get(said, ("unknown", "none"))
        if self.answer is not None:
            status = "feasible"
        elif status == "feasible":
            status = "unknown"
        if self.control.stopped:
            limit = "interrupt"
        elif self.options.iterations is not None and self.solutions >= self.options.iterations:
            limit = "iterations"
        elif time.perf_counter() >= self.ends - 0.01:
            limit = "time"
        statistics = {"solutions": self.solutions, "vehicles": len(model.types), "search": said, "scale": self.data.scales}
        if self.options.start is not None:
            statistics["start"] = "used" if start is not None else "refused"
        message = "" if self.answer is not None else f"OR-Tools found no answer that visits every {self._required()} (it ended with {said})"
        return RawResult(status, limit, self.answer, self.claim, statistics=statistics, message=message)

    def _take(self, cost: int, model: Model, successor: Callable[[int], int], ties: bool = False) -> None:
        """Publish an answer if it is better (or, with ``ties``, no worse) than all before and leaves no required customer or group out."""
        if self.cost is not None and (cost > self.cost or (cost == self.cost and not ties)):
            return
        answer = model.routes(successor)
        sites = self.problem.sites
        visited = np.zeros(len(sites), dtype=bool)
        visited[[site for route in answer for site in route.visits]] = True
        if (visited | ~sites.required).all() and all(visited[list(g.sites)].any() for g in sites.groups if g.required):
            self.cost, self.answer, self.claim = cost, answer, self._claim(cost, model, answer)
            self.control.publish(answer, self.claim)

    def _required(self) -> str:
        sites = self.problem.sites
        groups = any(g.required for g in sites.groups)
        return ("required site and group" if sites.required.any() else "required group") if groups else "required site"

    def _claim(self, cost: int, model: Model, answer: Routes) -> float | None:
        data = self.data
        if self.sloped or data.maxima.any() or ((data.time.any() or data.overtime.any()) and not data.scales["exact"]):
            # Durations are rounded up, move by move, and the largest value is counted from the earliest departure.
            return self.problem.evaluate(answer).values[0] if len(self.problem.senses) == 1 else None
        return claimed_objective(self.problem, (cost - model.offset) / data.cost_factor)


def with_more_routes(problem: RoutingProblem, answer: Routes) -> Routes | None:
    """The answer with ``min_vehicles`` routes at least, each further one a customer to whom that is the least detour.

    The answer is feasible but for the number of its routes. None where it does not work out, though other choices might.
    """
    lacking = problem.min_vehicles - sum(bool(route.visits) for route in answer)
    for _ in range(lacking):
        tried = (_alone(answer, *place) for _, *place in sorted(_places(problem, answer))[:MOST_TRIED])
        answer = next((one for one in tried if {v.check for v in problem.evaluate(one).violations} <= {"fleet"}), answer)
    return answer if problem.evaluate(answer).feasible else None


def _places(problem: RoutingProblem, answer: Routes) -> list[tuple[float, int, int, int]]:
    """Places for one more route: by how much all routes get longer, then route, position and new vehicle type of a customer who leaves
    others behind, or -1 and the site where it was left out before."""
    used, visited = Counter(route.vehicle for route in answer if route.visits), {site for route in answer for site in route.visits}
    places = []
    for kind, vehicle in enumerate(problem.fleet):
        if vehicle.count is not None and used[kind] >= vehicle.count:
            continue
        far = problem.travel_of(kind).distances
        for site in set(problem.customers.tolist()) - visited:
            places.append((float(far[vehicle.start, site] + far[site, vehicle.end]), -1, site, kind))
        for number, route in enumerate(answer.routes):
            served = [at for at, site in enumerate(route.visits) if not problem.sites.depot[site]]
            old, own = problem.fleet[route.vehicle], problem.travel_of(route.vehicle).distances
            stops = (old.start, *route.visits, old.end)
            for at in served if len(served) > 1 else ():
                before, site, after = stops[at : at + 3]
                longer = far[vehicle.start, site] + far[site, vehicle.end] + own[before, after] - own[before, site] - own[site, after]
                places.append((float(longer), number, at, kind))
    return places


def _alone(answer: Routes, number: int, at: int, kind: int) -> Routes:
    """The answer with a customer of ``_places`` on a route of his own."""
    if number < 0:
        return Routes((*answer.routes, Route((at,), kind)))
    route = answer.routes[number]
    rest = Route(route.visits[:at] + route.visits[at + 1 :], route.vehicle)
    return Routes((*answer.routes[:number], rest, *answer.routes[number + 1 :], Route((route.visits[at],), kind)))


def _parameters(options: Options, seconds: float, guided: bool = True, rewarded: bool = False) -> Any:
    """The library's search parameters, the user's own changes checked against its fields.

    Guided local search puts penalties on costs of moves, and finds nothing where these have none: tabu search does. Insertion fills routes
    in any order where only rewards count, which no later move mends: there routes go to the nearest site at first.
    """
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    parameters = pywrapcp.DefaultRoutingSearchParameters()
    first = routing_enums_pb2.FirstSolutionStrategy
    parameters.first_solution_strategy = first.PATH_CHEAPEST_ARC if rewarded else first.PARALLEL_CHEAPEST_INSERTION
    searches = routing_enums_pb2.LocalSearchMetaheuristic
    parameters.local_search_metaheuristic = searches.GUIDED_LOCAL_SEARCH if guided and not rewarded else searches.TABU_SEARCH
    parameters.time_limit.FromMilliseconds(max(1, round(1000 * min(seconds, 1e9))))
    if options.iterations is not None:
        parameters.solution_limit = options.iterations
    fields = {f.name: f for f in parameters.DESCRIPTOR.fields if not f.is_repeated and f.message_type is None}
    for name in ("solution_limit", "log_search"):
        fields.pop(name)
    extra = {{"metaheuristic": "local_search_metaheuristic"}.get(name, name): value for name, value in options.extra.items()}
    known = {name: None if field.enum_type is not None else getattr(parameters, name) for name, field in fields.items()}
    for name, value in own_options("ortools", extra, known).items():
        if fields[name].enum_type is not None:
            numbers = {v.name: v.number for v in fields[name].enum_type.values}
            word = str(value).upper().replace("-", "_")
            if word not in numbers:
                raise UsageError(f"ortools: {name} is one of {', '.join(numbers)}, not {value!r}", "unknown-name")
            value = numbers[word]
        try:
            setattr(parameters, name, value)
        except (TypeError, ValueError):
            raise UsageError(f"ortools: {value!r} is no value for option {name}", "out-of-range") from None
    return parameters
