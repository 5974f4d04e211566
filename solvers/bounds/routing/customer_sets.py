"""Bound ``customer-sets``: limits on the largest route by which the checker of the same name divides the answers."""

from __future__ import annotations

import heapq
import math
from typing import TYPE_CHECKING

import numpy as np

from ....formulations.certificate import verified_bound
from ....formulations.evidence import Evidence
from ....formulations.routing.checking.customer_sets import CUSTOMERS, LIMITS, WORK, CustomerSets, joined_peak
from ....formulations.routing.checking.known_features import unknown_features, without_stops
from ....formulations.routing.checking.vehicle_moves import terms_of
from ....formulations.stop import NEVER, Stop, until
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

PER_SECOND = 2e8
"""Sets that are joined in a second."""


def customer_sets_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """Evidence from limits that are halved where the bound is least.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
        Half of it is for finding limits; what they prove takes no longer.
    linear : unused
        No program is solved.
    target : float, optional
        Value of a known answer: a bound beyond it is worth nothing.

    Returns
    -------
    Evidence or None
        None where the time does not suffice.
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
        made = Evidence("customer-sets", "routes through each set of customers", math.nan, {joined_peak(terms): limits} if limits else {})
        bound = verified_bound(problem, made)
    nothing = -math.inf if problem.sense == "min" else math.inf
    return None if bound == nothing else Evidence(made.kind, made.source, bound, made.data)


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
    pieces = [(value + sets.weight * sets.least, first, len(peaks) - 1, value)]  # from which peak to which, and the least value of it
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


def _missing(problem: Problem) -> frozenset[str]:
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    unknown = unknown_features(without_stops(problem))  # type: ignore[arg-type]
    if not 0 < len(problem.customers) <= CUSTOMERS:  # type: ignore[attr-defined]
        unknown = unknown | {"few customers"}
    return unknown if terms_of(problem) is not None else unknown | {"objective:weights"}  # type: ignore[arg-type]


KERNELS = ("waybound.formulations.routing.checking.customer_set_kernels",)

BOUNDS.add("customer-sets", BoundMethod("customer-sets", _missing, customer_sets_bound, order=7, aims=True, kernels=KERNELS))
