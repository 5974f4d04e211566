"""The restarted primal-dual hybrid gradient method on the whole game; docs/saddle.md#what-the-engine-does."""

from __future__ import annotations

import math

import numpy as np

from .....formulations.sata.balls import Floats, even_shares
from .game import BLOCK, Game

ROUND = 40
"""Steps between two looks at how far the last one went."""

FIRST_WEIGHT = 0.3
"""Length of the first steps of the shares, in parts of that which is as long as the prices' in their own units."""

ENOUGH, SOME, LONG = 0.2, 0.8, 0.36
"""A restart comes once steps are this short, in parts of the first one since the last restart; or this short and growing again; or after
this share of all steps."""


class HalpernPrimalDual:
    """Primal-dual hybrid gradients, reflected and anchored (Halpern's iteration), restarted where steps have become short.

    A robot's shares go along their worths and back onto the simplex, prices of targets (which sum to their number) against the coverage.
    Steps are as long as the diagonal preconditioners of Pock and Chambolle (2011) allow. A restart weighs the sides' steps anew, by how
    far either came. ``run`` and the rest are those of ``RegretMatching``.

    Source: Lu and Yang (2024), Restarted Halpern PDHG for linear programming.
    """

    def __init__(self, game: Game) -> None:
        graph = game.graph
        self._game, self._owner = game, graph.robot_of_action
        self.steps, self.work = 0, 0.0
        self.value, self.bound = -math.inf, math.inf
        load = np.bincount(graph.action_of_edge, graph.weights, graph.num_actions)
        heaviest = np.zeros(graph.num_robots)
        np.maximum.at(heaviest, self._owner, load)
        self._share_steps = 1.0 / np.where(heaviest > 0.0, heaviest, 1.0)
        self._price_steps = 1.0 / np.bincount(graph.indices, graph.weights, graph.num_targets)
        self._weight, self._level, self._since, self._first, self._last = FIRST_WEIGHT, 0.0, 0, math.inf, math.inf
        self._shares, self._prices = even_shares(graph), np.ones(graph.num_targets)
        self._anchor = self._shares.copy(), self._prices.copy()
        self._new = self._shares.copy(), self._prices.copy()

    def run(self, steps: int) -> None:
        """Make ``steps`` steps, or until a limit is reached."""
        from .halpern_kernels import steps as loop

        limits, one = self._game.limits, self._game.pass_work
        while steps > 0 and not limits.reached():
            count = min(steps, max(1, int(min(BLOCK, limits.most_work - limits.work) / one)), 1 if self._since == 0 else ROUND)
            lengths = self._share_steps * self._weight, self._price_steps / self._weight
            made, self._level, far = loop(
                limits.stop.flag, self._game.layout, *lengths, self._shares, self._prices, *self._anchor, *self._new, self._level,
                self._since, count,
            )  # fmt: skip
            self.steps += made
            self._since += made
            steps -= count
            limits.work += made * one
            self.work += made * one
            if made == count:
                self._look(math.sqrt(far))

    def _look(self, far: float) -> None:
        if self._since == 1:
            self._first, self._last = far, math.inf
        elif far <= ENOUGH * self._first or (far <= SOME * self._first and far > self._last) or self._since > LONG * self.steps:
            self._restart()
        self._last = far

    def _restart(self) -> None:
        (shares, prices), (old_shares, old_prices) = self._new, self._anchor
        far = math.sqrt(float(((shares - old_shares) ** 2 / self._share_steps[self._owner]).sum()))
        wide = math.sqrt(float(((prices - old_prices) ** 2 / self._price_steps).sum()))
        if 0.0 < far < math.inf and 0.0 < wide < math.inf:
            self._weight = math.sqrt(self._weight * far / wide)
        for values in (self._shares, old_shares):
            values[:] = shares
        for values in (self._prices, old_prices):
            values[:] = prices
        self._since = 0

    def conclude(self) -> tuple[Floats, Floats]:
        """Offer the shares and prices of the last step to the record; returns a copy of the shares, and their coverage."""
        record, shares = self._game.record, self._new[0].copy()
        cover = record.offer(shares)
        priced = np.nonzero(self._new[1] > 0.0)[0]
        self.value = max(self.value, float(cover.min()))
        self.bound = min(self.bound, record.prove(priced, self._new[1][priced]))
        return shares, cover

    def means(self) -> tuple[Floats, Floats]:
        """Copies of the shares and prices of the last step."""
        return self._new[0].copy(), self._new[1].copy()
