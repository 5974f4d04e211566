"""The linear programs that bounds, engines and heuristics meet on their way, and the solver that they use."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..formulations.programs.program import LINEAR, Floats, Program
from ..formulations.stop import NEVER, Stop
from ..instances.errors import UnsupportedError
from ..instances.limits import MOST
from .backend import LP_SOLVER, Control, Options, RawResult, solver_named
from .program_backend import ProgramBackend, takers

Suits = Mapping[str, Mapping[str, Any]]
"""Options that suit a program, by solver: ``{"highs": {"solver": "ipm"}}``."""


@dataclass
class LinearPrograms:
    """Solves linear programs, one after the other.

    Parameters
    ----------
    solver : str
        A name of ``solvers()`` that takes linear programs. Bounds need row duals, of which ``mathopt:gscip`` and ``pulp:NAME`` tell none.
    seed, threads : int
    """

    solver: str = LP_SOLVER
    seed: int = 1
    threads: int = 1

    def backend(self) -> ProgramBackend:
        """The solver, ready to run; raises UsageError, MissingPackageError or UnsupportedError where there is none for linear programs."""
        backend = solver_named(self.solver)
        if not (isinstance(backend, ProgramBackend) and backend.able(LINEAR)):
            raise UnsupportedError(self.solver, {"LP programs"}, takers(LINEAR))
        return backend

    def solve(self, program: Program, stop: Stop = NEVER, suits: Suits | None = None, *, iterations: int | None = None) -> RawResult:
        """The solver's result for ``program``, searched until ``stop``.

        ``suits`` and ``iterations`` concern those solvers alone that ``suits`` names: what counts as one is not the same for all.
        """
        backend, program = self.backend(), program.first_level()
        own = (suits or {}).get(self.solver.partition(":")[0])
        options = Options(
            time_limit=min(stop.seconds_left, MOST["time_limit"]), iterations=None if own is None else iterations,
            seed=self.seed, threads=self.threads, extra=dict(own or {}),
        )  # fmt: skip
        control = Control()
        with stop.telling(control.stop):
            if backend.needs_process:
                from .isolation import run_isolated

                return run_isolated(self.solver, program, options, control)
            return backend.run(program, options, control)

    def duals(self, program: Program, stop: Stop = NEVER, suits: Suits | None = None) -> Floats | None:
        """Row duals of shape (rows,); None where the solver finds none in time."""
        if stop.reached():
            return None
        row_duals = self.solve(program, stop, suits).row_duals
        return None if row_duals is None or not np.isfinite(row_duals).all() else row_duals


def linear_programs(solver: str | None, seed: int = 1, threads: int = 1) -> LinearPrograms:
    """Linear programs by the solver that the user names, which is looked up at once, or by the default one, looked up when first needed."""
    if solver is None:
        return LinearPrograms(seed=seed, threads=threads)
    linear = LinearPrograms(solver, seed, threads)
    linear.backend()
    return linear
