"""Units in which the numbers of a risk allocation are near 1, as solvers count: powers of two, so that nothing is rounded."""

import copy
import math
from dataclasses import dataclass

import numpy as np

from .....formulations.risk.risk_allocation import RiskAllocation
from .....instances.number_arrays import Floats

ORDINARY = (1e-3, 1e5)
"""Sizes between which numbers are not scaled."""


@dataclass(frozen=True, eq=False)
class Units:
    """A problem in its units, and the way back.

    A decision is ``columns`` times its value in ``problem``; rows and chance rows of ``problem`` are those of the original times ``rows``
    and ``chance``, and its costs times ``cost``, as are the rows of each cone and each term of the cost times ``cones`` and ``terms``.
    """

    problem: RiskAllocation
    columns: Floats
    rows: Floats
    chance: Floats
    cost: float
    cones: tuple[float, ...]
    terms: tuple[float, ...]

    @classmethod
    def of(cls, p: RiskAllocation) -> "Units":
        """The units of a problem; all 1 where its numbers are ordinary."""
        rows, chance = p.rows, p.chance
        sides = np.concatenate([np.where(np.isfinite(p.row_upper), p.row_upper, np.where(np.isfinite(p.row_lower), p.row_lower, 0.0)),
                                np.maximum(np.abs(p.limits), p.deviation)])  # fmt: skip
        columns = _near(_column_sizes(p, np.abs(np.concatenate([rows, chance])), np.abs(sides)))
        per_row, per_chance = (1.0 / _near(np.abs(m * columns).max(axis=1, initial=0.0)) for m in (rows, chance))
        per_cone = tuple(_one_over(np.abs(f * columns).max(initial=0.0)) for f, _, _, _ in p.cones)
        per_term = tuple(_one_over(max(np.abs(f * columns).max(initial=0.0), np.abs(c).max(initial=0.0))) for _, _, f, c in p.terms)
        terms = [w * float(np.abs(f * columns).max(initial=0.0)) ** (2 if kind == "square" else 1) for kind, w, f, _ in p.terms]
        cost = _one_over(max([float(np.abs(p.linear * columns).max()), *terms]))
        if all((part == 1.0).all() for part in (columns, per_row, per_chance)) and all(k == 1.0 for k in (cost, *per_cone, *per_term)):
            return cls(p, columns, per_row, per_chance, cost, per_cone, per_term)
        scaled = copy.copy(p)
        scaled.lower, scaled.upper = p.lower / columns, p.upper / columns
        scaled.linear, scaled.offset = p.linear * columns * cost, p.offset * cost
        scaled.terms = tuple(
            (kind, w * cost / (k * k if kind == "square" else k), f * columns * k, c * k)
            for (kind, w, f, c), k in zip(p.terms, per_term, strict=True)
        )
        scaled.rows = rows * columns * per_row[:, None]
        scaled.row_lower, scaled.row_upper = p.row_lower * per_row, p.row_upper * per_row
        scaled.chance, scaled.limits = chance * columns * per_chance[:, None], p.limits * per_chance
        scaled.deviation, scaled.covariance = p.deviation * per_chance, p.covariance * np.outer(per_chance, per_chance)
        scaled.cones = tuple((f * columns * k, c * k, g * columns * k, h * k) for (f, c, g, h), k in zip(p.cones, per_cone, strict=True))
        scaled._joint = ((b"", None), {})
        return cls(scaled, columns, per_row, per_chance, cost, per_cone, per_term)

    def prices(self, prices: dict[str, Floats]) -> dict[str, Floats]:
        """Prices of the original problem, from prices of the problem in its units."""
        widths = [1 + len(c) for _, c, _, _ in self.problem.cones]
        return {
            "rows": prices["rows"] * self.rows / self.cost,
            "chance": prices["chance"] * self.chance / self.cost,
            "budgets": prices["budgets"] / self.cost,
            "terms": prices["terms"] * np.repeat(self.terms, [len(c) for _, _, _, c in self.problem.terms]) / self.cost,
            "cones": prices["cones"] * np.repeat(self.cones, widths) / self.cost,
        }


def _column_sizes(p: RiskAllocation, entries: Floats, sides: Floats) -> Floats:
    """Size of each decision by its larger bound, else by what its rows leave it, or 1; in the cost alone the largest of all."""
    bounds = np.maximum(*(np.where(np.isfinite(side), np.abs(side), 0.0) for side in (p.lower, p.upper)))
    with np.errstate(divide="ignore", invalid="ignore"):
        allowed = np.where((entries > 0.0) & (sides[:, None] > 0.0), sides[:, None] / entries, math.inf)
    rows = allowed.min(axis=0, initial=math.inf)
    sizes = np.where(bounds > 0.0, bounds, np.where(np.isfinite(rows), rows, 1.0))
    parts = [entries, *(f for _, _, f, _ in p.terms), *(np.abs(f) + np.abs(g) for f, _, g, _ in p.cones)]
    loose = ~np.concatenate(parts).any(axis=0) & (bounds == 0.0)
    return np.asarray(np.where(loose, sizes.max(initial=1.0), sizes))


def _one_over(size: float) -> float:
    return 1.0 / float(_near(np.array([size]))[0])


def _near(sizes: Floats) -> Floats:
    """The power of two below each size that is not ordinary; 1 for those that are, and for 0."""
    low, high = ORDINARY
    odd = (sizes > 0.0) & ((sizes < low) | (sizes > high))
    if not odd.any():
        return np.ones(len(sizes))
    return np.asarray(np.where(odd, np.exp2(np.floor(np.log2(np.where(odd, sizes, 1.0)))), 1.0))
