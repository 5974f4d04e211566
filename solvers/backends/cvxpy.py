"""CVXPY: Clarabel by default, HiGHS for integer programs, SCS or ECOS by name, as ``cvxpy:NAME``."""

import time
import warnings
from itertools import chain
from typing import Any

from ...formulations.programs.program import CONES, INTEGERS, QUADRATIC, Program
from ...formulations.programs.reductions.linear_products import LINEAR_PRODUCTS
from ...formulations.programs.reductions.one_sided_rows import ONE_SIDED_ROWS
from ...instances.errors import MissingPackageError, UsageError
from ...instances.suggestions import did_you_mean
from ..backend import BACKENDS, Control, Options, RawResult
from ..own_options import own_options
from ..packages import is_installed
from ..program_backend import ProgramBackend
from .highs import iteration_limits, named_options, sound

PRECISION = 1e-9
"""Asked of first-order and interior-point solvers, whose own of 1e-5 to 1e-8 leaves rows broken by more than the checks let pass."""

PROGRAMS = {
    "CLARABEL": (QUADRATIC | CONES,),
    "SCS": (QUADRATIC | CONES,),
    "ECOS": (CONES,),
    "HIGHS": (INTEGERS,),
}
"""Programs that each solver takes. HiGHS would take quadratic objectives, but CVXPY 1.9 hands over others, of another optimum."""


LIBRARIES = {"CLARABEL": "clarabel", "SCS": "scs", "ECOS": "ecos", "HIGHS": "highspy"}
"""Distributions that bring them, and their modules; CVXPY itself brings all but ECOS."""


@BACKENDS.register("cvxpy")
class CVXPY(ProgramBackend):
    """CVXPY (Diamond & Boyd 2016) over Clarabel, SCS, ECOS or HiGHS; without a name Clarabel, and HiGHS where variables are whole.

    CVXPY's status is not believed: a limit without a point leaves zeros behind under a status that means that there is one. Values
    count once they meet every row. ``iterations`` counts those of the solver, or nodes for an integer program. Extra options are the
    solver's own.
    """

    name, title = "cvxpy", "CVXPY's solver"
    package = "cvxpy"
    summary = "CVXPY: Clarabel for linear, quadratic and cone programs; SCS, ECOS or HiGHS as cvxpy:NAME"
    options = None
    order = 80
    interrupts = "shows no incumbents, and is ended without an answer when it is asked to stop"
    programs = tuple(chain.from_iterable(PROGRAMS.values()))
    reductions = (LINEAR_PRODUCTS, ONE_SIDED_ROWS)
    needs_process = True
    variants = tuple(PROGRAMS)

    def __init__(self, variant: str = "") -> None:
        super().__init__(variant)
        self.solver = variant.upper()
        self.engine = {"CLARABEL": "Clarabel", "SCS": "SCS", "ECOS": "ECOS"}.get(self.solver, "HiGHS")  # or where there are integers
        if self.solver and self.solver not in PROGRAMS:
            hint = did_you_mean(variant, PROGRAMS)
            raise UsageError(f"waybound uses {', '.join(PROGRAMS)} through CVXPY, not {variant!r}{hint}", "unknown-name")
        if self.solver:
            self.programs, self.library = PROGRAMS[self.solver], LIBRARIES[self.solver]

    @classmethod
    def available(cls) -> tuple[str, ...]:
        return (cls.name, *(f"{cls.name}:{solver}" for solver in solvers_found()))

    @classmethod
    def takers(cls, features: frozenset[str]) -> tuple[str, ...]:
        return tuple(f"{cls.name}:{solver}" for solver in solvers_found() if cls(solver).able(features))

    def search(self, program: Program, options: Options, control: Control) -> RawResult:
        import cvxpy

        solver = self.solver or ("HIGHS" if program.is_integer else "CLARABEL")
        known = cvxpy.installed_solvers()
        if solver not in known:
            raise MissingPackageError(f"CVXPY does not find {solver}: pip install {LIBRARIES[solver]}; found: {', '.join(known)}")
        began = time.perf_counter()
        chosen = _chosen_options(solver, program, options)
        try:
            model = _solved(program, solver, chosen, began + options.time_limit)
        except cvxpy.error.DCPError:
            return RawResult("error", message="CVXPY minimises convex and maximises concave quadratic objectives only")
        except cvxpy.error.SolverError as fault:
            return _without_model(str(fault), options, time.perf_counter() - began)
        return _said(model, program, options, solver, time.perf_counter() - began)


def solvers_found() -> tuple[str, ...]:
    """Solvers of ``PROGRAMS`` whose library is installed."""
    return tuple(solver for solver, library in LIBRARIES.items() if is_installed(library))


