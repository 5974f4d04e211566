"""HiGHS: linear, mixed-integer and convex quadratic programs, arrays straight into the solver."""

from __future__ import annotations

import difflib
import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ...formulations.programs.program import INTEGERS, QUADRATIC, Floats, Program
from ...instances.errors import UsageError
from ..backend import BACKENDS, Control, Options, ProgramBackend, RawResult
from ..sanity import settled

FEASIBLE_TOLERANCE = 1e-5
"""Residual up to which a point that HiGHS calls feasible, by 1e-6, is handed on; ``solve`` judges it in the problem's words."""

EQUAL_TOLERANCE = 1e-6
"""Relative difference up to which value and bound are the same."""

LOOK_EVERY = 0.1
"""Seconds between two looks at the dual bound. HiGHS' own logging callback is silent where its output is."""

STATUS_MAP: dict[str, tuple[str, str]] = {
    "kOptimal": ("optimal", "none"),
    "kModelEmpty": ("optimal", "none"),
    "kInfeasible": ("infeasible", "none"),
    "kUnbounded": ("unbounded", "none"),
    "kUnboundedOrInfeasible": ("infeasible_or_unbounded", "none"),
    "kTimeLimit": ("unknown", "time"),
    "kIterationLimit": ("unknown", "iterations"),
    "kSolutionLimit": ("unknown", "nodes"),
    "kMemoryLimit": ("unknown", "memory"),
    "kInterrupt": ("unknown", "interrupt"),
    "kHighsInterrupt": ("unknown", "interrupt"),
    "kObjectiveBound": ("unknown", "none"),
    "kObjectiveTarget": ("unknown", "none"),
    "kUnknown": ("unknown", "none"),
    "kNotset": ("error", "none"),
    "kLoadError": ("error", "none"),
    "kModelError": ("error", "none"),
    "kPresolveError": ("error", "none"),
    "kSolveError": ("error", "none"),
    "kPostsolveError": ("error", "none"),
}
"""HiGHS model status to ours, before the existence of a feasible point is considered."""

OWN_OPTIONS = {
    "time_limit": "the time limit",
    "mip_rel_gap": "the gap",
    "threads": "the threads",
    "random_seed": "the seed",
    "mip_max_nodes": "the iterations",
    "simplex_iteration_limit": "the iterations",
    "ipm_iteration_limit": "the iterations",
    "output_flag": "the verbosity",
    "log_to_console": "the verbosity",
}
"""HiGHS options that have a name common to all solvers."""


INTERIOR_POINT = ("max-min", "facility-location", "strong-linearisation", "weak-linearisation")
"""Forms on whose linear programs the interior point is faster than simplex: 0.4 s against 7.8 s at 10,000 actions of ``max-min``, 0.75 s
against 8 s at 1000 sets and 2000 items of ``facility-location``, 0.7 s against a time-out at 5000 and 5000. Crossover took a tenth of it at
most, and without it small programs came back with duals of no use. For linear programs alone: some versions of HiGHS drop integrality
where a solver for them is named."""


@BACKENDS.register("highs")
class Highs(ProgramBackend):
    """HiGHS (Huangfu & Hall 2018): dual simplex, interior point, branch and cut, active-set QP.

    ``iterations`` counts simplex, interior-point or QP iterations for a continuous program, and nodes for a mixed-integer one. Extra
    options are HiGHS' own by name.
    """

    name = "highs"
    package = "highspy"
    modules = ("highspy",)
    summary = "HiGHS: LP, MILP and convex QP, arrays straight into the solver"
    programs = (INTEGERS, QUADRATIC)

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        """See ``ProgramBackend.search``."""
        result = settled(program)
        if result is not None:
            return result
        import highspy

        model = program.to_highs()
        _configure(model, program, options)
        started = time.perf_counter()
        _watch(model, program, control)
        # The scheduler keeps the number of threads of the first run in this thread, and refuses another one.
        highspy.Highs.resetGlobalScheduler(True)
        use = options.start is not None and program.is_integer and _start_from(model, np.asarray(options.start, dtype=np.float64))
        model.run()
        status = model.getModelStatus().name
        if status == "kUnboundedOrInfeasible":
            status = _which(model, program, options.time_limit - (time.perf_counter() - started))
        result = _result(model, program, options, control, status)
        if options.start is None:
            return result
        return replace(result, statistics={**result.statistics, "start": "used" if use else "ignored"})


def _configure(model: Any, program: Program, options: Options) -> None:
    chosen: dict[str, Any] = {
        "output_flag": False,
        "time_limit": float(max(0.0, options.time_limit)),
        "threads": int(options.threads),
        "random_seed": int(options.seed) % (2**31 - 1),
        "mip_rel_gap": float(options.gap),
        "mip_abs_gap": 0.0,  # its own of 1e-6 is in units of the data
    }
    if options.iterations is not None:
        limits = ("mip_max_nodes",) if program.is_integer else ("simplex_iteration_limit", "ipm_iteration_limit", "qp_iteration_limit")
        chosen.update(dict.fromkeys(limits, int(options.iterations)))
    if program.name in INTERIOR_POINT and not program.is_integer:
        chosen["solver"] = "ipm"
    for name, value in chosen.items():
        model.setOptionValue(name, value)
    for name, value in options.extra.items():
        if name in OWN_OPTIONS:
            raise UsageError(f"highs: set {OWN_OPTIONS[name]} by its own option, not by {name}")
        set_option(model, name, value)


