"""Bound ``all-routes``: the optimum of a few customers, where other evidence knows too little of the fleet or the sites."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.routing.checking.all_routes import MOST, MOST_ORDERS, orders
from ....formulations.stop import NEVER, Stop, until
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem


def all_routes_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """What the checker of ``all-routes`` derives: in half a second for seven customers, in some more for twelve.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        Looked at before it begins, and from set to set.
    linear : unused
        No program is solved.
    target : unused
        All routes are walked.
    """
    if stop.reached():
        return None
    many = len(problem.customers)
    found = Evidence("all-routes", f"all routes of {many} customer{'s' if many != 1 else ''}", math.nan, {})
    with until(stop):
        bound = verified_bound(problem, found)
    nothing = -math.inf if problem.sense == "min" else math.inf
    return None if bound == nothing else Evidence(found.kind, found.source, bound, {})


def _missing(problem: Problem) -> frozenset[str]:
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    many = orders(problem) > MOST_ORDERS and len(problem.customers) > MOST  # type: ignore[arg-type, attr-defined]
    return frozenset({"few customers"}) if many else frozenset()


BOUNDS.add("all-routes", BoundMethod("all-routes", _missing, all_routes_bound, order=8, aims=True))
