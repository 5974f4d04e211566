"""The whole game, by regret matching or the interior point, whichever gets on faster; docs/saddle.md#what-the-engine-does."""

from __future__ import annotations

import itertools
import math

import numpy as np

from .....formulations.sata.balls import Floats
from .game import Game, RegretMatching
from .interior_point import InteriorPoint
from .refinement import refine

REFINE_SHARE = 0.25
"""Edges that refining an answer may read, as a share of those that its method has read so far."""

FEW, LEAST_FEW = 0.02, 100
"""An answer is refined when at most this share, or this number, of the targets falls short of the value wanted."""

FIRST_STEPS = 32
MORE_STEPS = 0.5
"""Steps of regret matching between two looks at the means: so many, later this share of all steps so far."""

TRIAL = 0.1
"""Share of the work that goes to the method that seems the slower, so that it can show that it is not."""

HOPELESS = 4.0
"""A method that would take so many times the work of the other is not tried any more, once it had this number of turns."""

ENOUGH_STEPS = 4000
"""Steps of regret matching that close most gaps; its turn comes where the steps of the interior point grow so that they would cost more."""

HORIZON = 0.5
"""Gap to which the methods are compared, as a share of the better one so far."""

LOOK_BACK = 1.5
"""Rates are taken since a method had done its work so far over this."""


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

    def projected(self, gap: float) -> float:
        """Work until ``gap`` where the turns go on to cost more, and gaps to shrink, by the same factors; 0 while little is known."""
        if len(self._seen) < 5 or self.gap <= gap:
            return 0.0
        works, gaps = zip(*self._seen[-5:], strict=True)
        costs = [max(b - a, 1.0) for a, b in itertools.pairwise(works)]
        growth, shrink = float(costs[-1] / costs[0]) ** (1 / 3), float(gaps[-1] / gaps[0]) ** 0.25
        if not shrink < 1.0:
            return math.inf
        turns = math.log(gap / gaps[-1]) / math.log(shrink)
        return float(costs[-1]) * math.fsum(growth ** min(k, 60) for k in range(1, math.ceil(min(turns, 1e4)) + 1))


def play(game: Game) -> tuple[int, int]:
    """Play until the gap is closed or a limit is reached; returns the steps of regret matching and of the interior point."""
    record, limits = game.record, game.limits
    matching, matched, pointed = RegretMatching(game), Pace(), Pace()
    point: InteriorPoint | None = None
    alone = False
    while not (record.closed() or limits.reached()):
        costly = matching.steps < ENOUGH_STEPS and pointed.projected(record.gap) > ENOUGH_STEPS * game.pass_work
        spent = 0.0 if point is None else point.work
        if alone or costly or not matching.steps or not _interior(matched, pointed, matching.work, spent, record.gap):
            most = math.inf if alone or costly or point is None or not matching.steps else max(TRIAL * point.work, 0.5 * matching.work)
            steps = max(FIRST_STEPS, int(MORE_STEPS * matching.steps))
            matching.run(max(1, min(steps, int(min(most / game.pass_work, 1e9)))))
            if not matching.steps:
                break
            shares, cover = matching.conclude()
            matched.note(matching.work, matching.value, matching.bound)
            _refine_few(game, shares, cover, matching.work)
            continue
        if point is None:
            point = InteriorPoint.begun(game, *matching.means())
        alone = point is None or not point.step()
        if point is not None and not alone:
            pointed.note(point.work, point.value, point.bound)
    return matching.steps, 0 if point is None else point.steps


def _interior(matched: Pace, pointed: Pace, matching: float, point: float, gap: float) -> bool:
    """Whether the interior point has the next turn, from the paces and the work of both methods.

    They are compared by what either takes to halve the better gap: rates over longer distances are guesses.
    """
    near = max(gap, HORIZON * min(matched.gap, pointed.gap))
    by_matching, by_point = matched.left(near), pointed.left(near)
    leads = by_point < by_matching
    other, spent = (matched, matching) if leads else (pointed, point)
    hopeless = other.turns >= HOPELESS and max(by_matching, by_point) > HOPELESS * min(by_matching, by_point)
    trial = spent < TRIAL * (matching + point) and not hopeless
    return leads != trial


def _refine_few(game: Game, shares: Floats, cover: Floats, work: float) -> None:
    if np.count_nonzero(cover < game.record.wanted) <= max(FEW * len(cover), LEAST_FEW):
        refine(game, shares, REFINE_SHARE * work)
