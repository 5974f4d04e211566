"""Evidence ``vehicles-needed``: the routes that loads ask for at least, by bin packing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ....instances.errors import InputError
from ...checking.evidence_numbers import number
from ...evidence import CHECKERS
from .known_features import unknown_features
from .round_trips import least_peak
from .route_limits import allowed
from .stops_on_the_way import without_stops
from .vehicle_moves import terms_of

if TYPE_CHECKING:
    from ..problem import RoutingProblem


@CHECKERS.register("vehicles-needed")
def check_vehicles_needed(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on a level of the number of vehicles, costs, durations and maxima, of which only the vehicles and maxima count.

    Parameters
    ----------
    problem : RoutingProblem
    data : dict
        ``threshold``: a size k of the bound L2. Demands above capacity - k share no vehicle with one of k or more; all vehicles are taken
        for as large as the largest.

    Notes
    -----
    Source: Martello and Toth (1990), *Knapsack Problems*, section 8.3; docs/formulations/routing.md#vehicles.
    """
    if problem.family != "routing":
        raise InputError("vehicles-needed is evidence for routing problems", found=problem.family)
    k, relaxed, terms = number(data, "threshold"), without_stops(problem), terms_of(problem)
    sites = problem.sites
    if problem.sense != "min" or terms is None or unknown_features(relaxed) or terms.vehicles < 0 or terms.reward or terms.penalties < 0:
        return -math.inf if problem.sense == "min" else math.inf
    need, capacity = int(sites.required.any()), allowed(max(v.capacity for v in relaxed.fleet))
    if 0 < capacity < math.inf and 0 <= k <= capacity / 2:
        demand = sites.demand[sites.required].tolist()
        huge = [d for d in demand if d > capacity - k]
        large = [d for d in demand if capacity / 2 < d <= capacity - k]
        small = [d for d in demand if k <= d <= capacity / 2]
        rest = math.fsum([*small, *large]) - len(large) * capacity
        need = max(need, len(huge) + len(large) + max(0, math.ceil(rest / capacity - 1e-9)))
    fixed = min(v.fixed_cost for v in problem.fleet)
    peaks = math.fsum(w * least_peak(relaxed, peak) for peak, w in terms.peaks.items())
    return ((terms.vehicles + terms.cost * fixed) * max(need, problem.min_vehicles) + peaks) * (1.0 - 1e-15 * (terms.cost > 0 or peaks > 0))
