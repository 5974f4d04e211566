"""Sessions: convex programs that are solved again and again with further rows or other sides, by HiGHS from where it stood, or Clarabel."""

import math
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .....formulations.programs.program import CONES, QUADRATIC, Floats, Program, Rows
from .....formulations.stop import Stop
from .....instances.errors import MissingPackageError
from ....backends.highs import SOUND

Ints = NDArray[np.int64]

PRECISION = 1e-9
"""Tolerance of rows and reduced costs in HiGHS, of the gap and of rows in Clarabel."""

DANTZIG = 0
"""HiGHS' pricing by the largest infeasibility: a quarter less time on small programs that change a little than with weights."""

SLICE = 0.2
"""Seconds after which an LP looks whether it has to end."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Outcome of a run; arrays are empty unless it is optimal.

    ``status`` is ``optimal``, ``infeasible``, ``unbounded`` or ``unknown``; ``value`` and ``bound`` are the objective of ``x`` and the
    solver's own bound, NaN without a point. ``duals`` (none of programs with integers) are d objective / d right side, ``cone_duals`` of
    shape (rows of cones,) members of the dual cones. ``ray`` of shape (rows,) is that of an infeasible program, of either sign.
    """

    status: str
    value: float = math.nan
    bound: float = math.nan
    x: Floats = field(default_factory=lambda: np.zeros(0))
    duals: Floats = field(default_factory=lambda: np.zeros(0))
    cone_duals: Floats = field(default_factory=lambda: np.zeros(0))
    ray: Floats | None = None


class Session(Protocol):
    """A program that is changed and solved again."""

    def add(self, rows: Rows) -> None:
        """Append a block of rows."""

    def change_upper(self, start: int, upper: Floats) -> None:
        """Change upper sides of rows that have no lower ones, from row ``start`` on."""

    def add_columns(self, upper: Floats, column: Ints, row: Ints, data: Floats) -> None:
        """Append continuous columns from 0 to ``upper``, without cost; ``column`` counts them from 0."""

    def change_column_upper(self, columns: Ints, upper: Floats) -> None:
        """Change upper bounds of columns that are at least 0."""

    def solve(self, stop: Stop, gap: float = 0.0) -> Solved:
        """Run until the end or ``stop``; a program with integers until the gap."""


def open_session(program: Program, seed: int = 1) -> Session:
    """A session in Clarabel where there are cones or squares, else in HiGHS; raises MissingPackageError where it is not installed."""
    return ClarabelSession(program) if program.features() & (CONES | QUADRATIC) else HighsSession(program, seed)


class HighsSession:
    """A session in HiGHS, on one thread: dual simplex without presolve, or branch and cut."""

    def __init__(self, program: Program, seed: int = 1) -> None:
        import highspy

        self._model, self._statuses = program.to_highs(), highspy.HighsModelStatus
        highspy.Highs.resetGlobalScheduler(True)
        self._integer = program.is_integer
        options: dict[str, Any] = {"threads": 1, "random_seed": int(seed) % (2**31 - 1), **SOUND}
        options |= {"primal_feasibility_tolerance": PRECISION, "dual_feasibility_tolerance": PRECISION}
        if self._integer:
            options["mip_feasibility_tolerance"] = PRECISION
        else:
            options |= {"presolve": "off", "solver": "simplex", "simplex_dual_edge_weight_strategy": DANTZIG}
        for name, value in options.items():
            self._model.setOptionValue(name, value)

    def add(self, rows: Rows) -> None:
        self._model.addRows(rows.size, rows.lower, rows.upper, len(rows.data), rows.indptr[:-1], rows.indices, rows.data)

    def change_upper(self, start: int, upper: Floats) -> None:
        for row, side in enumerate(upper.tolist(), start=start):
            self._model.changeRowBounds(row, -math.inf, side)

    def add_columns(self, upper: Floats, column: Ints, row: Ints, data: Floats) -> None:
        size, order = len(upper), np.argsort(column, kind="stable")
        starts = np.searchsorted(column[order], np.arange(size)).astype(np.int32)
        none = np.zeros(size)
        self._model.addCols(size, none, none, upper, len(data), starts, row[order].astype(np.int32), data[order])

    def change_column_upper(self, columns: Ints, upper: Floats) -> None:
        self._model.changeColsBounds(len(columns), columns.astype(np.int32), np.zeros(len(columns)), upper)

    def solve(self, stop: Stop, gap: float = 0.0) -> Solved:
        model, s = self._model, self._statuses
        if self._integer:
            model.setOptionValue("mip_rel_gap", gap)
        while not stop.reached():
            seconds = stop.seconds_left
            model.setOptionValue("time_limit", model.getRunTime() + (seconds if self._integer else min(SLICE, seconds)))
            with stop.telling(model.cancelSolve):
                model.run()
            status, info = model.getModelStatus(), model.getInfo()
            if status == s.kTimeLimit and not self._integer:
                continue
            if status in (s.kOptimal, s.kModelEmpty) or (self._integer and info.primal_solution_status == 2):
                solution, value = model.getSolution(), float(info.objective_function_value)
                duals = np.zeros(0) if self._integer else np.array(solution.row_dual)
                bound = float(info.mip_dual_bound) if self._integer else value
                return Solved(
                    "optimal" if status in (s.kOptimal, s.kModelEmpty) else "unknown", value, bound, np.array(solution.col_value), duals
                )
            if status == s.kInfeasible:
                known, ray = (False, None) if self._integer else model.getDualRay()[1:]
                return Solved("infeasible", ray=np.array(ray) if known else None)
            if status in (s.kUnbounded, s.kUnboundedOrInfeasible):
                return Solved("unbounded")
            break
        return Solved("unknown")


