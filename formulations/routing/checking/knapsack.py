"""Evidence ``knapsack``: what visits are worth at most, where each takes a part of what all routes have of one resource.

At any price of the resource it is the dual of a fractional knapsack, in which a visit takes half of the least moves in and out of its
site; docs/formulations/routing.md#knapsack.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...checking.evidence_numbers import number
from ...checking.granularity import grain, lift
from ..problem import RoutingProblem
from .known_features import EPS, RESOURCES, Floats, refuse_unknown_resources, routing_evidence
from .round_trips import least_peak
from .vehicle_moves import VehicleMoves, alike, relaxed_terms, terms_of


def needs(problem: RoutingProblem, name: str) -> tuple[Floats, float] | None:
    """The least of a resource that each visit uses, and the total that the fleet has for visits.

    Each move is shared half and half between its two ends; the depot's halves of first and last moves are taken off the total.
    None where the resource is not limited. For a problem without stops on the way.
    """
    terms, customers = terms_of(problem), problem.sites.customers
    assert terms is not None
    least, room = np.full(len(customers), math.inf), 0.0
    for vehicle, count in alike(problem).items():
        moves = VehicleMoves.of(problem, vehicle, terms, np.zeros(len(customers)), {})
        r = moves.resources.get(name)
        if r is None or not math.isfinite(r.upper[0]):
            return None
        weight = np.where(np.isfinite(moves.cost), r.weight, math.inf)
        into, out = weight[:, 1:].min(axis=0), weight[1:].min(axis=1)
        least = np.minimum(least, (into + out) / 2.0)
        first, last = float(weight[0].min()), float(weight[:, 0].min())
        if math.isfinite(first + last):
            room += min(len(customers), count) * max(0.0, float(r.upper[0]) + r.slack - r.start - (first + last) / 2.0)
    return np.where(np.isfinite(least), least, 0.0), room


@routing_evidence("knapsack")
def check_knapsack(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on an objective of rewards or penalties; costs beside them count as nothing.

    ``data``: ``resource``, and ``rate``, the price of a unit of it, negative ones read as 0.
    Source: Dantzig (1957); Leifer and Rosenwein (1994) for orienteering.
    """
    name, rate = data.get("resource"), max(0.0, number(data, "rate"))
    refuse_unknown_resources([str(name)], RESOURCES, str(name))
    sites, customers, (relaxed, terms) = problem.sites, problem.customers, relaxed_terms(problem)
    taken = None if terms is None or terms.vehicles < 0 else needs(relaxed, str(name))
    if terms is None or taken is None:
        return -math.inf
    least, room = taken
    worth = terms.reward * sites.reward[customers] - terms.penalties * sites.penalty[customers] + rate * least
    parts = np.concatenate([
        np.where(sites.required[customers], worth, np.minimum(worth, 0.0)),
        terms.penalties * sites.penalty[customers],
        terms.reward * sites.reward[sites.depots],
        [-rate * room, *(w * least_peak(relaxed, peak) for peak, w in terms.peaks.items())],
    ])  # fmt: skip
    bound = math.fsum(parts) - 32.0 * EPS * (math.fsum(np.abs(parts)) + rate * float(least.sum()))
    if not math.isfinite(bound):
        return -math.inf
    alone = not (terms.peaks or terms.cost or terms.duration or terms.vehicles)
    parts = np.concatenate([terms.reward * sites.reward, terms.penalties * sites.penalty])
    return lift(bound, "min", grain(parts) if alone else None)
