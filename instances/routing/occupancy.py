"""Cells of a map that are free or occupied, and change: how beliefs decay and are updated, and what a view of some cells is worth.

Source: Mitchell (2020), chapters 3 to 6; what was repaired: docs/missions/persistent-exploration.md#errata.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError
from ..generators import Flags, Floats, Integers

SIDES = ((0, 1), (1, 0), (0, -1), (-1, 0))
"""Row and column of the four neighbours, in the order in which ways prefer them."""

RAREST = 1e-12
"""Least probability in a logarithm, and least expected count in a quotient."""


@dataclass(frozen=True)
class RangeSensor:
    """Probabilities of a hit on an occupied and on a free cell; the former must be the larger one."""

    hit: float = 0.9
    false_hit: float = 0.05

    def __post_init__(self) -> None:
        if not 0.0 < self.false_hit < self.hit < 1.0:
            message = "a sensor's hits must be more probable on occupied than on free cells, and neither certain nor impossible"
            raise InputError(message, "out-of-range", expected="0 < false hit < hit < 1", found=f"{self.false_hit:g} and {self.hit:g}")

    def likelihood(self, hits: Flags) -> Floats:
        """Probability of each reading if its cell is free (row 0) and occupied (row 1)."""
        own = np.array([self.false_hit, self.hit])[:, None]
        return np.where(hits, own, 1.0 - own)

    def joint(self, p: ArrayLike) -> Floats:
        """Joint probabilities of state and reading, shape (2, 2, cells), of cells occupied with probability ``p``."""
        prior = np.atleast_1d(np.asarray(p, dtype=np.float64))
        readings = np.array([[1.0 - self.false_hit, self.false_hit], [1.0 - self.hit, self.hit]])
        return np.asarray(np.stack([1.0 - prior, prior])[:, None] * readings[..., None])


# -- confidence that decays: chapter 3 ------------------------------------------------------------------------------------


def logit(p: ArrayLike) -> Floats:
    """Log-odds of probabilities."""
    p = np.asarray(p, dtype=np.float64)
    return np.asarray(np.log(p / (1.0 - p)), dtype=np.float64)


def probability(log_odds: ArrayLike) -> Floats:
    """Inverse of ``logit``."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.asarray(log_odds, dtype=np.float64))), dtype=np.float64)


def decay_rate(period: ArrayLike, surest: float, threshold: float) -> Floats:
    """Rate, 1/s, at which log-odds shrink from those of ``surest`` to those of ``threshold`` within ``period`` seconds: (3.4) of log-odds.

    Raises InputError where they would grow.
    """
    ratio = float(logit(surest) / logit(threshold)) if 0 < surest < 1 and 0 < threshold < 1 and threshold != 0.5 else math.nan
    if not ratio >= 1.0 or not (np.asarray(period) > 0).all():
        message = "confidence would grow with time: the surest probability must lie beyond the threshold, and periods be positive"
        raise InputError(message, "out-of-range", expected="a decay that is not negative", found=f"from {surest:g} to {threshold:g}")
    return np.asarray(math.log(ratio) / np.asarray(period, dtype=np.float64))


