"""Bounds ``load-shares`` and ``nearest-moves``: what loads, and the least moves at each site, prove at once and at any size.

There is nothing to search for: the checkers look at all sites, and read nothing of the evidence.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.evidence import CHECKERS, Evidence
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.load_shares import by_coordinates
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .arcs import too_many_arcs

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

SOURCES = {"load-shares": "round trips shared by loads", "nearest-moves": "least moves at each site"}


def lacks_costs(problem: Problem) -> frozenset[str]:
    """Other families, objectives to which moves and vehicles add nothing, and what is unknown or of which more is better."""
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    missing, terms = unknown_features(without_stops(problem)), terms_of(problem)  # type: ignore[arg-type]
    if terms is None or terms.vehicles < 0:
        return missing | {"objective:weights"}
    return missing if terms.cost or terms.duration or terms.vehicles else missing | {"objectives without costs"}


def lacks_loads(problem: Problem) -> frozenset[str]:
    """The same, and loads that no vehicle is too small for."""
    missing = lacks_costs(problem)
    return missing if "capacity" in problem.features() else missing | {"problems without capacity"}


def evidence_of(kind: str, problem: RoutingProblem, stop: Stop = NEVER) -> Evidence | None:
    """What the checker ``kind`` proves; None where that is nothing, or takes all moves and they are too many."""
    if not by_coordinates(without_stops(problem)) and too_many_arcs(problem, stop.seconds_left):
        return None
    value = CHECKERS[kind](problem, {})
    return Evidence(kind, SOURCES[kind], value, {}) if math.isfinite(value) else None


def load_shares(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Each customer pays the part of a round trip that its load takes of a vehicle; see ``evidence_of``."""
    return evidence_of("load-shares", problem, stop)


def nearest_moves(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Each customer pays half of its two least moves; see ``evidence_of``."""
    return evidence_of("nearest-moves", problem, stop)


BOUNDS.add("load-shares", BoundMethod("load-shares", lacks_loads, load_shares, order=0))
BOUNDS.add("nearest-moves", BoundMethod("nearest-moves", lacks_costs, nearest_moves, order=0))
