"""Restarts of primal-dual methods with reflected Halpern steps; docs/saddle.md#the-restarted-halpern-method."""

from __future__ import annotations

import math

import numpy as np

from .....formulations.sata.balls import Floats

ROUND = 40
"""Most steps between two looks at how far they go."""

SUFFICIENT, NECESSARY, LONGEST = 0.2, 0.8, 0.36
"""A restart comes once steps are this short, in parts of the first one seen since the last restart; or this short and growing again; or
after this share of all steps."""

Pair = tuple[Floats, Floats]


class Restarts:
    """The primal and the dual side of a method with restarts, each an array: compiled steps change ``point`` in place, draw it to
    ``anchor``, and put into ``ahead`` where the last plain step led.

    ``lengths`` are those of the steps of the sides: ``weight`` times, and over, the ones given, in parts of which distances are taken. A
    restart goes on from ``ahead``, and weighs the sides anew by how far either came (Applegate et al. 2021).
    """

    def __init__(self, primal: Floats, dual: Floats, lengths: Pair, weight: float) -> None:
        self.point, self.anchor, self.ahead = ((primal.copy(), dual.copy()) for _ in range(3))
        self._lengths, self._inverse, self.weight = lengths, (inverse(lengths[0]), inverse(lengths[1])), 1.0
        self._weigh(weight)
        self.steps, self.since, self.count = 0, 0, 0
        self._first = self._last = math.inf

    @property
    def lengths(self) -> Pair:
        """Lengths of the sides' steps."""
        return self._lengths[0] * self.weight, self._lengths[1] / self.weight

    def _weigh(self, weight: float) -> None:
        if 0.0 < weight < math.inf:
            self.weight = weight

    def note(self, made: int) -> None:
        """So many steps were made."""
        self.steps += made
        self.since += made

    def look(self) -> None:
        """Restart if it is time to."""
        sides = zip(self.point, self.anchor, self.ahead, strict=True)
        far, wide = map(length, (point + (point - anchor) / self.since - ahead for point, anchor, ahead in sides), self._inverse)
        gone = math.hypot(far / math.sqrt(self.weight), wide * math.sqrt(self.weight))
        if self._first == math.inf:
            self._first = self._last = gone
            return
        rises, self._last = gone > self._last, gone
        if gone <= self._first * (NECESSARY if rises else SUFFICIENT) or self.since >= LONGEST * self.steps:
            self._restart()

    def _restart(self) -> None:
        far, wide = map(length, (new - old for new, old in zip(self.ahead, self.anchor, strict=True)), self._inverse)
        self._weigh(math.sqrt(self.weight * far / wide) if wide > 0.0 else 0.0)
        for point, anchor, ahead in zip(self.point, self.anchor, self.ahead, strict=True):
            point[:] = anchor[:] = ahead
        self.count, self.since, self._first = self.count + 1, 0, math.inf


def inverse(values: Floats) -> Floats:
    """1 over each, 0 for 0."""
    with np.errstate(over="ignore", divide="ignore"):
        return np.where(values > 0.0, 1.0 / values, 0.0)


def length(move: Floats, inverse_steps: Floats) -> float:
    """Euclidean length of a move in the metric of the lengths of steps."""
    with np.errstate(over="ignore", under="ignore"):
        return float(np.sqrt(np.sum(move**2 * inverse_steps)))
