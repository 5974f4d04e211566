"""Bounds ``farthest-round-trip`` and ``averaged-tour`` on the largest of all routes, for the evidence of the same names."""

import math

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.round_trips import check_farthest_round_trip, totals
from ....formulations.routing.objective import PEAKS
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import verified_bound
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .arcs import lacks_arc_costs, too_many_arcs
from .spanning_tree import spanning_tree_bound
from .state_space import state_space_bound


def lacks_peaks(problem: RoutingProblem) -> frozenset[str]:
    """Terms that are not the largest value of a route, and features that the checkers do not know."""
    terms = problem.objective.levels()[0].terms
    others = {f"objective:{term.name}" for weight, term in terms if term.name not in PEAKS or weight < 0}
    return unknown_features(without_stops(problem)) | others


def _lacks_one_peak(problem: RoutingProblem) -> frozenset[str]:
    missing = lacks_peaks(problem)
    several = len(problem.objective.levels()[0].terms) > 1
    return frozenset({"objective:weights"}) if several and not missing else missing


@bound_method("farthest-round-trip", of_family("routing", lacks_peaks))
def farthest_round_trip(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """There and back to the farthest required site, which the checker looks for; None where the moves are too many."""
    if too_many_arcs(problem, stop.seconds_left):
        return None
    return Evidence("farthest-round-trip", "farthest round trip", check_farthest_round_trip(problem, {}), {})


@bound_method("averaged-tour", of_family("routing", _lacks_one_peak), order=1)
def averaged_tour(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """A bound on the sum of all routes, shared by the vehicles: the better one of a spanning tree and a state-space relaxation."""
    summed = None if too_many_arcs(problem, stop.seconds_left) else totals(problem)
    if summed is None:
        return None
    methods = [state_space_bound] if lacks_arc_costs(summed) else [spanning_tree_bound, state_space_bound]
    best: Evidence | None = None
    for method in methods:
        total = None if stop.reached() else method(summed, stop.within(stop.seconds_left * 0.7))
        if total is None:
            continue
        source, data = f"{total.source}, shared by all vehicles", {"kind": total.kind, "data": dict(total.data)}
        value = verified_bound(problem, Evidence("averaged-tour", source, 0.0, data))
        if value > -math.inf and (best is None or value > best.value):
            best = Evidence("averaged-tour", source, value, data)
    return best
