"""Programs from small dense arrays, and who solves them in place of a solver."""

import math
import threading
from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import numpy as np
import scipy.sparse as sp

from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.backends.highs import Highs
from waybound.solvers.linear_programs import LinearPrograms, Suits
from waybound.solvers.program_backend import ProgramBackend

INF = math.inf


def program(
    cost: Any, matrix: Any, low: Any, high: Any, lower: Any = 0.0, upper: Any = INF, *, integer: Sequence[int] = (), sense: str = "min",
    offset: float = 0.0, quadratic: Any = None,
) -> Program:  # fmt: skip
    """A program with a block for each variable."""
    n = len(cost)
    a = matrix if sp.issparse(matrix) else sp.csr_matrix(np.asarray(matrix, dtype=float).reshape(-1, n))
    spread = lambda v, k: np.array(np.broadcast_to(np.asarray(v, dtype=float), k))  # noqa: E731
    low_x, high_x = spread(lower, n), spread(upper, n)
    columns = tuple(
        Variables(f"x{j}", lower=low_x[j : j + 1], upper=high_x[j : j + 1], cost=np.array([float(cost[j])]), integer=j in set(integer))
        for j in range(n)
    )
    rows = Rows("row", indptr=a.indptr, indices=a.indices, data=a.data, lower=spread(low, a.shape[0]), upper=spread(high, a.shape[0]))
    return Program("test", sense, columns, (rows,), offset, None if quadratic is None else sp.csr_matrix(np.asarray(quadratic, float)))


def sane(indices=(0, 1), data=(1.0, 1.0), lower=(0.0, 0.0), upper=(1.0, 1.0), side=(1.0, math.inf)) -> Program:
    """Two columns and a row, of which any part may be another one."""
    x = Variables("x", keys=(np.arange(2),), lower=np.array(lower), upper=np.array(upper), cost=np.ones(2))
    rows = Rows(
        "need", indptr=np.array([0, len(indices)], dtype=np.int32), indices=np.array(indices, dtype=np.int32), data=np.array(data),
        lower=np.array(side[:1]), upper=np.array(side[1:]),
    )  # fmt: skip
    return Program("sane", "min", (x,), (rows,))


class AnsweredBy(LinearPrograms):
    """Linear programs of which a function of program and seconds gives the row duals, or None."""

    def __init__(self, duals: Callable[[Program, float], Any]) -> None:
        super().__init__()
        self.answer = duals

    def solve(self, program: Program, stop: Stop = NEVER, suits: Suits | None = None, *, iterations: int | None = None) -> RawResult:
        return RawResult("unknown", row_duals=self.answer(program, stop.seconds_left))


class Patient(ProgramBackend):
    """Waits until it is asked to stop, or for its time; ``told`` keeps the options that were given to any of this class."""

    name, package, modules, summary = "patient", "numpy", ("json",), "waits"
    told: ClassVar[list[Options]] = []

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        self.told.append(options)
        asked = threading.Event()
        control.on_stop(asked.set)
        return RawResult("unknown", "interrupt" if asked.wait(min(options.time_limit, 30.0)) else "time")


class Counting(Highs):
    """HiGHS under another name; ``told`` keeps the programs and options that were given to any of this class."""

    name = "counting"
    told: ClassVar[list[tuple[Program, Options]]] = []

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        self.told.append((program, options))
        return super().search(program, options, control)
