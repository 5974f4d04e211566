"""Evidence ``averaged-tour``: the largest of all routes is at least their mean, which a bound of their sum bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ...evidence import CHECKERS
from ..objective import Objective, TotalCost
from .known_features import departure, own_moves, unknown_features
from .round_trips import PEAKS
from .stops_on_the_way import explicit, with_fleet, without_stops

if TYPE_CHECKING:
    from ..problem import RoutingProblem

SUMS = ("spanning-tree", "arc-multipliers", "set-partitioning-duals", "state-space")
"""Evidence that bounds sums over routes."""

_EPS = float(np.finfo(np.float64).eps)


def totals(problem: RoutingProblem) -> RoutingProblem | None:
    """The problem whose total cost is the sum of what the first level is the largest of; None where that is no single maximum.

    A service counts half on the move into its site and half on the move out, so that a symmetric problem stays one.
    """
    relaxed, level = without_stops(problem), problem.objective.levels()[0].terms
    if problem.sense != "min" or len(level) != 1 or level[0][1].name not in PEAKS or unknown_features(relaxed):
        return None
    long, fleet = level[0][1].name == "longest-route", []
    half = np.where(problem.sites.depot, 0.0, problem.sites.service / 2.0)
    for v in relaxed.fleet:
        far, move = own_moves(relaxed, v)
        free = {"fixed_cost": 0.0, "unit_cost": 1.0, "unit_duration_cost": 0.0, "unit_overtime_cost": 0.0, "regular_duration": math.inf}
        if long and v.travel is None and v.speed == 1.0:
            fleet.append(replace(v, **free))  # type: ignore[arg-type]
            continue
        counted = far if long else move + half[:, None] + half[None, :]
        # Only what is counted can be limited as a distance.
        limits = {} if long else {"max_distance": math.inf}
        fleet.append(replace(v, travel=explicit(counted, move), speed=1.0, **free, **limits))  # type: ignore[arg-type]
    travel = relaxed.travel if long else explicit(fleet[0].travel.distances, fleet[0].travel.durations)  # type: ignore[union-attr]
    return with_fleet(relaxed, fleet, travel).altered(objective=Objective.of(TotalCost()))


@CHECKERS.register("averaged-tour")
def check_averaged_tour(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the makespan, the longest route or the latest return.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``kind`` and ``data`` of evidence for the sum of all routes: ``spanning-tree``, ``arc-multipliers``, ``set-partitioning-duals`` or
        ``state-space``.

    Notes
    -----
    Source: Frederickson, Hecht, Kim (1978); docs/formulations/routing.md#makespan.
    """
    if problem.family != "routing":
        raise InputError("averaged-tour is evidence for routing problems", found=problem.family)
    kind, given = data.get("kind"), data.get("data")
    if kind not in SUMS or not isinstance(given, Mapping):
        raise InputError("evidence of an averaged tour lacks that of its sum", expected=", ".join(SUMS), found=str(kind)[:80])
    summed = totals(problem)
    if summed is None:
        return -math.inf if problem.sense == "min" else math.inf
    total = CHECKERS[kind](summed, given)
    if math.isinf(total):
        return total
    counts = [len(problem.customers) if v.count is None else v.count for v in problem.fleet]
    (weight, term), routes = problem.objective.levels()[0].terms[0], min(len(problem.customers), sum(counts))
    start = min(departure(problem, v) for v in problem.fleet) if term.name == "latest-return" else 0.0
    mean = max(0.0, total) / routes
    return weight * (start + mean - 8.0 * _EPS * (abs(start) + mean))
