"""OR-Tools MathOpt: the solvers that come with OR-Tools, as ``mathopt:NAME``."""

from __future__ import annotations

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

from ...formulations.programs.program import INTEGERS, LINEAR, QUADRATIC, Floats, Program, Variables
from ...formulations.programs.scaling import scaled
from ...instances.errors import UnsupportedError, UsageError
from ..backend import BACKENDS, Control, Options, ProgramBackend, RawResult, takers, takes_features
from ..integer_program import Uncountable, integer_program
from ..sanity import prepared, settled

FEASIBLE_TOLERANCE = 1e-5
EQUAL_TOLERANCE = 1e-6
"""Relative difference up to which value and bound are the same."""

FIRST_ORDER_TOLERANCE = 1e-9
"""PDLP's own is 1e-6, relative, which leaves rows broken by more than the checks let pass."""

PROGRAMS = {
    "highs": (INTEGERS,),
    "gscip": (INTEGERS | QUADRATIC,),
    "glop": (LINEAR,),
    "cp-sat": (INTEGERS,),
    "pdlp": (QUADRATIC,),
}
"""What each solver takes. MathOpt hands no quadratic objective to HiGHS, GLOP and CP-SAT."""

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
    modules = ("ortools",)
    summary = "OR-Tools MathOpt: SCIP (nonconvex quadratics too) and GLOP, others as mathopt:NAME"
    interrupts = "mathopt:highs shows no incumbents, and is ended without an answer when it is asked to stop"
    programs = tuple(chain.from_iterable(PROGRAMS.values()))
    variants = tuple(PROGRAMS)

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        chosen = {"scip": "gscip", "cpsat": "cp-sat", "cp_sat": "cp-sat"}.get(variant.lower(), variant.lower())
        if chosen and chosen not in PROGRAMS:
            raise UsageError(f"mathopt has no solver {variant!r}; it has {', '.join(PROGRAMS)}")
        self.solver = chosen
        if chosen:
            self.programs, self.only_integers = PROGRAMS[chosen], chosen == "cp-sat"
        self.needs_process = chosen == "highs"  # it hears no interrupt

    @classmethod
    def takers(cls, features: frozenset[str]) -> tuple[str, ...]:
        return tuple(f"{cls.name}:{s}" for s, programs in PROGRAMS.items() if takes_features(features, programs, s == "cp-sat"))

    def missing(self, program: Program) -> frozenset[str]:
        """See ``ProgramBackend.missing``: MathOpt's CP-SAT takes whole variables only."""
        lacking = super().missing(program)
        try:
            if self.solver == "cp-sat" and not lacking:
                self._whole(scaled(prepared(program)).program)
        except UnsupportedError as fault:
            return frozenset(fault.missing)
        return lacking

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        """See ``ProgramBackend.search``."""
        result = settled(program)
        if result is not None:
            return result
        import ortools.math_opt.python.mathopt  # noqa: F401 - loading it is not counted against the limit

        solver = self.solver or ("glop" if program.features() == LINEAR else "gscip")
        asked = program
        if solver == "cp-sat":
            program = self._whole(program)
            result = settled(program)
            if result is not None:
                return result
        parameters = _parameters(solver, program, options)
        run = _Run(solver, asked, options, control, time.perf_counter() + options.time_limit)
        try:
            return run.conclude(run.solve(program, parameters), parameters)
        except _Endless:
            return RawResult(run.which(parameters))
        except _Refused as fault:
            text = str(fault)
            if "support" in text or "UNIMPLEMENTED" in text or "finite range" in text:
                raise UnsupportedError(self._label, {text}, takers(program.features(), self._label)) from None
            return RawResult("error", message=f"MathOpt ended with an error: {text}")

    @property
    def _label(self) -> str:
        return f"{self.name}:{self.variant}" if self.variant else self.name

    def _whole(self, program: Program) -> Program:
        """The program with integer variables and bounds only: MathOpt's CP-SAT rounds continuous ones without a word."""
        try:
            counted = integer_program(program)
        except Uncountable as fault:
            raise UnsupportedError(self._label, {str(fault)}, takers(program.features(), self._label)) from None
        if not ((counted.unit == 1.0).all() and (counted.shift == np.round(counted.shift)).all()):
            raise UnsupportedError(self._label, {"continuous variables"}, takers(program.features(), self._label))
        low, high = counted.vector(counted.lower), counted.vector(counted.upper)
        return replace(program, variables=(Variables("x", lower=low, upper=high, cost=program.cost, integer=True),))


