"""PyVRP: iterated local search for rich vehicle routing problems."""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...formulations.problem import Problem
from ...formulations.routing.routes import Route, Routes
from ...instances.errors import UnsupportedError, UsageError
from ..backend import BACKENDS, Control, Engine, Options, RawResult
from ..own_options import own_options
from .routing_integers import UNLIMITED, IntegerRouting, integer_routing
from .routing_objective import claimed_objective, unscalable

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem

PUBLISH_EVERY = 0.05
"""Seconds between two published incumbents, so that a flood of early ones costs nothing."""

MAX_PENALTY = 100_000
"""Largest price of a unit of violation in PyVRP."""

GROUPS = ("ils", "penalty", "neighbourhood", "perturbation")
"""Groups of parameters of ``pyvrp.SolveParams``."""


@BACKENDS.register("pyvrp")
class PyVRP(Engine):
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
    family = "routing"
    features = frozenset(
        {
            "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "optional-sites",
            "limited-fleet", "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations",
            "energy:travel", "energy:elapsed", "energy:elapsed-fixed-start", "objective:total-cost", "objective:vehicles",
            "objective:reward", "objective:weights", "objective:priorities",
        }
    )  # fmt: skip

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        lacking = super().missing(problem)
        if not lacking:
            lacking |= unscalable(problem)  # type: ignore[arg-type]
            if {"energy:travel", "separate-durations"} <= problem.features():
                # Time on the move can only be limited as a distance.
                lacking |= {"energy:travel with separate-durations"}
        return lacking

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        params = _parameters(options.extra)
        data = integer_routing(problem)  # type: ignore[arg-type]
        found = _Search(problem, data, options, control).run(params)  # type: ignore[arg-type]
        return replace(found, holds=data.holds, links=(data.link,))


def problem_data(problem: RoutingProblem, data: IntegerRouting) -> tuple[Any, list[int]]:
    """PyVRP's own ``ProblemData``, and the fleet's type of each of its vehicle types.

    Types that no route can use, because their end closes before their start opens, are left out; None if that is all.
    """
    import pyvrp

    sites = problem.sites
    xy = sites.coordinates if sites.coordinates is not None else np.zeros((len(sites), 2))
    loaded = "capacity" in problem.features()
    factor = load_factor(data)
    required, due, demand = sites.required.tolist(), data.due.tolist(), (data.demand * factor).tolist()
    ready, service, prize = (a.tolist() for a in (data.ready, data.service, data.prize))
    clients = [
        pyvrp.Client(
            i, delivery=[demand[i]] if loaded else [], service_duration=service[i], tw_early=ready[i], tw_late=due[i], prize=prize[i],
            required=required[i],
        )
        for i in problem.customers.tolist()
    ]  # fmt: skip
    depots = sites.depots.tolist()
    place = {site: k for k, site in enumerate(depots)}
    types, kept = [], []
    for k, vehicle in enumerate(problem.fleet):
        closes = int(min(data.due[vehicle.end], data.latest_return[k]))
        opens = ready[vehicle.start]
        if closes < opens:
            continue
        reach = int(min(data.max_distance[k], data.travel_reach[k]))
        types.append(
            pyvrp.VehicleType(
                num_available=len(clients) if vehicle.count is None else min(vehicle.count, len(clients)),
                capacity=[min(int(data.capacity[k]) * factor, UNLIMITED)] if loaded else [],
                start_depot=place[vehicle.start], end_depot=place[vehicle.end],
                fixed_cost=int(data.fixed[k]), unit_distance_cost=int(data.unit[k]),
                tw_early=opens, tw_late=closes, start_late=min(max(opens, due[vehicle.start]), closes),
                shift_duration=int(data.max_duration[k]), max_distance=reach,
            )
        )  # fmt: skip
        kept.append(k)
    # One matrix serves as cost and as distance limit; only where there is a limit does it have to be rounded up.
    if not types:
        return None, []
    limited = any(t.max_distance != UNLIMITED for t in types)
    made = pyvrp.ProblemData(
        locations=[pyvrp.Location(float(x), float(y)) for x, y in xy],
        clients=clients,
        depots=[pyvrp.Depot(i) for i in depots],
        vehicle_types=types,
        distance_matrices=[data.distance_up if limited else data.distance],
        duration_matrices=[data.duration],
    )
    return made, kept


def load_factor(data: IntegerRouting) -> int:
    """Power of ten by which loads are multiplied, so that too much load can never pay.

    PyVRP prices a unit of excess load at 1e5 at most; where costs count in millionths that is next to nothing.
    """
    gain = max(int(data.distance.max(initial=0)) * int(data.unit.max()), int(data.fixed.max()), int(data.prize.max()))
    factor, most = 1, UNLIMITED // max(1, 10 * int(data.demand.sum()))
    while factor * MAX_PENALTY < 10 * gain and factor <= most:
        factor *= 10
    return factor


