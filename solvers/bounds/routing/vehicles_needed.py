"""Bounds ``vehicles-needed`` and ``fewest-routes`` on the number of vehicles, by loads alone or by whatever proves a fleet too small.

The first is the bound L2 of bin packing. The second rules out one number of routes after the other from there upwards, by loads, ranges,
hours, or sites of which no two share a route. Its evidence is a branching tree of one statement, "there are k routes at most": evidence
that no answer has so few, and the bound L2 of answers with more.
"""

import math

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.no_answer import check_vehicles_needed
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.routing.fleet_need import bin_packing_bound, fleet_conflicts
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .infeasibility import MOST_ENUMERATED, MOST_SITES

WORDS = {
    "too-few-vehicles": "loads", "bin-packing": "loads", "too-little-range": "range", "too-little-time": "time windows",
    "sites-apart": "sites of which no two share a route", "sites-beyond-fleet": "a few sites and all routes for them",
}  # fmt: skip
"""Reasons against fewer vehicles, for people, by kind of evidence."""


def lacks(problem: RoutingProblem) -> frozenset[str]:
    """Features that the checker does not know, and objectives in which vehicles do not count."""
    missing, terms = unknown_features(without_stops(problem)), terms_of(problem)
    bounded = terms is not None and problem.sense == "min" and terms.vehicles > 0 and not terms.reward and terms.penalties >= 0
    return missing if bounded else missing | {"objectives without vehicles"}


@bound_method("vehicles-needed", of_family("routing", lacks))
def vehicles_needed(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence:
    """Evidence from the threshold of the bound L2 that is best for the required demands."""
    capacity = max(v.capacity for v in without_stops(problem).fleet)
    _, threshold = bin_packing_bound(problem.sites.demand[problem.sites.required], capacity)
    data = {"threshold": threshold}
    return Evidence("vehicles-needed", "vehicles that the loads need", check_vehicles_needed(problem, data), data)


@bound_method("fewest-routes", of_family("routing", lacks), order=1)
def fewest_routes(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """A bound on the number of routes, by a proof that fewer are infeasible; None where bin packing gives as good a bound.

    None as well where no such proof is found, and beyond ``MOST_SITES`` sites. The evidence is a branching tree.
    """
    terms, packed = terms_of(problem), vehicles_needed(problem)
    if terms is None or len(problem.sites) > MOST_SITES:
        return None
    most = min(len(problem.customers), problem.vehicle_limit or len(problem.customers))
    few = max(1, problem.min_vehicles, round(packed.value / terms.vehicles) if terms.vehicles > 0 and not terms.cost else 1)
    ruled_out: tuple[int, Evidence] | None = None
    for routes in range(few, most):
        statement = {"routes": routes}
        conflict = next(fleet_conflicts(problem.restricted([(statement, True)]), lambda: bool(stop.reached()), MOST_ENUMERATED), None)
        if conflict is None or stop.reached():
            break
        ruled_out = routes, conflict
    if ruled_out is None:
        return None
    routes, conflict = ruled_out
    rest = vehicles_needed(problem.restricted([({"routes": routes}, False)]))
    if not math.isfinite(rest.value) or rest.value <= packed.value:
        return None
    nodes = [
        {"branch": {"routes": routes}},
        {"kind": conflict.kind, "data": dict(conflict.data)},
        {"kind": rest.kind, "data": dict(rest.data)},
    ]
    return Evidence("branching-tree", f"vehicles needed, by {WORDS.get(conflict.kind, conflict.kind)}", rest.value, {"nodes": nodes})
