"""The whole game, by two first-order methods and the interior point, whichever gets on fastest; docs/saddle.md#what-the-engine-does."""

from __future__ import annotations

import itertools
import math

import numpy as np

from .....formulations.sata.balls import Floats
from .game import Game, RegretMatching
from .halpern import HalpernPrimalDual
from .interior_point import InteriorPoint
from .refinement import refine

REFINE_SHARE = 0.25
"""Edges that refining an answer may read, as a share of those that its method has read so far."""

FEW, LEAST_FEW = 0.02, 100
"""An answer is refined when at most this share, or this number, of the targets falls short of the value wanted."""

LEVELLED, LEVEL_SHARE, ABOVE = 0.3, 0.05, 0.05
"""An answer of which at most this share of the targets falls short of the value wanted is levelled out first: moved downhill on the squared
deficits for at most this share of the method's work, at a level above that value by this share of its distance to the bound."""

FIRST_STEPS = 32
MORE_STEPS = 0.25
"""Steps of a first-order method between two looks at what it proves: so many, later this share of all its steps so far."""

TRIAL, FIRST_TRIAL = 0.1, 0.3
"""Share of the work that goes to the method that seems the slower, so that it can show that it is not; and that which the first step of the
interior point may take of the work of the other methods."""

HOPELESS = 4.0
"""A method that would take so many times the work of the other is not tried any more, once it had this number of turns."""

ENOUGH_STEPS = 4000
"""Steps of first-order methods that close most gaps; it is their turn where the interior point's own grow so that they would cost more."""

GROWTH, REST = 3.0, 2.0
"""A step of the interior point is given up when it has cost what a first-order method takes to halve the gap, or so many times the one
before; the next is made when the first-order methods have done so many times their work, the square of it after the second time, etc."""

HORIZON = 0.5
"""Gap to which the methods are compared, as a share of the better one so far."""

LOOK_BACK, TURNS = 1.5, 9
"""Rates are taken since a method had done its work so far over this; those of the interior point over so many turns."""


class Pace:
    """What a method has reached after how much work, and what it will take at this rate."""

    def __init__(self) -> None:
        self._seen: list[tuple[float, float]] = []

    @property
    def gap(self) -> float:
        return self._seen[-1][1] if self._seen else math.inf

    @property
    def turns(self) -> int:
        return len(self._seen)

    def note(self, work: float, value: float, bound: float) -> None:
        """A relative gap after ``work``, from its start on."""
        gap = (bound - value) / value if value > 0.0 else math.inf
        self._seen.append((work, gap))

    def left(self, gap: float) -> float:
        """Work until ``gap``, the gap so far falling as a power of the work: 0 while nothing is known, infinite where it stands still."""
        if len(self._seen) < 2:
            return 0.0
        work, reached = self._seen[-1]
        since, before = next(((w, g) for w, g in reversed(self._seen) if w <= work / LOOK_BACK), self._seen[0])
        if reached <= gap:
            return 0.0
        if not (reached < before and 0.0 < since < work):
            return math.inf
        if before == math.inf:
            return 0.0
        power = math.log(before / reached) / math.log(work / since)
        times = math.log(reached / gap) / power
        return work * math.expm1(times) if times < 100.0 else math.inf


class GrowingPace(Pace):
    """That of the interior point, whose steps shrink the gap by much the same factor, and cost more and more."""

    def left(self, gap: float) -> float:
        left = self.projected(gap) if self.turns > 2 else super().left(gap)
        return left if left < math.inf or self.turns >= TURNS else 0.0

    def projected(self, gap: float) -> float:
        """Work until ``gap`` where the turns go on to cost more, and gaps to shrink, by the same factors; 0 while little is known."""
        first = self.turns - TURNS
        while first > 0 and self._seen[first][1] <= self.gap:  # a point that is centred does not get on meanwhile
            first -= 1
        works, gaps = zip(*self._seen[max(first, 0) :], strict=True) if self._seen else ((), ())
        if len(gaps) < 3 or self.gap <= gap or gaps[0] == math.inf:
            return 0.0
        costs = [max(b - a, 1.0) for a, b in itertools.pairwise(works)]
        half = len(costs) // 2
        growth = (math.fsum(costs[-half:]) / math.fsum(costs[:half])) ** (1 / (len(costs) - half))
        shrink = float(gaps[-1] / gaps[0]) ** (1 / len(costs))
        if not shrink < 1.0:
            return math.inf
        turns = math.log(gap / gaps[-1]) / math.log(shrink)
        return float(costs[-1]) * math.fsum(growth ** min(k, 60) for k in range(1, math.ceil(min(turns, 1e4)) + 1))


