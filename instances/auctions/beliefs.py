"""Beliefs about rooms, one distribution of a room's type and of whether it holds a target, and the worth of what robots do there."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InputError

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

TARGET, EMPTY = 0, 1
"""Columns of a room's belief."""


def probabilities(what: str, table: ArrayLike, states: int) -> Floats:
    """A square table of so many states, one row a true state, as an array; InputError if a row is no distribution."""
    try:
        rows = np.asarray(table, dtype=np.float64)
    except ValueError:
        rows = np.zeros(0)
    if rows.shape != (states, states):
        raise InputError(f"{what} must be a table of {states} rows, the true states, of {states} numbers", "wrong-shape")
    wrong = ~(rows >= 0).all(axis=1) | ~(np.abs(rows.sum(axis=1) - 1) <= 1e-9)
    if wrong.any():
        row = int(wrong.argmax())
        told = f"row {row + 1} is {' '.join(f'{p:g}' for p in rows[row])}, of sum {rows[row].sum():g}"
        raise InputError(f"{what}: each row, a true state, must be probabilities that sum to 1", "out-of-range", found=told)
    return rows


def sensors_from_text(types: str, targets: str) -> "Sensors":
    """Sensors from two tables as text, rows apart by ``;``: of readings of types, and of a target and none; InputError if one is none."""
    read = []
    for what, text, states in (("type-sensor", types, 3), ("target-sensor", targets, 2)):
        try:
            rows = [[float(number) for number in row.replace(",", " ").split()] for row in text.split(";")]
        except ValueError:
            raise InputError(f"{what} must be numbers, rows apart by ;", found=text[:60]) from None
        read.append(probabilities(what, rows, states))
    return Sensors(read[0], float(read[1][0, 0]), float(read[1][1, 0]))


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
        object.__setattr__(self, "types", probabilities("readings of types", self.types, len(np.atleast_1d(self.types))))
        if not (0 <= self.detection <= 1 and 0 <= self.false_alarm <= 1):
            raise InputError(
                "detection and false alarm must be probabilities", "out-of-range", found=f"{self.detection}, {self.false_alarm}"
            )

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
    total = belief.sum(axis=(-2, -1), keepdims=True)
    if not (total > 0).all():
        raise InputError("a reading that the belief holds impossible", "contradiction")
    return np.asarray(belief / total)


def posterior(belief: Floats, sensors: Sensors, types: ArrayLike, targets: ArrayLike, *, joint: bool = True) -> Floats:
    """Beliefs after many readings, in any order; shape (..., types, 2).

    ``types`` and ``targets`` count readings of each kind, shapes (..., types) and (..., 2). Without ``joint`` the marginals of type and
    target are updated one by the other, as (5.1) and (5.2) of Zhang (2015) have it: each reading by its probabilities given the one, the
    other as it was at first. That counts repeated readings twice.
    """
    with np.errstate(divide="ignore"):  # what cannot be read
        of_types, of_targets = _times(types, np.log(sensors.types)), _times(targets, np.log(sensors.targets))
        if joint:
            log = of_types[..., :, None] + of_targets[..., None, :]
            return _normalised(belief * np.exp(log - np.maximum(log.max(axis=(-2, -1), keepdims=True), -1e300)))
        type_, target = belief.sum(axis=1), belief.sum(axis=0)
        of_types = of_types + _times(targets, np.log((belief / type_[:, None]) @ sensors.targets))
        of_targets = of_targets + _times(types, np.log((belief / target).T @ sensors.types))
    parts = [p * np.exp(log - np.maximum(log.max(axis=-1, keepdims=True), -1e300)) for p, log in ((type_, of_types), (target, of_targets))]
    return _normalised(parts[0][..., :, None] * parts[1][..., None, :])


def _times(counts: ArrayLike, logs: Floats) -> Floats:
    """Sum over readings of their number times their logarithm, one a state; 0 times minus infinity is 0."""
    numbers = np.asarray(counts, dtype=np.float64)[..., None, :]
    return np.asarray(np.where(numbers > 0, numbers * np.where(numbers > 0, logs, 0.0), 0.0).sum(axis=-1))


def entropy(distribution: ArrayLike) -> Floats:
    """Entropy of distributions along the last axis, in nats."""
    p = np.asarray(distribution, dtype=np.float64)
    return np.asarray(-(p * np.log(np.where(p > 0, p, 1.0))).sum(axis=-1))


