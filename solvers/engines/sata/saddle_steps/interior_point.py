"""A primal-dual interior point for the whole game, its equations solved by conjugate gradients; docs/saddle.md#the-interior-point."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .....formulations.sata.balls import Floats, even_shares
from .game import Game
from .normal_matrix import NormalMatrix

APART = 0.1
"""Distance of the first point from the bounds, as a share of the gap, and the share of it that is even."""

CENTRING = 0.5
"""The complementarity products aimed at, as a share of their mean."""

CORRECTORS, STRETCH, LEAST_GAIN = 1, 0.5, 0.02
"""Correctors a step, how much longer a step they aim at, and the gain below which they end."""

RANGE = 0.3
"""Products from this share of what is aimed at to its inverse need no correction."""

MIXES = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Shares of a corrector that are tried."""

BACK = 0.99
"""Share of the way to the nearest bound that a step goes."""

RESIDUAL = 0.3
"""Residual of the equations, of the largest entry, as a share of the mean product, which is what an entry is worth on the central path."""

CHARGE = 4.0
"""Charge of what else a direction takes, in edges for each pair of targets that a robot sees."""

SHORTEST = 1e-3
"""Two steps in turn that are shorter end this."""


class _Direction(NamedTuple):
    """Changes of shares, slacks of targets, prices and slacks of actions."""

    shares: Floats
    surplus: Floats
    prices: Floats
    loss: Floats

    def plus(self, other: _Direction, primal: float, dual: float) -> _Direction:
        return _Direction(
            self.shares + primal * other.shares, self.surplus + primal * other.surplus,
            self.prices + dual * other.prices, self.loss + dual * other.loss,
        )  # fmt: skip


