"""CVXPY: Clarabel by default, HiGHS for integer programs, or any other solver that CVXPY finds, as ``cvxpy:NAME``."""

from __future__ import annotations

import time
import warnings
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np

from ...formulations.programs.program import CONES, INTEGERS, QUADRATIC, Program
from ...instances.errors import MissingPackageError, UsageError
from ..backend import BACKENDS, Control, Options, ProgramBackend, RawResult, takes_features
from ..sanity import settled
from .highs import EQUAL_TOLERANCE, OWN_OPTIONS, set_option

FEASIBLE_TOLERANCE = 1e-5
"""Residual up to which values that a solver leaves in CVXPY's variables are taken for a point."""

PRECISION = 1e-9
"""Asked of first-order and interior-point solvers, whose own of 1e-5 to 1e-8 leaves rows broken by more than the checks let pass."""

PROGRAMS = {
    "CLARABEL": (QUADRATIC | CONES,),
    "SCS": (QUADRATIC | CONES,),
    "HIGHS": (INTEGERS, QUADRATIC),
}


@BACKENDS.register("cvxpy")
class CVXPY(ProgramBackend):
    """CVXPY (Diamond & Boyd 2016) over Clarabel, SCS or HiGHS; without a name Clarabel, and HiGHS where variables are whole.

    CVXPY's status is not believed: a limit without a point leaves zeros behind under a status that means that there is one. Values
    count once they meet every row. ``iterations`` counts those of the solver, or nodes for an integer program. Extra options are the
    solver's own.
    """

    name = "cvxpy"
    package = "cvxpy"
    modules = ("cvxpy",)
    summary = "CVXPY: Clarabel for linear, quadratic and cone programs; SCS or HiGHS as cvxpy:NAME"
    interrupts = "shows no incumbents, and is ended without an answer when it is asked to stop"
    programs = tuple(chain.from_iterable(PROGRAMS.values()))
    needs_process = True
    variants = tuple(PROGRAMS)

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        self.solver = variant.upper()
        if self.solver and self.solver not in PROGRAMS:
            raise UsageError(f"waybound uses {', '.join(PROGRAMS)} through CVXPY, not {variant!r}")
        if self.solver:
            self.programs = PROGRAMS[self.solver]

    @classmethod
    def takers(cls, features: frozenset[str]) -> tuple[str, ...]:
        return tuple(f"{cls.name}:{solver}" for solver, programs in PROGRAMS.items() if takes_features(features, programs))

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        """See ``ProgramBackend.search``."""
        result = settled(program)
        if result is not None:
            return result
        import cvxpy

        solver = self.solver or ("HIGHS" if program.is_integer else "CLARABEL")
        if solver not in cvxpy.installed_solvers():
            raise MissingPackageError(f"CVXPY does not find {solver}; found: {', '.join(cvxpy.installed_solvers())}")
        began = time.perf_counter()
        chosen = _CHOSEN[solver](program, options)
        try:
            model = _solved(program, solver, chosen, began + options.time_limit)
        except cvxpy.error.DCPError:
            return RawResult("error", message="CVXPY minimises convex and maximises concave quadratic objectives only")
        except cvxpy.error.SolverError as fault:
            return _without_model(str(fault), options, time.perf_counter() - began)
        result = _result(model, program, options, solver, time.perf_counter() - began)
        if result.status == "infeasible_or_unbounded" and time.perf_counter() - began < options.time_limit:
            result = replace(result, status=_which(program, solver, chosen, began + options.time_limit))
        return result


def _solved(program: Program, solver: str, chosen: dict[str, Any], end: float) -> Any:
    from ...formulations.programs.export.cvxpy import to_cvxpy

    model = to_cvxpy(program)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # "solution may be inaccurate": judged here
        limit = {"SCS": "time_limit_secs"}.get(solver, "time_limit")
        model.solve(solver=solver, **chosen, **{limit: max(1e-3, end - time.perf_counter())})
    return model


def _which(program: Program, solver: str, chosen: dict[str, Any], end: float) -> str:
    """Tell infeasible from unbounded: without its objective a program is never unbounded."""
    bare = replace(program, quadratic=None, variables=tuple(replace(b, cost=np.zeros(b.size)) for b in program.variables))
    status = _solved(bare, solver, chosen, end).status
    return {"optimal": "unbounded", "infeasible": "infeasible"}.get(status, "infeasible_or_unbounded")


# -- options, in each solver's words --------------------------------------------------------------------------------


def _clarabel(program: Program, options: Options) -> dict[str, Any]:
    import clarabel

    made: dict[str, Any] = {
        "max_threads": int(options.threads), "tol_gap_abs": PRECISION, "tol_gap_rel": PRECISION, "tol_feas": PRECISION,
    }  # fmt: skip
    if options.iterations is not None:
        made["max_iter"] = int(options.iterations)
    known = {n: getattr(clarabel.DefaultSettings(), n) for n in dir(clarabel.DefaultSettings()) if not n.startswith("_")}
    own = {"time_limit": "the time limit", "max_iter": "the iterations", "max_threads": "the threads", "verbose": "the verbosity"}
    return {**made, **_converted("CLARABEL", options.extra, known, own)}


