"""Outer approximation: mixed-integer programs with second-order cones, by any solver of linear ones.

A cone t >= ||v|| holds if and only if u v <= t for all u of length 1. Some of these rows are written: first those that the continuous
relaxation breaks, then, program after program, those that an optimum breaks, until one breaks none. There are finitely many whole parts of
points, and the row of u = v / ||v|| excludes the point it was made at, so that this ends. Each program is a relaxation, so that its bound
counts. The row of one cone holds for every other cone of its block, and is written for all: they are mostly alike.

Source: Duran and Grossmann (1986), An outer-approximation algorithm for a class of mixed-integer nonlinear programs; rows at points alone,
without nonlinear programs between, as in Westerlund and Pettersson (1995), An extended cutting plane method.
"""

import math
import time
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from ...formulations.programs.cones import Cones
from ...formulations.programs.program import CONES, INTEGERS, Floats, Program, Rows
from ..backend import BACKENDS, Control, Options, RawResult, solver_named
from ..program_backend import ProgramBackend

SECOND_ORDER = frozenset(kind for kind in CONES if kind.startswith("second-order"))

BROKEN = 1e-6
"""Excess from which on a cone counts as broken, in the units of the program: a solver's own tolerance of a row."""

FRACTIONAL_ROUNDS = 30
"""Continuous relaxations that are solved at most before the first program with integers."""

GAINED = 1e-4
"""Part of its value by which a relaxation has to gain for another one to follow."""

TOGETHER = 100
"""Cones of a block up to which a row is written for all of them."""


@BACKENDS.register("outer-approximation")
class OuterApproximation(ProgramBackend):
    """Rows that touch the cones, added where a solver of linear programs breaks them: HiGHS, or another as ``outer-approximation:NAME``.

    ``iterations`` counts nodes of all programs together, where the solver counts any. Extra options are the solver's own.
    """

    name, title = "outer-approximation", "outer approximation"
    package = "highspy"
    summary = "MILP with second-order cones, by rows that touch them; HiGHS, or another MILP solver by name"
    options = None
    order = 45
    programs = (INTEGERS | SECOND_ORDER,)
    only_integers = True
    variants = ("highs", "scip", "mathopt:highs")

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        self.within = solver_named(variant or "highs")
        self.engine = getattr(self.within, "engine", "")
        self.needs_process = self.within.needs_process

    def able(self, features: frozenset[str]) -> bool:
        """See ``ProgramBackend.able``; without cones there is nothing to do."""
        within = self.within
        return features >= SECOND_ORDER and super().able(features) and isinstance(within, ProgramBackend) and within.able(INTEGERS)

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        return _Search(self.within, program, options, control).run()


class _Heard(Control):
    """Control that collects the points that a solver publishes on its way."""

    def __init__(self, outer: Control) -> None:
        super().__init__()
        self.points: list[Floats] = []
        outer.on_stop(self.stop)

    def publish(self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: Any = ()) -> None:
        super().publish(answer, objective, bound, evidence)
        if answer is not None:
            self.points.append(np.asarray(answer, dtype=np.float64))


