"""Bounds ``infeasible-site`` and ``too-few-vehicles``: reasons why there is no answer at all, found before any search."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.routing.reachability import servable_alone
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem


def infeasible_site_evidence(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """A required site that no vehicle can serve, if there is one.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        Sites whose direct visit fails are tried in site order until then.
    linear : unused
        No program is solved.

    Returns
    -------
    Evidence of kind ``infeasible-site``, or None

    Notes
    -----
    Sites that some vehicle can serve on a route of their own are ruled out at once. Whether a detour helps one of the others (distances
    need not obey the triangle inequality) is for the checker to say.
    """
    customers = problem.customers
    for site in customers[problem.sites.required[customers] & ~servable_alone(problem)].tolist():
        if stop.reached():
            return None
        name = problem.sites.ids[site]
        found = Evidence("infeasible-site", f"no vehicle can serve site {name}", _none(problem), {"site": name})
        if verified_bound(problem, found) == found.value:
            return found
    return None


def too_few_vehicles_evidence(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence of kind ``too-few-vehicles`` if the fleet cannot carry the total demand of the required sites, else None."""
    limit = problem.vehicle_limit
    if limit is None:
        return None
    total = math.fsum(problem.sites.demand[problem.sites.required])
    room = math.fsum(v.capacity * (v.count or 0) for v in problem.fleet)
    found = Evidence("too-few-vehicles", f"the sites demand {total:g}, all vehicles together carry {room:g}", _none(problem), {})
    return found if total > room and verified_bound(problem, found) == found.value else None


def _none(problem: Problem) -> float:
    return math.inf if problem.sense == "min" else -math.inf


def lacks(problem: Problem) -> frozenset[str]:
    """Nothing for routing problems, all else is of another family."""
    return frozenset() if problem.family == "routing" else frozenset({f"{problem.family} problems"})


BOUNDS.add("infeasible-site", BoundMethod("infeasible-site", lacks, infeasible_site_evidence, order=0))
BOUNDS.add("too-few-vehicles", BoundMethod("too-few-vehicles", lacks, too_few_vehicles_evidence, order=0))