def set_option(model: Any, name: str, value: Any) -> Any:
    """Set an option of a ``highspy.Highs`` that the user named; returns the value in the option's type.

    Raises
    ------
    UsageError
        If HiGHS has no such option, naming close ones, or does not take the value.
    """
    import highspy

    status, kind = model.getOptionType(name)
    if status != highspy.HighsStatus.kOk:
        known = [o for o in dir(model.getOptions()) if not o.startswith("_")]
        close = difflib.get_close_matches(name, known, n=3)
        raise UsageError(f"highs has no option {name!r}" + (f"; close: {', '.join(close)}" if close else ""))
    try:
        converted = _CONVERT[kind.name](value)
    except (KeyError, ValueError):
        raise UsageError(f"highs: option {name} takes a {kind.name[1:].lower()}, not {value!r}") from None
    if model.setOptionValue(name, converted) != highspy.HighsStatus.kOk:
        raise UsageError(f"highs: {value!r} is no value for option {name}")
    return converted


def _truth(value: Any) -> bool:
    return {"true": True, "false": False, "on": True, "off": False, "1": True, "0": False}[str(value).lower()]


_CONVERT: dict[str, Callable[[Any], Any]] = {
    "kBool": _truth, "kInt": lambda v: int(str(v)), "kDouble": float, "kString": str,
}  # fmt: skip


def _watch(model: Any, program: Program, control: Control) -> None:
    """Publish incumbents and bounds, and pass the wish to stop on."""
    from highspy import cb

    kinds = cb.HighsCallbackType
    improving, interrupt = kinds.kCallbackMipImprovingSolution, kinds.kCallbackMipInterrupt
    told, next_look = math.nan, 0.0

    def hear(kind: Any, message: str, out: Any, into: Any, data: Any) -> None:
        nonlocal told, next_look
        if kind == improving:
            control.publish(np.array(out.mip_solution), float(out.objective_function_value))
        elif control.stopped:
            into.user_interrupt = True
        elif kind == interrupt and time.perf_counter() >= next_look:
            next_look = time.perf_counter() + LOOK_EVERY
            bound = float(out.mip_dual_bound)
            if math.isfinite(bound) and bound != told:
                told = bound
                control.publish(bound=bound)

    model.setCallback(hear, None)
    wanted = [kinds.kCallbackSimplexInterrupt, kinds.kCallbackIpmInterrupt, *([improving, interrupt] if program.is_integer else [])]
    for kind in wanted:
        model.startCallback(kind)


def _start_from(model: Any, start: Floats) -> bool:
    """Hand over a start, whose NaN are left for HiGHS to complete; whether HiGHS takes it."""
    import highspy

    known = np.nonzero(np.isfinite(start))[0].astype(np.int32)
    return bool(model.setSolution(len(known), known, start[known]) == highspy.HighsStatus.kOk)


def _which(model: Any, program: Program, seconds: float) -> str:
    """Tell infeasible from unbounded: without its objective a program is never unbounded."""
    n = program.num_variables
    if seconds <= 0:
        return "kUnboundedOrInfeasible"
    model.changeColsCost(n, np.arange(n, dtype=np.int32), np.zeros(n))
    model.setOptionValue("time_limit", model.getRunTime() + seconds)
    model.run()
    return {"kOptimal": "kUnbounded", "kInfeasible": "kInfeasible"}.get(model.getModelStatus().name, "kUnboundedOrInfeasible")


def _result(model: Any, program: Program, options: Options, control: Control, found: str) -> RawResult:
    status, limit = STATUS_MAP[found]
    info = model.getInfo()
    statistics: dict[str, Any] = {
        "simplex_iterations": int(info.simplex_iteration_count),
        "ipm_iterations": int(info.ipm_iteration_count),
    }
    answer = objective = bound = duals = None
    message = ""
    if program.is_integer:
        statistics["nodes"] = int(info.mip_node_count)
    if status in ("optimal", "unknown"):
        solution = model.getSolution()
        x = np.array(solution.col_value)
        if info.primal_solution_status == 2 and program.residual(x) <= FEASIBLE_TOLERANCE:
            answer, objective = x, program.value(x)
        elif control.answer is not None:
            answer, objective = control.answer, program.value(control.answer)
        if not program.is_integer and solution.dual_valid:
            duals = np.array(solution.row_dual)
        if program.is_integer and math.isfinite(info.mip_dual_bound):
            bound = float(info.mip_dual_bound)
    if status == "optimal":
        if answer is None:
            status, message = "unknown", "HiGHS reports an optimum, but its point is not feasible within 1e-5"
        elif not program.is_integer:
            bound = objective
        elif bound is None or objective is None or abs(bound - objective) > EQUAL_TOLERANCE * max(1.0, abs(objective)):
            status, limit = "feasible", "gap"
    elif status == "unknown" and answer is not None:
        status = "feasible"
    if status == "error":
        message = f"HiGHS ended with status {model.modelStatusToString(model.getModelStatus())}"
        if program.quadratic is not None:
            message += "; it minimises convex and maximises concave quadratic objectives only"
    elif status == "unknown" and not message:
        end = {"none": "", "interrupt": " before it was interrupted"}.get(limit, f" within the {limit} limit")
        message = f"HiGHS found no feasible point{end}"
    if limit == "iterations" and program.is_integer:
        limit = "nodes"
    return RawResult(status, limit, answer, objective, bound, duals, statistics, message)
