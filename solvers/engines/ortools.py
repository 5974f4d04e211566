"""The OR-Tools routing library: insertion heuristics, local search and guided local search."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...formulations.problem import Problem
from ...formulations.routing.routes import Route, Routes
from ...instances.errors import UnsupportedError, UsageError
from ..backend import BACKENDS, Control, Engine, Options, RawResult
from ..own_options import own_options
from .routing_integers import UNLIMITED, IntegerRouting, Integers, integer_routing
from .routing_objective import claimed_objective, unscalable

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem

PUBLISH_EVERY = 0.05
"""Seconds between two published incumbents, so that a flood of early ones costs nothing."""

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


@BACKENDS.register("ortools")
class ORTools(Engine):
    """OR-Tools routing library (Perron & Furnon): cheapest insertion, then guided local search.

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
    one_thread = True
    family = "routing"
    features = frozenset(
        {
            "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "optional-sites",
            "limited-fleet", "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations",
            "energy:travel", "energy:elapsed", "energy:elapsed-fixed-start", "energy:windows", "objective:total-cost",
            "objective:vehicles", "objective:reward", "objective:weights", "objective:priorities",
        }
    )  # fmt: skip

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        lacking = super().missing(problem)
        return lacking or unscalable(problem)  # type: ignore[arg-type]

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        began = time.perf_counter()
        data = integer_routing(problem)  # type: ignore[arg-type]
        return replace(_Search(problem, data, options, control, began).run(), holds=data.holds, links=(data.link,))  # type: ignore[arg-type]


