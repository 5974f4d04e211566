"""Which levels a robot is asked to test, and what it says of them: for the version of the local algorithm that sends messages."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from .....instances.errors import UsageError
from .cleaning import Floats
from .level_grid import LevelGrid
from .search import DEEPEST, SLACK

Request = tuple[float, ...]

MOST_LEVELS = 100_000
"""Levels of one family that robots test at once."""


class Tested(NamedTuple):
    """The recursion of one red copy at ascending levels: what limits its tree, the number of the first level, and the values."""

    least: float
    first: int
    reds: Floats


class Levels(ABC):
    """A search: requests are tuples of numbers, and stand for families of levels."""

    @abstractmethod
    def wanted(self, ceilings: list[float]) -> Request:
        """The request of roots with these ceilings."""

    @abstractmethod
    def join(self, requests: Iterable[Request]) -> Request:
        """One request for all of ``requests``."""

    @abstractmethod
    def families(self, request: Request) -> dict[float, tuple[int, Floats]]:
        """Of each family the number of its first level and its levels, ascending."""

    @abstractmethod
    def names(self, request: Request) -> Request:
        """Names of the families, in their order."""

    @abstractmethod
    def crossing(self, reds: Floats, levels: Floats, cap: float) -> tuple[float, Floats]:
        """The last level at which a red copy is not negative, infinite where it never is; and the copy, cut at ``DEEPEST``."""

    @abstractmethod
    def settle(self, ceiling: float, found: Mapping[float, Tested]) -> float:
        """The level of a root."""

    def message(self, found: Mapping[float, Tested]) -> tuple[tuple[float, int, tuple[float, ...]], ...]:
        """What is said of one action: for each family, in the order of the request, all numbers of ``Tested``."""
        return tuple((t.least, t.first, tuple(t.reds.tolist())) for t in found.values())

    def read(self, request: Request, said: tuple[tuple[float, int, tuple[float, ...]], ...]) -> dict[float, Tested]:
        """Inverse of ``message``, for a sender that was asked ``request``."""
        return {f: Tested(least, first, np.array(reds)) for f, (least, first, reds) in zip(self.names(request), said, strict=True)}


class CommonLevels(Levels):
    """Levels of a ``LevelGrid``, the same for everybody: a request is the least and the largest j.

    Parameters
    ----------
    eps : float
    """

    def __init__(self, eps: float) -> None:
        self._eps, self._grid = eps, LevelGrid(eps)

    def wanted(self, ceilings: list[float]) -> Request:
        low, high = (self._grid.number(c) for c in (min(ceilings) / 2, max(ceilings)))
        return (math.floor(low) - 1, math.ceil(high) + 1)

    def join(self, requests: Iterable[Request]) -> Request:
        lows, highs = zip(*requests, strict=True)
        return (min(lows), max(highs))

    def families(self, request: Request) -> dict[float, tuple[int, Floats]]:
        low, high = (int(j) for j in request)
        _refuse(high - low, "eps", self._eps)
        return {0.0: (low, np.array([self._grid.level(j) for j in range(low, high + 1)]))}

    def names(self, request: Request) -> Request:
        return (0.0,)

    def crossing(self, reds: Floats, levels: Floats, cap: float) -> tuple[float, Floats]:
        valid, cut = np.nonzero(reds >= 0.0)[0], np.maximum(reds, -DEEPEST * cap)
        if not len(valid):
            return float(levels[0]), cut
        j = int(valid[-1])
        if j + 1 == len(levels):
            return math.inf, cut
        if reds[j + 1] < cut[j + 1]:
            return float(levels[j]), cut
        return float(levels[j] + (levels[j + 1] - levels[j]) * (reds[j] / (reds[j] - reds[j + 1]))), cut

    def settle(self, ceiling: float, found: Mapping[float, Tested]) -> float:
        return found[0.0].least


class SteppedLevels(Levels):
    """Levels U, U - step, U - 2 step, ... down to U/2, for the ceiling U of each tree: a request is the ceilings.

    Parameters
    ----------
    step : float
    """

    def __init__(self, step: float) -> None:
        self._step = step

    def wanted(self, ceilings: list[float]) -> Request:
        return tuple(sorted(set(ceilings)))

    def join(self, requests: Iterable[Request]) -> Request:
        return tuple(sorted({ceiling for request in requests for ceiling in request}))

    def families(self, request: Request) -> dict[float, tuple[int, Floats]]:
        families: dict[float, tuple[int, Floats]] = {}
        for ceiling in request:
            _refuse(ceiling / (2 * self._step), "step", self._step)
            steps = np.arange(math.ceil(ceiling / (2 * self._step)) + 1, -1, -1, dtype=np.float64)
            families[ceiling] = (0, ceiling - steps * self._step)
        return families

    def names(self, request: Request) -> Request:
        return request

    def crossing(self, reds: Floats, levels: Floats, cap: float) -> tuple[float, Floats]:
        valid, cut = np.nonzero(reds >= -SLACK * cap)[0], np.maximum(reds, -DEEPEST * cap)
        if not len(valid):
            return float(levels[0]), cut
        return math.inf if valid[-1] + 1 == len(levels) else float(levels[valid[-1]]), cut

    def settle(self, ceiling: float, found: Mapping[float, Tested]) -> float:
        return max(min(found[ceiling].least, ceiling), ceiling / 2)


def _refuse(number: float, option: str, value: float) -> None:
    if number > MOST_LEVELS:
        message = f"messages=true tests all levels at once, {number:.3g} of them with {option}={value:g}; the limit is {MOST_LEVELS}"
        raise UsageError(message)
