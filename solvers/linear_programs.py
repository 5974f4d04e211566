"""Linear programs that bounds, engines and heuristics meet on their way, and who solves them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..formulations.programs.program import Floats, Program
from ..formulations.stop import NEVER, Stop
from .backend import Control, Options, ProgramBackend, RawResult, solver_named
from .isolation import run_isolated

LP_SOLVER = "highs"
"""Who solves them where the user names nobody: exact vertices, interior points and first-order steps by one library, interruptible."""

Suits = Mapping[str, Mapping[str, Any]]
"""Options that suit a program, by solver: ``{"highs": {"solver": "ipm"}}``."""


@dataclass
class LinearPrograms:
    """Solves one after the other.

    Parameters
    ----------
    solver : str
        A name of ``solvers()`` that takes programs and returns row duals.
    seed, threads : int
    """

    solver: str = LP_SOLVER
    seed: int = 1
    threads: int = 1

    def solve(self, program: Program, stop: Stop = NEVER, suits: Suits | None = None, *, iterations: int | None = None) -> RawResult:
        """What the solver says of ``program`` until ``stop``, or after so many iterations; its own options in ``suits`` are used."""
        backend = solver_named(self.solver)
        assert isinstance(backend, ProgramBackend)
        own = dict((suits or {}).get(self.solver.partition(":")[0], {}))
        options = Options(time_limit=stop.seconds_left, iterations=iterations, seed=self.seed, threads=self.threads, extra=own)
        control = Control()
        with stop.telling(control.stop):
            if backend.needs_process:
                return run_isolated(self.solver, program, options, control)
            return backend.run(program, options, control)

    def duals(self, program: Program, stop: Stop = NEVER, suits: Suits | None = None) -> Floats | None:
        """Row duals of shape (rows,); None where the solver finds none in time."""
        if stop.reached():
            return None
        found = self.solve(program, stop, suits).row_duals
        return None if found is None or not np.isfinite(found).all() else found
