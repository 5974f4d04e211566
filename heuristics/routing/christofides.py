"""Christofides' algorithm: a tour of at most one and a half times the shortest one."""

from typing import Any

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ..heuristic import Context, Outcome, heuristic
from .tour_partitioning import FEATURES
from .tour_steps.cutting import ended, no_time
from .tour_steps.giant_tour import giant_tour, guaranteed, moving_costs


def _refuses(problem: Any) -> frozenset[str]:
    full = problem.sites.demand[problem.customers].sum() > problem.fleet[0].capacity
    return frozenset({"capacity"}) if full else frozenset()


@heuristic(
    "christofides",
    "routing", FEATURES, "one tour from a spanning tree and a matching, for a vehicle that can serve all",
    stated="3/2, where distances are metric", refuses=_refuses,
)  # fmt: skip
def christofides(problem: RoutingProblem, context: Context, *, improve: bool = True) -> Outcome:
    """A minimum spanning tree, a minimum-weight perfect matching of its nodes of odd degree, and a walk around both without repetitions.

    ``improve`` shortens the tour by 2-opt and Or-opt. The guarantee is 3/2 where distances are symmetric and keep the triangle inequality,
    and 2 where there are too many nodes to match. Weights are matched as whole numbers of 2^-40 of the longest distance.

    Source: Christofides (1976), Report 388, Carnegie Mellon University; Serdyukov (1978).
    """
    stop = context.begin()
    costs = moving_costs(problem, stop)
    if costs is None:
        return no_time(Routes((Route(tuple(problem.customers.tolist())),)), stop)
    tour = giant_tour(costs, "christofides", bool(improve), stop)
    answer = Routes.of([costs.nodes[tour.order].tolist()])
    value, cut = problem.evaluate(answer).values[0], stop.reached()
    guarantee = guaranteed(tour, value, 0.0, 0.0, 1.0, f"tour <= {tour.ratio:g} OPT", (), tour.source) if tour.ratio else None
    return ended(answer, cut, {"tour": tour.length}, tour.message, guarantee=guarantee)
