"""A robot of the local algorithm: it knows its own actions and what its neighbours sent, and nothing else.

All robots run the same programme in step; ``messages`` carries what they say. Every sum runs over actions in ascending order of
robots, as in the version over arrays, so that the two agree.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .....instances.errors import UsageError
from .cleaning import Floats
from .records import DEEPEST
from .search import MARGIN, SLACK, LevelGrid

Outbox = dict[int, Any]
Inbox = Mapping[int, Any]
Heard = dict[tuple[int, int], Any]
Request = tuple[float, ...]

MOST_LEVELS = 100_000
"""Levels of one family that robots test at once."""


# -- which levels are tested -------------------------------------------------------------------------------------------


class Tested(NamedTuple):
    """The recursion of one red copy at ascending levels: the level that limits its tree, the number of the first level, and the values."""

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
        """The number of the first level of each family, and its levels, ascending."""

    @abstractmethod
    def names(self, request: Request) -> Request:
        """Names of the families, in their order."""

    @abstractmethod
    def crossing(self, reds: Floats, levels: Floats, cap: float) -> tuple[float, Floats]:
        """The last level at which a red copy is not negative, infinite where it never is; and the copy, cut at ``DEEPEST``."""

    @abstractmethod
    def settle(self, ceiling: float, tested: Mapping[float, Tested]) -> float:
        """The level of a root."""

    def message(self, tested: Mapping[float, Tested]) -> tuple[tuple[float, int, tuple[float, ...]], ...]:
        """The message on one action: for each family, in the order of the request, all numbers of ``Tested``."""
        return tuple((t.least, t.first, tuple(t.reds.tolist())) for t in tested.values())

    def read(self, request: Request, said: tuple[tuple[float, int, tuple[float, ...]], ...]) -> dict[float, Tested]:
        """Inverse of ``message``, for a sender that was asked ``request``."""
        return {f: Tested(least, first, np.array(reds)) for f, (least, first, reds) in zip(self.names(request), said, strict=True)}


class CommonLevels(Levels):
    """Levels of a ``LevelGrid``, the same for everybody: a request is the least and the largest j."""

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

    def settle(self, ceiling: float, tested: Mapping[float, Tested]) -> float:
        return tested[0.0].least


class SteppedLevels(Levels):
    """Levels U, U - step, U - 2 step, ... down to U/2, for the ceiling U of each tree: a request is the ceilings."""

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

    def settle(self, ceiling: float, tested: Mapping[float, Tested]) -> float:
        return max(min(tested[ceiling].least, ceiling), ceiling / 2)


def _refuse(number: float, option: str, value: float) -> None:
    if number > MOST_LEVELS:
        message = f"messages=true tests all levels at once, {number:.3g} of them with {option}={value:g}; the limit is {MOST_LEVELS}"
        raise UsageError(message, "too-large")


# -- robots -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Orders:
    """The orders that all robots have beforehand; see ``local_shares``."""

    h: int
    levels: Levels
    smoothing: str
    normalise: bool


class Robot:
    """One robot, which knows the weights of the targets that each of its actions sees. The order of names is the order of sums."""

    def __init__(self, name: int, actions: Sequence[Mapping[int, float]], orders: Orders) -> None:
        self.name, self._orders = name, orders
        self._sees = [dict(a) for a in actions]
        self._cap = 2.0 / len(self._sees)
        self._own = range(len(self._sees))
        self.levels: list[float] = []

    def programme(self) -> Generator[Outbox, Inbox, list[float]]:
        """Its part of all rounds: yields messages by target first, then by neighbour; returns the shares of its actions."""
        targets = sorted({k for sees in self._sees for k in sees})
        inbox = yield {k: (self._cap, tuple((v, self._sees[v][k]) for v in self._own if k in self._sees[v])) for k in targets}
        self._meet(targets, inbox)
        ceilings = yield from self._minima(self._capacities(), self._capacities())
        reach = yield from self._requests(ceilings[-1])
        self.levels = yield from self._test(reach, ceilings[-1])
        used = [level * (1.0 - MARGIN) for level in self.levels]
        if self._orders.smoothing == "layers":
            smooth = yield from self._minima(used)
        else:
            smooth = yield from self._ball(used)
        return (yield from self._solve(smooth))

    # -- getting to know the neighbours ------------------------------------------------------------------------------

    def _meet(self, targets: list[int], inbox: Inbox) -> None:
        """Note the viewers of each target, as (robot, action, weight, cap) in order, from what they said; targets that only one action
        sees apart."""
        self._viewers: dict[int, list[tuple[int, int, float, float]]] = {}
        self._private = [0.0 for _ in self._own]
        known: dict[int, set[int]] = {}
        shown: dict[int, set[int]] = {}
        for k in targets:
            said = {**inbox[k], self.name: (self._cap, tuple((v, self._sees[v][k]) for v in self._own if k in self._sees[v]))}
            viewers = [(j, v, weight, said[j][0]) for j in sorted(said) for v, weight in said[j][1]]
            if len(viewers) == 1:
                _, v, weight, _ = viewers[0]
                self._private[v] = min(weight, self._private[v] or math.inf)
                continue
            self._viewers[k] = viewers
            for j in inbox[k]:
                known.setdefault(j, set()).update(v for v, _ in said[j][1])
                shown.setdefault(j, set()).update(v for v, _ in said[self.name][1])
        self._edges = [[(k, self._sees[v][k]) for k in sorted(self._sees[v]) if k in self._viewers] for v in self._own]
        self._known = {j: sorted(known[j]) for j in sorted(known)}
        self._shown = {j: sorted(shown[j]) for j in sorted(shown)}

    def _tell(self, content: Callable[[int], Any]) -> Generator[Outbox, Inbox, Heard]:
        """One round: ``content(v)`` of each own action goes to the neighbours that share a target of v, and theirs come back."""
        inbox = yield {j: tuple(content(v) for v in actions) for j, actions in self._shown.items()}
        heard = {(j, v): said for j, message in inbox.items() for v, said in zip(self._known[j], message, strict=True)}
        return heard | {(self.name, v): content(v) for v in self._own}

    def _of_others(self, values: Sequence[Any], v: int, choose: Callable[..., Any]) -> Any:
        """``choose`` among the values of all own actions but v, of v itself where it is the only one."""
        return choose(values[w] for w in self._own if w != v) if len(self._own) > 1 else values[v]

    def _least_heard(self, heard: Heard, v: int) -> float:
        """The least value, over the targets of v, that came from other actions; its own where nobody else sees a target."""
        others = [heard[j, w] for k, _ in self._edges[v] for j, w, _, _ in self._viewers[k] if (j, w) != (self.name, v)]
        return float(min([*others, heard[self.name, v]] if self._private[v] else others))

    # -- minima over trees -------------------------------------------------------------------------------------------

    def _capacities(self) -> list[float]:
        """Per action the least value that one of its targets has with all viewers at their caps."""
        full = {k: _total(weight * cap for _, _, weight, cap in viewers) for k, viewers in self._viewers.items()}
        alone = [self._private[v] * self._cap if self._private[v] else math.inf for v in self._own]
        return [min([full[k] for k, _ in self._edges[v]] + [alone[v]]) for v in self._own]

    def _minima(self, start: list[float], floor: list[float] | None = None) -> Generator[Outbox, Inbox, list[list[float]]]:
        """Per layer and action the least ``start`` over the roots above its blue copy, in h - 1 rounds."""
        layers, values = [], list(start)
        while True:
            layers.append([self._of_others(values, v, min) for v in self._own])
            if len(layers) == self._orders.h:
                return layers
            heard = yield from self._tell(layers[-1].__getitem__)
            values = [self._least_heard(heard, v) for v in self._own]
            if floor is not None:
                values = [min(pair) for pair in zip(values, floor, strict=True)]

    def _ball(self, start: list[float]) -> Generator[Outbox, Inbox, list[list[float]]]:
        """The least ``start`` within h - 1 hops, the same on all layers."""
        lowest = min(start)
        for _ in range(self._orders.h - 1):
            heard = yield dict.fromkeys(self._shown, (lowest,))
            lowest = min([lowest, *(value for (value,) in heard.values())])
        return [[lowest for _ in self._own]] * self._orders.h

    # -- the search --------------------------------------------------------------------------------------------------

    def _requests(self, ceilings: list[float]) -> Generator[Outbox, Inbox, list[Request]]:
        """Entry d: the levels that the roots within d hops want tested, in h - 1 rounds."""
        reach = [self._orders.levels.wanted(ceilings)]
        while len(reach) < self._orders.h:
            inbox = yield dict.fromkeys(self._shown, reach[-1])
            reach.append(self._orders.levels.join([reach[-1], *inbox.values()]))
        return reach

    def _test(self, reach: list[Request], ceilings: list[float]) -> Generator[Outbox, Inbox, list[float]]:
        """The recursion at all levels that are wanted, one depth a round; returns the level of each own root."""
        h, choice = self._orders.h, self._orders.levels
        heard: dict[tuple[int, int], dict[float, Tested]] = {}
        for depth in range(1, h + 1):
            request = reach[h - depth]
            found: list[dict[float, Tested]] = [{} for _ in self._own]
            for family, (first, levels) in choice.families(request).items():
                reds = {}
                for who, cap in self._everyone():
                    if depth == 1:
                        reds[who] = np.full(len(levels), cap)
                    else:  # others had to test more levels: all that robots one hop further on want
                        skip = first - heard[who][family].first
                        reds[who] = heard[who][family].reds[skip : skip + len(levels)]
                leasts = {who: tested[family].least for who, tested in heard.items() if family in tested}
                below = [self._least_heard(leasts, v) if depth > 1 else math.inf for v in self._own]
                blues = self._blues(levels, reds)
                for v in self._own:
                    limit, red = choice.crossing(self._cap - self._of_others(blues, v, _largest), levels, self._cap)
                    found[v][family] = Tested(min(self._of_others(below, v, min), limit), first, red)
            if depth < h:
                said = [choice.message(tested) for tested in found]
                inbox = yield {j: (request, tuple(said[v] for v in actions)) for j, actions in self._shown.items()}
                heard = {(self.name, v): found[v] for v in self._own}
                for j, (asked, answers) in inbox.items():
                    heard |= {(j, v): choice.read(asked, answer) for v, answer in zip(self._known[j], answers, strict=True)}
        return [choice.settle(ceilings[v], found[v]) for v in self._own]

    def _everyone(self) -> list[tuple[tuple[int, int], float]]:
        """Own actions, and those that share a target with one, with their caps."""
        caps = {(j, v): cap for viewers in self._viewers.values() for j, v, _, cap in viewers}
        return list((caps | {(self.name, v): self._cap for v in self._own}).items())

    def _blues(self, levels: Floats, reds: Mapping[tuple[int, int], Floats]) -> list[Floats]:
        """B(v, d) of the own actions from R(., d - 1) of all viewers of their targets, at several levels."""
        room = {}
        for k, viewers in self._viewers.items():
            room[k] = levels
            for j, w, weight, _ in viewers:
                room[k] = room[k] - weight * reds[j, w]
        blues = []
        for v in self._own:
            red, blue = reds[self.name, v], np.zeros(len(levels))
            if self._edges[v]:
                most = np.max([room[k] * (1.0 / weight) for k, weight in self._edges[v]], axis=0)
                blue = np.maximum(blue, most + red)
            if self._private[v]:
                blue = np.maximum(blue, levels * (2.0 / self._private[v]) - red)
            blues.append(blue)
        return blues

    # -- the solution ------------------------------------------------------------------------------------------------

    def _solve(self, smooth: list[list[float]]) -> Generator[Outbox, Inbox, list[float]]:
        """The recursion with the smoothed levels, from the lowest layer up, in h - 1 rounds; then the average of all copies."""
        h = self._orders.h
        heard: Heard = dict(self._everyone())
        total = [self._cap for _ in self._own]
        for layer in range(h - 1, -1, -1):
            levels = smooth[layer]
            sums = {k: _total(weight * heard[j, w] for j, w, weight, _ in viewers) for k, viewers in self._viewers.items()}
            blues = []
            for v in self._own:
                red = heard[self.name, v]
                most = max([(levels[v] - sums[k]) * (1.0 / weight) for k, weight in self._edges[v]], default=-math.inf)
                value = most + red
                if self._private[v]:
                    value = max(value, levels[v] * (2.0 / self._private[v]) - red)
                blues.append(max(0.0, value))
            reds = [self._cap - self._of_others(blues, v, max) for v in self._own]
            total = [total[v] + (reds[v] + blues[v]) for v in self._own]
            if layer > 0:
                heard = yield from self._tell(reds.__getitem__)
        shares = [value / (2.0 * (h + 1)) for value in total]
        load = _total(shares)
        return [x / load for x in shares] if self._orders.normalise or load > 1.0 else shares


def _largest(values: Iterable[Floats]) -> Floats:
    return np.asarray(np.max(list(values), axis=0), dtype=np.float64)


def _total(values: Iterable[float]) -> float:
    """The plain sum from left to right: ``sum`` compensates rounding on some versions of Python, and compiled loops do not."""
    total = 0.0
    for value in values:
        total += value
    return total