class InteriorPoint:
    """Shares x > 0 that sum to 1 a robot, prices y > 0 that sum to 1, and positive slacks s = C x - t and w = z - C'y, moved along the
    central path on which all products x w and y s are equal.

    Each point is feasible for both sides, whatever the equations are solved to, and hence an answer and a bound. ``begun`` is None where
    the normal matrix would be too large to form.

    Source: Gondzio (1996), Multiple centrality correctors in a primal-dual method for linear programming; equations in
    docs/saddle.md#the-interior-point.
    """

    def __init__(self, game: Game, shares: Floats, prices: Floats, matrix: NormalMatrix) -> None:
        self._game, self._matrix = game, matrix
        self._owner, self._robots = game.graph.robot_of_action, game.graph.num_robots
        self.steps, self.work, self.iterations = 0, 0.0, 0
        self._short = 0
        self._x = (1.0 - APART) * shares + APART * even_shares(game.graph)
        self._y = (1.0 - APART) * prices / prices.sum() + APART / len(prices)
        cover, worth = matrix.covers(self._x), matrix.worths(self._y)
        best = self._best(worth)
        self.value, self.bound = float(cover.min()), float(best.sum())
        apart = APART * (self.bound - self.value)
        self._s = cover - (self.value - apart)
        self._w = (best + apart / self._robots)[self._owner] - worth

    @classmethod
    def begun(cls, game: Game, shares: Floats, prices: Floats) -> InteriorPoint | None:
        """One that starts near these."""
        matrix = NormalMatrix.of(game)
        if matrix is None:
            return None
        return cls(game, shares, prices, matrix)

    def step(self) -> bool:
        """Move once, and offer the point to the record; false where a limit or rounding is in the way, with all as it was."""
        with np.errstate(all="ignore"):  # what is not finite ends this below
            before = self._game.limits.work
            moved = self._short < 2 and self._step()
            self.work += self._game.limits.work - before
        return moved

    def _step(self) -> bool:
        x, y, s, w = self._x, self._y, self._s, self._w
        mean = float(x @ w + y @ s) / (len(x) + len(y))
        if not 0.0 < mean < math.inf:
            return False
        aim = CENTRING * mean
        equations = self._equations()
        if equations is None:
            return False
        way = equations(aim - x * w, aim - y * s, RESIDUAL * mean)
        if way is None:
            return False
        primal, dual = self._lengths(way)
        for _ in range(CORRECTORS):
            corrector = equations(*self._outlying(way, min(1.0, primal + STRETCH), min(1.0, dual + STRETCH), aim), RESIDUAL * mean)
            if corrector is None:
                return False
            lengths = [self._lengths(way, corrector, mix) for mix in MIXES]
            k, m = (max(range(len(MIXES)), key=lambda i: lengths[i][side]) for side in (0, 1))
            gain = lengths[k][0] - primal + lengths[m][1] - dual
            way = way.plus(corrector, MIXES[k], MIXES[m])
            primal, dual = lengths[k][0], lengths[m][1]
            if gain < LEAST_GAIN:
                break
        primal, dual = BACK * primal, BACK * dual
        moved = _Direction(x + primal * way.shares, s + primal * way.surplus, y + dual * way.prices, w + dual * way.loss)
        if not all(np.isfinite(part).all() and (part > 0.0).all() for part in moved):
            return False
        self._x, self._s, self._y, self._w = moved
        self._short = self._short + 1 if max(primal, dual) < SHORTEST else 0
        self.steps += 1
        self.iterations += self._system.iterations
        self._offer()
        return True

    def _offer(self) -> None:
        record = self._game.record
        shares = self._x / self._sums(self._x)[self._owner]
        self.value = float(record.offer(shares).min())
        self.bound = float(self._best(self._matrix.worths(self._y)).sum() / self._y.sum())
        record.prove(np.arange(len(self._y)), self._y, self.bound)

    def _lengths(self, way: _Direction, corrector: _Direction | None = None, mix: float = 0.0) -> tuple[float, float]:
        from .normal_kernels import step_length

        other = corrector or way
        points = self._x, self._s, self._y, self._w
        a, b, c, d = (step_length(v, change, more, mix) for v, change, more in zip(points, way, other, strict=True))
        return min(a, b), min(c, d)

    def _outlying(self, way: _Direction, primal: float, dual: float, aim: float) -> tuple[Floats, Floats]:
        from .normal_kernels import outliers

        of_actions, of_targets = np.empty(len(self._x)), np.empty(len(self._y))
        outliers(self._x, self._w, way.shares, way.loss, primal, dual, RANGE * aim, aim / RANGE, of_actions)
        outliers(self._y, self._s, way.prices, way.surplus, dual, primal, RANGE * aim, aim / RANGE, of_targets)
        return of_actions, of_targets

    def _equations(self) -> Callable[[Floats, Floats, float], _Direction | None] | None:
        """The Newton equations at this point, as a function of what the products x w and y s are to change by."""
        matrix, owner, limits, y, s, w = self._matrix, self._owner, self._game.limits, self._y, self._s, self._w
        if not limits.afford(matrix.pairs):
            return None
        scaling = self._x / w
        total = np.maximum(self._sums(scaling), 1e-300)
        self._system = system = matrix.system(scaling, y, s * y)

        def solved(products: Floats, priced: Floats, residual: float) -> _Direction | None:
            rate = products / w
            loss = rate - scaling * (self._sums(rate) / total)[owner]
            if not limits.afford(CHARGE * matrix.pairs):
                return None
            u = system.solve(priced - y * matrix.covers(loss), residual, limits)
            if u is None:
                return None
            prices = y * u
            prices -= y * prices.sum()  # rounding
            worth = matrix.worths(prices)
            values = self._sums(rate + scaling * worth) / total
            slacks = values[owner] - worth
            shares = rate - scaling * slacks
            change = matrix.covers(shares)
            return _Direction(shares, change - float(y @ (change - (priced - s * prices) / y)), prices, slacks)

        return solved

    def _sums(self, values: Floats) -> Floats:
        return np.asarray(np.bincount(self._owner, values, minlength=self._robots))

    def _best(self, worth: Floats) -> Floats:
        best = np.zeros(self._robots)
        np.maximum.at(best, self._owner, worth)
        return best
