"""Probability that a route overruns its limits, where durations of moves are uncertain: part of the judge.

Durations of moves are independent and normal, so that what a route takes is normal too. It shares no code with the forms.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...instances.routing.vehicle_type import VehicleType
    from .schedule import Schedule


@dataclass(frozen=True)
class Uncertain:
    """A normal quantity that is limited, ``duration`` or ``energy`` of a route."""

    name: str
    mean: float
    deviation: float
    limit: float

    def overrun(self) -> float:
        """Probability that it exceeds its limit."""
        return tail((self.limit - self.mean) / self.deviation)

    def needed(self, risk: float) -> float:
        """The least limit that it exceeds with probability ``risk``."""
        return self.mean + quantile(risk) * self.deviation


def uncertain(vehicle: VehicleType, plan: Schedule) -> list[Uncertain]:
    """Limited quantities of a route that are uncertain."""
    deviation, energy = math.sqrt(plan.variance), vehicle.energy
    quantities = [Uncertain("duration", plan.duration, deviation, vehicle.max_duration)]
    if energy is not None:
        quantities.append(Uncertain("energy", energy.rate * plan.charged[energy.charge], energy.rate * deviation, energy.at_departure))
    return [one for one in quantities if one.deviation > 0.0 and one.limit < math.inf]


def route_overrun(vehicle: VehicleType, plan: Schedule) -> float:
    """Probability that a route takes too long or draws too much: both depend on the same durations, so the likelier of the two."""
    return max((one.overrun() for one in uncertain(vehicle, plan)), default=0.0)


def joint_overrun(overruns: Sequence[float]) -> float:
    """Probability that any of several routes overruns a limit: each drives by itself, so that they do so independently."""
    return 1.0 if 1.0 in overruns else 0.0 - math.expm1(math.fsum(math.log1p(-p) for p in overruns))


def tail(x: float) -> float:
    """Probability that a standard normal number is larger than ``x``; right to the last digits however small it is."""
    return 0.5 * math.erfc(x / math.sqrt(2.0))


@functools.lru_cache(maxsize=1024)
def quantile(risk: float) -> float:
    """The number that a standard normal one exceeds with probability ``risk``, which is above 0 and 1/2 at most."""
    if risk >= 0.5:
        return 0.0  # halving would end above it
    low, high = 0.0, 40.0
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if tail(middle) > risk else (low, middle)
    return high
