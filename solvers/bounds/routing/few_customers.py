"""Bounds ``all-routes`` and ``customer-sets``: the optimum of problems with few customers, by evidence of the same names.

``all-routes`` serves where other evidence knows too little of the fleet or the sites; ``customer-sets`` where the largest route is weighed
against costs: limits on it divide the answers, and are found here.
"""

import heapq
import math

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.all_routes import MOST, MOST_ORDERS, orders
from ....formulations.routing.checking.customer_sets import CUSTOMERS, LIMITS, WORK, CustomerSets, joined_peak
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop, until
from ....formulations.verified_bounds import verified_bound
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family

PER_SECOND = 2e8
"""Sets that are joined in a second."""


def _lacks_few_routes(problem: RoutingProblem) -> frozenset[str]:
    many = orders(problem) > MOST_ORDERS and len(problem.customers) > MOST
    return frozenset({"few customers"}) if many else frozenset()


@bound_method("all-routes", of_family("routing", _lacks_few_routes), order=8, aims=True)
def all_routes_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """The optimum over all routes, which the checker derives: in half a second for seven customers, in some more for twelve."""
    if stop.reached():
        return None
    count = len(problem.customers)
    return _verified(problem, Evidence("all-routes", f"all routes of {count} customer{'s' if count != 1 else ''}", math.nan, {}), stop)


def _lacks_few_sets(problem: RoutingProblem) -> frozenset[str]:
    missing = unknown_features(without_stops(problem))
    if not 0 < len(problem.customers) <= CUSTOMERS:
        missing = missing | {"few customers"}
    return missing if terms_of(problem) is not None else missing | {"objective:weights"}


KERNELS = ("waybound.formulations.routing.checking.customer_set_kernels",)


@bound_method("customer-sets", of_family("routing", _lacks_few_sets), order=7, aims=True, kernels=KERNELS)
def customer_sets_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """Evidence from limits on the largest route, each halved where the bound is least; a bound beyond ``target`` is worth no time.

    Half of the time is for finding limits; what they prove takes no longer.
    """
    if stop.reached():
        return None
    terms = terms_of(problem)
    assert terms is not None
    with until(stop):
        sets = CustomerSets.of(problem, terms)
        limits = None if sets is None else _limits(sets, stop, math.inf if target is None or problem.sense == "max" else target)
    if limits is None:
        return None
    data = {joined_peak(terms): limits} if limits else {}
    return _verified(problem, Evidence("customer-sets", "routes through each set of customers", math.nan, data), stop)


def _verified(problem: RoutingProblem, evidence: Evidence, stop: Stop) -> Evidence | None:
    """The evidence with the bound that its checker derives; None where that is nothing."""
    with until(stop):
        bound = verified_bound(problem, evidence)
    nothing = -math.inf if problem.sense == "min" else math.inf
    return None if bound == nothing else Evidence(evidence.kind, evidence.source, bound, evidence.data)


def _limits(sets: CustomerSets, stop: Stop, target: float) -> list[float] | None:
    """Limits below which answers are bounded as well as above; None where the time does not suffice for one bound."""
    most = min(WORK / 2, PER_SECOND * stop.seconds_left / 2)
    value, done = sets.cheapest(work=most)
    if math.isnan(value):
        return None
    if not sets.weight or not math.isfinite(value):
        return []
    # Between two neighbours nothing changes, so that a limit just below a peak stands for all answers below it.
    peaks = np.unique(np.concatenate([peaks for _, _, peaks, _ in sets.types]))
    below = np.maximum(sets.least, peaks - 4.0 * sets.blur - 1e-15 * np.abs(peaks))
    best = (target - sets.fixed) if math.isfinite(target) else math.inf
    first = max(0, int(np.searchsorted(peaks, sets.least - sets.blur)))
    pieces = [(value + sets.weight * sets.least, first, len(peaks) - 1, value)]  # bound, first and last peak, least cost
    while len(pieces) <= LIMITS:
        bound, low, high, worth = pieces[0]
        if bound >= best or low >= high:
            break
        half = (low + high) // 2
        cheaper, work = sets.cheapest(float(peaks[half]), most - done)
        done += work
        if math.isnan(cheaper):
            break
        best = min(best, cheaper + sets.weight * float(peaks[half]))
        heapq.heapreplace(pieces, (cheaper + sets.weight * (float(below[low]) if low > first else sets.least), low, half, cheaper))
        heapq.heappush(pieces, (worth + sets.weight * float(below[half + 1]), half + 1, high, worth))
    return sorted(float(below[low]) for _, low, _, _ in pieces if low > first)
