"""Bound ``farthest-round-trip``: there and back to the farthest required site, for the evidence of the same name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.round_trips import PEAKS
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .arcs import too_many_arcs

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem


def lacks_peaks(problem: Problem) -> frozenset[str]:
    """Terms that are no largest of all routes, and features that nothing is known of."""
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    terms = problem.objective.levels()[0].terms  # type: ignore[attr-defined]
    others = {f"objective:{term.name}" for weight, term in terms if term.name not in PEAKS or weight < 0}
    return unknown_features(without_stops(problem)) | others  # type: ignore[arg-type]


def farthest_round_trip(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The checker looks at all sites: there is nothing to search for. None where the moves are too many."""
    from ....formulations.routing.checking.round_trips import check_farthest_round_trip

    if too_many_arcs(problem, stop.seconds_left):
        return None
    return Evidence("farthest-round-trip", "farthest round trip", check_farthest_round_trip(problem, {}), {})


BOUNDS.add("farthest-round-trip", BoundMethod("farthest-round-trip", lacks_peaks, farthest_round_trip, order=0))
