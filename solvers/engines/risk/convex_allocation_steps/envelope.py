"""Tangents of the normal tail as columns of a program, so that further tangents leave its rows as they are.

The largest of some tangents is a convex function of z, in pieces of which each has the slope of one tangent. With z_i = its least value and
what it goes on along each piece, up to that one's length,

    a_i x + s_i (floor_i + sum of piece_j) <= b_i                                         each chance row
    sum of (tail(floor_i) - sum of slope_j piece_j) <= its risk                           each budget
    0 <= piece_j <= length_j

Where less risk is worth something, pieces are taken in their order, as the first are the steepest. It is the program of
``formulations/risk/forms/piecewise.py`` with as many rows as there are chance constraints and budgets, however many tangents it has.
"""

import math

import numpy as np

from .....formulations.programs.program import Variables
from .....formulations.programs.rows import rows
from .....formulations.risk.forms._blocks import Blocks, dense_rows
from .....formulations.risk.forms.piecewise import density, mean_risk, points
from .....formulations.risk.normal import ndtr
from .....formulations.risk.risk_allocation import RiskAllocation
from .....instances.number_arrays import Floats
from .session import Ints, Solved, open_session

TINY = float(np.finfo(np.float64).tiny)


class Envelope:
    """A program with tangents, and its session, of a problem with ``allocated`` risk and without alternatives.

    It begins with ``count`` tangents of each constraint, from its largest risk to the part ``least`` of a mean one. ``program`` is that of
    the start, whose rows are those of all others; ``chance`` and ``budget`` are the first rows of the chance rows and of the budgets, whose
    risks, in ``unit``, are ``budgets`` of shape (budgets,).
    """

    def __init__(self, problem: RiskAllocation, count: int, least: float, seed: int) -> None:
        self.unit = mean_risk(problem)
        at, many = points(problem, self.unit, count, least), len(problem.names)
        self._floor, self._row, self._many = at[:, 0], np.argsort(problem.constraint), many  # one row a constraint
        self._noise = problem.deviation[self._row]
        noisy = np.nonzero(self._noise > 0.0)[0]  # the others have no risk
        self._constraint = np.repeat(noisy, count)
        self._tangents, self._length = np.zeros((3, 0)), np.zeros(0)
        self._lay(at[noisy].ravel())
        blocks, columns = Blocks(problem), np.arange(len(self._constraint))
        none = np.zeros(len(columns))
        self._first = blocks.add(Variables("piece", (columns,), (), none, self._length, none))
        self.chance = sum(block.size for block in blocks.rows)
        self.budget = self.chance + many
        self.budgets = np.array([b.risk for b in problem.budgets]) / self.unit
        self._base = np.where(self._noise > 0.0, ndtr(-self._floor) / self.unit, 0.0)
        self._members = np.zeros((len(self.budgets), many), dtype=bool)
        for k, budget in enumerate(problem.budgets):
            self._members[k, budget.constraints] = True
        limits = problem.limits - problem.deviation * self._floor[problem.constraint]
        part = [(self._row[self._constraint], self._first + columns, self._noise[self._constraint])]
        blocks.rows.append(dense_rows("chance", problem.chance, -math.inf, limits, part, (problem.constraint,), (problem.names,)))
        row, piece = np.nonzero(self._members[:, self._constraint])
        blocks.rows.append(
            rows("budget", len(self.budgets), [(row, self._first + piece, -self._tangents[1, piece])], -math.inf, self._sides(0.0))
        )
        self.program = blocks.program("tangents")
        self.session = open_session(self.program, seed)

    def _lay(self, at: Floats) -> Ints:
        """Take further tangents at ``at``, one for each new entry of the constraints; the earlier pieces whose length changes."""
        before = self._length
        self._tangents = np.concatenate((self._tangents, (at, density(at) / self.unit, ndtr(-at) / self.unit)), axis=1)
        order = np.lexsort((self._tangents[0], self._constraint))
        constraint, (z, slope, risk) = self._constraint[order], self._tangents[:, order]
        gap, less = z[1:] - z[:-1], slope[:-1] - slope[1:]
        meet = (risk[:-1] - risk[1:] - slope[1:] * gap) / np.where(less > 0.0, less, 1.0)  # beyond the one before
        meet = z[:-1] + np.minimum(np.maximum(meet, 0.0), gap)
        start, end = np.concatenate((z[:1], meet)), np.concatenate((meet, z[-1:]))
        last = np.nonzero(np.append(constraint[1:] != constraint[:-1], True)[: len(z)])[0]
        start[last[:-1] + 1] = z[last[:-1] + 1]  # the first touches the tail at the floor
        end[last] = z[last] + risk[last] / np.maximum(slope[last], TINY)  # where it has no risk
        self._length = np.empty(len(order))
        self._length[order] = np.maximum(end - start, 0.0)
        return np.nonzero(self._length[: len(before)] != before)[0]

    def add(self, constraint: Ints, at: Floats) -> None:
        """Tangents of some constraints at ``at``."""
        known = len(self._length)
        self._constraint = np.concatenate((self._constraint, constraint))
        changed = self._lay(np.maximum(at, self._floor[constraint]))
        self.session.change_column_upper(self._first + changed, self._length[changed])
        piece, budget = np.nonzero(self._members[:, constraint].T)
        column = np.concatenate([np.arange(len(constraint)), piece])
        row = np.concatenate([self.chance + self._row[constraint], self.budget + budget])
        entries = np.concatenate([self._noise[constraint], -self._tangents[1, known + piece]])
        self.session.add_columns(self._length[known:], column, row, entries)

    def _sides(self, less: float) -> Floats:
        """Right sides of the budgets smaller by the part ``less``."""
        return np.asarray(self.budgets * (1.0 - less) - self._members @ self._base)

    def use(self, less: float) -> None:
        """Make budgets smaller by the part ``less``."""
        self.session.change_upper(self.budget, self._sides(less))

    def parts(self, solved: Solved) -> tuple[Floats, Floats]:
        """Arguments of the tail, and the risks that the program counts for them in the unit; shape (constraints,)."""
        piece = solved.x[self._first :]
        z = self._floor + np.bincount(self._constraint, piece, self._many)
        return z, self._base - np.bincount(self._constraint, self._tangents[1] * piece, self._many)
