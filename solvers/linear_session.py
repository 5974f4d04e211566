"""A linear program that is solved again and again with changed bounds, each time from the last basis."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..formulations.programs.program import Floats, Program
from ..formulations.programs.rows import Ints
from ..formulations.stop import Stop

SLICE = 0.2
"""Seconds after which a run looks whether it has to end."""


@dataclass(frozen=True, eq=False)
class LinearResult:
    """One run: ``optimal``, ``infeasible``, ``unbounded``, ``iterations`` (their limit was met) or ``unknown``, and what it found.

    ``value`` is the objective, with the status ``iterations`` that of the point at which it stopped; point, duals (rows,) and reduced costs
    are empty unless optimal, and ``ray`` (rows,) is that of an infeasible program, where HiGHS has one.
    """

    status: str
    value: float
    x: Floats
    duals: Floats
    ray: Floats | None = None
    reduced: Floats = field(default_factory=lambda: np.zeros(0))


class LinearSession:
    """A linear program in HiGHS' dual simplex, on one thread, without presolve.

    ``program``: linear and without integers.
    """

    def __init__(self, program: Program, seed: int = 1) -> None:
        import highspy

        self._program, self._model = program, program.to_highs()
        highspy.Highs.resetGlobalScheduler(True)  # it keeps the number of threads of whoever ran in this thread before
        self._statuses = highspy.HighsModelStatus
        options = {"presolve": "off", "solver": "simplex", "threads": 1, "random_seed": int(seed) % (2**31 - 1)}
        for name, value in options.items():
            self._model.setOptionValue(name, value)
        self._most = self._model.getOptionValue("simplex_iteration_limit")[1]
        self.lower, self.upper = program.lower.copy(), program.upper.copy()
        self.iterations = 0
        self._grown = False

    def bound(self, lower: Floats, upper: Floats) -> None:
        """Set the bounds of all variables."""
        changed = np.nonzero((self.lower != lower) | (self.upper != upper))[0].astype(np.int32)
        if len(changed):
            self._model.changeColsBounds(len(changed), changed, lower[changed], upper[changed])
            self.lower[changed], self.upper[changed] = lower[changed], upper[changed]

    def without_costs(self) -> None:
        """Drop the objective: any point will do."""
        columns = np.arange(self._program.num_variables, dtype=np.int32)
        self._model.changeColsCost(len(columns), columns, np.zeros(len(columns)))

    def price(self, columns: Ints, cost: Floats) -> None:
        """Set the costs of some columns."""
        self._model.changeColsCost(len(columns), columns.astype(np.int32), cost)

    def add(self, cost: Floats, starts: Ints, rows: Ints, values: Floats, upper: Floats | None = None) -> None:
        """Append columns with bounds 0 and ``upper``, by default infinite; ``starts`` says where the entries of each begin."""
        size, none = len(cost), np.zeros(len(cost))
        upper = np.full(size, math.inf) if upper is None else upper
        self._model.addCols(size, cost, none, upper, len(rows), starts.astype(np.int32), rows.astype(np.int32), values.astype(np.float64))
        self.lower, self.upper = np.append(self.lower, none), np.append(self.upper, upper)
        self._grown = True

    def add_rows(self, lower: Floats, starts: Ints, columns: Ints, values: Floats) -> None:
        """Append rows of at least ``lower``; ``starts`` says where the entries of each begin."""
        size, given = len(lower), (starts.astype(np.int32), columns.astype(np.int32), values.astype(np.float64))
        self._model.addRows(size, lower, np.full(size, math.inf), len(columns), *given)
        self._grown = True

    def bound_row(self, row: int, lower: float) -> None:
        """Set the lower limit of a row, which may be minus infinity."""
        self._model.changeRowBounds(row, lower, math.inf)

    def remove_rows(self, rows: Ints) -> None:
        """Remove some rows, which must not be binding."""
        if len(rows):
            self._model.deleteRows(len(rows), rows.astype(np.int32))

    def remove_columns(self, columns: Ints) -> None:
        """Remove some columns, whose values must be 0."""
        if len(columns):
            self._model.deleteCols(len(columns), columns.astype(np.int32))
            self.lower, self.upper = np.delete(self.lower, columns), np.delete(self.upper, columns)

    def primal(self, wanted: bool) -> None:
        """Use the primal simplex, which new columns leave feasible, or else the dual one, which new rows and bounds leave feasible."""
        self._model.setOptionValue("simplex_strategy", 4 if wanted else 1)

    def basis(self) -> Any:
        """The session's basis, for ``start``."""
        return self._model.getBasis()

    def start(self, basis: Any) -> None:
        """Go back to a basis."""
        self._model.setBasis(basis)

    def solve(self, stop: Stop, iterations: int | None = None) -> LinearResult:
        """Run until the end, ``stop``, or a number of iterations.

        Returns
        -------
        LinearResult
            ``unknown`` where it had to stop, or HiGHS does not know.
        """
        model, s = self._model, self._statuses
        model.setOptionValue("simplex_iteration_limit", self._most if iterations is None else iterations)
        if (self.lower > self.upper).any():
            return LinearResult("infeasible", math.nan, np.zeros(0), np.zeros(0))
        while not stop.reached():
            model.setOptionValue("time_limit", model.getRunTime() + min(SLICE, stop.seconds_left))
            model.run()
            status, info = model.getModelStatus(), model.getInfo()
            self.iterations += max(0, int(info.simplex_iteration_count))
            if status == s.kTimeLimit:
                continue
            if status in (s.kOptimal, s.kModelEmpty):
                point = model.getSolution()
                x, duals, reduced = (np.array(part) for part in (point.col_value, point.row_dual, point.col_dual))
                return LinearResult("optimal", float(info.objective_function_value), x, duals, reduced=reduced)
            if status == s.kInfeasible:
                _, known, ray = model.getDualRay()
                return LinearResult("infeasible", math.nan, np.zeros(0), np.zeros(0), np.array(ray) if known else self._broken_row())
            if status == s.kUnbounded:
                return LinearResult("unbounded", math.nan, np.zeros(0), np.zeros(0))
            if status == s.kIterationLimit:
                return LinearResult("iterations", float(info.objective_function_value), np.zeros(0), np.zeros(0))
            break
        return LinearResult("unknown", math.nan, np.zeros(0), np.zeros(0))

    def _broken_row(self) -> Floats | None:
        """The ray of one row that no values within the bounds can meet; HiGHS, which sees these first, has none then."""
        if self._grown:
            return None
        p, up = self._program, self._program.data > 0
        row = np.repeat(np.arange(p.num_rows), np.diff(p.indptr))
        lower, upper = self.lower[p.indices], self.upper[p.indices]
        with np.errstate(invalid="ignore"):
            least, most = (np.where(p.data == 0, 0.0, p.data * np.where(up, a, b)) for a, b in ((lower, upper), (upper, lower)))
            low, high = (np.bincount(row, end, minlength=p.num_rows) for end in (least, most))
            excess = np.maximum(p.row_lower - high, low - p.row_upper)
        if not len(excess) or not np.nanmax(excess) > 0:
            return None
        worst = int(np.nanargmax(excess))
        ray = np.zeros(p.num_rows)
        ray[worst] = 1.0 if p.row_lower[worst] > high[worst] else -1.0
        return ray
