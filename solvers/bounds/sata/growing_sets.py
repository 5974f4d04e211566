"""A set that grows, whatever the function: its value, and the gains of elements over it."""

from abc import ABC, abstractmethod
from collections.abc import Iterable

import numpy as np

from ....formulations.sata.feasibility import with_each
from ....formulations.stop import NEVER, Stop
from ....formulations.tolerance import LIMIT
from ....instances.number_arrays import Integers as Elements
from ....instances.sata.set_functions import Floats, ItemWeights, SetFunction


def rounding(value: float, gain: float) -> float:
    """Rounding error of a gain that is the difference of ``value`` and another: sums depend on how many sets are valued at once."""
    return LIMIT * (abs(value) + abs(gain))


def first_of_largest(elements: Elements, gains: Floats, value: float) -> tuple[int, float]:
    """The smallest of the ascending ``elements`` whose gain is the largest but for its rounding, and the gain."""
    largest = float(gains.max())
    at = int(np.argmax(gains >= largest - rounding(value, largest)))
    return int(elements[at]), float(gains[at])


class GrowingSet(ABC):
    """The set chosen so far: its value, and how many gains were evaluated."""

    value: float
    evaluations = 0

    @abstractmethod
    def gains(self, elements: Elements, stop: Stop = NEVER) -> Floats:
        """Gain of each of ``elements``; 0 for those that were not asked for before it had to end."""

    @abstractmethod
    def take(self, element: int, gain: float) -> None:
        """Add ``element``, whose gain is known."""

    @abstractmethod
    def add(self, elements: Iterable[int]) -> None:
        """Add elements whose gains are not known."""

    def best_of(self, elements: Elements, stop: Stop = NEVER) -> tuple[int, float]:
        """The element of ``first_of_largest`` and its gain; -1 once it has to end."""
        gains = self.gains(elements, stop)
        if stop.reached():
            return -1, 0.0
        return first_of_largest(elements, gains, self.value)


class WeightedSet(GrowingSet):
    """A set for functions given by the weights of items, compiled."""

    def __init__(self, weights: ItemWeights) -> None:
        from .gain_kernels import gains_of, take

        self.arrays, self.best = weights.arrays, np.zeros(weights.num_items)
        self._gains_of, self._take = gains_of, take

    @property
    def value(self) -> float:  # type: ignore[override]
        return float(self.best.sum())

    def gains(self, elements: Elements, stop: Stop = NEVER) -> Floats:
        self.evaluations += len(elements)
        gains: Floats = self._gains_of(stop.flag, elements, self.best, *self.arrays)
        return gains

    def take(self, element: int, gain: float) -> None:
        self._take(element, self.best, *self.arrays)

    def add(self, elements: Iterable[int]) -> None:
        for element in elements:
            self._take(element, self.best, *self.arrays)


class ValuedSet(GrowingSet):
    """A set for functions known by their values: many sets a call."""

    def __init__(self, function: SetFunction) -> None:
        self.function = function
        self.inside = np.zeros(function.num_elements, dtype=bool)
        self.value = 0.0

    def gains(self, elements: Elements, stop: Stop = NEVER) -> Floats:
        self.evaluations += len(elements)
        gains = np.zeros(len(elements))
        for part, masks in with_each(self.inside, elements):
            if stop.reached():
                break
            gains[part] = self.function.values(masks) - self.value
        gains[self.inside[elements]] = 0.0
        return gains

    def take(self, element: int, gain: float) -> None:
        self.inside[element] = True
        self.value += gain

    def add(self, elements: Iterable[int]) -> None:
        self.inside[list(elements)] = True
        self.value = float(self.function.values(self.inside[None, :])[0])


def empty_set(function: SetFunction) -> GrowingSet:
    """The empty set, to which elements are added."""
    weights = function.as_item_weights()
    return ValuedSet(function) if weights is None else WeightedSet(weights)