def mutual_information(states: ArrayLike, readings: ArrayLike) -> Floats:
    """Expected fall of the entropy of a state by one reading, in nats, at least 0; shape (...) of ``states``, shape (..., states).

    ``readings`` has one row per state.
    """
    p, table = np.asarray(states, dtype=np.float64), np.asarray(readings, dtype=np.float64)
    return np.maximum(entropy(p @ table) - p @ entropy(table), 0.0)


def expected_gains(states: ArrayLike, readings: ArrayLike, times: int) -> Floats:
    """Information that each further reading of a state brings, in nats: mutual information with that many less that with one fewer.

    ``states`` has shape (..., states), and ``readings``, the probability of each reading in each state, shape (states, readings). The
    gains, shape (..., times), do not increase (Cover and Thomas 2006, theorem 2.8.1, for readings that are independent given the state).
    """
    once = several = np.asarray(readings, dtype=np.float64)
    information = [np.zeros(np.shape(states)[:-1])]
    for _ in range(times):
        information.append(mutual_information(states, several))
        several = (several[:, :, None] * once[:, None, :]).reshape(len(once), -1)
    return np.minimum.accumulate(np.maximum(np.diff(np.stack(information, axis=-1), axis=-1), 0.0), axis=-1)


def capacity(readings: ArrayLike, rounds: int = 200) -> float:
    """No less than the information of a reading in nats, whatever is believed of the state (Blahut 1972, by his upper bound)."""
    table = np.asarray(readings, dtype=np.float64)
    p = np.full(len(table), 1.0 / len(table))
    for _ in range(rounds):
        apart = np.asarray([-entropy(row) for row in table]) - np.log(np.maximum(p @ table, 1e-300)) @ table.T
        p = p * np.exp(apart)
        p /= p.sum()
    return float((-entropy(table) - np.log(np.maximum(p @ table, 1e-300)) @ table.T).max())


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
        if len(self.weights) != 3 or not min(self.weights) >= 0 or not abs(sum(self.weights) - 1) <= 1e-9:
            raise InputError(
                "weights of exploring, mapping and searching must not be negative, and sum to 1", "out-of-range", found=str(self.weights)
            )
        if not 0 < self.decay < 1 or not 0 <= self.first < np.inf or self.gain not in ("mutual-information", "entropy"):
            raise InputError(
                "first must be finite and at least 0, decay between 0 and 1, gain mutual-information or entropy", "out-of-range"
            )

    def explore(self, visits: Any) -> Any:
        """Worth of entering a room that was visited so many times; for arrays as for numbers."""
        return self.weights[0] * self.visit(visits)

    def map(self, belief: Floats, sensors: Sensors) -> Floats:
        """Worth of reading the type of each room, shape (...) of beliefs of shape (..., types, 2)."""
        return np.asarray(self.weights[1] * self.reading(belief.sum(axis=-1), sensors.types))

    def search(self, belief: Floats, sensors: Sensors) -> Floats:
        """Worth of looking for a target in each room."""
        return np.asarray(self.weights[2] * self.reading(belief.sum(axis=-2), sensors.targets))

    def visit(self, visits: Any) -> Any:
        """Gain of one more visit, before it is weighted."""
        return self.first * self.decay**visits

    def reading(self, states: Floats, readings: Floats) -> Floats:
        """Gain of a reading, before it is weighted, from beliefs about states and the sensor's table."""
        return entropy(states) if self.gain == "entropy" else mutual_information(states, readings)

    def tables(self, beliefs: Floats, visits: Integers, sensors: Sensors, times: int) -> list[Floats]:
        """Expected gains of the next visits, readings of the type and searches of each room; each of shape (rooms, times).

        With ``gain="entropy"``, what is expected to be unknown still.
        """
        tables = [self.explore(visits[:, None] + np.arange(times))]
        for kind, states, readings in ((1, beliefs.sum(axis=2), sensors.types), (2, beliefs.sum(axis=1), sensors.targets)):
            gains = expected_gains(states, readings, times)
            if self.gain == "entropy":
                gains = np.maximum(entropy(states)[:, None] - np.cumsum(gains, axis=1) + gains, 0.0)
            tables.append(self.weights[kind] * gains)
        return tables