class _Search:
    """One run: stops it, publishes its incumbents, and translates its answers."""

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, options: Options, control: Control) -> None:
        self.problem, self.data, self.options, self.control = problem, data, options, control
        self.iterations = 0
        self.limit = "none"
        self.pending: Any = None
        self.ends = time.perf_counter() + options.time_limit
        self.publish_at = 0.0
        self.best_cost, self.best_at = math.inf, 0

    def run(self, params: Any) -> RawResult:
        import pyvrp

        if not len(self.problem.customers):
            return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
        self.model, self.types = problem_data(self.problem, self.data)
        if self.model is None:
            message = "no vehicle can leave its depot and return in time"
            return RawResult("infeasible" if self.problem.sites.required.any() else "unknown", message=message)
        params.ils.callbacks = self._callbacks()
        start = None if self.options.start is None else self._from_routes(self.options.start)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pyvrp.exceptions.PenaltyBoundWarning)
            result = pyvrp.solve(
                self.model, self._stop, seed=self.options.seed % 2**32, collect_stats=False, display=False, params=params,
                initial_solution=start,
            )  # fmt: skip
        statistics: dict[str, Any] = {"iterations": result.num_iterations, "scale": self.data.scales}
        if self.options.start is not None:
            statistics["start"] = "refused" if start is None else "used"
        if not result.is_feasible():
            return RawResult("unknown", self.limit, statistics=statistics, message="PyVRP found no feasible answer")
        answer = self._to_routes(result.best)
        return RawResult("feasible", self.limit, answer, self._claim(result.best), statistics=statistics)

    def _stop(self, best_cost: float) -> bool:
        now = time.perf_counter()
        if self.pending is not None and now >= self.publish_at:
            self.control.publish(self._to_routes(self.pending), self._claim(self.pending))
            self.pending, self.publish_at = None, now + PUBLISH_EVERY
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

        class Hear(IteratedLocalSearchCallbacks):  # type: ignore[misc]
            def on_start(this, ils: Any) -> None:
                this.on_best(ils.initial_solution)

            def on_best(this, best: Any) -> None:
                if best.is_feasible():
                    self.pending = best

        return Hear()

    def _claim(self, solution: Any) -> float | None:
        cost = solution.distance_cost() + solution.fixed_vehicle_cost() - solution.prizes()
        return claimed_objective(self.problem, cost / self.data.cost_factor)

    def _to_routes(self, solution: Any) -> Routes:
        customers = self.problem.customers
        return Routes.of(
            Route(tuple(int(customers[a.idx]) for a in route if a.is_client()), self.types[route.vehicle_type()])
            for route in solution.routes()
        )

    def _from_routes(self, answer: Routes) -> Any:
        """A start for the search, feasible or not; None if PyVRP cannot represent it."""
        import pyvrp

        client = {int(site): k for k, site in enumerate(self.problem.customers)}
        kind = {k: number for number, k in enumerate(self.types)}
        try:
            return pyvrp.Solution(self.model, [pyvrp.Route(self.model, [client[i] for i in r.visits], kind[r.vehicle]) for r in answer])
        except (KeyError, RuntimeError, ValueError):
            return None


def _parameters(extra: dict[str, Any]) -> Any:
    """``SolveParams`` with the user's changes, each checked against the fields there are."""
    import pyvrp
    from pyvrp.IteratedLocalSearch import IteratedLocalSearchParams
    from pyvrp.PenaltyManager import PenaltyParams
    from pyvrp.search import NeighbourhoodParams, PerturbationParams

    kinds = dict(zip(GROUPS, (IteratedLocalSearchParams, PenaltyParams, NeighbourhoodParams, PerturbationParams), strict=True))
    defaults = {group: kind() for group, kind in kinds.items()}
    known = {
        f"{group}.{field}": getattr(made, field)
        for group, made in defaults.items()
        for field in dir(made)
        if not field.startswith("_") and isinstance(getattr(made, field), bool | int | float)
    }
    chosen: dict[str, dict[str, Any]] = {group: {} for group in GROUPS}
    for name, value in own_options("pyvrp", extra, known).items():
        group, _, field = name.partition(".")
        chosen[group][field] = value
    try:
        made = {group: kinds[group](**chosen[group]) for group in GROUPS}
    except (TypeError, ValueError) as fault:
        raise UsageError(f"pyvrp: {fault}") from None
    return pyvrp.SolveParams(**made)
