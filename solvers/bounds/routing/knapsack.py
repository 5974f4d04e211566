"""Bound ``knapsack``: the best price of the resource of which visits take most, for the evidence of the same name."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.knapsack import check_knapsack, needs
from ....formulations.routing.checking.known_features import RESOURCES, unknown_features, without_stops
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod
from .arcs import too_many_arcs

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem


def lacks_rewards(problem: Problem) -> frozenset[str]:
    """Other families, objectives without rewards and penalties, and what is unknown or of which more is better."""
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    terms = terms_of(problem)  # type: ignore[arg-type]
    missing = unknown_features(without_stops(problem))  # type: ignore[arg-type]
    if terms is None or terms.vehicles < 0:
        return missing | {"objective:weights"}
    return missing if terms.reward < 0 or terms.penalties > 0 else missing | {"objectives without rewards and penalties"}


def knapsack_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The critical ratio of the fractional knapsack of each resource, and the best of the bounds that they prove.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
    linear : unused
        No program is solved.
    """
    if too_many_arcs(problem, stop.seconds_left):
        return None
    relaxed, terms, sites, customers = without_stops(problem), terms_of(problem), problem.sites, problem.customers
    assert terms is not None
    sign = 1.0 if problem.sense == "min" else -1.0
    gain = terms.penalties * sites.penalty[customers] - terms.reward * sites.reward[customers]
    found = [Evidence("knapsack", "", check_knapsack(problem, data), data) for data in [{"resource": "time", "rate": 0.0}]]
    for name in RESOURCES:
        taken = needs(relaxed, name)
        if taken is None or stop.reached():
            continue
        least, room = taken
        ratio = gain / np.maximum(least, 1e-300)
        order = np.argsort(-ratio, kind="stable")
        full = int(np.searchsorted(np.cumsum(least[order]), room))
        if full < len(order):
            data = {"resource": name, "rate": float(max(0.0, ratio[order[full]]))}
            found.append(Evidence("knapsack", "", check_knapsack(problem, data), data))
    best = max(found, key=lambda e: sign * e.value)
    return Evidence(best.kind, f"knapsack of {best.data['resource']}", best.value, best.data)


BOUNDS.add("knapsack", BoundMethod("knapsack", lacks_rewards, knapsack_bound, order=0))