def _parameters(solver: str, program: Program, options: Options) -> Any:
    """The common options and the solver's own."""
    from ortools.math_opt.python import mathopt

    made = mathopt.SolveParameters()
    if solver == "highs":
        made.highs.int_options["threads"] = int(options.threads)  # the common parameter is refused
    elif solver != "gscip":  # with more than one it races copies of itself, and MathOpt does not know their status
        made.threads = int(options.threads)
    if solver != "pdlp":
        made.random_seed = int(options.seed) % (2**31 - 1)
    # Ctrl-C is Python's to hear: SCIP takes it for itself, and CP-SAT aborts in any thread but its own.
    made.gscip.bool_params["misc/catchctrlc"] = False
    made.cp_sat.catch_sigint_signal = False
    if program.is_integer:
        made.relative_gap_tolerance, made.absolute_gap_tolerance = float(options.gap), 0.0
    if solver == "pdlp":
        precise = made.pdlp.termination_criteria.simple_optimality_criteria
        precise.eps_optimal_absolute = precise.eps_optimal_relative = FIRST_ORDER_TOLERANCE
    if options.iterations is not None:
        if solver == "cp-sat":
            made.cp_sat.max_number_of_conflicts = int(options.iterations)
        elif program.is_integer:
            made.node_limit = int(options.iterations)
        elif solver == "gscip":
            raise UsageError("SCIP has no limit on the iterations of a continuous program; use a time limit")
        else:
            made.iteration_limit = int(options.iterations)
    for name, value in options.extra.items():
        _OWN[solver](made, name, value)
    return made


def _highs_option(parameters: Any, name: str, value: Any) -> None:
    import highspy

    from .highs import OWN_OPTIONS, set_option

    if name in OWN_OPTIONS:
        raise UsageError(f"mathopt:highs: set {OWN_OPTIONS[name]} by its own option, not by {name}")
    converted = set_option(highspy.Highs(), name, value)
    kinds = {bool: "bool_options", int: "int_options", float: "double_options", str: "string_options"}
    getattr(parameters.highs, kinds[type(converted)])[name] = converted


def _scip_option(parameters: Any, name: str, value: Any) -> None:
    """SCIP tells only in the run whether it has a parameter of this name and type."""
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


def _field(message: str) -> Callable[[Any, str, Any], None]:
    def put(parameters: Any, name: str, value: Any) -> None:
        target = getattr(parameters, message)
        known = [f.name for f in target.DESCRIPTOR.fields]
        if name not in known:
            raise UsageError(f"mathopt:{message.replace('_', '-')} has no parameter {name!r}; it has {', '.join(known[:8])}, ...")
        kind = type(getattr(target, name))
        try:
            setattr(target, name, str(value).lower() in ("true", "1", "on") if kind is bool else kind(value))
        except (TypeError, ValueError):
            raise UsageError(f"mathopt: {value!r} is no value for parameter {name}") from None

    return put


_OWN: dict[str, Callable[[Any, str, Any], None]] = {
    "highs": _highs_option, "gscip": _scip_option, "glop": _field("glop"), "cp-sat": _field("cp_sat"), "pdlp": _field("pdlp"),
}  # fmt: skip


