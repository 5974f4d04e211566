"""Uncertain durations in whole numbers: variances of moves, and by how many deviations each vehicle keeps its limits."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from ..integer_scales import Integers
from ..routing_integers import IntegerRouting

if TYPE_CHECKING:
    from .....formulations.routing.problem import RoutingProblem

BITS = 40
"""Variances are scaled by a power of 4 such that the largest has about so many bits: sums along a route keep within 64."""


class Risks:
    """Risks of a problem: ``risky`` tells the vehicle types whose limits are uncertain, ``shared`` whether the team has a risk; columns of
    ``types``, shape (vehicle types, 2), and the most of ``sums[HAZARDS]``."""

    def __init__(self, problem: RoutingProblem) -> None:
        fleet = problem.fleet
        asked = [[p for p in (v.risk, problem.team_risk) if p is not None] for v in fleet]
        self.risky = np.array([bool(each) and problem.travel_of(k).uncertain for k, each in enumerate(asked)])
        self.shared = problem.team_risk is not None and bool(self.risky.any())
        cautions = [-NormalDist().inv_cdf(min(each)) if risky else 0.0 for each, risky in zip(asked, self.risky, strict=True)]
        self.caution = np.ceil(np.ldexp(cautions, 40)).astype(np.int64)
        self.most = math.floor(math.ldexp(-math.log1p(-problem.team_risk), 50)) if problem.team_risk is not None else 0

    def variances(self, problem: RoutingProblem, data: IntegerRouting) -> tuple[list[Integers], int]:
        """Variances of the moves of each profile, in units of time squared, times ``4**fineness``, and this fineness."""
        clock = data.scales["time"]
        held = {int(p): problem.travel_of(k).variances for k, p in enumerate(data.profile)}
        largest = max((float(v.max()) for v in held.values() if v is not None), default=0.0) * clock**2
        fineness = (BITS - math.frexp(largest)[1]) // 2 if largest else 0
        zeros = np.zeros((len(problem.sites),) * 2)
        kept = [held[p] if held[p] is not None else zeros for p in range(len(data.moves))]
        return [np.ceil(v * clock**2 * 4.0**fineness).astype(np.int64) for v in kept], fineness