def _solved(program: Program, solver: str, chosen: dict[str, Any], end: float) -> Any:
    from ...formulations.programs.export.cvxpy import to_cvxpy

    model = to_cvxpy(program)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # "solution may be inaccurate": judged here
        limit = {"SCS": "time_limit_secs", "ECOS": None}.get(solver, "time_limit")  # ECOS has none: its process is ended
        model.solve(solver=solver, **chosen, **({limit: max(1e-3, end - time.perf_counter())} if limit else {}))
    return model


# -- options, in each solver's words --------------------------------------------------------------------------------

PRECISIONS = {
    "CLARABEL": ("tol_gap_abs", "tol_gap_rel", "tol_feas"), "SCS": ("eps_abs", "eps_rel"), "ECOS": ("abstol", "reltol", "feastol"),
}  # fmt: skip
"""Options of each solver that are set to ``PRECISION``."""

MOST_ITERATIONS = {"CLARABEL": ("max_iter", None), "SCS": ("max_iters", 10_000_000), "ECOS": ("max_iters", 1_000)}
"""Name of each solver's limit of iterations, and its default; None leaves the solver's own."""

KNOWN = {
    "SCS": {
        "use_indirect": False, "normalize": True, "scale": 0.1, "adaptive_scale": True, "rho_x": 1e-6, "alpha": 1.5, "eps_abs": 1e-4,
        "eps_rel": 1e-4, "eps_infeas": 1e-7, "acceleration_lookback": 10, "acceleration_interval": 10,
    },
    "ECOS": {"abstol": 1e-8, "reltol": 1e-8, "feastol": 1e-8, "abstol_inacc": 5e-5, "reltol_inacc": 5e-5, "feastol_inacc": 1e-4},
}  # fmt: skip
"""Options of solvers that do not list them, with their defaults."""

COMMON = {
    "CLARABEL": {"time_limit": "the time limit", "max_iter": "the iterations", "max_threads": "the threads", "verbose": "the verbosity"},
    "SCS": {"time_limit_secs": "the time limit", "max_iters": "the iterations", "verbose": "the verbosity"},
    "ECOS": {"max_iters": "the iterations", "verbose": "the verbosity"},
}
"""Options of each solver that have a name common to all solvers."""


def _chosen_options(solver: str, program: Program, options: Options) -> dict[str, Any]:
    """The common options and the solver's own, by the names that the solver has for them."""
    if solver == "HIGHS":
        return _highs_options(program, options)
    chosen: dict[str, Any] = dict.fromkeys(PRECISIONS[solver], PRECISION)
    name, default = MOST_ITERATIONS[solver]
    if options.iterations is not None or default is not None:
        chosen[name] = int(options.iterations or default or 0)
    known: dict[str, Any] = KNOWN.get(solver, {})
    if solver == "CLARABEL":
        import clarabel

        chosen["max_threads"], settings = int(options.threads), clarabel.DefaultSettings()
        known = {n: getattr(settings, n) for n in dir(settings) if not n.startswith("_")}
    return {**chosen, **own_options(f"cvxpy:{solver}", options.extra, known, COMMON[solver])}


def _highs_options(program: Program, options: Options) -> dict[str, Any]:
    import highspy

    highspy.Highs.resetGlobalScheduler(True)  # it keeps the number of threads of the first run, and refuses another one
    chosen: dict[str, Any] = {"threads": int(options.threads), "random_seed": int(options.seed) % (2**31 - 1)}
    if program.is_integer:
        chosen["mip_rel_gap"], chosen["mip_abs_gap"] = float(options.gap), 0.0
    chosen |= iteration_limits(program, options)
    return {**chosen, **sound(program, options.extra), **named_options("cvxpy:HIGHS", options.extra)}


# -- what is believed -----------------------------------------------------------------------------------------------


def _said(model: Any, program: Program, options: Options, solver: str, seconds: float) -> RawResult:
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
        late, counted = seconds >= 0.98 * options.time_limit, options.iterations is not None or said == "user_limit"
        limit = "time" if late else "iterations" if counted else "none"
    if program.is_integer and info is not None and abs(info.mip_dual_bound) < 1e30:
        sign = 1.0 if program.sense == "min" else -1.0
        bound = sign * float(info.mip_dual_bound) + program.offset
        statistics["nodes"] = int(info.mip_node_count)
    if said == "optimal" and not program.is_integer and not program.cones:
        duals = row_duals_of(program, model)
    return RawResult("optimal" if said == "optimal" else "unknown", limit, vector_of(program, model), None, bound, duals, statistics)


def _without_model(said: str, options: Options, seconds: float) -> RawResult:
    """Meaning of an exception: CVXPY raises one for every end that leaves no values."""
    if seconds >= 0.98 * options.time_limit:
        return RawResult("unknown", "time", message="CVXPY's solver found no feasible point within the time limit")
    if options.iterations is not None:
        return RawResult("unknown", "iterations", message="CVXPY's solver found no feasible point within the iterations limit")
    return RawResult("error", message=f"CVXPY failed: {' '.join(said.split())}")
