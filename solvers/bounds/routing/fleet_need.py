"""Bound ``too-small-fleet``: proofs that the fleet is too small, or too many routes are asked for, found before any search."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....formulations.evidence import Evidence
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .infeasible_site import lacks

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

MOST_SITES = 200
"""Sites up to which it is tried: solving bears this cost even where there is an answer."""

MOST_ENUMERATED = 5
"""Sites of which every choice of routes is tried, for the same reason."""


def fleet_need_evidence(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The first proof among ``fleet_conflicts``, if there is one.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        Looked at between arguments.
    linear : unused
        No program is solved.
    """
    from ....formulations.routing.fleet_need import fleet_conflicts

    if len(problem.sites) > MOST_SITES:
        return None
    return next(fleet_conflicts(problem, lambda: bool(stop.reached()), MOST_ENUMERATED), None)


BOUNDS.add("too-small-fleet", BoundMethod("too-small-fleet", lacks, fleet_need_evidence, order=0))