class Model:
    """A routing problem as an OR-Tools routing model.

    Parameters
    ----------
    problem : RoutingProblem
    data : IntegerRouting
    most : int
        Vehicles of each unlimited type.
    droppable : bool
        Let required customers be left out at a price above any answer's cost: a search that finds no first answer any
        other way starts from an incomplete one. Such answers are not published.
    """

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, most: int, droppable: bool = False) -> None:
        from ortools.constraint_solver import pywrapcp

        self.problem, self.data = problem, data
        self.types = [
            k for k, v in enumerate(problem.fleet)
            if min(data.due[v.end], data.latest_return[k]) >= data.ready[v.start]
            for _ in range(most if v.count is None else min(v.count, len(problem.customers)))
        ]  # fmt: skip
        if not self.types:
            return
        fleet = [problem.fleet[k] for k in self.types]
        ends = {site for v in fleet for site in (v.start, v.end)}
        self.sites = np.array(sorted({*ends, *problem.customers.tolist()}))
        self.node = {int(site): k for k, site in enumerate(self.sites)}
        self.manager = pywrapcp.RoutingIndexManager(
            len(self.sites), len(fleet), [self.node[v.start] for v in fleet], [self.node[v.end] for v in fleet]
        )
        self.routing = pywrapcp.RoutingModel(self.manager)
        self._costs()
        self._dimensions()
        dear = 1 + 2 * int(data.distance.max(initial=0)) * int(data.unit.max()) + int(data.fixed.max()) + int(data.prize.sum())
        for site in problem.customers.tolist():
            if not problem.sites.required[site]:
                self.routing.AddDisjunction([self.index(site)], int(data.prize[site]))
            elif droppable:
                self.routing.AddDisjunction([self.index(site)], dear)

    def index(self, site: int) -> int:
        """The library's index of a customer."""
        return int(self.manager.NodeToIndex(self.node[site]))

    def _matrix(self, values: Integers) -> int:
        return int(self.routing.RegisterTransitMatrix(values[np.ix_(self.sites, self.sites)].tolist()))

    def _costs(self) -> None:
        unit = self.data.unit[self.types]
        for u in np.unique(unit).tolist():
            evaluator = self._matrix(self.data.distance * u)
            for vehicle in np.nonzero(unit == u)[0].tolist():
                self.routing.SetArcCostEvaluatorOfVehicle(evaluator, vehicle)
        fixed = self.data.fixed[self.types]
        for vehicle in np.nonzero(fixed)[0].tolist():
            self.routing.SetFixedCostOfVehicle(int(fixed[vehicle]), vehicle)

    def _dimensions(self) -> None:
        data, present = self.data, self.problem.features()
        if "capacity" in present:
            demand = self.routing.RegisterUnaryTransitVector(data.demand[self.sites].tolist())
            self._limit(demand, data.capacity, int(data.demand.sum()), "load")
        longest = 2 * len(self.sites)
        for name, matrix, limit in (
            ("distance", data.distance_up, data.max_distance),
            ("travel", data.duration, data.travel_limit),
            ("charge", data.charge, data.charge_limit),
        ):
            if matrix is not None and (limit[self.types] != UNLIMITED).any():
                self._limit(self._matrix(matrix), limit, longest * int(matrix.max(initial=0)), name)
        timed = {"time-windows", "depot-windows", "max-duration", "energy:elapsed", "energy:elapsed-fixed-start"}
        if timed & present:
            self._time()

    def _limit(self, evaluator: int, limit: Integers, most: int, name: str) -> None:
        limits = np.minimum(limit[self.types], most).tolist()
        self.routing.AddDimensionWithVehicleCapacity(evaluator, 0, limits, True, name)

    def _time(self) -> None:
        data, problem = self.data, self.problem
        moves = data.service[:, None] + data.duration
        horizon = int(data.ready.max() + moves.max(axis=1)[self.sites].sum())
        self.routing.AddDimension(self._matrix(moves), horizon, horizon, False, "time")
        time = self.routing.GetDimensionOrDie("time")
        for site in problem.customers.tolist():
            time.CumulVar(self.index(site)).SetRange(int(data.ready[site]), int(min(data.due[site], horizon)))
        for vehicle, k in enumerate(self.types):
            start, end = problem.fleet[k].start, problem.fleet[k].end
            opens = int(data.ready[start])
            time.CumulVar(self.routing.Start(vehicle)).SetRange(opens, int(min(max(opens, data.due[start]), horizon)))
            time.CumulVar(self.routing.End(vehicle)).SetRange(0, int(min(data.due[end], data.latest_return[k], horizon)))
            if data.max_duration[k] != UNLIMITED:
                time.SetSpanUpperBoundForVehicle(int(min(data.max_duration[k], horizon)), vehicle)

    def routes(self, successor: Callable[[int], int]) -> Routes:
        """The routes of ``successor``, a function from an index to the next one."""
        found = []
        for vehicle, kind in enumerate(self.types):
            at, visits = successor(self.routing.Start(vehicle)), []
            while not self.routing.IsEnd(at):
                visits.append(int(self.sites[self.manager.IndexToNode(at)]))
                at = successor(at)
            found.append(Route(tuple(visits), kind))
        return Routes.of(found)

    def assignment(self, answer: Routes) -> Any:
        """A start for the search; None if the library cannot take the answer."""
        free: dict[int, list[int]] = {}
        for vehicle, kind in enumerate(self.types):
            free.setdefault(kind, []).append(vehicle)
        routes: list[list[int]] = [[] for _ in self.types]
        for route in answer:
            if not free.get(route.vehicle) or not self.node.keys() >= set(route.visits):
                return None
            routes[free[route.vehicle].pop(0)] = [self.index(site) for site in route.visits]
        return self.routing.ReadAssignmentFromRoutes(routes, True)


