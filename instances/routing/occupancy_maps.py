"""Maps of occupancy cells: of hidden Markov models whose rates are learnt, or of confidence that decays as periods of change are learnt."""

from typing import Any

import numpy as np

from ..errors import InputError
from ..generators import Flags, Floats, Integers
from .occupancy import (
    RangeSensor,
    chi_square,
    corrected,
    csqmi,
    decay_rate,
    logit,
    mutual_information,
    online_em,
    predicted,
    probability,
    stationary,
    unknown_at,
    updated_period,
)

UTILITIES = ("csqmi", "mutual-information", "chi-square")

RAREST_RATE = 1e-4
"""Least probability of a change in a step: with none a cell could never be doubted again."""


class MarkovMap:
    """Each cell a hidden Markov model of free and occupied whose rates are learnt by online expectation maximisation.

    ``prior`` (cells,) are probabilities of occupied at the start, ``seconds`` the time of a step, ``rate`` the probability of each change
    in a step at the start, ``forgetting`` the weight of a step in what is learnt, and ``window`` the seconds in which transitions are
    counted: ``observed`` ones with each reading, from what was more probable after the reading before, or ``believed`` ones, one a step.

    Source: Mitchell (2020), section 4.2; the map is taken for what it is now when ways are planned, as in chapter 5.
    """

    def __init__(
        self, prior: Floats, sensor: RangeSensor, *, seconds: float, rate: float = 0.02, forgetting: float = 0.005, window: float = 3000.0,
        counted: str = "observed",
    ) -> None:  # fmt: skip
        if not 0.0 < rate < 1.0 or not 0.0 < forgetting < 1.0 or window < seconds:
            message = "rates of change and forgetting must lie between 0 and 1, and the window have a step"
            raise InputError(message, "out-of-range", found=f"{rate:g}, {forgetting:g} and {window:g} s")
        self.p, self.sensor, self.seconds, self.forgetting, self.counted = prior.copy(), sensor, seconds, forgetting, counted
        count = len(prior)
        self.rates = np.broadcast_to(np.array([[1.0 - rate, rate], [rate, 1.0 - rate]])[..., None], (2, 2, count)).copy()
        self._flows = 0.5 * self.rates[:, :, None] * np.stack([1.0 - prior, prior])
        self._counts, self._past, self._step = np.zeros((4, count)), np.full((round(window / seconds), count), -1, dtype=np.int8), 0
        self._state = prior > 0.5

    def update(self, seen: Integers, hits: Flags) -> None:
        likelihood = np.full((2, len(self.p)), 0.5)
        likelihood[:, seen] = self.sensor.likelihood(hits)
        before = predicted(self.p, self.rates[0, 1], self.rates[1, 0])
        q = np.stack([1.0 - self.p, self.p])
        _, self._flows, learnt = online_em(q, self._flows, self.rates, likelihood, self.forgetting)
        self.p = corrected(before, likelihood)
        change = np.clip(learnt[[0, 1], [1, 0]], RAREST_RATE, 0.5)
        self.rates = np.array([[1.0 - change[0], change[0]], [change[1], 1.0 - change[1]]])
        self._count(seen)

    def _count(self, seen: Integers) -> None:
        slot, cells = self._step % len(self._past), np.arange(len(self.p))
        old = self._past[slot]
        np.subtract.at(self._counts, (old[old >= 0], cells[old >= 0]), 1.0)
        state, using = self.p > 0.5, cells if self.counted == "believed" else seen
        new = np.full(len(self.p), -1, dtype=np.int8)
        new[using] = 2 * self._state[using] + state[using]
        self._counts[new[using], using] += 1.0
        self._state[using] = state[using]
        self._past[slot] = new
        self._step += 1

    @property
    def settled(self) -> Floats:
        """Probability of occupied that the rates tend to."""
        return np.asarray(stationary(self.rates[0, 1], self.rates[1, 0]))

    def chi_square(self) -> Floats:
        """Misfit of the counted transitions to the rates, for each second of the window that has passed."""
        steps = max(min(self._step, len(self._past)), 1)
        return chi_square(self._counts, self.settled, self.rates[0, 1], self.rates[1, 0], steps) / (steps * self.seconds)

    def closes(self, threshold: float) -> Floats:
        return np.where(self.p < threshold, np.inf, -np.inf)


