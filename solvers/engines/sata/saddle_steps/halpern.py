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
        self._between = np.empty(graph.num_actions), np.empty(graph.num_targets)
        self._restarts = Restarts(even_shares(graph), np.ones(graph.num_targets), (share_steps, price_steps), FIRST_WEIGHT)

    @property
    def steps(self) -> int:
        return self._restarts.steps

    def run(self, steps: int) -> None:
        """Make ``steps`` steps, or until a limit is reached."""
        limits, one, play = self._game.limits, self._game.pass_work, self._restarts
        while steps > 0 and not limits.reached():
            count = min(steps, max(1, int(min(BLOCK, limits.most_work - limits.work) / one)), 1 if play.since == 0 else ROUND)
            made = self._make(count)
            play.note(made)
            steps -= count
            limits.work += made * one
            self.work += made * one
            if made == count:
                play.look()

    def _make(self, count: int) -> int:
        """``count`` steps, or fewer; returns how many."""
        from .halpern_kernels import move_prices, move_shares, steps
        from .sums_kernels import multiply

        game, play, flag, (ahead, cover) = self._game, self._restarts, self._game.limits.stop.flag, self._between
        (shares, prices), (new_shares, new_prices), (first_shares, first_prices) = play.point, play.ahead, play.anchor
        threads, graph, (share_steps, price_steps) = game.threads, game.layout, play.lengths
        if threads.count == 1:
            return int(
                steps(flag, graph, *play.lengths, *play.point, *play.ahead, *play.anchor, self._level, ahead, cover, play.since, count)
            )
        for made in range(count):
            if flag[0]:
                return made
            part = (play.since + made + 1.0) / (play.since + made + 2.0)
            threads.share(move_shares, game.robot_parts, graph, share_steps, prices, shares, new_shares, first_shares, ahead, part)
            threads.share(multiply, game.target_parts, *graph.by_target, ahead, cover)
            move_prices(price_steps, cover, prices, new_prices, first_prices, self._level, part)
        return count

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
