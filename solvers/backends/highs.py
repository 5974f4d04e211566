"""HiGHS: linear, mixed-integer and convex quadratic programs, arrays straight into the solver."""

import math
import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...formulations.programs.program import INTEGERS, QUADRATIC, Floats, Program
from ...formulations.programs.reductions.linear_products import LINEAR_PRODUCTS
from ...instances.errors import UsageError
from ..backend import BACKENDS, Control, Options, RawResult
from ..own_options import own_options
from ..program_backend import ProgramBackend

LOOK_EVERY = 0.1
"""Seconds between two looks at the dual bound. HiGHS' own logging callback is silent where its output is."""

STATUS_MAP: dict[str, tuple[str, str]] = {
    **dict.fromkeys(("kOptimal", "kModelEmpty"), ("optimal", "none")),
    "kInfeasible": ("infeasible", "none"),
    "kUnbounded": ("unbounded", "none"),
    "kUnboundedOrInfeasible": ("infeasible_or_unbounded", "none"),
    "kTimeLimit": ("unknown", "time"),
    "kIterationLimit": ("unknown", "iterations"),
    "kSolutionLimit": ("unknown", "nodes"),
    "kMemoryLimit": ("unknown", "memory"),
    **dict.fromkeys(("kInterrupt", "kHighsInterrupt"), ("unknown", "interrupt")),
    **dict.fromkeys(("kObjectiveBound", "kObjectiveTarget", "kUnknown"), ("unknown", "none")),
    **dict.fromkeys(("kNotset", "kLoadError", "kModelError", "kPresolveError", "kSolveError", "kPostsolveError"), ("error", "none")),
}
"""HiGHS model status to ours."""

SOUND: dict[str, Any] = {"presolve_rule_off": 4096}
"""Set on every road to HiGHS, and overruled by the user's own options. 4096 is presolve's aggregator: with it, 1.12.0 to 1.15.1 call
feasible programs infeasible and worse answers optimal, tiny ones of ordinary whole numbers too (HiGHS#3090 and its like; docs/claims.md has
the counts, and docs/measurements.md what it costs). ``waybound solvers --examine highs --option presolve_rule_off=0`` shows it."""

SMALL = 5_000
"""Entries up to which integer programs that have a best answer are searched without presolve: it is wrong even with that rule off (once in
9,362 programs; docs/claims.md), and saved a tenth of the time where that was measured (docs/measurements.md)."""

