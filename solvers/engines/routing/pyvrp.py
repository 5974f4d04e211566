"""PyVRP: iterated local search for rich vehicle routing problems."""

from __future__ import annotations

import math
import time
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ....formulations.routing.routes import Routes
from ....instances.errors import UsageError
from ...backend import BACKENDS, Control, Options, RawResult
from ...own_options import own_options
from .bisection import USUAL_FEATURES, Bisecting
from .pyvrp_model import Model
from .routing_integers import IntegerRouting, entangled, integer_routing
from .routing_objective import claimed_objective, unscalable

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

PUBLISH_EVERY = 0.05
"""Seconds between two published incumbents, so that a flood of early ones costs nothing."""

LARGEST_WITHIN = 1_500
"""Sites up to which it runs in our own process: it looks for their neighbours in a quarter of a second, during which nothing else runs."""

GROUPS = ("ils", "penalty", "neighbourhood", "perturbation")
"""Groups of parameters of ``pyvrp.SolveParams``."""


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
    family = "routing"
    features = USUAL_FEATURES | {"overtime", "groups", "reloads", "forbidden-moves"}

    def apart(self, problem: Problem) -> bool:
        """See ``Engine.apart``: the library holds Python's global lock while it looks for neighbours."""
        return problem.size > LARGEST_WITHIN

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        """See ``Bisecting.beyond``."""
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
        """See ``Bisecting.search``."""
        params = _parameters(options.extra)
        control.begin_set_up()
        began = time.perf_counter()
        data = integer_routing(problem)
        result = _Search(problem, data, options, control, began).run(params)
        return replace(result, holds=data.holds, links=(data.link,))


class _Search:
    """One run: stops it, publishes its incumbents, and translates its answers."""

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, options: Options, control: Control, began: float) -> None:
        self.problem, self.data, self.options, self.control, self.began = problem, data, options, control, began
        self.timed = bool(data.time.any() or data.overtime.any())
        self.iterations = 0
        self.limit = "none"
        self.pending: Any = None
        self.ends = began + options.time_limit
        self.publish_at = 0.0
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
        if self.pending is not None and now >= self.publish_at:
            answer = self.model.routes(self.pending)
            self.control.publish(answer, self._claim(self.pending, answer))
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

        class Incumbents(IteratedLocalSearchCallbacks):  # type: ignore[misc]
            def on_start(this, ils: Any) -> None:
                this.on_best(ils.initial_solution)

            def on_best(this, best: Any) -> None:
                if best.is_feasible() and self.model.keeps_to_moves(best):
                    self.pending = best

        return Incumbents()

    def _claim(self, solution: Any, answer: Routes) -> float | None:
        if self.timed and not self.data.scales["exact"]:  # durations are rounded up, move by move
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
        raise UsageError(f"pyvrp: {fault}") from None
