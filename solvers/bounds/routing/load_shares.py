"""Bounds ``load-shares`` and ``nearest-moves``: what loads, and the least moves at each site, prove at once and at any size.

The checkers look at all sites, and read nothing of the evidence.
"""

import math

from ....formulations.evidence import CHECKERS, Evidence
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.load_shares import by_coordinates
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .arcs import too_many_arcs

SOURCES = {"load-shares": "round trips shared by loads", "nearest-moves": "least moves at each site"}


def lacks_costs(problem: RoutingProblem) -> frozenset[str]:
    """Features that the checkers do not know; also objectives in which moves and vehicles cost nothing, or vehicles are rewarded."""
    missing, terms = unknown_features(without_stops(problem)), terms_of(problem)
    if terms is None or terms.vehicles < 0:
        return missing | {"objective:weights"}
    return missing if terms.cost or terms.duration or terms.vehicles else missing | {"objectives without costs"}


def lacks_loads(problem: RoutingProblem) -> frozenset[str]:
    """The features of ``lacks_costs``, and problems without capacities."""
    missing = lacks_costs(problem)
    return missing if "capacity" in problem.features() else missing | {"problems without capacity"}


def evidence_of(kind: str, problem: RoutingProblem, stop: Stop = NEVER) -> Evidence | None:
    """The bound that the checker ``kind`` derives; None where that is nothing, or takes all moves and they are too many."""
    if not by_coordinates(without_stops(problem)) and too_many_arcs(problem, stop.seconds_left):
        return None
    value = CHECKERS[kind](problem, {})
    return Evidence(kind, SOURCES[kind], value, {}) if math.isfinite(value) else None


@bound_method("load-shares", of_family("routing", lacks_loads))
def load_shares(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Each customer pays the part of a round trip that its load takes of a vehicle."""
    return evidence_of("load-shares", problem, stop)


@bound_method("nearest-moves", of_family("routing", lacks_costs))
def nearest_moves(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Each customer pays half of its two least moves."""
    return evidence_of("nearest-moves", problem, stop)