COMMON_OPTIONS = {
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

    name, title = "highs", "HiGHS"
    engine = "HiGHS"
    package = "highspy"
    summary = "HiGHS: LP, MILP and convex QP, arrays straight into the solver"
    options = None
    order = 30
    programs = (INTEGERS, QUADRATIC)
    reductions = (LINEAR_PRODUCTS,)

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        import highspy

        model = program.to_highs()
        _configure(model, program, options)
        _watch(model, program, control)
        # The scheduler keeps the number of threads of the first run in this thread, and refuses another one.
        highspy.Highs.resetGlobalScheduler(True)
        start = None
        if options.start is not None:
            start = "used" if program.is_integer and _start_from(model, options.start) else "ignored"
        model.run()
        return _said(model, program, start)


def _configure(model: Any, program: Program, options: Options) -> None:
    chosen: dict[str, Any] = {
        "output_flag": False,
        "time_limit": float(max(0.0, options.time_limit)),
        "threads": int(options.threads),
        "random_seed": int(options.seed) % (2**31 - 1),
        "mip_rel_gap": float(options.gap),
        "mip_abs_gap": 0.0,  # its own of 1e-6 is in units of the data
        **sound(program, options.extra),
    }
    chosen |= iteration_limits(program, options)
    if program.name in INTERIOR_POINT and not program.is_integer:
        chosen["solver"] = "ipm"
    for name, value in chosen.items():
        model.setOptionValue(name, value)
    for name, value in named_options("highs", options.extra).items():
        model.setOptionValue(name, value)


def iteration_limits(program: Program, options: Options) -> dict[str, int]:
    """The limit of iterations under the names that HiGHS has for it: nodes of a program with integers."""
    limits = ("mip_max_nodes",) if program.is_integer else ("simplex_iteration_limit", "ipm_iteration_limit", "qp_iteration_limit")
    return {} if options.iterations is None else dict.fromkeys(limits, int(options.iterations))


def sound(program: Program, own: Mapping[str, Any]) -> dict[str, Any]:
    """Options that keep HiGHS from false words about ``program``; they give way to the user's ``own``."""
    small = program.is_integer and sum(len(rows.data) for rows in program.rows) <= SMALL
    gain = program.cost if program.sense == "max" else -program.cost
    # Presolve sees that a program has no best answer before any is found.
    ends = np.isfinite(program.upper[gain > 0]).all() and np.isfinite(program.lower[gain < 0]).all()
    return {**SOUND, "presolve": "off"} if small and ends and not SOUND.keys() & own.keys() else SOUND


def named_options(label: str, own: Mapping[str, Any]) -> dict[str, Any]:
    """HiGHS options that the user named, in their types; raises UsageError for one that HiGHS does not have or a value that it does not
    take."""
    if not own:
        return {}
    import highspy

    model = highspy.Highs()
    defaults = model.getOptions()
    known = {name: getattr(defaults, name) for name in dir(defaults) if not name.startswith("_")}
    for name in own:  # some have no attribute
        status, value = model.getOptionValue(name)
        if status == highspy.HighsStatus.kOk:
            known[name] = value
    typed = own_options(label, own, known, COMMON_OPTIONS)
    model.setOptionValue("output_flag", False)
    for name, value in typed.items():
        if model.setOptionValue(name, value) != highspy.HighsStatus.kOk:
            raise UsageError(f"{label}: {value!r} is no value for option {name}", "out-of-range")
    return typed


def _watch(model: Any, program: Program, control: Control) -> None:
    """Publish incumbents and bounds, and pass the wish to stop on."""
    from highspy import cb

    kinds = cb.HighsCallbackType
    improving, interrupt = kinds.kCallbackMipImprovingSolution, kinds.kCallbackMipInterrupt
    next_look = 0.0

    def hear(kind: Any, message: str, out: Any, into: Any, data: Any) -> None:
        nonlocal next_look
        if kind in (improving, interrupt):
            control.count(int(out.mip_node_count))
        if kind == improving:
            control.publish(np.array(out.mip_solution), float(out.objective_function_value))
        elif control.stopped:
            into.user_interrupt = True
        elif kind == interrupt and time.perf_counter() >= next_look:
            next_look = time.perf_counter() + LOOK_EVERY
            bound = float(out.mip_dual_bound)
            control.publish(bound=bound if math.isfinite(bound) else None)

    model.setCallback(hear, None)
    wanted = [kinds.kCallbackSimplexInterrupt, kinds.kCallbackIpmInterrupt, *([improving, interrupt] if program.is_integer else [])]
    for kind in wanted:
        model.startCallback(kind)


def _start_from(model: Any, start: Floats) -> bool:
    """Hand over a start, whose NaN are for HiGHS to complete; whether HiGHS takes it."""
    import highspy

    known = np.nonzero(np.isfinite(start))[0].astype(np.int32)
    return bool(model.setSolution(len(known), known, start[known]) == highspy.HighsStatus.kOk)


def _said(model: Any, program: Program, start: str | None) -> RawResult:
    model_status = model.getModelStatus()
    status, limit = STATUS_MAP[model_status.name]
    info, solution = model.getInfo(), model.getSolution()
    statistics: dict[str, Any] = {
        "simplex_iterations": int(info.simplex_iteration_count),
        "ipm_iterations": int(info.ipm_iteration_count),
    }
    if program.is_integer:
        statistics["nodes"] = int(info.mip_node_count)
    if start is not None:
        statistics["start"] = start
    message = ""
    if status == "error":
        message = f"HiGHS ended with status {model.modelStatusToString(model_status)}"
        if program.quadratic is not None:
            message += "; it minimises convex and maximises concave quadratic objectives only"
    bound = float(info.mip_dual_bound) if program.is_integer and math.isfinite(info.mip_dual_bound) else None
    return RawResult(
        status, limit, np.array(solution.col_value) if info.primal_solution_status == 2 else None, None, bound,
        np.array(solution.row_dual) if solution.dual_valid and not program.is_integer else None, statistics, message,
    )  # fmt: skip
