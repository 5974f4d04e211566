"""The normal matrix of the interior point, and conjugate gradients with it; docs/saddle.md#the-interior-point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .....formulations.sata.balls import Floats
from .game import Game, Limits
from .layout import Layout
from .multigrid import Multigrid

MOST_PAIRS = 32
"""Pairs of targets that one robot sees, as a multiple of the edges, up to which the normal matrix is formed."""

MOST_ITERATIONS, FEW_ITERATIONS = 400, 8
"""Iterations of conjugate gradients; as long as they are so few with the diagonal as preconditioner, nothing better is made."""

Numbers = NDArray[np.int32]


class NormalMatrix:
    """The pattern of C K C', rows and columns targets, for matrices K that have a block for each robot."""

    def __init__(self, layout: Layout, sees: Numbers, seen: Numbers, starts: Numbers, columns: Numbers, pairs: int) -> None:
        from .normal_kernels import places

        self.layout, self.starts, self.columns = layout, starts, columns
        local, self._place = np.empty(len(layout.targets), np.int32), np.empty(pairs, np.int32)
        places(layout, sees, seen, starts, columns, local, self._place)
        self._blocks = sees, seen, local, self._place
        rows = np.repeat(np.arange(len(starts) - 1, dtype=np.int32), np.diff(starts))
        self.diagonal = np.nonzero(rows == columns)[0]
        self.pairs = pairs

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
        both.sort_indices()
        as_numbers = (np.ascontiguousarray(part, np.int32) for part in (sight.indptr, sight.indices, both.indptr, both.indices))
        return cls(game.layout, *as_numbers, pairs)

    def covers(self, shares: Floats) -> Floats:
        """C x of shape (targets,)."""
        from .normal_kernels import covers

        cover = np.empty(len(self.starts) - 1)
        covers(self.layout, shares, cover)
        return cover

    def worths(self, prices: Floats) -> Floats:
        """C'y of shape (actions,)."""
        from .normal_kernels import worths

        worth = np.empty(len(self.layout.starts) - 1)
        worths(self.layout, prices, worth)
        return worth

    def system(self, scaling: Floats, prices: Floats, products: Floats) -> System:
        """Y C K C' Y + diag(``products``), with Y = diag(``prices``) and K = D - d d' / sum d of each robot, d its ``scaling``."""
        from .normal_kernels import assemble

        values = np.empty(len(self.columns))
        assemble(self.layout, *self._blocks, scaling, prices, values)
        values[self.diagonal] += products
        return System(self, values, prices)


class System:
    """Equations A u = given + y lambda with y'u = 0, for a symmetric positive definite matrix A and prices y."""

    def __init__(self, matrix: NormalMatrix, values: Floats, prices: Floats) -> None:
        self._matrix, self._values, self._prices = matrix, values, prices
        self._inverse = 1.0 / values[matrix.diagonal]
        self._multigrid: Multigrid | None = None
        self.iterations = 0
        self._condition()

    def solve(self, given: Floats, residual: float, limits: Limits) -> Floats | None:
        """u, up to ``residual`` in the largest entry; None where a limit is in the way.

        The diagonal is the preconditioner as long as few iterations do, then multigrid.
        """
        found, rest = np.zeros(len(given)), given.copy()
        for most in (FEW_ITERATIONS, MOST_ITERATIONS):
            if most == FEW_ITERATIONS and self._multigrid is not None:
                continue
            done = self._iterate(found, rest, residual, most, limits)
            if done is None:
                return None
            if done:
                break
            if self._multigrid is None and not self.use_multigrid(limits):
                return None
        return found

    @property
    def multigrid(self) -> bool:
        """Whether the diagonal did not do."""
        return self._multigrid is not None

    def use_multigrid(self, limits: Limits) -> bool:
        """Make the better preconditioner; false where a limit is in the way."""
        m = self._matrix
        if not limits.afford(4.0 * len(self._values)):
            return False
        self._multigrid = Multigrid(m.starts, m.columns, self._values, self._values[m.diagonal])
        self._condition()
        return True

    def _condition(self) -> None:
        self._image = self._approximate(self._prices)
        self._scale = float(self._prices @ self._image)

    def _approximate(self, rest: Floats) -> Floats:
        return rest * self._inverse if self._multigrid is None else self._multigrid(rest)

    def _project(self, rest: Floats) -> tuple[Floats, float]:
        """The preconditioned residual that keeps y'u, and lambda."""
        image = self._approximate(rest)
        multiplier = float(self._prices @ image) / self._scale
        return image - multiplier * self._image, multiplier

    def _iterate(self, found: Floats, rest: Floats, residual: float, most: int, limits: Limits) -> bool | None:
        """Flexible conjugate gradients; ``found`` and ``rest`` change in place. Whether the residual was reached, None at a limit."""
        from .multigrid_kernels import multiply

        charge = len(self._values) + (0.0 if self._multigrid is None else self._multigrid.work)
        image, multiplier = self._project(rest)
        way, slope, product = image.copy(), float(rest @ image), np.empty(len(rest))
        for _ in range(most):
            if np.abs(rest - multiplier * self._prices).max() <= residual:
                return True
            if not limits.afford(charge):
                return None
            self.iterations += 1
            multiply(self._matrix.starts, self._matrix.columns, self._values, way, product)
            curvature = float(way @ product)
            if not (0.0 < slope and 0.0 < curvature):
                return True  # rounding: no better is to be had
            length = slope / curvature
            found += length * way
            before = rest.copy()
            rest -= length * product
            image, multiplier = self._project(rest)
            new_slope = float(rest @ image)
            way *= (new_slope - float(before @ image)) / slope
            way += image
            slope = new_slope
        return False