def _scs(program: Program, options: Options) -> dict[str, Any]:
    made: dict[str, Any] = {"eps_abs": PRECISION, "eps_rel": PRECISION, "max_iters": int(options.iterations or 10_000_000)}
    known = {
        "use_indirect": False, "normalize": True, "scale": 0.1, "adaptive_scale": True, "rho_x": 1e-6, "alpha": 1.5, "eps_abs": 1e-4,
        "eps_rel": 1e-4, "eps_infeas": 1e-7, "acceleration_lookback": 10, "acceleration_interval": 10,
    }  # fmt: skip
    own = {"time_limit_secs": "the time limit", "max_iters": "the iterations", "verbose": "the verbosity"}
    return {**made, **_converted("SCS", options.extra, known, own)}


def _highs(program: Program, options: Options) -> dict[str, Any]:
    import highspy

    highspy.Highs.resetGlobalScheduler(True)  # it keeps the number of threads of the first run, and refuses another one
    made: dict[str, Any] = {"threads": int(options.threads), "random_seed": int(options.seed) % (2**31 - 1)}
    if program.is_integer:
        made["mip_rel_gap"], made["mip_abs_gap"] = float(options.gap), 0.0
    if options.iterations is not None:
        limits = ("mip_max_nodes",) if program.is_integer else ("simplex_iteration_limit", "ipm_iteration_limit", "qp_iteration_limit")
        made.update(dict.fromkeys(limits, int(options.iterations)))
    for name, value in options.extra.items():
        if name in OWN_OPTIONS:
            raise UsageError(f"cvxpy:HIGHS: set {OWN_OPTIONS[name]} by its own option, not by {name}")
        made[name] = set_option(highspy.Highs(), name, value)
    return made


def _converted(solver: str, extra: dict[str, Any], known: dict[str, Any], own: dict[str, str]) -> dict[str, Any]:
    made = {}
    for name, value in extra.items():
        if name in own:
            raise UsageError(f"cvxpy:{solver}: set {own[name]} by its own option, not by {name}")
        if name not in known:
            raise UsageError(f"cvxpy:{solver} has no option {name!r}; it has {', '.join(sorted(known))}")
        kind = type(known[name])
        try:
            made[name] = str(value).lower() in ("true", "1", "on") if kind is bool else kind(value)
        except (TypeError, ValueError):
            raise UsageError(f"cvxpy:{solver}: {value!r} is no value for option {name}") from None
    return made


_CHOSEN = {"CLARABEL": _clarabel, "SCS": _scs, "HIGHS": _highs}


# -- what is believed -----------------------------------------------------------------------------------------------


def _result(model: Any, program: Program, options: Options, solver: str, seconds: float) -> RawResult:
    from ...formulations.programs.export.cvxpy import row_duals_of, vector_of

    said = str(model.status)
    stats = model.solver_stats
    info = getattr(stats, "extra_stats", None)
    statistics: dict[str, Any] = {"solver": solver, "said": said}
    if stats is not None and stats.num_iters is not None:
        statistics["iterations"] = int(stats.num_iters)
    if options.start is not None:
        statistics["start"] = "ignored"
    if said in ("infeasible", "unbounded", "infeasible_or_unbounded"):
        # Clarabel and SCS call a program unbounded whose dual is infeasible: it may have no point at all.
        return RawResult("infeasible" if said == "infeasible" else "infeasible_or_unbounded", statistics=statistics)
    limit, bound, duals = "none", None, None
    if said not in ("optimal", "solver_error"):  # SCS calls what it has at its limit inaccurate
        late = seconds >= 0.98 * options.time_limit
        limit = "time" if late or options.iterations is None else "nodes" if program.is_integer else "iterations"
    if program.is_integer and info is not None and abs(info.mip_dual_bound) < 1e30:
        sign = 1.0 if program.sense == "min" else -1.0
        bound = sign * float(info.mip_dual_bound) + program.offset
        statistics["nodes"] = int(info.mip_node_count)
    x = vector_of(program, model)
    if x is None or program.residual(x) > FEASIBLE_TOLERANCE:
        end = f" within the {limit} limit" if limit != "none" else f": CVXPY says {said}"
        return RawResult("unknown", limit, None, None, bound, None, statistics, f"{solver} through CVXPY found no feasible point{end}")
    objective = program.value(x)
    if said == "optimal" and not program.is_integer:
        duals = None if program.cones else row_duals_of(program, model)
        return RawResult("optimal", "none", x, objective, objective, duals, statistics)
    if said == "optimal" and (bound is None or abs(bound - objective) <= EQUAL_TOLERANCE * max(1.0, abs(objective))):
        return RawResult("optimal", "none", x, objective, bound, None, statistics)
    return RawResult("feasible", "gap" if said == "optimal" else limit, x, objective, bound, None, statistics)


def _without_model(said: str, options: Options, seconds: float) -> RawResult:
    """What an exception means: CVXPY raises one for every end that leaves no values."""
    if seconds >= 0.98 * options.time_limit:
        return RawResult("unknown", "time", message="CVXPY's solver found no feasible point within the time limit")
    if options.iterations is not None:
        return RawResult("unknown", "iterations", message="CVXPY's solver found no feasible point within the iterations limit")
    return RawResult("error", message=f"CVXPY failed: {' '.join(said.split())}")