def unknown_at(log_odds: ArrayLike, rate: ArrayLike, last: ArrayLike, threshold: float) -> Floats:
    """Moment at which log-odds of the moment ``last`` have shrunk to those of ``threshold``: (3.15). Without decay never."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.asarray(log_odds, dtype=np.float64) / logit(threshold)
        moment = np.asarray(last) + np.log(np.maximum(ratio, RAREST)) / np.asarray(rate)
    return np.asarray(np.where(ratio <= 1.0, -np.inf, moment), dtype=np.float64)


def updated_period(period: Any, variance: Any, measured: Any, process: float, noise: float) -> tuple[Any, Any]:
    """Period of change and its variance after a measurement, by a scalar Kalman filter."""
    predicted = variance + process
    gain = predicted / (noise + predicted)
    return period + gain * (measured - period), (1.0 - gain) * predicted


# -- two states with rates: chapter 4 ---------------------------------------------------------------------------------------


def predicted(p: Any, to_occupied: Any, to_free: Any) -> Any:
    """Probability of occupied a step later, (4.5)."""
    return to_occupied * (1.0 - p) + (1.0 - to_free) * p


def corrected(p: Any, likelihood: Any) -> Any:
    """Probability of occupied after a reading of these likelihoods if free and if occupied, (4.4)."""
    return likelihood[1] * p / (likelihood[1] * p + likelihood[0] * (1.0 - p))


def stationary(to_occupied: Any, to_free: Any) -> Any:
    """Probability of occupied after many steps without a reading."""
    return to_occupied / (to_occupied + to_free)


def online_em(q: Floats, flows: Floats, rates: Floats, likelihood: Floats, forgetting: float) -> tuple[Floats, Floats, Floats]:
    """A step of online expectation maximisation of a two-state hidden Markov model in each cell.

    ``q`` are probabilities of the states, shape (2, cells); ``flows[i, j, h]`` expected transitions from i to j, jointly with the state h
    now; ``rates[i, j]`` probabilities of j after i; ``likelihood`` that of the reading in each state, equal numbers where there was none.
    Source: Mongillo and Deneve (2008), which the thesis cites.
    """
    step = rates * likelihood[None]
    step = step / (q[:, None] * step).sum(axis=(0, 1))  # l, h
    kept = np.einsum("ijlc,lhc->ijhc", (1.0 - forgetting) * flows, step)
    now = q[:, None] * step
    for j in range(2):
        kept[:, j, j] += forgetting * now[:, j]
    total = kept.sum(axis=2)
    return now.sum(axis=0), kept, total / np.maximum(total.sum(axis=1, keepdims=True), RAREST)


def chi_square(counts: Floats, occupied: Floats, to_occupied: Floats, to_free: Floats, window: float) -> Floats:
    """How badly counts of transitions in a window of as many steps fit the rates: sum over both states twice of (n - e)^2 / e.

    ``counts`` are those of free to free, to occupied, occupied to free, to occupied, shape (4, cells); ``occupied`` is the probability of
    occupied that goes with the rates, the stationary one. Source: the utilities (4.6) and (5.2).
    """
    free = 1.0 - occupied
    expected = np.array([free * (1 - to_occupied), free * to_occupied, occupied * to_free, occupied * (1 - to_free)]) * window
    return np.asarray(((counts - expected) ** 2 / np.maximum(expected, RAREST)).sum(axis=0))


# -- worth and measures -------------------------------------------------------------------------------------------------------


def entropy(p: ArrayLike) -> Floats:
    """Entropy of each probability, bits."""
    q = np.clip(np.asarray(p, dtype=np.float64), RAREST, 1.0 - RAREST)
    return np.asarray(-q * np.log2(q) - (1.0 - q) * np.log2(1.0 - q))


def divergence(p: Floats, occupied: Flags) -> Floats:
    """Kullback-Leibler divergence of the truth from each belief, bits."""
    return np.asarray(-np.log2(np.clip(np.where(occupied, p, 1.0 - p), RAREST, 1.0)))


def mutual_information(joint: Floats) -> Floats:
    """Mutual information of state (axis 0) and reading (axis 1), bits; at the further axes one of each cell."""
    apart = joint.sum(axis=1, keepdims=True) * joint.sum(axis=0, keepdims=True)
    return np.asarray((joint * np.log2(np.maximum(joint, RAREST) / np.maximum(apart, RAREST))).sum(axis=(0, 1)))


def csqmi(joint: Floats) -> Floats:
    """Cauchy-Schwarz quadratic mutual information of state and reading, bits; not submodular: docs/selection.md#is-it-submodular."""
    apart = joint.sum(axis=1, keepdims=True) * joint.sum(axis=0, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        cross = (joint * apart).sum(axis=(0, 1)) ** 2
        return np.asarray(np.maximum(-np.log2(cross / ((joint**2).sum(axis=(0, 1)) * (apart**2).sum(axis=(0, 1)))), 0.0))


# -- views and ways -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Beams:
    """Cells that the beams of a sensor pass one after the other, from the middle of a cell: row and column relative to it.

    ``steps`` has shape (beams, cells, 2), ``there`` tells which of them are within reach. The first beam is the cell itself.
    """

    steps: Integers
    there: Flags

    @classmethod
    def of(cls, reach: float, field: float, count: int) -> "Beams":
        """``count`` beams of ``reach`` cells, evenly over ``field`` degrees around east."""
        angles = np.radians((np.arange(count) + 0.5) / count * field - field / 2.0)
        rows: list[NDArray[np.int64]] = [np.zeros((1, 2), dtype=np.int64)]
        for toward in np.column_stack([np.sin(angles), np.cos(angles)]):
            walls = np.arange(math.ceil(reach) + 1) + 0.5
            met = np.concatenate([walls / abs(part) for part in toward if abs(part) > 1e-12])
            met = np.unique(np.append(met[met < reach], reach))
            met = met[np.append(True, np.diff(met) > 1e-9 * reach)]  # a corner is met once
            rows.append(np.rint((met[:-1, None] + met[1:, None]) / 2.0 * toward).astype(np.int64))
        longest = max(map(len, rows))
        steps, there = np.zeros((len(rows), longest, 2), dtype=np.int64), np.zeros((len(rows), longest), dtype=bool)
        for k, cells in enumerate(rows):
            steps[k, : len(cells)], there[k, : len(cells)] = cells, True
        return cls(steps, there)

    def passed(self, blocked: Floats, cells: Integers) -> tuple[Integers, Integers, Floats]:
        """Number of the view, of the cell and visibility of all that the beams meet from ``cells``, shape (views, 2).

        Visibility is the product of ``1 - blocked`` over the cells before, (5.3); with a truth of zeros and ones it tells what is seen.
        """
        shape = np.array(blocked.shape)
        met = cells[:, None, None] + self.steps
        inside = self.there & ((met >= 0) & (met < shape)).all(axis=3)
        numbers = np.where(inside, met[..., 0] * shape[1] + met[..., 1], 0)
        clear = np.where(inside, 1.0 - blocked.ravel()[numbers], 0.0)
        visible = np.ones_like(clear)
        visible[..., 1:] = np.cumprod(clear, axis=2)[..., :-1]
        use = inside & (visible > 0)
        return np.nonzero(use)[0], numbers[use], visible[use]

    def visibility(self, blocked: Floats, cells: Integers) -> Floats:
        """The best visibility of each cell of the map over the beams of each view, shape (views, cells): a row of (5.5) each."""
        best = np.zeros((len(cells), blocked.size))
        view, cell, visible = self.passed(blocked, cells)
        np.maximum.at(best, (view, cell), visible)
        return best


def ways(closes: Floats, starts: ArrayLike, begin: ArrayLike, step: float) -> Integers:
    """Steps of shortest ways from each start to all cells, -1 where there is none: shape (starts, rows, columns).

    A cell may be entered before it closes. All steps to the four sides take as long, so that the cells are settled a distance at a time;
    since cells only close, it never helps to be later. Source: Mitchell (2020), algorithm 2.
    """
    at = np.asarray(starts, dtype=np.int64).reshape(-1, 2)
    begun = np.broadcast_to(np.asarray(begin, dtype=np.float64), len(at))[:, None, None]
    found = np.full((len(at), *closes.shape), -1)
    edge = np.zeros(found.shape, dtype=bool)
    edge[np.arange(len(at)), at[:, 0], at[:, 1]] = True
    found[edge] = distance = 0
    while edge.any():
        distance += 1
        near = np.zeros_like(edge)
        near[:, 1:] |= edge[:, :-1]
        near[:, :-1] |= edge[:, 1:]
        near[:, :, 1:] |= edge[:, :, :-1]
        near[:, :, :-1] |= edge[:, :, 1:]
        edge = near & (found < 0) & (begun + distance * step < closes)
        found[edge] = distance
    return found


def way(steps: Integers, target: tuple[int, int]) -> list[tuple[int, int]]:
    """Cells of a shortest way to ``target``, without the start; ``steps`` are those of one start."""
    cells: list[tuple[int, int]] = []
    row, column = target
    while (left := steps[row, column]) > 0:
        cells.append((row, column))
        row, column = next(
            (r, c) for y, x in SIDES if 0 <= (r := row - y) < steps.shape[0] and 0 <= (c := column - x) < steps.shape[1]
            and steps[r, c] == left - 1
        )  # fmt: skip
    return cells[::-1]


def latest_start(closes: ArrayLike, step: float) -> float:
    """The latest moment to begin a way whose cells close at these moments, one a step."""
    moments = np.asarray(closes, dtype=np.float64)
    return float(np.min(moments - step * np.arange(1, len(moments) + 1), initial=np.inf))
