"""Beliefs about rooms: the joint distribution of a room's type and of whether it holds a target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ....instances.errors import InputError

Floats = NDArray[np.float64]

TARGET, EMPTY = 0, 1
"""Columns of a room's belief."""


@dataclass(frozen=True)
class Sensors:
    """Probabilities of readings given the truth.

    ``types`` has a row of readings for each true type, which sums to 1; ``detection`` and ``false_alarm`` are the probabilities that a
    target is reported where there is one, and where there is none.
    """

    types: Floats
    detection: float
    false_alarm: float

    def __post_init__(self) -> None:
        table = np.asarray(self.types, dtype=np.float64)
        if table.ndim != 2 or table.shape[0] != table.shape[1] or not (table >= 0).all() or (np.abs(table.sum(axis=1) - 1) > 1e-9).any():
            raise InputError("readings of types must be a square table of probabilities whose rows, the true types, sum to 1")
        if not (0 <= self.detection <= 1 and 0 <= self.false_alarm <= 1):
            raise InputError("detection and false alarm must be probabilities", found=f"{self.detection}, {self.false_alarm}")
        object.__setattr__(self, "types", table)

    @property
    def targets(self) -> Floats:
        """Probabilities of a report and of none; one row with a target, one without."""
        return np.array([[self.detection, 1 - self.detection], [self.false_alarm, 1 - self.false_alarm]])


def prior(types: ArrayLike, target_given_type: ArrayLike) -> Floats:
    """Joint belief of a room, shape (types, 2), from probabilities of types and the probability of a target given each type."""
    p, q = np.asarray(types, dtype=np.float64), np.asarray(target_given_type, dtype=np.float64)
    if p.ndim != 1 or p.shape != q.shape or not (p >= 0).all() or abs(p.sum() - 1) > 1e-9 or not ((q >= 0) & (q <= 1)).all():
        raise InputError("types must be probabilities that sum to 1, with a probability of a target each", found=f"{p} and {q}")
    return np.column_stack([p * q, p * (1 - q)])


def after_type(belief: Floats, sensors: Sensors, reading: int) -> Floats:
    """The belief after a reading of the type, by Bayes' rule on the joint distribution, which updates the target too.

    Updating the two marginals in turn, as (5.1) and (5.2) of Zhang (2015) suggest, counts repeated readings twice.
    """
    return _normalised(belief * sensors.types[:, [reading]])


def after_target(belief: Floats, sensors: Sensors, reported: bool) -> Floats:
    """The belief after a report of a target, or of none."""
    return _normalised(belief * sensors.targets[:, 0 if reported else 1])


def _normalised(belief: Floats) -> Floats:
    total = float(belief.sum())
    if not total > 0:
        raise InputError("a reading that the belief holds impossible")
    return belief / total


def entropy(probabilities: ArrayLike) -> float:
    """Entropy of a distribution in nats."""
    p = np.asarray(probabilities, dtype=np.float64)
    return float(-(p[p > 0] * np.log(p[p > 0])).sum())


def mutual_information(states: ArrayLike, readings: ArrayLike) -> float:
    """Expected fall of the entropy of a state by one reading, in nats, at least 0; ``readings`` has one row a state."""
    p, table = np.asarray(states, dtype=np.float64), np.asarray(readings, dtype=np.float64)
    return max(0.0, entropy(p @ table) - float(p @ np.array([entropy(row) for row in table])))


@dataclass(frozen=True)
class Rewards:
    """Worth of actions: weights of exploring, mapping and searching, worth of a first visit, and its decay at each further one.

    Weights are at least 0 and sum to 1. ``gain`` is ``mutual-information``, the expected information of a reading, or ``entropy``, what is
    not known yet, as the source has it, whatever the sensor is worth.

    Source: Zhang (2015), (5.3) and (5.4); docs/formulations/task-allocation.md#exploration.
    """

    weights: tuple[float, float, float]
    first: float = 1.0
    decay: float = 0.5
    gain: str = "mutual-information"

    def __post_init__(self) -> None:
        if len(self.weights) != 3 or min(self.weights) < 0 or abs(sum(self.weights) - 1) > 1e-9:
            raise InputError("weights of exploring, mapping and searching must not be negative, and sum to 1", found=str(self.weights))
        if not 0 < self.decay < 1 or not self.first >= 0 or self.gain not in ("mutual-information", "entropy"):
            raise InputError("first must be at least 0, decay between 0 and 1, gain mutual-information or entropy")

    def explore(self, visits: int) -> float:
        return self.weights[0] * self.first * self.decay**visits

    def map(self, belief: Floats, sensors: Sensors) -> float:
        types = belief.sum(axis=1)
        return self.weights[1] * (entropy(types) if self.gain == "entropy" else mutual_information(types, sensors.types))

    def search(self, belief: Floats, sensors: Sensors) -> float:
        target = belief.sum(axis=0)
        return self.weights[2] * (entropy(target) if self.gain == "entropy" else mutual_information(target, sensors.targets))
