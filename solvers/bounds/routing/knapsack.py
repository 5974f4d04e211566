"""Bound ``knapsack``: the best price of the resource of which visits take most, for the evidence of the same name."""

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.knapsack import check_knapsack, needs
from ....formulations.routing.checking.known_features import RESOURCES, unknown_features, without_stops
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family
from .arcs import too_many_arcs


def lacks_rewards(problem: RoutingProblem) -> frozenset[str]:
    """Features that the checker does not know, objectives in which more of a cost is better, and those without rewards and penalties."""
    terms = terms_of(problem)
    missing = unknown_features(without_stops(problem))
    if terms is None or terms.vehicles < 0:
        return missing | {"objective:weights"}
    return missing if terms.reward < 0 or terms.penalties > 0 else missing | {"objectives without rewards and penalties"}


@bound_method("knapsack", of_family("routing", lacks_rewards))
def knapsack_bound(problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """The best of the bounds that the critical ratios of the fractional knapsacks of all resources prove."""
    if too_many_arcs(problem, stop.seconds_left):
        return None
    relaxed, terms, sites, customers = without_stops(problem), terms_of(problem), problem.sites, problem.customers
    assert terms is not None
    sign = 1.0 if problem.sense == "min" else -1.0
    gain = terms.penalties * sites.penalty[customers] - terms.reward * sites.reward[customers]
    everything: dict[str, object] = {"resource": "time", "rate": 0.0}
    proved = [(check_knapsack(problem, everything), everything)]
    for name in RESOURCES:
        taken = needs(relaxed, name)
        if taken is None or stop.reached():
            continue
        least, room = taken
        ratio = gain / np.maximum(least, 1e-300)
        order = np.argsort(-ratio, kind="stable")
        full = int(np.searchsorted(np.cumsum(least[order]), room))
        if full < len(order):
            priced: dict[str, object] = {"resource": name, "rate": float(max(0.0, ratio[order[full]]))}
            proved.append((check_knapsack(problem, priced), priced))
    value, data = max(proved, key=lambda one: sign * one[0])
    return Evidence("knapsack", f"knapsack of {data['resource']}", value, data)
