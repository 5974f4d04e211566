"""Bounds ``infeasible-site``, ``too-few-vehicles`` and ``too-small-fleet``: proofs, before any search, that a problem has no answer."""

import math

from ....formulations.evidence import Evidence
from ....formulations.routing.fleet_need import fleet_conflicts, infeasible_bound
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.reachability import servable_alone
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import verified_bound
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family

MOST_SITES = 200
"""Sites up to which a fleet is examined: this costs time even where the problem has an answer."""

MOST_ENUMERATED = 5
"""Sites of which every choice of routes is tried, for the same reason."""


@bound_method("infeasible-site", of_family("routing"))
def infeasible_site_evidence(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Proof that some required site cannot be served by any vehicle, if there is such a site.

    Only sites that no vehicle can serve on a route of their own are tried. Whether a detour reaches them (distances need not obey the
    triangle inequality) is for the checker to say.
    """
    customers = problem.customers
    for site in customers[problem.sites.required[customers] & ~servable_alone(problem)].tolist():
        if stop.reached():
            return None
        name = problem.sites.ids[site]
        evidence = Evidence("infeasible-site", f"no vehicle can serve site {name}", infeasible_bound(problem), {"site": name})
        if verified_bound(problem, evidence) == evidence.value:
            return evidence
    return None


@bound_method("too-few-vehicles", of_family("routing"))
def too_few_vehicles_evidence(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Proof that the fleet cannot carry the total demand of the required sites, if it cannot."""
    limit = problem.vehicle_limit
    if limit is None:
        return None
    total = math.fsum(problem.sites.demand[problem.sites.required])
    room = math.fsum(v.capacity * (v.count or 0) for v in problem.fleet)
    source = f"the sites demand {total:g}, all vehicles together carry {room:g}"
    evidence = Evidence("too-few-vehicles", source, infeasible_bound(problem), {})
    return evidence if total > room and verified_bound(problem, evidence) == evidence.value else None


@bound_method("too-small-fleet", of_family("routing"))
def fleet_need_evidence(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The first proof that the fleet is too small, or that too many routes are asked for, among ``fleet_conflicts``."""
    if len(problem.sites) > MOST_SITES:
        return None
    return next(fleet_conflicts(problem, lambda: bool(stop.reached()), MOST_ENUMERATED), None)
