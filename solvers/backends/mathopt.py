"""OR-Tools MathOpt: the solvers that come with OR-Tools, as ``mathopt:NAME``."""

import ctypes
import datetime
import math
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from ...formulations.programs.program import INTEGERS, LINEAR, QUADRATIC, Floats, Program
from ...formulations.programs.reductions.linear_products import LINEAR_PRODUCTS
from ...formulations.programs.reductions.reduction import Irreducible, Reduction, Step
from ...formulations.programs.reductions.whole_numbers import WHOLE_VARIABLES
from ...instances.errors import Code, UsageError
from ...instances.suggestions import did_you_mean
from ..backend import BACKENDS, Control, Options, RawResult
from ..own_options import own_options
from ..program_backend import FEASIBLE_TOLERANCE, ProgramBackend
from .highs import named_options, sound

FIRST_ORDER_TOLERANCE = 1e-9
"""PDLP's own is 1e-6, relative, which leaves rows broken by more than the checks let pass."""

PROGRAMS = {
    "highs": (INTEGERS,),
    "gscip": (INTEGERS | QUADRATIC,),
    "glop": (LINEAR,),
    "cp-sat": (INTEGERS,),
    "pdlp": (QUADRATIC,),
}
"""Programs that each solver takes. MathOpt hands no quadratic objective to HiGHS, GLOP and CP-SAT."""

ENGINES = {"highs": "HiGHS", "gscip": "SCIP", "glop": "GLOP", "cp-sat": "CP-SAT", "pdlp": "PDLP"}


class SeparableObjective(Reduction):
    """Changes nothing, and refuses products of two variables."""

    may_refuse = True

    def apply(self, program: Program) -> tuple[Step, ...]:
        if program.quadratic is not None:
            entries = program.quadratic.tocoo()
            if (entries.data[entries.row != entries.col] != 0).any():
                raise Irreducible("products of two variables")
        return ()


REDUCTIONS: dict[str, tuple[Reduction, ...]] = {
    "highs": (LINEAR_PRODUCTS,),
    "cp-sat": (LINEAR_PRODUCTS, WHOLE_VARIABLES),  # it rounds continuous variables without a word
    "pdlp": (SeparableObjective(),),
}

REASONS = {
    "OPTIMAL": "optimal", "INFEASIBLE": "infeasible", "UNBOUNDED": "unbounded", "INFEASIBLE_OR_UNBOUNDED": "infeasible_or_unbounded",
    "IMPRECISE": "unknown", "FEASIBLE": "unknown", "NO_SOLUTION_FOUND": "unknown", "NUMERICAL_ERROR": "error", "OTHER_ERROR": "error",
}  # fmt: skip
"""Why MathOpt ended, as our status before the existence of a feasible point is considered."""

LIMITS = {"TIME": "time", "ITERATION": "iterations", "NODE": "nodes", "MEMORY": "memory", "INTERRUPTED": "interrupt"}


class _Refused(Exception):
    """MathOpt or a solver in it refused the program or a parameter."""


class _Endless(Exception):
    """SCIP found an infinite objective, which MathOpt takes for a fault of its own."""


@BACKENDS.register("mathopt")
class MathOpt(ProgramBackend):
    """OR-Tools MathOpt: HiGHS, SCIP, GLOP, CP-SAT or PDLP; without a name GLOP for linear programs and SCIP for all else.

    ``iterations`` counts nodes (CP-SAT: conflicts) of a mixed-integer program, and iterations of a linear one. Extra options are the
    solver's own parameters by name.
    """

    name = "mathopt"
    package = "ortools"
    summary = "OR-Tools MathOpt: SCIP (nonconvex quadratics too) and GLOP, others as mathopt:NAME"
    options = None
    order = 50
    interrupts = "mathopt:highs shows no incumbents, and is ended without an answer when it is asked to stop"
    programs = tuple(chain.from_iterable(PROGRAMS.values()))
    variants = tuple(PROGRAMS)

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        chosen = {"scip": "gscip", "cpsat": "cp-sat", "cp_sat": "cp-sat"}.get(variant.lower(), variant.lower())
        if chosen and chosen not in PROGRAMS:
            hint = did_you_mean(variant, PROGRAMS)
            raise UsageError(f"mathopt has no solver {variant!r}; it has {', '.join(PROGRAMS)}{hint}", "unknown-name")
        self.solver = chosen
        self.engine = ENGINES.get(chosen, "SCIP")  # without a name it is SCIP that takes programs with integers
        if chosen:
            self.title, self.programs, self.only_integers = chosen, PROGRAMS[chosen], chosen == "cp-sat"
        self.reductions = REDUCTIONS.get(chosen, ())
        self.needs_process = chosen == "highs"  # it hears no interrupt

    @classmethod
    def takers(cls, features: frozenset[str]) -> tuple[str, ...]:
        return tuple(f"{cls.name}:{s}" for s in PROGRAMS if cls(s).able(features))

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        import ortools.math_opt.python.mathopt  # noqa: F401 - loading it is not counted against the limit

        solver = self.solver or ("glop" if program.features() == LINEAR else "gscip")
        parameters = _parameters(solver, program, options)
        run = _Run(solver, program, options, control, time.perf_counter() + options.time_limit)
        try:
            return run.said(run.solve(parameters))
        except _Endless:
            return RawResult("infeasible_or_unbounded")
        except _Refused as fault:
            text = str(fault)
            if any(word in text for word in ("support", "UNIMPLEMENTED", "finite range", "non-diagonal")):
                raise self.refusal({text}, program) from None
            return RawResult("error", message=f"MathOpt ended with an error: {text}")


