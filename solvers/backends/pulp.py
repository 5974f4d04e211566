"""PuLP: CBC by default, or any other solver that PuLP finds, as ``pulp:NAME``."""

import inspect
import time
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.programs.program import INTEGERS, Program
from ...formulations.programs.reductions.linear_products import LINEAR_PRODUCTS
from ...formulations.programs.reductions.minimisation import MINIMISATION
from ...formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS
from ...formulations.programs.reductions.reduction import Reduction
from ...instances.errors import MissingPackageError, UsageError
from ...instances.suggestions import did_you_mean
from ..backend import BACKENDS, Control, Options, RawResult
from ..children import scratch
from ..own_options import own_options
from ..program_backend import FEASIBLE_TOLERANCE, ProgramBackend
from .cbc import find_cbc, run_cbc
from .highs import named_options, sound


@BACKENDS.register("pulp")
class PuLP(ProgramBackend):
    """CBC (Forrest & Lougee-Heimer 2005) through PuLP, or another solver that PuLP finds.

    CBC reads the program as MPS and is driven directly, because PuLP's own account of it is not to be trusted: it says ``Optimal`` for
    whatever incumbent a limit left behind, and drops the bound. The truth is in CBC's log. ``iterations`` counts nodes of a mixed-integer
    program and iterations of a linear one. Extra options are CBC's own parameters by name (``cuts=off``), or the keywords of PuLP's class
    for ``NAME``.
    """

    name = "pulp"
    package = "pulp"
    summary = "PuLP: CBC by default, any solver that PuLP finds as pulp:NAME"
    options = None
    order = 70
    interrupts = "CBC shows no incumbents, and hands over its best one when it is asked to stop; pulp:NAME is ended without an answer"
    programs = (INTEGERS,)
    reductions: tuple[Reduction, ...] = (LINEAR_PRODUCTS,)
    variants = ("CBC", "HiGHS", "GLPK_CMD", "SCIP_CMD", "GUROBI", "CPLEX_PY")

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        self.needs_process = not self.is_cbc  # they hear no wish to stop
        if not self.is_cbc:
            self.honours = self.honours - {"iterations"}
        self.library = "highspy" if variant == "HiGHS" else None
        self.engine = "CBC" if self.is_cbc else variant
        self.title = "CBC" if self.is_cbc else f"{variant} through PuLP"
        self.reductions = (*self.reductions, MINIMISATION if self.is_cbc else ONE_SIDED_ROWS)

    @classmethod
    def available(cls) -> tuple[str, ...]:
        installed = _found()
        return (cls.name, *(f"{cls.name}:{variant}" for variant in cls.variants if variant in installed))

    @property
    def is_cbc(self) -> bool:
        """True if CBC is to solve the program."""
        return self.variant.upper() in ("", "CBC", "PULP_CBC_CMD", "COIN_CMD")

    def converted(self, options: Options) -> Options:
        """See ``Backend.converted``; a solver that PuLP does not know or find is refused whatever the program."""
        if not self.is_cbc:
            import pulp

            if self.variant not in pulp.listSolvers():
                hint = did_you_mean(self.variant, pulp.listSolvers())
                raise UsageError(f"PuLP knows no solver {self.variant!r}; it knows {', '.join(pulp.listSolvers())}{hint}", "unknown-name")
            if self.variant not in _found():
                raise MissingPackageError(f"PuLP does not find {self.variant} on this machine; found: {', '.join(_found())}")
        return super().converted(options)

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        if self.is_cbc:
            began, cbc = time.perf_counter(), find_cbc()
            with scratch() as folder:
                # Its preprocessing loses optima, 2 of 1,000 of the battery's programs; without it some runs crash.
                result = run_cbc(cbc, program, options, control, folder, preprocess=not program.is_integer)
                seconds = options.time_limit - (time.perf_counter() - began)
                if result.status == "error" and program.is_integer and seconds > 0 and not control.stopped:
                    result = run_cbc(cbc, program, replace(options, time_limit=seconds), control, folder)
            return result
        return _through_pulp(self._solver(program, options), self.title, program, options)

    def _solver(self, program: Program, options: Options) -> Any:
        """PuLP's solver object for ``variant``, with the common options that it has."""
        import pulp

        common = {"msg": False, "timeLimit": options.time_limit, "gapRel": options.gap, "threads": options.threads}
        known = inspect.signature(_class(self.variant)).parameters
        extra = dict(options.extra)
        if self.variant == "HiGHS":
            import highspy

            # Its scheduler keeps the number of threads of the first run in this thread, and refuses another one.
            highspy.Highs.resetGlobalScheduler(True)
            extra = {"random_seed": options.seed % (2**31 - 1), **sound(program, extra), **named_options(self.label, extra)}
        elif not any(p.kind is inspect.Parameter.VAR_KEYWORD for p in known.values()):
            extra = own_options(self.label, extra, dict.fromkeys(known))
        chosen = {name: value for name, value in common.items() if name in known}
        return pulp.getSolver(self.variant, **chosen, **extra)


def _class(name: str) -> Any:
    import pulp

    return getattr(pulp.apis, name)


def _found() -> list[str]:
    import pulp

    return [str(n) for n in pulp.listSolvers(onlyAvailable=True)]


def _through_pulp(solver: Any, name: str, program: Program, options: Options) -> RawResult:
    """Solve with one of PuLP's own interfaces; its word is taken only where it can be right."""
    import pulp
    from pulp import constants

    began = time.perf_counter()
    try:
        status, solution_status, x = _one_run(solver, program)
    except pulp.PulpSolverError as fault:
        return RawResult("error", message=f"{name} failed: {fault}")
    late = time.perf_counter() - began >= 0.98 * options.time_limit
    said = f"{constants.LpStatus[status]}, {constants.LpSolution[solution_status]}"
    limit = "time" if late else "none"
    if solution_status in (constants.LpSolutionOptimal, constants.LpSolutionIntegerFeasible) and program.residual(x) <= FEASIBLE_TOLERANCE:
        proven = solution_status == constants.LpSolutionOptimal and not late
        if proven and options.gap > 0 and program.is_integer:
            proven, limit = False, "gap"
        bound = program.value(x) if proven else None
        return RawResult("optimal" if proven else "feasible", limit, x, None, bound, statistics={"said": said})
    # Interfaces call programs infeasible that are infeasible or unbounded.
    settles = {constants.LpStatusInfeasible: "infeasible_or_unbounded", constants.LpStatusUnbounded: "unbounded"}
    if status in settles and not late:
        return RawResult(settles[status], statistics={"said": said})
    return RawResult("unknown", limit, statistics={"said": said}, message=f"{name} says: {said}")


def _one_run(solver: Any, program: Program) -> tuple[int, int, NDArray[np.float64]]:
    """PuLP's two statuses and the values it leaves behind, NaN where it leaves none."""
    model = program.to_pulp()
    model.solve(solver)
    x = np.full(program.num_variables, np.nan)
    for variable in model.variables():
        if variable.name != "__dummy" and variable.varValue is not None:
            x[int(variable.name[1:])] = variable.varValue
    return int(model.status), int(model.sol_status), x
