"""Bound ``vehicles-needed``: the threshold of the bound L2 of bin packing, for the evidence of the same name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.no_answer import check_vehicles_needed
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.routing.fleet_need import bin_packing_bound
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem


def lacks(problem: Problem) -> frozenset[str]:
    """Features under which nothing is proved, and objectives in which vehicles do not count."""
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    missing, terms = unknown_features(without_stops(problem)), terms_of(problem)  # type: ignore[arg-type]
    bounded = terms is not None and problem.sense == "min" and terms.vehicles > 0 and not terms.reward and terms.penalties >= 0
    return missing if bounded else missing | {"objectives without vehicles"}


def vehicles_needed(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The best threshold for the required demands.

    Parameters
    ----------
    problem : RoutingProblem
    stop, linear : unused
    """
    capacity = max(v.capacity for v in without_stops(problem).fleet)
    _, threshold = bin_packing_bound(problem.sites.demand[problem.sites.required], capacity)
    data = {"threshold": threshold}
    return Evidence("vehicles-needed", "vehicles that the loads need", check_vehicles_needed(problem, data), data)


BOUNDS.add("vehicles-needed", BoundMethod("vehicles-needed", lacks, vehicles_needed, order=0))