class _Search:
    """Programs without cones, each with more rows than the one before."""

    def __init__(self, within: Any, program: Program, options: Options, control: Control) -> None:
        self.within, self.program, self.options, self.control = within, program, options, control
        self.end = time.perf_counter() + options.time_limit
        self.matrices = [cones.matrix(program.num_variables) for cones in program.cones]
        self.rows: list[Rows] = [_tips(cones) for cones in program.cones]
        self.start: Floats | None = options.start
        self.best: Floats | None = None
        self.best_value = math.inf
        self.sign = 1.0 if program.sense == "min" else -1.0
        self.bound: float | None = None
        self.nodes = self.rounds = self.cuts = 0

    def run(self) -> RawResult:
        before = -math.inf
        for _ in range(FRACTIONAL_ROUNDS):
            result = self._solve(whole=False)
            if result.answer is None or not self._cut([result.answer]) or self.control.stopped or self._left() <= 0:
                break
            value = self.sign * self.program.value(result.answer)
            if value - before <= GAINED * max(abs(value), abs(before)):
                break
            before = value
        while True:
            heard = _Heard(self.control)
            result = self._solve(whole=True, heard=heard)
            if result.status not in ("optimal", "feasible", "unknown"):
                return replace(result, answer=None, statistics=self._statistics())
            if result.bound is not None:
                self.bound = result.bound
                self.control.publish(bound=result.bound)
            points = heard.points if result.answer is None else [*heard.points, result.answer]
            for x in points:
                self._keep(x)
            done = result.answer is not None and self._excess(result.answer) <= BROKEN
            if done:
                return self._ended(result, result.answer)
            broken = self._cut(points)
            if result.status != "optimal" and result.limit != "gap":
                return self._ended(result, self.best)
            if not broken:
                return RawResult("error", message="outer approximation came to a point that its rows do not exclude")
            if self._left() <= 0 or self.control.stopped or self._nodes_left() == 0:
                limit = "interrupt" if self.control.stopped else "nodes" if self._nodes_left() == 0 else "time"
                return self._ended(replace(result, limit=limit), self.best)

    def _solve(self, *, whole: bool, heard: Control | None = None) -> RawResult:
        """Solve the program with the rows so far, continuous or ``whole``."""
        linear = replace(self.program, cones=(), rows=(*self.program.rows, *self.rows))
        if not whole:
            linear = replace(linear, variables=tuple(replace(block, integer=False) for block in linear.variables))
        options = replace(
            self.options, time_limit=max(self._left(), 0.0), start=self.start if whole else None,
            iterations=self._nodes_left() if whole else None,
        )  # fmt: skip
        heard = heard or _Heard(self.control)
        result: RawResult = self.within.run(linear, options, heard)
        if result.status == "error" and options.start is not None:  # HiGHS fails on starts that are off by its own tolerance
            self.start = None
            result = self.within.run(linear, replace(options, start=None), heard)
        self.rounds += 1
        self.nodes += int(result.statistics.get("nodes", 0)) if whole else 0
        return result

    def _left(self) -> float:
        return self.end - time.perf_counter()

    def _nodes_left(self) -> int | None:
        return None if self.options.iterations is None else max(0, self.options.iterations - self.nodes)

    # -- points ------------------------------------------------------------------------------------------------------

    def _excess(self, x: Floats) -> float:
        return max(float(cones.excess(x).max(initial=0.0)) for cones in self.program.cones)

    def _keep(self, x: Floats) -> None:
        """Take note of a point, its tips raised to where the cones hold, if it is feasible and the best so far."""
        raised = x.copy()
        for cones, matrix in zip(self.program.cones, self.matrices, strict=True):
            parts = (matrix @ x + cones.offset).reshape(cones.size, cones.width)
            short = np.linalg.norm(parts[:, 1:], axis=1) - parts[:, 0]
            for k in np.nonzero(short > 0.0)[0].tolist():
                row = slice(matrix.indptr[k * cones.width], matrix.indptr[k * cones.width + 1])
                if row.stop - row.start == 1 and matrix.data[row][0] > 0.0:
                    raised[matrix.indices[row]] += short[k] / matrix.data[row]
        value = self.sign * self.program.value(raised)
        if self.program.residual(raised) <= BROKEN and value < self.best_value:
            self.best, self.best_value, self.start = raised, value, raised
            self.control.publish(raised, self.sign * value, self.bound)

    def _cut(self, points: Iterable[Floats]) -> bool:
        """Write the rows that touch the cones where points break them; whether there were any."""
        before = self.cuts
        for x in points:
            for cones, matrix in zip(self.program.cones, self.matrices, strict=True):
                parts = (matrix @ x + cones.offset).reshape(cones.size, cones.width)
                size = np.linalg.norm(parts[:, 1:], axis=1)
                for k in np.nonzero(size - parts[:, 0] > 0.5 * BROKEN)[0].tolist():
                    own = np.arange(cones.size) if cones.size <= TOGETHER else np.array([k])
                    self.rows.append(_touching(cones, matrix, own, parts[k, 1:] / size[k]))
                    self.cuts += len(own)
        return self.cuts > before

    def _ended(self, said: RawResult, x: Floats | None) -> RawResult:
        status = said.status if said.status == "optimal" and said.limit == "none" else "unknown"
        return RawResult(status, said.limit, x, None, self.bound, None, self._statistics(), said.message if x is None else "")

    def _statistics(self) -> dict[str, Any]:
        return {"programs": self.rounds, "rows_added": self.cuts, "nodes": self.nodes}


def _tips(cones: Cones) -> Rows:
    """Rows that keep the first number of each cone from being negative."""
    first = np.arange(cones.size) * cones.width
    parts = [np.arange(cones.indptr[k], cones.indptr[k + 1]) for k in first.tolist()]
    at = np.concatenate([*parts, np.zeros(0, dtype=np.int64)]).astype(np.int64)
    return Rows(
        "tip", indptr=np.cumsum([0, *map(len, parts)]).astype(np.int32), indices=cones.indices[at], data=cones.data[at],
        lower=-cones.offset[first], upper=np.full(cones.size, math.inf),
    )  # fmt: skip


def _touching(cones: Cones, matrix: Any, own: Any, unit: Floats) -> Rows:
    """Rows t - u v >= 0 for cones ``own``, u being ``unit``."""
    import scipy.sparse as sp

    factors = np.concatenate([[1.0], -unit])
    row = np.repeat(np.arange(len(own)), cones.width)
    column = (np.asarray(own)[:, None] * cones.width + np.arange(cones.width)).ravel()
    mix = sp.csr_matrix((np.tile(factors, len(own)), (row, column)), shape=(len(own), matrix.shape[0]))
    touching = (mix @ matrix).tocsr()
    touching.eliminate_zeros()
    return Rows(
        "touching", indptr=touching.indptr.astype(np.int32), indices=touching.indices.astype(np.int32), data=np.asarray(touching.data),
        lower=np.asarray(-(mix @ cones.offset)), upper=np.full(len(own), math.inf),
    )  # fmt: skip
