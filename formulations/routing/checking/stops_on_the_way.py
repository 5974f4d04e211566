"""A problem whose vehicles make stops at depots on the way, as one without such stops that has every answer of it, at no more cost.

A move between two sites becomes the shortest way between them over any of the depots where the vehicle reloads or recharges, and what
starts anew there is no longer limited. Distances and durations are shortened each by itself.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ....instances.routing.travel import EXPLICIT, Travel
from .known_features import Floats, Longs, own_moves

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


def with_fleet(problem: RoutingProblem, fleet: Sequence[VehicleType], travel: Travel | None = None) -> RoutingProblem:
    """The same problem with other vehicles."""
    return problem.altered(fleet=tuple(fleet), travel=travel or problem.travel)


def explicit(distances: Floats, durations: Floats) -> Travel:
    """Travel along matrices as they are, whatever the convention of the problem."""
    return Travel(EXPLICIT, matrix=distances, duration_matrix=durations, convention="exact")


def without_stops(problem: RoutingProblem) -> RoutingProblem:
    """The problem without stops on the way; ``problem`` itself where no vehicle makes any."""
    if not any(v.reloads or v.stations for v in problem.fleet):
        return problem
    fleet = []
    for v in problem.fleet:
        stops = np.array(sorted({*v.reloads, *v.stations}), dtype=np.int64)
        distances, durations = (_over(matrix, stops) if len(stops) else matrix for matrix in own_moves(problem, v))
        loads = {"capacity": math.inf, "further_capacity": (), "reloads": (), "max_reloads": None} if v.reloads else {}
        store = {"energy": None} if v.stations else {}
        fleet.append(replace(v, travel=explicit(distances, durations), speed=1.0, **loads, **store))  # type: ignore[arg-type]
    travel = explicit(problem.travel.distances, problem.travel.durations)
    return with_fleet(problem, fleet, travel).altered(forbidden=None)  # what is forbidden is a move without a stop between


def _over(matrix: Floats, stops: Longs) -> Floats:
    """Shortest ways over any of the stops (Floyd 1962)."""
    length = matrix.copy()
    for k in stops.tolist():
        np.minimum(length, length[:, k, None] + length[None, k], out=length)
    return length
