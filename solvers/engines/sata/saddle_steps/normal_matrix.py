"""The normal matrix of the interior point, and conjugate gradients with it; docs/saddle.md#the-interior-point."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .....formulations.sata.balls import Floats
from .....formulations.stop import Flag
from .game import BLOCK, Game, Limits
from .multigrid import Multigrid

MOST_PAIRS = 32
"""Pairs of targets that one robot sees, as a multiple of the edges, up to which the normal matrix is formed."""

MOST_ITERATIONS, MOST_CYCLES = 1000, 60
"""Iterations of conjugate gradients in one solve, with the diagonal and with multigrid."""

FIRST_TRIAL, NEXT_TRIAL = 30, 3
"""Iterations at which the other preconditioner is tried, later as a multiple of those at the last trial."""

TINY = 1e-300
"""Least divisor."""

CHARGE = 0.4
"""Charge of an entry of the normal matrix, in edges: it is read in order."""

Numbers = NDArray[np.int32]


class NormalMatrix:
    """The pattern of C K C', rows and columns targets, for matrices K that have a block for each robot."""

    def __init__(self, game: Game, sees: Numbers, seen: Numbers, starts: Numbers, columns: Numbers, pairs: int) -> None:
        from .normal_kernels import places

        layout, self._game, self.threads, self.starts, self.columns = game.layout, game, game.threads, starts, columns
        self._row_parts = self.threads.cut(starts)
        local, self._place = np.empty(len(layout.targets), np.int32), np.empty(pairs, np.int32)
        places(layout, sees, seen, starts, columns, local, self._place)
        self._blocks = sees, seen, local, self._place
        rows = np.repeat(np.arange(len(starts) - 1, dtype=np.int32), np.diff(starts))
        self.diagonal = np.nonzero(rows == columns)[0]
        self.pairs = pairs
        self.preconditioners = Preconditioners()

    @classmethod
    def of(cls, game: Game) -> NormalMatrix | None:
        """The pattern for a game of which every target is seen; None where it is too large to form."""
        from scipy.sparse import csr_matrix

        graph = game.graph
        robot = graph.robot_of_action[graph.action_of_edge]
        sight = csr_matrix((np.ones(len(robot), np.int8), (robot, graph.indices)), shape=(graph.num_robots, graph.num_targets))
        sight.sum_duplicates()
        sight.data = np.ones(len(sight.data), np.int32)
        pairs = int((np.diff(sight.indptr).astype(np.int64) ** 2).sum())
        if pairs > min(MOST_PAIRS * graph.num_edges, np.iinfo(np.int32).max) or not game.limits.afford(2.0 * pairs):
            return None
        both = (sight.T @ sight).tocsr()
        if not both.diagonal().all():  # the loops rely on it
            return None
        both.sort_indices()
        sees, seen, starts, columns = (
            np.ascontiguousarray(part, np.int32) for part in (sight.indptr, sight.indices, both.indptr, both.indices)
        )
        return cls(game, sees, seen, starts, columns, pairs)

    def covers(self, shares: Floats) -> Floats:
        """C x of shape (targets,)."""
        from .sums_kernels import multiply

        game, cover = self._game, np.empty(len(self.starts) - 1)
        self.threads.share(multiply, game.target_parts, *game.layout.by_target, shares, cover)
        return cover

    def worths(self, prices: Floats) -> Floats:
        """C'y of shape (actions,)."""
        from .sums_kernels import multiply

        game, worth = self._game, np.empty(self._game.graph.num_actions)
        self.threads.share(multiply, game.action_parts, *game.layout.by_action, prices, worth)
        return worth

    def times(self, values: Floats, vector: Floats, product: Floats) -> None:
        """The matrix of ``values`` times ``vector``, into ``product``."""
        from .sums_kernels import multiply

        self.threads.share(multiply, self._row_parts, self.starts, self.columns, values, vector, product)

    def system(self, scaling: Floats, prices: Floats, products: Floats) -> System:
        """Y C K C' Y + diag(``products``), with Y = diag(``prices``) and K = D - d d' / sum d of each robot, d its ``scaling``."""
        from .normal_kernels import assemble

        values = np.empty(len(self.columns))
        assemble(self._game.layout, *self._blocks, scaling, prices, values)
        values[self.diagonal] += products
        return System(self, values, prices)


class Preconditioners:
    """Which preconditioner serves, the diagonal (0) or multigrid (1): the one whose last solve was charged less.

    The other is tried where iterations have grown.
    """

    def __init__(self) -> None:
        self.chosen = 0
        self._charge, self._trials, self._due = 0.0, [FIRST_TRIAL, FIRST_TRIAL], False

    def next(self) -> tuple[int, float]:
        """The preconditioner of the next solve, and the most it may be charged before the other takes over."""
        return (1 - self.chosen, self._charge) if self._due else (self.chosen, math.inf)

    def note(self, kind: int, iterations: int, charge: float, done: bool) -> None:
        """What a solve with one of them took."""
        if kind != self.chosen:
            self._due = False
            if done and charge < self._charge:
                self.chosen, self._charge = kind, charge
                self._trials[kind] = max(self._trials[kind], NEXT_TRIAL * iterations)
            return
        self._charge = charge
        if iterations > self._trials[kind] or (kind and not done):
            self._due, self._trials[kind] = True, NEXT_TRIAL * iterations