def _parameters(solver: str, program: Program, options: Options) -> Any:
    """The common options and the solver's own."""
    from ortools.math_opt.python import mathopt

    parameters = mathopt.SolveParameters()
    if solver == "highs":
        # The common parameter for threads is refused.
        _put_highs(parameters, {"threads": int(options.threads), **sound(program, options.extra)})
    elif solver != "gscip":  # with more than one it races copies of itself, and MathOpt does not know their status
        parameters.threads = int(options.threads)
    if solver != "pdlp":
        parameters.random_seed = int(options.seed) % (2**31 - 1)
    # Ctrl-C is Python's to hear: SCIP takes it for itself, and CP-SAT aborts in any thread but its own.
    parameters.gscip.bool_params["misc/catchctrlc"] = False
    parameters.cp_sat.catch_sigint_signal = False
    if program.is_integer:
        parameters.relative_gap_tolerance, parameters.absolute_gap_tolerance = float(options.gap), 0.0
    if solver == "pdlp":
        precise = parameters.pdlp.termination_criteria.simple_optimality_criteria
        precise.eps_optimal_absolute = precise.eps_optimal_relative = FIRST_ORDER_TOLERANCE
    if options.iterations is not None:
        if solver == "cp-sat":
            parameters.cp_sat.max_number_of_conflicts = int(options.iterations)
        elif program.is_integer:
            parameters.node_limit = int(options.iterations)
        elif solver == "gscip":
            raise UsageError("SCIP has no limit on the iterations of a continuous program; use a time limit", "unsupported")
        else:
            parameters.iteration_limit = int(options.iterations)
    _OWN[solver](parameters, options.extra)
    return parameters


def _highs_options(parameters: Any, own: dict[str, Any]) -> None:
    _put_highs(parameters, named_options("mathopt:highs", own))


def _put_highs(parameters: Any, chosen: dict[str, Any]) -> None:
    kinds = {bool: "bool_options", int: "int_options", float: "double_options", str: "string_options"}
    for name, value in chosen.items():
        getattr(parameters.highs, kinds[type(value)])[name] = value


def _scip_parameters(parameters: Any, own: dict[str, Any]) -> None:
    """Set SCIP's own parameters, in the type of their text: SCIP says only in the run whether it has them."""
    for name, value in own.items():
        text = str(value)
        if text.lower() in ("true", "false"):
            parameters.gscip.bool_params[name] = text.lower() == "true"
        elif text.lstrip("+-").isdigit():
            parameters.gscip.int_params[name] = int(text)
        else:
            try:
                parameters.gscip.real_params[name] = float(text)
            except ValueError:
                parameters.gscip.string_params[name] = text


def _fields(message: str) -> Callable[[Any, dict[str, Any]], None]:
    def put(parameters: Any, own: dict[str, Any]) -> None:
        target, label = getattr(parameters, message), f"mathopt:{message.replace('_', '-')}"
        known = {f.name: getattr(target, f.name) for f in target.DESCRIPTOR.fields}
        for name, value in own_options(label, own, known, word="parameter").items():
            try:
                setattr(target, name, value)
            except (TypeError, ValueError, AttributeError):
                raise UsageError(f"{label}: {value!r} is no value for parameter {name}", "out-of-range") from None

    return put


_OWN: dict[str, Callable[[Any, dict[str, Any]], None]] = {
    "highs": _highs_options, "gscip": _scip_parameters, "glop": _fields("glop"), "cp-sat": _fields("cp_sat"), "pdlp": _fields("pdlp"),
}  # fmt: skip


