"""Christofides' algorithm: a tour of at most one and a half times the shortest one."""

from __future__ import annotations

from typing import Any

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .tour_partitioning import FEATURES
from .tour_steps.cutting import closed_routes
from .tour_steps.giant_tour import giant_tour, guaranteed, moving_costs


def christofides(problem: RoutingProblem, context: Context, *, improve: bool = True) -> Outcome:
    """A minimum spanning tree, a minimum-weight perfect matching of its nodes of odd degree, and a walk around both that skips what it has
    met.

    Parameters
    ----------
    problem : RoutingProblem
        One vehicle can serve all customers: no capacity that it exceeds, no windows, no limits.
    context : Context
    improve : bool
        Shorten the tour by 2-opt and Or-opt.

    Returns
    -------
    Outcome
        With the guarantee 3/2 where distances are symmetric and keep the triangle inequality; 2 where there are too many nodes to match.

    Raises
    ------
    UsageError
        If there are too many sites.

    Notes
    -----
    Source: Christofides (1976), Report 388, Carnegie Mellon University; Serdyukov (1978). Weights are matched as whole numbers of 2^-40 of
    the longest distance.
    """
    stop = context.begin()
    costs = moving_costs(problem, stop)
    if costs is None:
        answer = Routes((Route(tuple(problem.customers.tolist())),))
        return Outcome(answer, message=f"customers in their order: {CUT_SHORT}", limit=stop.reached())
    tour = giant_tour(costs, "christofides", bool(improve), stop)
    answer = Routes.of([costs.nodes[tour.order].tolist()])
    value, cut = problem.evaluate(answer).values[0], stop.reached()
    guarantee = guaranteed(tour, value, 0.0, 0.0, 1.0, f"tour <= {tour.ratio:g} OPT", (), tour.source) if tour.ratio else None
    message = "; ".join(w for w in (tour.message, CUT_SHORT if cut else "") if w)
    return Outcome(answer, guarantee, (), {"tour": tour.length}, message, cut or "none")


def _refuses(problem: Any) -> frozenset[str]:
    full = problem.sites.demand[problem.customers].sum() > problem.fleet[0].capacity
    return closed_routes(problem) | (frozenset({"capacity"}) if full else frozenset())


HEURISTICS.add(
    "christofides",
    Heuristic(
        name="christofides",
        families=("routing",),
        features=FEATURES,
        run=christofides,
        summary="one tour from a spanning tree and a matching, for a vehicle that can serve all",
        stated="3/2, where distances are metric",
        refuses=_refuses,
    ),
)