class ClarabelSession:
    """A session in Clarabel (Goulart and Chen 2024), anew each time: interior points gain little from where they stood."""

    def __init__(self, program: Program) -> None:
        try:
            import clarabel  # noqa: F401
        except ImportError:
            raise MissingPackageError("problems with cones or quadratic costs need the package clarabel: pip install clarabel") from None
        self._program, self._matrix = program, program.matrix
        self._sides = [program.row_lower.copy(), program.row_upper.copy()]
        self._bounds = [program.lower.copy(), program.upper.copy()]

    def add(self, rows: Rows) -> None:
        import scipy.sparse as sp

        further = sp.csr_matrix((rows.data, rows.indices, rows.indptr), shape=(rows.size, self._matrix.shape[1]))
        self._matrix = sp.vstack([self._matrix, further], format="csr")
        self._sides = [np.append(all_, new) for all_, new in zip(self._sides, (rows.lower, rows.upper), strict=True)]

    def change_upper(self, start: int, upper: Floats) -> None:
        self._sides[1][start : start + len(upper)] = upper

    def add_columns(self, upper: Floats, column: Ints, row: Ints, data: Floats) -> None:
        import scipy.sparse as sp

        further = sp.csr_matrix((data, (row, column)), shape=(self._matrix.shape[0], len(upper)))
        self._matrix = sp.hstack([self._matrix, further], format="csr")
        self._bounds = [np.append(all_, new) for all_, new in zip(self._bounds, (np.zeros(len(upper)), upper), strict=True)]

    def change_column_upper(self, columns: Ints, upper: Floats) -> None:
        self._bounds[1][columns] = upper

    def solve(self, stop: Stop, gap: float = 0.0) -> Solved:
        import clarabel
        import scipy.sparse as sp

        p, matrix, (lower, upper), (least, most) = self._program, self._matrix, self._sides, self._bounds
        n, known = len(least), p.num_variables
        if stop.reached():
            return Solved("unknown")
        equal = lower == upper
        over, under = ~equal & np.isfinite(upper), ~equal & np.isfinite(lower)
        high, low, unit = np.isfinite(most), np.isfinite(least), sp.identity(n, format="csr")
        parts = [matrix[equal], matrix[over], -matrix[under], unit[high], -unit[low], *(-c.matrix(n) for c in p.cones)]
        sides = [upper[equal], upper[over], -lower[under], most[high], -least[low], *(c.offset for c in p.cones)]
        cones = [clarabel.ZeroConeT(int(equal.sum())), clarabel.NonnegativeConeT(sum(len(side) for side in sides[1:5]))]
        cones += [clarabel.SecondOrderConeT(c.width) for c in p.cones for _ in range(c.size)]
        sign = 1.0 if p.sense == "min" else -1.0
        quadratic = sp.csc_matrix((n, n)) if p.quadratic is None else sp.triu(sign * p.quadratic, format="csc")
        quadratic.resize(n, n)
        settings = clarabel.DefaultSettings()
        settings.verbose, settings.max_threads, settings.time_limit = False, 1, max(1e-3, stop.seconds_left)
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = PRECISION
        cost, stacked = sign * np.append(p.cost, np.zeros(n - known)), sp.csc_matrix(sp.vstack(parts))
        solution = clarabel.DefaultSolver(quadratic, cost, stacked, np.concatenate(sides), cones, settings).solve()
        status, z = str(solution.status), np.array(solution.z)
        ends = np.cumsum([len(side) for side in sides[:5]])
        duals = np.zeros(len(equal))
        duals[equal] = -z[: ends[0]]
        duals[over] -= z[ends[0] : ends[1]]
        duals[under] += z[ends[1] : ends[2]]
        if status in ("PrimalInfeasible", "AlmostPrimalInfeasible"):
            return Solved("infeasible", ray=duals, cone_duals=z[ends[4] :])
        if status in ("Solved", "AlmostSolved"):
            x = np.array(solution.x)
            return Solved("optimal", p.value(x[:known]), sign * float(solution.obj_val_dual) + p.offset, x, sign * duals, z[ends[4] :])
        return Solved("unbounded" if status in ("DualInfeasible", "AlmostDualInfeasible") else "unknown")
