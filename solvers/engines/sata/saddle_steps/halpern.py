"""The restarted primal-dual hybrid gradient method on the whole game; docs/saddle.md#what-the-engine-does."""

from __future__ import annotations

import math

import numpy as np

from .....formulations.sata.balls import Floats, even_shares
from .game import BLOCK, Game
from .restarts import ROUND, Restarts

FIRST_WEIGHT = 0.3
"""Length of the first steps of the shares, in parts of that which is as long as the prices' in their own units."""


class HalpernPrimalDual:
    """Primal-dual hybrid gradients, reflected and anchored (Halpern's iteration), restarted where steps have become short.

    A robot's shares go along their worths and back onto the simplex, prices of targets (which sum to their number) against the coverage.
    Steps are as long as the diagonal preconditioners of Pock and Chambolle (2011) allow. A restart weighs the sides' steps anew, by how
    far either came. ``run`` and the rest are those of ``RegretMatching``.

    Source: Lu and Yang (2024), Restarted Halpern PDHG for linear programming.
    """

    def __init__(self, game: Game) -> None:
        graph = game.graph
        self._game, self._level = game, np.zeros(1)
        self.work = 0.0
        self.value, self.bound = -math.inf, math.inf
        load = np.bincount(graph.action_of_edge, graph.weights, graph.num_actions)
        heaviest = np.zeros(graph.num_robots)
        np.maximum.at(heaviest, graph.robot_of_action, load)
        share_steps = (1.0 / np.where(heaviest > 0.0, heaviest, 1.0))[graph.robot_of_action]
        price_steps = 1.0 / np.bincount(graph.indices, graph.weights, graph.num_targets)
        self._restarts = Restarts(even_shares(graph), np.ones(graph.num_targets), (share_steps, price_steps), FIRST_WEIGHT)

    @property
    def steps(self) -> int:
        return self._restarts.steps

    def run(self, steps: int) -> None:
        """Make ``steps`` steps, or until a limit is reached."""
        from .halpern_kernels import steps as loop

        limits, one, play = self._game.limits, self._game.pass_work, self._restarts
        while steps > 0 and not limits.reached():
            count = min(steps, max(1, int(min(BLOCK, limits.most_work - limits.work) / one)), 1 if play.since == 0 else ROUND)
            made = loop(
                limits.stop.flag, self._game.layout, *play.lengths, *play.point, *play.ahead, *play.anchor, self._level, play.since, count
            )
            play.note(made)
            steps -= count
            limits.work += made * one
            self.work += made * one
            if made == count:
                play.look()

    def conclude(self) -> tuple[Floats, Floats]:
        """Offer the shares and prices of the last step to the record; returns a copy of the shares, and their coverage."""
        record, shares = self._game.record, self._restarts.ahead[0].copy()
        cover = record.offer(shares)
        priced = np.nonzero(self._restarts.ahead[1] > 0.0)[0]
        self.value = max(self.value, float(cover.min()))
        self.bound = min(self.bound, record.prove(priced, self._restarts.ahead[1][priced]))
        return shares, cover

    def means(self) -> tuple[Floats, Floats]:
        """Copies of the shares and prices of the last step."""
        return self._restarts.ahead[0].copy(), self._restarts.ahead[1].copy()
