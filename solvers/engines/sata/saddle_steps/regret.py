"""Predictive regret matching on the whole game, for values that are no matter of some clusters.

Robots play shares, targets play prices; the value of the game is the optimum. Each side keeps its positive regrets and plays in proportion
to these and the last payoff (predictive regret matching+), the two in turn. The means of both sides' plays, step t with weight t^2,
tend to an optimal answer and to weights that prove it.

Source: Farina, Kroer and Sandholm (2021), Faster game solving via predictive Blackwell approachability: connecting regret matching and
mirror descent.
"""

from __future__ import annotations

import numpy as np

from .....formulations.sata.balls import Floats, even_shares
from .game import BLOCK, Game


class RegretMatching:
    """The state of both sides.

    Parameters
    ----------
    game : Game
    """

    def __init__(self, game: Game) -> None:
        n, m = game.graph.num_actions, game.graph.num_targets
        self._game = game
        self.steps = 0
        self._shares, self._prices = even_shares(game.graph), np.full(m, 1.0 / m)
        self._mean_shares, self._mean_prices = np.zeros(n), np.zeros(m)
        self._regrets, self._grudges, self._cover = np.zeros(n), np.zeros(m), np.zeros(m)

    def run(self, steps: int) -> None:
        """Play ``steps`` times, or until a limit is reached."""
        from .regret_kernels import play

        limits, one = self._game.limits, self._game.pass_work
        while steps > 0 and not limits.reached():
            count = min(steps, max(1, int(min(BLOCK, limits.most_work - limits.work) / one)))
            made = play(
                limits.stop.flag, self._game.layout, self._shares, self._prices, self._regrets, self._grudges, self._mean_shares,
                self._mean_prices, self._cover, self.steps + 1, count,
            )  # fmt: skip
            self.steps += made
            steps -= count
            limits.work += made * one

    def conclude(self) -> tuple[Floats, Floats]:
        """Offer the mean shares and prices to the record; returns a copy of the shares, and their coverage."""
        record, shares = self._game.record, self._mean_shares.copy()
        cover = record.offer(shares)
        priced = np.nonzero(self._mean_prices > 0.0)[0]
        record.prove(priced, self._mean_prices[priced])
        return shares, cover