class DecayMap:
    """Each cell's log-odds shrink at a rate that goes with its learnt period of change; without ``learning`` they stay.

    ``prior``, ``sensor`` and ``seconds`` are as in ``MarkovMap``; ``period`` (s) and ``variance`` (s2) are those of changes at the start,
    ``process`` and ``noise`` (s2) the variances of what periods do by themselves in a step, and of a measurement. ``surest`` is the largest
    confidence (``1 - surest`` the least), ``occupied`` and ``free`` are thresholds. A change is measured ``since`` the ``shift`` before it,
    or since the ``last`` reading, as (3.5) prints.

    Source: Mitchell (2020), (3.2)-(3.6), with (3.4) of log-odds.
    """

    def __init__(
        self, prior: Floats, sensor: RangeSensor, *, seconds: float, period: float = 300.0, variance: float = 1e4, process: float = 10.0,
        noise: float = 1e4, surest: float = 0.97, occupied: float = 0.7, free: float = 0.3, since: str = "shift", learning: bool = True,
    ) -> None:  # fmt: skip
        if min(variance, process) < 0 or not noise > 0:
            raise InputError("variances of periods must not be negative, that of measurements positive", "out-of-range")
        self.p, self.sensor, self.seconds, self.learning, self.since = prior.copy(), sensor, seconds, learning, since
        self.process, self.noise, self.surest, self.occupied, self.free = process, noise, surest, occupied, free
        self.period, self._variance = np.full(len(prior), float(period)), np.full(len(prior), float(variance))
        self._odds, self._last, self._shift = logit(prior), np.zeros(len(prior)), np.zeros(len(prior))
        self._state, self.clock = np.where(prior >= occupied, 1, np.where(prior <= free, 0, -1)), 0.0
        self._rates()

    def _rates(self) -> None:
        self.rate = np.where(self._odds > 0, decay_rate(self.period, self.surest, self.occupied), 0.0)
        self.rate = np.where(self._odds < 0, decay_rate(self.period, 1.0 - self.surest, self.free), self.rate) * self.learning

    def update(self, seen: Integers, hits: Flags) -> None:
        self.clock += self.seconds
        own = self.sensor.likelihood(hits)
        most = float(logit(self.surest))
        odds = self._odds[seen] * np.exp(-self.rate[seen] * (self.clock - self._last[seen])) + np.log(own[1] / own[0])
        p = probability(odds)
        state, known = np.where(p >= self.occupied, 1, np.where(p <= self.free, 0, -1)), self._state[seen]
        shifted, first = (state >= 0) & (known >= 0) & (state != known), (known < 0) & (state >= 0)
        since = self._shift if self.since == "shift" else self._last
        lasted = self.clock - self._shift[seen]
        measured = np.where(shifted, self.clock - since[seen], lasted)
        use = shifted | ((state == known) & (known >= 0) & (lasted > self.period[seen]))
        cells = seen[use]
        self.period[cells], self._variance[cells] = updated_period(
            self.period[cells], self._variance[cells], np.maximum(measured[use], self.seconds), self.process, self.noise
        )
        self._shift[seen[shifted | first]] = self.clock
        self._state[seen] = np.where(state >= 0, state, known)
        self._odds[seen], self._last[seen] = np.clip(odds, -most, most), self.clock
        self._rates()
        self.p = probability(self._odds * np.exp(-self.rate * (self.clock - self._last)))

    def chi_square(self) -> Floats:
        """None is counted: zero."""
        return np.zeros(len(self.p))

    def closes(self, threshold: float) -> Floats:
        """Limits below the threshold of free, beyond which a cell is not even classified so, are never more than that one."""
        free = unknown_at(self._odds, self.rate, self._last, min(threshold, self.free)) - self.clock
        return np.where(self._odds < 0, np.where(np.isnan(free), np.inf, free), -np.inf)


def cell_worth(map_: Any, utility: str, weight: float) -> Floats:
    """Worth of a reading of each cell: bits of information, and ``weight`` times the misfit a second of the window; (4.6) and (5.2).

    ``chi-square`` is the misfit alone, the limit of large weights.
    """
    if utility == "chi-square":
        return np.asarray(map_.chi_square())
    joint = map_.sensor.joint(map_.p)
    worth = csqmi(joint) if utility == "csqmi" else mutual_information(joint)
    return np.asarray(worth + weight * map_.chi_square())
