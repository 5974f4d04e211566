"""A primal-dual interior point for the whole game, its equations solved by conjugate gradients; docs/saddle.md#the-interior-point."""

from __future__ import annotations

import math

import numpy as np

from .....formulations.sata.balls import Floats, even_shares
from .game import Game
from .normal_matrix import NormalMatrix

APART = 0.1
"""Distance of the first point from the bounds, as a share of the gap, and the share of it that is even."""

CENTRING = 0.5
"""The least complementarity product aimed at, as a share of the last one."""

CURVED = 0.01
"""Share of the robots that may not have gone the whole step where the next one aims at smaller products."""

RANGE, KEPT = 0.1, 0.1
"""Products from this share of what is aimed at to its inverse are kept, and so are values of which at least this share is left."""

STAGE = 10.0
"""Factor by which the gap shrinks, about, until the point is centred, so that it is worth what its products say."""

CLOSER = 0.97
"""The product aimed at near the end of a stage, as a share of the one that would close its gap at the last point that was centred."""

STALLED = 20
"""Steps in turn after which this ends where none has moved the aim or bettered the record."""

RESIDUAL = 0.3
"""Residual of the equations, of the largest entry, as a share of the product, which is what an entry is worth on the central path."""

CHARGE = 2.0
"""Charge of what else a step takes, in edges for each pair of targets that a robot sees."""


class InteriorPoint:
    """Shares x > 0 that sum to 1 a robot, prices y > 0 that sum to 1, and positive slacks w = z - C'y of actions and s of targets, moved
    along the central path on which all products x w and y s are equal and C x - s is the same level for all targets.

    Shares and prices are an answer and a bound at any point. Prices go the whole step; a robot that cannot goes as far as it can, which
    leaves C x - s off the level around it, and the next steps make up for that. ``promised`` is what the answer is worth once they have.
    ``begun`` is None where the normal matrix would be too large to form.

    Equations in docs/saddle.md#the-interior-point.
    """

    def __init__(self, game: Game, shares: Floats, prices: Floats, matrix: NormalMatrix) -> None:
        self._game, self._matrix = game, matrix
        self._owner, self._robots = game.graph.robot_of_action, game.graph.num_robots
        self.steps, self.work, self.iterations = 0, 0.0, 0
        self._x = (1.0 - APART) * shares + APART * even_shares(game.graph)
        self._y = (1.0 - APART) * prices / prices.sum() + APART / len(prices)
        cover, worth = matrix.covers(self._x), matrix.worths(self._y)
        best = self._best(worth)
        self.value, self.bound = float(cover.min()), float(best.sum())
        apart = APART * (self.bound - self.value)
        self._level = self.value - apart
        self._s, self._rest = cover - self._level, np.zeros(len(cover))
        self._z = best + apart / self._robots
        self._w = self._z[self._owner] - worth
        with np.errstate(all="ignore"):
            self._product = float(self._x @ self._w + self._y @ self._s) / (len(self._x) + len(self._y))
        self._curved, self._still, self._share, self._centred = 0, 0, 1.0, False
        self._wanted = self._stage()

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
            moved = self._still < STALLED and 0.0 < self._product < math.inf and self._step()
            self.work += self._game.limits.work - before
        return moved

    def _step(self) -> bool:
        from .normal_kernels import move_robots

        matrix, owner, limits, aim = self._matrix, self._owner, self._game.limits, self._aim()
        x, y, s, w = self._x, self._y, self._s, self._w
        if not limits.afford((1.0 + CHARGE) * matrix.pairs):
            return False
        scaling = x / w
        total = np.maximum(self._sums(scaling), 1e-300)
        system = matrix.system(scaling, y, s * y)
        rate, priced = aim / w - x, aim - y * s
        loss = rate - scaling * (self._sums(rate) / total)[owner]
        u = system.solve(priced - y * (matrix.covers(loss) + self._rest), RESIDUAL * self._product, limits)
        if u is None:
            return False
        prices = y * u
        prices -= y * prices.sum()  # rounding
        worth = matrix.worths(prices)
        values = self._sums(rate + scaling * worth) / total
        change = rate - scaling * (values[owner] - worth)
        level = self._level + float(y @ (matrix.covers(change) + self._rest)) - float((priced - s * prices).sum())
        y = np.maximum(y + prices, KEPT * y)
        y /= y.sum()
        x, w, z, worth = x.copy(), np.empty(len(w)), self._z + values, matrix.worths(y)
        curved = move_robots(self._game.layout, worth, change, aim, RANGE, KEPT, x, w, z)
        if not all(np.isfinite(part).all() and (part > 0.0).all() for part in (x, y, w)) or not math.isfinite(level):
            return False
        self._x, self._y, self._w, self._z, self._level = x, y, w, z, level
        self._still = 0 if aim < self._product else self._still + 1
        self._product, self._curved = aim, curved
        self.steps += 1
        self.iterations += system.iterations
        self._offer(worth)
        return True

    def _offer(self, worth: Floats) -> None:
        record, y, aim = self._game.record, self._y, self._product
        before = record.value, record.bound
        cover = record.offer(self._x)
        self.value, self.bound = float(cover.min()), float(self._best(worth).sum())
        record.prove(np.arange(len(y)), y, self.bound)
        if before != (record.value, record.bound):
            self._still = 0
        surplus = cover - self._level
        self._s = np.clip(surplus, RANGE * aim / y, aim / RANGE / y)
        self._rest = surplus - self._s
        self._centred = self._curved == 0 and not self._rest.any()
        if self._centred:
            self._share = (self.bound - self.value) / (aim * (len(self._x) + len(y)))

    @property
    def promised(self) -> float:
        """Worth of the answer once the point is centred, about."""
        return self.bound - self._share * self._product * (len(self._x) + len(self._y))

    def _aim(self) -> float:
        """The products to aim at: smaller ones unless many robots lag behind, but not before a stage ends with a point that is centred."""
        record, product = self._game.record, self._product
        if not record.bound - record.value > self._wanted * abs(record.value):
            self._wanted = self._stage()
        if self._curved > CURVED * self._robots:
            return product
        enough = CLOSER * self._wanted * max(self.promised, 0.0) / (self.bound - self.promised)
        return product * min(CLOSER if self._centred else 1.0, max(CENTRING, enough))

    def _stage(self) -> float:
        """The gap that ends the next stage, so that all have the same ratio."""
        record = self._game.record
        gap = (self.bound - self.value) / self.value if record.value <= 0.0 else record.bound / record.value - 1.0
        ratio = gap / record.gap
        if not 1.0 < ratio < math.inf:
            return record.gap
        return float(gap / ratio ** (1.0 / max(1, round(math.log(ratio, STAGE)))))

    def _sums(self, values: Floats) -> Floats:
        return np.asarray(np.bincount(self._owner, values, minlength=self._robots))

    def _best(self, worth: Floats) -> Floats:
        best = np.zeros(self._robots)
        np.maximum.at(best, self._owner, worth)
        return best