class System:
    """Equations A u = given + y lambda with y'u = 0, for a symmetric positive definite matrix A and prices y."""

    def __init__(self, matrix: NormalMatrix, values: Floats, prices: Floats) -> None:
        self._matrix, self._values, self._prices = matrix, values, prices
        self._inverse = 1.0 / values[matrix.diagonal]
        self._multigrid: Multigrid | None = None
        self._of_prices: Floats | None = None
        self._scale = max(float((prices * self._inverse) @ prices), TINY)
        self.iterations = 0

    def solve(self, given: Floats, residual: float, limits: Limits) -> Floats | None:
        """u, up to ``residual`` in the largest entry; None where a limit is in the way."""
        found, rest, choice = np.zeros(len(given)), given.copy(), self._matrix.preconditioners
        rest -= (float((self._prices * self._inverse) @ rest) / self._scale) * self._prices  # lambda is free
        kind, most = choice.next()
        for turn in (kind, choice.chosen):
            if turn and self._multigrid is None:
                if not limits.afford(4.0 * len(self._values)):
                    return None
                m = self._matrix
                self._multigrid = Multigrid(m.starts, m.columns, self._values, self._values[m.diagonal])
            iterations, work = self.iterations, limits.work
            iterate = self._with_multigrid if turn else self._with_diagonal
            done = iterate(found, rest, residual, most, limits)
            if done is None:
                return None
            choice.note(turn, self.iterations - iterations, limits.work - work, done)
            if done or turn == choice.chosen:
                break
            most = math.inf
        return found

    def _with_diagonal(self, found: Floats, rest: Floats, residual: float, most: float, limits: Limits) -> bool | None:
        """Conjugate gradients; ``found`` and ``rest`` change in place. Whether that was done for a charge of ``most``, None at a limit."""
        charge, total = CHARGE * len(self._values), 0
        way, product = rest * self._inverse, np.empty(len(rest))
        slope = float(rest @ way)
        while np.abs(rest).max() > residual:
            count = int(min(BLOCK / charge + 1, (limits.most_work - limits.work) / charge, most / charge - total, MOST_ITERATIONS - total))
            if limits.reached() or limits.work + charge > limits.most_work:
                return None
            if count <= 0 or not slope > 0.0:
                return False
            count, slope = self._conjugate(limits.stop.flag, found, rest, way, product, slope, residual, count)
            limits.work += count * charge
            self.iterations += count
            total += count
        return True

    def _conjugate(
        self, flag: Flag, found: Floats, rest: Floats, way: Floats, product: Floats, slope: float, residual: float, most: int
    ) -> tuple[int, float]:
        from .normal_kernels import conjugate, improve

        m, given = self._matrix, (self._inverse, self._prices, found, rest, way, product)
        if m.threads.count == 1:
            count, slope = conjugate(flag, m.starts, m.columns, self._values, *given, slope, self._scale, residual, most)
            return count, slope
        count, largest = 0, math.inf
        while count < most and slope > 0.0 and largest > residual and not flag[0]:
            m.times(self._values, way, product)
            slope, largest = improve(*given, slope, self._scale)
            count += 1
        return count, slope

    def _with_multigrid(self, found: Floats, rest: Floats, residual: float, most: float, limits: Limits) -> bool | None:
        """The same with multigrid, whose cycles are not linear: flexible conjugate gradients."""
        m, cycle, prices = self._matrix, self._multigrid, self._prices
        assert cycle is not None
        charge, product = CHARGE * len(self._values) + cycle.work, np.empty(len(rest))
        if self._of_prices is None:
            self._of_prices = cycle(prices)
        of_prices = self._of_prices
        scale = float(prices @ of_prices)

        def projected() -> Floats:
            """The preconditioned residual without its part that changes y'u; the residual without its part along the prices."""
            image = cycle(rest)
            multiplier = float(prices @ image) / scale
            rest[:] -= multiplier * prices
            return np.asarray(image - multiplier * of_prices)

        way = projected()
        slope, total = float(rest @ way), 0
        while np.abs(rest).max() > residual:
            if not limits.afford(charge):
                return None
            total += 1
            self.iterations += 1
            m.times(self._values, way, product)
            curvature = float(way @ product)
            if total * charge > most or total > MOST_CYCLES or not (slope > 0.0 and curvature > 0.0):
                return False
            found += (slope / curvature) * way
            before = rest.copy()
            rest -= (slope / curvature) * product
            image = projected()
            fresh = float(rest @ image)
            way *= (fresh - float(before @ image)) / slope
            way += image
            slope = fresh
        return True