def play(game: Game) -> tuple[int, int]:
    """Play until the gap is closed or a limit is reached; returns the steps of both first-order methods and of the interior point."""
    record, limits = game.record, game.limits
    methods: tuple[RegretMatching, HalpernPrimalDual] = RegretMatching(game), HalpernPrimalDual(game)
    paces, pointed = (Pace(), Pace()), GrowingPace()
    point: InteriorPoint | None = None
    alone, resting, cost, failures = False, 0.0, 0.0, 0
    while not (record.closed() or limits.reached()):
        steps, work, spent = methods[0].steps + methods[1].steps, methods[0].work + methods[1].work, 0.0 if point is None else point.work
        costly = steps < ENOUGH_STEPS and pointed.left(record.gap) > ENOUGH_STEPS * game.pass_work
        leading = int(_faster(*paces, record.gap))
        if (
            alone
            or costly
            or work < resting
            or min(pace.turns for pace in paces) < 2
            or not _second(paces[leading], pointed, work, spent, record.gap)
        ):
            k = int(_second(*paces, methods[0].work, methods[1].work, record.gap))
            most = math.inf if alone or costly or point is None else max(TRIAL * point.work, 0.5 * methods[k].work)
            more = max(FIRST_STEPS, int(MORE_STEPS * methods[k].steps))
            methods[k].run(max(1, min(more, int(min(most / game.pass_work, 1e9)))))
            if not methods[k].steps:
                break
            shares, cover = methods[k].conclude()
            paces[k].note(methods[k].work, methods[k].value, methods[k].bound)
            _refine_few(game, shares, cover, work)
            continue
        if point is None:
            point = InteriorPoint.begun(game, *methods[leading].means())
        if point is None:
            alone = True
            continue
        left, most, begun = _left(paces[leading], pointed, record.gap)[0], limits.most_work, limits.work
        allowed = min(left or math.inf, max((TRIAL if cost else FIRST_TRIAL) * work, GROWTH * cost))
        limits.most_work = min(most, begun + allowed)
        moved = point.step()
        limits.most_work = most
        if moved:
            cost = limits.work - begun
            pointed.note(point.work, point.promised, point.bound)
            failures = 0
        elif limits.work - begun > 0.5 * allowed:
            failures += 1
            resting = REST**failures * work
        else:
            alone = True
    return methods[0].steps + methods[1].steps, 0 if point is None else point.steps


def _left(first: Pace, second: Pace, gap: float) -> tuple[float, float]:
    """Work until each has halved the better gap: rates over longer distances are guesses."""
    near = max(gap, HORIZON * min(first.gap, second.gap))
    return first.left(near), second.left(near)


def _faster(first: Pace, second: Pace, gap: float) -> bool:
    """Whether the second method gets on faster."""
    by_first, by_second = _left(first, second, gap)
    return by_second < by_first


def _second(first: Pace, second: Pace, work: float, second_work: float, gap: float) -> bool:
    """Whether the second of two methods has the next turn, from their paces and their work: the faster one, or the other for a trial."""
    by_first, by_second = _left(first, second, gap)
    leads = by_second < by_first
    other, spent = (first, work) if leads else (second, second_work)
    hopeless = other.turns >= HOPELESS and max(by_first, by_second) > HOPELESS * min(by_first, by_second)
    trial = spent < TRIAL * (work + second_work) and not hopeless
    return leads != trial


def _refine_few(game: Game, shares: Floats, cover: Floats, work: float) -> None:
    """Level a method's answer out where few enough targets fall short, and refine it where hardly any do then; ``work`` is the method's."""
    record, limits = game.record, game.limits
    if np.count_nonzero(cover < record.wanted) > LEVELLED * len(cover):
        return
    over = ABOVE * (record.bound - record.wanted)
    game.descend(shares, cover, record.wanted + over, over, limits.work + LEVEL_SHARE * work)
    cover = record.offer(shares)
    if not record.closed() and np.count_nonzero(cover < record.wanted) <= max(FEW * len(cover), LEAST_FEW):
        refine(game, shares, REFINE_SHARE * work, 2.0 * ABOVE)
