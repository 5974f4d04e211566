"""The game between robots, who divide themselves among actions, and targets, which set prices; and what is known of its value."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from .....formulations.sata.balls import Floats, Indices, Positions, coverage, even_shares, robots_seeing, weights_bound
from .....formulations.stop import Stop
from .....instances.sata.sensing_graph import SensingGraph
from .layout import Layout
from .programs import Programs
from .threads import Threads

BLOCK = 1e7
"""Edges that a compiled loop reads between two looks at the limits: some 0.05 s."""

_EPS = float(np.finfo(np.float64).eps)


class Limits:
    """The limits of a search: its time and the wish to stop, and the edges that the compiled loops may read."""

    def __init__(self, stop: Stop, most_work: float = math.inf) -> None:
        self.stop = stop
        self.most_work = most_work
        self.work = 0.0

    @property
    def seconds_left(self) -> float:
        return self.stop.seconds_left

    def afford(self, charge: float) -> bool:
        """Charge so many edges; false, and nothing is charged, where a limit is reached or would be."""
        if self.reached() or self.work + charge > self.most_work:
            return False
        self.work += charge
        return True

    def reached(self) -> str:
        """Name of the limit that is reached: ``interrupt``, ``time``, ``iterations``, or none (empty)."""
        return self.stop.reached() or ("iterations" if self.work >= self.most_work else "")


class Record:
    """The best answer and the best bound so far, for a graph of which every target is seen.

    ``gap`` is the relative one that is asked for between them; ``news(record, what)`` is called with ``answer`` or ``bound`` when there is
    a better one. ``bound`` is what the checker makes of ``weights`` of ``targets`` (ascending), its rounding upwards included.
    """

    def __init__(self, graph: SensingGraph, gap: float, news: Callable[[Record, str], Any] = lambda record, what: None) -> None:
        self.graph, self.gap, self._news = graph, gap, news
        self.shares = even_shares(graph)
        self.value, self.bound = -math.inf, math.inf
        self.targets: Indices = np.zeros(0, dtype=np.int64)
        self.weights: Floats = np.zeros(0)

    @property
    def wanted(self) -> float:
        """Value that closes the gap to the bound."""
        return self.bound / (1.0 + self.gap)

    def closed(self) -> bool:
        """True if the gap is as small as asked for."""
        return self.value >= self.wanted

    def offer(self, shares: Floats) -> Floats:
        """Take ``shares`` if they are better; returns their coverage, computed anew."""
        cover = coverage(self.graph, shares)
        value = float(cover.min())
        if value > self.value:
            self.shares, self.value = shares.copy(), value
            self._news(self, "answer")
        return cover

    def prove(self, targets: Indices, weights: Floats, bound: float | None = None) -> float:
        """Take the bound that weights of targets prove, if it is better; returns it."""
        if bound is None:
            bound = weights_bound(self.graph, targets, weights)
        bound *= self._rounding
        if bound < self.bound:
            self.bound, self.targets, self.weights = bound, targets, weights
            self._news(self, "bound")
        return bound

    @cached_property
    def _rounding(self) -> float:
        return 1.0 + float(np.diff(self.graph.indptr).max(initial=0) + 16) * _EPS


class Game:
    """A graph of which every target is seen, the best that is known of it, and what the methods need to work on it."""

    def __init__(self, graph: SensingGraph, record: Record, limits: Limits, programs: Programs, threads: int = 1) -> None:
        self.graph, self.record, self.limits, self.programs = graph, record, limits, programs
        self.layout = layout = Layout.of(graph)
        self.threads = Threads(threads, self.pass_work)
        edges = np.concatenate([[0], np.cumsum(np.diff(layout.starts)[layout.order])])[layout.first]
        self.robot_parts, self.action_parts, self.target_parts = map(self.threads.cut, (edges, layout.starts, layout.viewer_starts))
        room = 2 * int(np.diff(graph.indptr).max(initial=0))
        self._scratch = np.empty(room, dtype=np.int32), np.empty(room), np.empty(room)
        self._queue = np.zeros(graph.num_robots, dtype=np.int32)
        self._queued = np.zeros(graph.num_robots, dtype=np.bool_)

    @property
    def pass_work(self) -> float:
        """Edges that a step over the whole graph reads."""
        return float(2 * self.graph.num_edges + self.graph.num_targets)

    def descend(self, shares: Floats, cover: Floats, level: float, negligible: float, end: float) -> bool:
        """Move ``shares`` downhill on the squared deficits below ``level``, as long as ``limits.work`` is below ``end``; true if it came to
        rest.

        ``shares`` and ``cover`` change in place. Deficits up to ``negligible`` are left as they are.
        """
        from .descent_kernels import descend

        limits, queue, queued = self.limits, self._queue, self._queued
        waiting: Positions = robots_seeing(self.graph, np.nonzero(level - cover > negligible)[0])
        queue[: len(waiting)] = waiting
        queued[:] = False
        queued[waiting] = True
        head, size = 0, len(waiting)
        while size > 0 and limits.work < end and not limits.reached():
            block = max(1.0, min(BLOCK, end - limits.work, limits.most_work - limits.work))
            head, size, work = descend(
                limits.stop.flag, self.layout, self._scratch, shares, cover, level, negligible, queue, queued, head, size, int(block)
            )
            limits.work += work
        return bool(size == 0)


class RegretMatching:
    """Predictive regret matching on the whole game, for values that are no matter of some clusters.

    Each side keeps its positive regrets and plays in proportion to these and the last payoff (predictive regret matching+), robots shares
    and targets prices, the two in turn. The means of both sides' plays, step t with weight t^2, tend to an optimal answer and to weights
    that prove it.

    Source: Farina, Kroer and Sandholm (2021), Faster game solving via predictive Blackwell approachability: connecting regret matching and
    mirror descent.
    """

    def __init__(self, game: Game) -> None:
        n, m = game.graph.num_actions, game.graph.num_targets
        self._game, self._worth, self._cover = game, np.empty(n), np.empty(m)
        self.steps, self.work = 0, 0.0
        self.value, self.bound = -math.inf, math.inf
        self._shares, self._prices = even_shares(game.graph), np.full(m, 1.0 / m)
        self._mean_shares, self._mean_prices = np.zeros(n), np.zeros(m)
        self._regrets, self._grudges = np.zeros(n), np.zeros(m)

    def run(self, steps: int) -> None:
        """Play ``steps`` times, or until a limit is reached."""
        limits, one = self._game.limits, self._game.pass_work
        while steps > 0 and not limits.reached():
            count = min(steps, max(1, int(min(BLOCK, limits.most_work - limits.work) / one)))
            played = self._play(count)
            self.steps += played
            steps -= count
            limits.work += played * one
            self.work += played * one

    def _play(self, count: int) -> int:
        """``count`` steps, or fewer; returns how many."""
        from .regret_kernels import answer, charge, play
        from .sums_kernels import multiply

        game, first, flag = self._game, self.steps + 1, self._game.limits.stop.flag
        graph, threads, shares, prices = game.layout, game.threads, self._shares, self._prices
        if threads.count == 1:
            means = self._mean_shares, self._mean_prices
            return int(play(flag, graph, shares, prices, self._regrets, self._grudges, *means, self._worth, self._cover, first, count))
        for step in range(first, first + count):
            if flag[0]:
                return step - first
            part = 6.0 * step / ((step + 1.0) * (2.0 * step + 1.0))
            threads.share(answer, game.robot_parts, graph, prices, shares, self._worth, self._regrets, self._mean_shares, part)
            threads.share(multiply, game.target_parts, *graph.by_target, shares, self._cover)
            charge(self._cover, prices, self._grudges, self._mean_prices, part)
        return count

    def conclude(self) -> tuple[Floats, Floats]:
        """Offer the mean shares and prices to the record; returns a copy of the shares, and their coverage."""
        record, shares = self._game.record, self._mean_shares.copy()
        cover = record.offer(shares)
        priced = np.nonzero(self._mean_prices > 0.0)[0]
        self.value = float(cover.min())
        self.bound = record.prove(priced, self._mean_prices[priced])
        return shares, cover

    def means(self) -> tuple[Floats, Floats]:
        """Copies of the mean shares and prices."""
        return self._mean_shares.copy(), self._mean_prices.copy()
