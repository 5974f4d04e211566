"""Evidence ``nearest-moves``: each customer is entered and left by one move, and each route leaves a depot and comes back to one.

Half of a move is paid by either end of it. A customer pays half of its two least moves, from two sites or a depot; the depots pay for as
many routes as the loads need half of the least moves to, and from, as many customers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ...evidence import CHECKERS
from .known_features import unknown_features
from .load_shares import fewest_routes, summed
from .stops_on_the_way import without_stops
from .vehicle_moves import terms_of
from .ways_by_metric import least_moves_at, rates

if TYPE_CHECKING:
    from ..problem import RoutingProblem


@CHECKERS.register("nearest-moves")
def check_nearest_moves(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective by the least moves at each site; nothing of ``data`` is read.

    Parameters
    ----------
    problem : RoutingProblem
        Objective: cost, duration and vehicles, rewards and penalties; maxima beside them count as nothing.

    Notes
    -----
    docs/formulations/routing.md#load-shares.
    """
    if problem.family != "routing":
        raise InputError("nearest-moves is evidence for routing problems", found=problem.family)
    sign, terms, relaxed = 1.0 if problem.sense == "min" else -1.0, terms_of(problem), without_stops(problem)
    if terms is None or terms.vehicles < 0 or unknown_features(relaxed) or not len(problem.customers):
        return -sign * math.inf
    service, routes = relaxed.sites.service[relaxed.sites.customers], fewest_routes(relaxed)
    vehicle = min(terms.cost * v.fixed_cost + terms.vehicles for v in relaxed.fleet)
    with np.errstate(over="ignore", invalid="ignore"):
        moves, first, last = least_moves_at(relaxed, terms)
        paid = moves / 2.0 + min(rates(terms, v)[1] for v in relaxed.fleet) * service
        ends = np.concatenate([np.sort(side)[:routes] for side in (first, last)])
        return sign * summed(relaxed, terms, paid, routes * vehicle + float(ends.sum()) / 2.0)
