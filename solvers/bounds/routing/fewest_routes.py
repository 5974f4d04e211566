"""Bound ``fewest-routes``: as many vehicles as no smaller fleet can do without, by what proves that a fleet is too small.

Loads, ranges, hours, sites of which no two share a route: each number of routes for which one of these proves that there is no answer is
ruled out, from the bin packing bound upwards. The evidence is a branching tree of one statement, "there are k routes at most": evidence
that no answer has so few, and the bound L2 of what has more.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.routing.fleet_need import fleet_conflicts
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .fleet_need import MOST_ENUMERATED, MOST_SITES
from .vehicles_needed import lacks, vehicles_needed

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

WORDS = {
    "too-few-vehicles": "loads", "bin-packing": "loads", "too-little-range": "range", "too-little-time": "time windows",
    "sites-apart": "sites of which no two share a route", "sites-beyond-fleet": "a few sites and all routes for them",
}  # fmt: skip
"""What rules out fewer, for people, by kind of evidence."""


def fewest_routes(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """A tree that rules out every fleet of fewer vehicles than it proves to be needed; None where bin packing already says as much.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        Looked at between arguments.
    linear : unused
    """
    terms, packed = terms_of(problem), vehicles_needed(problem)
    if terms is None or packed is None or len(problem.sites) > MOST_SITES:
        return None
    most = min(len(problem.customers), problem.vehicle_limit or len(problem.customers))
    few = max(1, problem.min_vehicles, round(packed.value / terms.vehicles) if terms.vehicles > 0 and not terms.cost else 1)
    found: tuple[int, Evidence] | None = None
    for routes in range(few, most):
        statement = {"routes": routes}
        conflict = next(fleet_conflicts(problem.restricted([(statement, True)]), lambda: bool(stop.reached()), MOST_ENUMERATED), None)
        if conflict is None or stop.reached():
            break
        found = routes, conflict
    if found is None:
        return None
    routes, conflict = found
    rest = vehicles_needed(problem.restricted([({"routes": routes}, False)]))
    if rest is None or not math.isfinite(rest.value) or rest.value <= packed.value:
        return None
    nodes = [
        {"branch": {"routes": routes}},
        {"kind": conflict.kind, "data": dict(conflict.data)},
        {"kind": rest.kind, "data": dict(rest.data)},
    ]
    return Evidence("branching-tree", f"vehicles needed, by {WORDS.get(conflict.kind, conflict.kind)}", rest.value, {"nodes": nodes})


BOUNDS.add("fewest-routes", BoundMethod("fewest-routes", lacks, fewest_routes, order=1))