class _Run:
    """A search: how MathOpt is asked, and what is believed of its answer."""

    def __init__(self, solver: str, program: Program, options: Options, control: Control, end: float) -> None:
        self.solver, self.program, self.options, self.control, self.end = solver, program, options, control, end
        self.best: float | None = None

    def solve(self, parameters: Any) -> Any:
        """MathOpt's result; raises ``_Refused`` with its message where there is none."""
        from ortools.math_opt.python import mathopt
        from ortools.util.python.solve_interrupter import SolveInterrupter

        program = self.program
        kind = mathopt.SolverType[self.solver.replace("-", "_").upper()]
        parameters = replace(parameters, time_limit=datetime.timedelta(seconds=max(0.0, self.end - time.perf_counter())))
        model, arguments = program.to_mathopt(), {}
        if self.options.start is not None and program.is_integer:
            values = {v: float(a) for v, a in zip(model.variables(), self.options.start, strict=True) if math.isfinite(a)}
            arguments["model_params"] = mathopt.ModelSolveParameters(solution_hints=[mathopt.SolutionHint(variable_values=values)])
        if self.solver != "highs":
            interrupter = SolveInterrupter()
            self.control.on_stop(interrupter.interrupt)
            arguments["interrupter"] = interrupter
        if self.solver == "gscip":
            _quiet_scip()
        if program.is_integer and self.solver in ("gscip", "cp-sat"):
            events = {mathopt.Event.MIP_SOLUTION, *([mathopt.Event.MIP] if self.solver == "cp-sat" else [])}
            arguments["callback_reg"] = mathopt.CallbackRegistration(events=events)
            arguments["cb"] = self._hear
        try:
            return mathopt.solve(model, kind, params=parameters, **arguments)
        except Exception as fault:  # its own translation of a status fails with an AttributeError
            inner = fault.__context__ if type(fault.__context__).__name__ == "StatusNotOk" else fault
            if inner is fault and not isinstance(fault, ValueError | RuntimeError | mathopt.InternalMathOptError):
                raise
            text = str(inner)
            if "error setting" in text or "SetBoolParam" in text or "Param(scip_" in text:
                code: Code = "unknown-name" if "error code -12 " in text else "out-of-range" if "error code -14 " in text else "malformed"
                raise UsageError(f"mathopt:{self.solver} refuses a parameter: {text}", code) from None
            raise (_Endless(text) if "Expected no NaN or inf" in text else _Refused(text)) from None

    def _hear(self, data: Any) -> Any:
        """Publish incumbents and bounds."""
        from ortools.math_opt.python import mathopt

        if data.mip_stats.explored_nodes > 0:  # CP-SAT tells none
            self.control.count(int(data.mip_stats.explored_nodes))
        bound = data.mip_stats.dual_bound
        finite_bound = float(bound) if math.isfinite(bound) and abs(bound) < 1e20 else None
        if data.solution:
            x = np.zeros(self.program.num_variables)
            x[[v.id for v in data.solution]] = list(data.solution.values())
            value = self.program.value(x)
            sign = 1.0 if self.program.sense == "min" else -1.0
            if (self.best is None or sign * value < sign * self.best) and self.program.residual(x) <= FEASIBLE_TOLERANCE:
                self.best = value
                self.control.publish(x, value, finite_bound)
        elif finite_bound is not None:
            self.control.publish(bound=finite_bound)
        return mathopt.CallbackResult()

    def said(self, result: Any) -> RawResult:
        """MathOpt's last word."""
        program = self.program
        status, limit = REASONS[result.termination.reason.name], self._limit(result)
        first = result.solutions[0] if result.solutions else None
        primal, dual = (None, None) if first is None else (first.primal_solution, first.dual_solution)
        x = _by_id(primal.variable_values, program.num_variables) if primal is not None and primal.variable_values else None
        best = float(result.termination.objective_bounds.dual_bound)
        bounded = (program.is_integer or status == "optimal") and math.isfinite(best) and abs(best) < 1e20
        duals = None
        if status == "optimal" and not program.is_integer and dual is not None and dual.dual_values:
            duals = _by_id(dual.dual_values, program.num_rows)
        message = f"{self.solver} ended with an error: {result.termination.detail}" if status == "error" else ""
        return RawResult(status, limit, x, None, best if bounded else None, duals, self._statistics(result), message)

    def _limit(self, result: Any) -> str:
        reason = result.termination.limit
        if reason is None:
            return "none"
        if reason.name in LIMITS:
            return LIMITS[reason.name]
        if self.control.stopped:  # GLOP and CP-SAT do not tell which limit they met
            return "interrupt"
        if self.options.iterations is not None and time.perf_counter() < self.end:
            return "iterations"
        return "time"

    def _statistics(self, result: Any) -> dict[str, Any]:
        stats = result.solve_stats
        statistics: dict[str, Any] = {"solver": self.solver}
        if self.program.is_integer:
            statistics["nodes"] = int(stats.node_count)
        statistics["iterations"] = int(stats.simplex_iterations + stats.barrier_iterations + stats.first_order_iterations)
        if self.options.start is not None:
            statistics["start"] = "used" if self.program.is_integer else "ignored"
        return statistics


def _by_id(values: Any, size: int) -> Floats:
    array = np.zeros(size)
    array[[key.id for key in values]] = list(values.values())
    return array


def _quiet_scip() -> None:
    """Stop SCIP's error printing: MathOpt's event handler makes it print two lines of a fault that has no effect."""
    import ortools

    for library in Path(ortools.__file__).parent.glob(".libs/libscip.so*"):
        printing = ctypes.CDLL(str(library)).SCIPmessageSetErrorPrinting
        printing.argtypes, printing.restype = [ctypes.c_void_p, ctypes.c_void_p], None
        printing(None, None)
