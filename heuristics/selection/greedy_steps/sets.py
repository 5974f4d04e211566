"""A set that grows, whatever the function: its value, and the gains of elements over it."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ....formulations.selection.submodular_selection import SubmodularSelection, UserFunction
from ....formulations.stop import NEVER, Stop
from ....solvers.bounds.selection.marginal_gains import user_gains

Floats = NDArray[np.float64]
Elements = NDArray[np.int64]


class GrowingSet(ABC):
    """The set chosen so far.

    Attributes
    ----------
    value : float
        f of the set, summed up from the gains.
    evaluations : int
        Gains evaluated so far.
    """

    def __init__(self) -> None:
        self.value = 0.0
        self.evaluations = 0

    @abstractmethod
    def gains(self, elements: Elements, stop: Stop = NEVER) -> Floats:
        """What each of ``elements`` would add; 0 for those that were not asked for before it had to end."""

    @abstractmethod
    def take(self, element: int, gain: float) -> None:
        """Add ``element``, whose gain is known."""

    def best_of(self, elements: Elements, stop: Stop = NEVER) -> tuple[int, float]:
        """The element of largest gain, the smallest index among equal ones, and the gain; ``elements`` ascend; -1 once it has to end."""
        found = self.gains(elements, stop)
        if stop.reached():
            return -1, 0.0
        at = int(np.argmax(found))
        return int(elements[at]), float(found[at])


class ArraySet(GrowingSet):
    """For functions given by arrays."""

    def __init__(self, problem: SubmodularSelection) -> None:
        super().__init__()
        from ....solvers.bounds.selection._gains import as_arrays

        self.arrays = as_arrays(problem.function)  # type: ignore[arg-type]
        self.best = np.zeros(problem.function.num_items)  # type: ignore[union-attr]

    def gains(self, elements: Elements, stop: Stop = NEVER) -> Floats:
        from ....solvers.bounds.selection._gains import gains_of

        self.evaluations += len(elements)
        found: Floats = gains_of(stop.flag, elements, self.best, *self.arrays)
        return found

    def take(self, element: int, gain: float) -> None:
        from ....solvers.bounds.selection._gains import take

        take(element, self.best, *self.arrays)
        self.value += gain


class UserSet(GrowingSet):
    """For a user's function: many sets a call."""

    def __init__(self, function: UserFunction) -> None:
        super().__init__()
        self.function = function
        self.inside = np.zeros(function.num_elements, dtype=bool)

    def gains(self, elements: Elements, stop: Stop = NEVER) -> Floats:
        self.evaluations += len(elements)
        return user_gains(self.function, self.inside, self.value, elements, stop)

    def take(self, element: int, gain: float) -> None:
        self.inside[element] = True
        self.value += gain


def empty_set(problem: SubmodularSelection) -> GrowingSet:
    """The empty set of a problem."""
    return UserSet(problem.function) if isinstance(problem.function, UserFunction) else ArraySet(problem)
