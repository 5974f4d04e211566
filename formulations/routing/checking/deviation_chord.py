"""Evidence ``deviation-chord``: a bound on problems with risks, by one of certain durations that has every answer of theirs.

The risk of the team is given to each route whole. The deviation of a route is concave in its variance, so that it is no less than its
chord from 0 to the largest deviation that a route may have: the slope of the chord times the variances is added to durations, and the
limit stays. Evidence on that problem, of any kind that knows routes, is evidence on the one with risks. Windows, and limits on time other
than the longest duration or the store, are left out. docs/formulations/routing.md#the-chord-of-the-deviation.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.routing.instance import VehicleType
from ...evidence import Evidence
from ...verified_bounds import verified_bound
from ..problem import RoutingProblem
from .known_features import Floats, explicit, own_moves, routing_evidence, unknown_features, with_fleet
from .route_limits import limits_of

KIND = "deviation-chord"

TERMS = frozenset({"total-cost", "vehicles", "reward", "penalties", "longest-route"})
"""Terms of the objective that do not depend on durations."""

_NEAR = 1e-9
"""Relative widening of limits, for the rounding of sums and roots."""


@routing_evidence(KIND)
def check_deviation_chord(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Bound on the first level of the objective; ``data``: ``kind`` and ``data`` of evidence on the problem of certain durations."""
    kind, inner = data["kind"], data["data"]
    if not isinstance(kind, str) or kind == KIND or not isinstance(inner, Mapping):
        raise InputError(f"the evidence within {KIND} is malformed, or of the same kind", found=str(kind)[:80])
    certain = without_risks(problem)
    bound = math.nan if certain is None else verified_bound(certain, Evidence(kind, "", 0.0, dict(inner)))
    return -math.inf if math.isnan(bound) else bound * (1.0 if problem.sense == "min" else -1.0)


def lacks_chord(problem: RoutingProblem) -> frozenset[str]:
    """Features for which nothing is proved."""
    features = problem.features()
    lacking = (features & {"duration-cost", "overtime", "reloads", "recharging", "committed-vehicles"}) | unknown_features(problem)
    lacking |= {f"objective:{term.name}" for _, term in problem.objective.levels()[0].terms if term.name not in TERMS}
    return lacking if features & {"route-risk", "team-risk"} else lacking | {"certain durations"}


def without_risks(problem: RoutingProblem) -> RoutingProblem | None:
    """The problem of certain durations; None where it would prove nothing."""
    if lacks_chord(problem):
        return None
    sites = problem.sites
    fleet = [_certain(problem, vehicle) for vehicle in problem.fleet]
    certain = with_fleet(problem, fleet, replace(problem.travel, variances=None, closing=None))
    zeros = np.zeros(len(sites))
    timeless = replace(sites, ready=zeros, due=np.full(len(sites), math.inf), service=zeros, windows=())
    return certain.altered(sites=timeless, team_risk=None)


def _certain(problem: RoutingProblem, vehicle: VehicleType) -> VehicleType:
    """The vehicle with services and the chord in its durations, so that its longest duration is all that is left of time."""
    distances, durations = own_moves(problem, vehicle)
    plain = replace(vehicle, risk=None, speed=1.0, shift=(-math.inf, math.inf), regular_duration=math.inf)
    chances = limits_of(problem, vehicle).chances
    if not chances:
        return replace(plain, travel=explicit(distances, durations))
    means, variances, deviations, limit = chances[0]
    largest = _largest_deviation(means, variances, deviations, limit)
    at, longer = np.concatenate([[vehicle.start], problem.sites.customers, [vehicle.end]]), durations.copy()
    slope = deviations / largest if largest > 0.0 else 0.0
    longer[np.ix_(at[:-1], at[1:])] = means[:-1, 1:] + slope * variances[:-1, 1:]
    return replace(plain, travel=explicit(distances, longer), max_duration=max(0.0, limit * (1.0 + _NEAR)), energy=None)


def _largest_deviation(means: Floats, variances: Floats, deviations: float, limit: float) -> float:
    """Largest root of the variance that a route within the limit may have: s where s^2 / ratio + deviations s = limit."""
    m, v = means[:-1, 1:], variances[:-1, 1:]
    used = (v > 0.0) & (m + deviations * np.sqrt(v) <= limit * (1.0 + _NEAR))
    if not used.any() or limit <= 0.0 or not deviations > 0.0:
        return 0.0
    with np.errstate(divide="ignore", over="ignore"):
        ratio = float((v[used] / m[used]).max())
    per = 4.0 * limit / ratio if math.isfinite(ratio) else 0.0
    return 2.0 * limit / (deviations + math.sqrt(deviations * deviations + per)) * (1.0 + _NEAR)
