"""Bound ``averaged-tour``: bounds of the sum of all routes, spread over the vehicles, for the evidence of the same name."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.routing.checking.round_trips import totals
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .arcs import lacks_arc_costs, too_many_arcs
from .round_trips import lacks_peaks
from .spanning_tree import spanning_tree_bound
from .state_space import state_space_bound

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem


def _lacks(problem: Problem) -> frozenset[str]:
    missing = lacks_peaks(problem)
    single = missing or len(problem.objective.levels()[0].terms) == 1  # type: ignore[attr-defined]
    return missing if single else frozenset({"objective:weights"})


def averaged_tour(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The best of what a spanning tree and a state-space relaxation prove of the sum; the latter where the former takes the problem not, or
    in the time that it leaves.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
    linear : unused
        No program is solved.
    """
    summed = None if too_many_arcs(problem, stop.seconds_left) else totals(problem)
    if summed is None:
        return None
    methods = [state_space_bound] if lacks_arc_costs(summed) else [spanning_tree_bound, state_space_bound]
    best: Evidence | None = None
    for method in methods:
        found = None if stop.reached() else method(summed, stop.within(stop.seconds_left * 0.7))
        if found is None:
            continue
        made = Evidence("averaged-tour", f"{found.source}, shared by all vehicles", 0.0, {"kind": found.kind, "data": dict(found.data)})
        value = verified_bound(problem, made)
        if value > -math.inf and (best is None or value > best.value):
            best = Evidence(made.kind, made.source, value, made.data)
    return best


BOUNDS.add("averaged-tour", BoundMethod("averaged-tour", _lacks, averaged_tour, order=1))