class _Search:
    """One run: publishes its incumbents and asks for its end from within the library's callback."""

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, options: Options, control: Control, began: float) -> None:
        self.problem, self.data, self.options, self.control = problem, data, options, control
        self.ends = began + options.time_limit
        self.solutions = 0
        self.publish_at = 0.0
        self.cost: int | None = None
        self.answer: Routes | None = None

    def run(self) -> RawResult:
        customers = self.problem.customers
        if not len(customers):
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
        """Vehicles of an unlimited type, and whether customers may be left out, in the order in which they are tried.

        The library's search slows down with every vehicle that it could use: first come a few times what the load asks
        for, then as many as there are customers.
        """
        customers = len(self.problem.customers)
        roomiest = int(self.data.capacity.max())
        loads = 0 if roomiest in (0, UNLIMITED) else -(-int(self.data.demand.sum()) // roomiest)
        first = min(customers, max(25, 3 * loads))
        wider = first < customers and any(v.count is None for v in self.problem.fleet)
        return [(first, False), *([(customers, False)] if wider else []), (customers, True)]

    def _solve(self, model: Model) -> RawResult:
        from ortools.constraint_solver import routing_enums_pb2

        routing = model.routing
        parameters = _parameters(self.options, max(0.0, self.ends - time.perf_counter()))
        routing.solver().ReSeed(self.options.seed % 2**31)
        routing.CloseModelWithParameters(parameters)

        def at_solution() -> None:
            self.solutions += 1
            cost, now = routing.CostVar().Max(), time.perf_counter()
            if now >= self.publish_at and (self.cost is None or cost < self.cost):
                self._take(cost, model, lambda i: routing.NextVar(i).Value())
                self.publish_at = now + PUBLISH_EVERY
            if self.control.stopped:
                routing.solver().FinishCurrentSearch()

        routing.AddAtSolutionCallback(at_solution)
        start = None if self.options.start is None else model.assignment(self.options.start)
        if start is not None:
            found = routing.SolveFromAssignmentWithParameters(start, parameters)
        else:
            found = routing.SolveWithParameters(parameters)
        if found is not None:
            # The clock decides which incumbents were published, so among equals the library's last word counts.
            self._take(found.ObjectiveValue(), model, lambda i: found.Value(routing.NextVar(i)), ties=True)
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
        message = "" if self.answer is not None else f"OR-Tools found no answer that visits every required site (it ended with {said})"
        claim = None if self.cost is None else self._claim(self.cost)
        return RawResult(status, limit, self.answer, claim, statistics=statistics, message=message)

    def _take(self, cost: int, model: Model, successor: Callable[[int], int], ties: bool = False) -> None:
        """Publish an answer if it is the best one so far (or, with ``ties``, no worse) and leaves no required customer out."""
        if self.cost is not None and (cost > self.cost or (cost == self.cost and not ties)):
            return
        answer = model.routes(successor)
        visited = np.zeros(len(self.problem.sites), dtype=bool)
        visited[[site for route in answer for site in route.visits]] = True
        if (visited | ~self.problem.sites.required).all():
            self.cost, self.answer = cost, answer
            self.control.publish(answer, self._claim(cost))

    def _claim(self, cost: int) -> float | None:
        optional = ~self.problem.sites.required & ~self.problem.sites.depot
        lost = int(self.data.prize[optional].sum())
        return claimed_objective(
            self.problem, (cost - lost - int(self.data.prize[self.problem.sites.required].sum())) / self.data.cost_factor
        )


def _parameters(options: Options, seconds: float) -> Any:
    """The library's search parameters, the user's own changes checked against its fields."""
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    made = pywrapcp.DefaultRoutingSearchParameters()
    made.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
    made.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    made.time_limit.FromMilliseconds(max(1, round(1000 * min(seconds, 1e9))))
    if options.iterations is not None:
        made.solution_limit = options.iterations
    fields = {f.name: f for f in made.DESCRIPTOR.fields if not f.is_repeated and f.message_type is None}
    for name in ("solution_limit", "log_search"):
        fields.pop(name)
    given = {{"metaheuristic": "local_search_metaheuristic"}.get(name, name): value for name, value in options.extra.items()}
    known = {name: None if field.enum_type is not None else getattr(made, name) for name, field in fields.items()}
    for name, value in own_options("ortools", given, known).items():
        if fields[name].enum_type is not None:
            numbers = {v.name: v.number for v in fields[name].enum_type.values}
            word = str(value).upper().replace("-", "_")
            if word not in numbers:
                raise UsageError(f"ortools: {name} is one of {', '.join(numbers)}, not {value!r}")
            value = numbers[word]
        try:
            setattr(made, name, value)
        except (TypeError, ValueError):
            raise UsageError(f"ortools: {value!r} is no value for option {name}") from None
    return made
