"""Multigrid by aggregation for matrices that are nearly graph Laplacians; docs/saddle.md#the-interior-point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .....formulations.sata.balls import Floats

COARSEST = 400
"""Rows that a dense factorisation takes."""

STALLED = 0.9
"""Aggregation ends where it leaves more than this share of the rows."""

EVERY = 2
"""Levels of which one is solved by two conjugate gradient steps; all others pass on what they are given."""

ENOUGH = 0.25
"""Share of the residual that is left by the first of these steps when the second is not made."""


@dataclass
class Level:
    """A symmetric positive definite CSR matrix, its entries in the order of ``sort_halves`` and of half the precision, the inverse of its
    diagonal, and the group of each row."""

    starts: NDArray[np.int32]
    middle: NDArray[np.int32]
    columns: NDArray[np.int32]
    values: NDArray[np.float32]
    inverse: Floats
    group: NDArray[np.int32]
    groups: int

    def times(self, vector: Floats) -> Floats:
        from .multigrid_kernels import times

        product = np.empty(len(vector))
        times(self.starts, self.columns, self.values, self.inverse, vector, product)
        return product


class Multigrid:
    """A preconditioner: one cycle through matrices of which each joins strongly coupled rows of the one before.

    Rows are joined in pairs (up to four), so that weak couplings, of which a normal matrix near the optimum is full, separate groups. A
    cycle smooths by symmetric Gauss-Seidel, and solves every second coarser level by up to two steps of conjugate gradients.

    Source: Notay (2010), An aggregation-based algebraic multigrid method, Electronic Transactions on Numerical Analysis 37.
    """

    def __init__(self, starts: NDArray[np.int32], columns: NDArray[np.int32], values: Floats, diagonal: Floats) -> None:
        from scipy.linalg import cho_factor

        from .multigrid_kernels import aggregate, coarsen, sort_halves

        self.levels: list[Level] = []
        self._dense = None
        while True:
            group = np.zeros(len(diagonal), dtype=np.int32)
            count = len(group)
            if count > COARSEST:
                count = aggregate(starts, columns, values, group)
            stalled = count > STALLED * len(group)
            if stalled:
                group[:] = 0
            middle, halves, halved = np.empty_like(group), np.empty_like(columns), np.empty(len(values), np.float32)
            sort_halves(starts, columns, values, middle, halves, halved)
            self.levels.append(Level(starts, middle, halves, halved, 1.0 / diagonal, group, 0 if stalled else count))
            if stalled:
                break
            starts, columns, values = coarsen(starts, columns, values, group, count)
            diagonal = values[starts[:-1]]
        if len(diagonal) <= COARSEST:
            dense = np.zeros((len(diagonal), len(diagonal)))
            dense[np.repeat(np.arange(len(diagonal)), np.diff(starts)), columns] = values
            try:
                self._dense = cho_factor(dense, check_finite=False, overwrite_a=True)
            except np.linalg.LinAlgError:
                self._dense = None

    @property
    def work(self) -> float:
        """Charge of a cycle, in edges: one for each entry of a level, which is read three times and mostly in order."""
        total, often = 0.0, 1.0
        for depth, level in enumerate(self.levels):
            often *= 2.0 if depth and depth % EVERY == 1 else 1.0
            total += often * len(level.columns)
        return total

    def __call__(self, given: Floats, depth: int = 0) -> Floats:
        """One cycle for the matrix at ``depth``."""
        from scipy.linalg import cho_solve

        from .multigrid_kernels import ascend_a_level, descend_a_level

        level = self.levels[depth]
        if not level.groups and self._dense is not None:
            return np.asarray(cho_solve(self._dense, given, check_finite=False))
        solution, coarse = np.empty(len(given)), np.zeros(max(level.groups, 1))
        matrix = level.columns, level.values, level.inverse, given, solution, level.group
        descend_a_level(level.starts, level.middle, *matrix, coarse)
        coarse = self._coarse(coarse, depth + 1) if level.groups else np.zeros(1)
        ascend_a_level(level.starts, *matrix, coarse)
        return solution

    def _coarse(self, given: Floats, depth: int) -> Floats:
        level = self.levels[depth]
        first = self(given, depth)
        if depth % EVERY == 0 or (not level.groups and self._dense is not None):
            return first
        image = level.times(first)
        curvature, slope = float(first @ image), float(first @ given)
        if not curvature > 0.0:
            return first
        rest = given - (slope / curvature) * image
        if float(rest @ rest) <= ENOUGH**2 * float(given @ given):
            return (slope / curvature) * first
        second = self(rest, depth)
        mixed, own = float(second @ image), float(second @ level.times(second))
        own -= mixed * mixed / curvature
        if not own > 0.0:
            return (slope / curvature) * first
        share = float(second @ rest) / own
        return (slope / curvature - mixed * share / curvature) * first + share * second