class _Run:
    """One search: what MathOpt is told, and what is believed of its answer."""

    def __init__(self, solver: str, program: Program, options: Options, control: Control, end: float) -> None:
        self.solver, self.program, self.options, self.control, self.end = solver, program, options, control, end
        self.best: float | None = None

    def solve(self, program: Program, parameters: Any, *, listen: bool = True) -> Any:
        """MathOpt's result; raises ``_Refused`` with its message where there is none."""
        from ortools.math_opt.python import mathopt
        from ortools.util.python.solve_interrupter import SolveInterrupter

        kind = mathopt.SolverType[self.solver.replace("-", "_").upper()]
        parameters = replace(parameters, time_limit=datetime.timedelta(seconds=max(0.0, self.end - time.perf_counter())))
        model, given = program.to_mathopt(), {}
        if self.options.start is not None and program.is_integer:
            start = np.asarray(self.options.start, dtype=np.float64)
            values = {v: float(a) for v, a in zip(model.variables(), start, strict=True) if math.isfinite(a)}
            given["model_params"] = mathopt.ModelSolveParameters(solution_hints=[mathopt.SolutionHint(variable_values=values)])
        if self.solver != "highs":
            interrupter = SolveInterrupter()
            self.control.on_stop(interrupter.interrupt)
            given["interrupter"] = interrupter
        if self.solver == "gscip":
            _quiet_scip()
        if listen and program.is_integer and self.solver in ("gscip", "cp-sat"):
            events = {mathopt.Event.MIP_SOLUTION, *([mathopt.Event.MIP] if self.solver == "cp-sat" else [])}
            given["callback_reg"] = mathopt.CallbackRegistration(events=events)
            given["cb"] = self._hear
        try:
            return mathopt.solve(model, kind, params=parameters, **given)
        except Exception as fault:  # its own translation of a status fails with an AttributeError
            inner = fault.__context__ if type(fault.__context__).__name__ == "StatusNotOk" else fault
            if inner is fault and not isinstance(fault, ValueError | RuntimeError | mathopt.InternalMathOptError):
                raise
            text = str(inner)
            if "error setting" in text or "SetBoolParam" in text or "Param(scip_" in text:
                raise UsageError(f"mathopt:{self.solver} refuses a parameter: {text}") from None
            raise (_Endless(text) if "Expected no NaN or inf" in text else _Refused(text)) from None

    def _hear(self, data: Any) -> Any:
        """Publish incumbents and bounds."""
        from ortools.math_opt.python import mathopt

        bound = data.mip_stats.dual_bound
        told = float(bound) if math.isfinite(bound) and abs(bound) < 1e20 else None
        if data.solution:
            x = np.zeros(self.program.num_variables)
            x[[v.id for v in data.solution]] = list(data.solution.values())
            value = self.program.value(x)
            sign = 1.0 if self.program.sense == "min" else -1.0
            if (self.best is None or sign * value < sign * self.best) and self.program.residual(x) <= FEASIBLE_TOLERANCE:
                self.best = value
                self.control.publish(x, value, told)
        elif told is not None:
            self.control.publish(bound=told)
        return mathopt.CallbackResult()

    def conclude(self, found: Any, parameters: Any) -> RawResult:
        """What is true of MathOpt's result."""
        program = self.program
        status, limit = REASONS[found.termination.reason.name], self._limit(found)
        if status == "infeasible_or_unbounded":
            status = self.which(parameters)
        answer, objective, bound, duals, message = None, None, None, None, ""
        primal = found.solutions[0].primal_solution if found.solutions else None
        if status in ("optimal", "unknown") and primal is not None and primal.variable_values:
            x = _by_id(primal.variable_values, program.num_variables)
            if program.residual(x) <= FEASIBLE_TOLERANCE:
                answer, objective = x, program.value(x)
        if answer is None and self.control.answer is not None and status == "unknown":
            answer, objective = self.control.answer, program.value(self.control.answer)
        best = float(found.termination.objective_bounds.dual_bound)
        if (program.is_integer or status == "optimal") and math.isfinite(best) and status in ("optimal", "unknown") and abs(best) < 1e20:
            bound = best
        if status == "optimal":
            dual = found.solutions[0].dual_solution if found.solutions else None
            if not program.is_integer and dual is not None and dual.dual_values:
                duals = _by_id(dual.dual_values, program.num_rows)
            if answer is None:
                status, message = "unknown", f"{self.solver} reports an optimum, but its point is not feasible within 1e-5"
            elif bound is None or objective is None or abs(bound - objective) > EQUAL_TOLERANCE * max(1.0, abs(objective)):
                status, limit = "feasible", "gap"
            else:
                limit = "none"
        elif status == "unknown" and answer is not None:
            status = "feasible"
        if status == "unknown" and not message:
            end = {"none": "", "interrupt": " before it was interrupted"}.get(limit, f" within the {limit} limit")
            message = f"{self.solver} found no feasible point{end}"
        if status == "error":
            message = f"{self.solver} ended with an error: {found.termination.detail}"
        if status in ("infeasible", "unbounded", "infeasible_or_unbounded"):
            limit = "none"
        if bound is not None:
            self.control.publish(bound=bound)
        return RawResult(status, limit, answer, objective, bound, duals, self._statistics(found), message)

    def _limit(self, found: Any) -> str:
        reason = found.termination.limit
        if reason is None:
            return "none"
        if reason.name in LIMITS:
            return LIMITS[reason.name]
        if self.control.stopped:  # GLOP and CP-SAT do not tell which limit they met
            return "interrupt"
        if self.options.iterations is not None and time.perf_counter() < self.end:
            return "nodes" if self.program.is_integer else "iterations"
        return "time"

    def which(self, parameters: Any) -> str:
        """Tell infeasible from unbounded: without its objective a program is never unbounded."""
        program = self.program
        bare = replace(program, quadratic=None, variables=tuple(replace(b, cost=np.zeros(b.size)) for b in program.variables))
        again = REASONS[self.solve(bare, parameters, listen=False).termination.reason.name]
        return {"optimal": "unbounded", "infeasible": "infeasible"}.get(again, "infeasible_or_unbounded")

    def _statistics(self, found: Any) -> dict[str, Any]:
        stats = found.solve_stats
        made: dict[str, Any] = {"solver": self.solver}
        if self.program.is_integer:
            made["nodes"] = int(stats.node_count)
        made["iterations"] = int(stats.simplex_iterations + stats.barrier_iterations + stats.first_order_iterations)
        if self.options.start is not None:
            made["start"] = "used" if self.program.is_integer else "ignored"
        return made


def _by_id(values: Any, size: int) -> Floats:
    made = np.zeros(size)
    made[[key.id for key in values]] = list(values.values())
    return made


def _quiet_scip() -> None:
    """Stop SCIP's error printing: MathOpt's event handler makes it print two lines of a fault that has no effect."""
    import ortools

    for library in Path(ortools.__file__).parent.glob(".libs/libscip.so*"):
        printing = ctypes.CDLL(str(library)).SCIPmessageSetErrorPrinting
        printing.argtypes, printing.restype = [ctypes.c_void_p, ctypes.c_void_p], None
        printing(None, None)
