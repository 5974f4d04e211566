"""``solve``: from a problem to an answer with its evidence, whichever solver does the search."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..formulations.certificate import Certificate, better_bound, certify
from ..formulations.evaluation import CHECK_TOLERANCE, Evaluation
from ..formulations.evidence import Evidence, Guarantee
from ..formulations.exactness import Exactness
from ..formulations.forms import FORMS, relaxed
from ..formulations.problem import Problem
from ..formulations.program import Program
from ..formulations.solution import Solution, Value, relative_gap
from ..heuristics.heuristic import HEURISTICS, Outcome, Setting
from ..instances.errors import InputError, MissingPackageError, UnsupportedError, UsageError
from . import claims, interrupts
from .backend import BACKENDS, Backend, Control, Engine, Options, ProgramBackend, RawResult, takers
from .bounding import find_bounds
from .goal import SECONDS, Goal, first_evidence
from .listing import missing_features
from .search import BOUND_OVERTIME, Searched, in_time, search

PREFERENCE = ("pyvrp", "ortools", "highs", "scip", "mathopt", "cpsat", "pulp", "cvxpy")
"""Order in which ``solve`` looks for a solver when none is named: by measured quality on routing files, then by measured speed on the
linear forms of the other families, then those that take nonconvex products whatever the bounds of their variables."""

MOST_THREADS = 1024
"""More is a slip of the keyboard, and some solvers take all memory for it."""

Progress = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class _Run:
    """One search, ready to start: what is searched, and how its raw answers become answers of the problem."""

    name: str
    form: str | None
    exactness: Exactness
    go: Callable[[Control], RawResult]
    decode: Callable[[Any], Any]
    program: Program | None
    versions: dict[str, str]
    compile_seconds: float
    outcome: list[Outcome]
    notes: list[str]
    routes: bool = False


def solve(
    problem: Problem | Program,
    solver: str | None = None,
    *,
    heuristic: str | None = None,
    form: str | None = None,
    relax: bool = False,
    time_limit: float = 60.0,
    bound_time: float | None = None,
    iterations: int | None = None,
    gap: float = 0.0,
    seed: int = 1,
    threads: int = 1,
    start: Any = None,
    progress: Progress | None = None,
    isolate: bool = False,
    memory_limit: float | None = None,
    options: dict[str, Any] | None = None,
    **parameters: Any,
) -> Solution:
    """Solve a problem with a solver or a heuristic, check the answer, and bound it.

    Parameters
    ----------
    problem : Problem or Program
    solver : str, optional
        A name of ``solvers()``; ``pulp:HiGHS`` names a solver within a solver. Without solver and heuristic, the first
        installed one that can take the problem.
    heuristic : str, optional
        A name of ``heuristics()``; its parameters as keywords or in ``options``.
    form : str, optional
        For solvers that take programs; the problem's first form by default.
    relax : bool
        Drop integrality: the optimum is a bound.
    time_limit : float, seconds
        Wall time for the engine alone.
    bound_time : float, seconds, optional
        Budget for bounding after it: a tenth of the limit, at least 1 s, by default; 0 turns it off.
    iterations, gap, seed, threads, memory_limit
        See ``Options``.
    start : answer or Solution, optional
    progress : callable, optional
        Receives ``{"phase", "seconds", "objective", "bound"}`` from a worker thread.
    isolate : bool
        Run the solver in a process of its own, with hard time and memory limits.
    options : dict, optional
        The solver's or heuristic's own options.

    Returns
    -------
    Solution
        Its answer, if any, passed every check. Ctrl-C returns the best one so far.

    Raises
    ------
    UsageError, UnsupportedError, MissingPackageError, InputError
        Before anything is run.
    CheckFailedError
        If a claim of the solver does not hold up.
    """
    if not isinstance(problem, Problem | Program):
        raise UsageError(f"solve takes a problem or a program, not {type(problem).__name__}; read(path) makes a problem of a file")
    _check_number("time_limit", time_limit, above=0)
    _check_number("gap", gap)
    for name, whole, least, most in (
        ("iterations", iterations, 1, None), ("seed", seed, 0, None), ("threads", threads, 1, MOST_THREADS),
    ):  # fmt: skip
        _check_whole(name, whole, least, most)
    if bound_time is not None:
        _check_number("bound_time", bound_time)
    if memory_limit is not None:
        _check_number("memory_limit", memory_limit, above=0)
    if memory_limit is not None and not isolate:
        isolate = True
    if isinstance(start, Solution):
        start = start.answer
    budget = max(1.0, time_limit / 10.0) if bound_time is None else bound_time
    chosen = Options(time_limit, iterations, gap, threads, seed, start, memory_limit, {**(options or {}), **parameters})

    given: Program | None = None
    if isinstance(problem, Program):
        given = problem
        problem = _problem_of(given)
    if heuristic is not None:
        if solver is not None or form is not None or relax:
            raise UsageError("a heuristic takes no solver, form or relaxation")
        run = _heuristic_run(problem, heuristic, chosen)
    else:
        run = _solver_run(problem, given, solver or _default_solver(problem, given, form, relax), form, relax, chosen, isolate)

    control = Control(None if progress is None else lambda event: progress({"phase": "solve", **event}))
    with interrupts.held():  # an answer that is found is judged, whatever signal comes then
        began = time.perf_counter()
        first: list[Evidence] = []
        goal: Goal | None = None
        if run.routes and iterations is None:  # a clock decides when evidence is there, and work limits shall repeat to the bit
            first, goal = first_evidence(problem, min(SECONDS, budget))  # type: ignore[arg-type]
            control.goal = goal
            if goal is not None and goal.infeasible:
                run, budget = replace(run, go=lambda control: RawResult("unknown", message="proved before the search")), 0.0
        spent = time.perf_counter() - began
        searched = search(run.go, control, time_limit)
        if goal is not None and goal.reached and not searched.interrupted:
            searched = replace(searched, result=replace(searched.result, limit="none"))
        return _conclude(problem, run, searched, control, chosen, budget, progress, first, spent)


def _check_number(name: str, value: Any, above: float | None = None) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not (value >= 0 if above is None else value > above):
        raise UsageError(f"{name} must be {'not negative' if above is None else 'positive'}, not {value!r}")


def _check_whole(name: str, value: Any, least: int, most: int | None) -> None:
    if value is None and name == "iterations":
        return
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least or (most is not None and value > most):
        upper = "" if most is None else f" and at most {most}"
        raise UsageError(f"{name} must be a whole number of at least {least}{upper}, not {value!r}")


def _problem_of(program: Program) -> Problem:
    if program.problem is not None:
        return program.problem
    from ..formulations.problems.arrays import ArrayProblem

    return ArrayProblem(program)


def _default_solver(problem: Problem, given: Program | None, form: str | None, relax: bool) -> str:
    """The first installed solver that can take the problem, or the program that is meant."""
    lacking: frozenset[str] = frozenset()
    kind = given.kind if given is not None else FORMS[form].kind(problem) if form is not None else None
    if relax and (kind or "MILP").startswith("MI"):
        kind = "LP"
    for name in [*PREFERENCE, *(n for n in BACKENDS if n not in PREFERENCE)]:
        if name in BACKENDS and BACKENDS[name].installed():
            missing, _ = missing_features(name, problem)
            if kind is not None:
                backend = BACKENDS[name]
                able = issubclass(backend, ProgramBackend) and bool(backend.takers(kind))
                missing = frozenset() if able else frozenset({f"{kind} programs"})
            if not missing:
                return name
            lacking |= missing
    raise UnsupportedError("every installed solver", lacking or {"an installed solver"})


def _backend(name: str) -> Backend:
    base, colon, variant = name.partition(":")
    kind = BACKENDS[base]
    if colon and not variant:
        raise UsageError(f"{name!r} names no solver within {base}; write {base} or {base}:NAME")
    if not kind.installed():
        raise MissingPackageError(f"solver {base} needs the package {kind.package}: pip install {kind.package}")
    return kind(variant) if variant else kind()


def _able(problem: Problem) -> list[str]:
    return [n for n in BACKENDS if BACKENDS[n].installed() and not missing_features(n, problem)[0]]


def _solver_run(
    problem: Problem, given: Program | None, solver: str, form: str | None, relax: bool, options: Options, isolate: bool
) -> _Run:
    backend = _backend(solver)
    versions = {backend.package: backend.version()}
    notes: list[str] = []
    isolate = isolate or backend.needs_process

    if isinstance(backend, Engine):
        if form is not None or relax or given is not None:
            raise UsageError(f"{solver} takes problems as they are: it has no forms and no relaxation")
        missing = backend.missing(problem)
        if missing:
            raise UnsupportedError(solver, missing, _able(problem))
        engine = backend
        go = _isolated(solver, problem, options) if isolate else (lambda control: engine.run(problem, options, control))
        return _Run(solver, None, Exactness.RESTRICTION, go, lambda a: a, None, versions, 0.0, [], notes, engine.family == "routing")

    assert isinstance(backend, ProgramBackend)
    began = time.perf_counter()
    if given is None:
        program = problem.compile(form, relax=relax) if form is not None else _first_program(problem, backend, relax)
    elif form is not None:
        raise UsageError(f"the program is already compiled, as {given.form}")
    else:
        program = relaxed(given) if relax else given
    compiled = time.perf_counter() - began
    if program.kind not in backend.kinds:
        raise UnsupportedError(solver, {f"{program.kind} programs"}, takers(program.kind, solver))
    start = None
    if options.start is not None and program.encode is not None:
        try:
            start = program.encode(options.start)
        except InputError as fault:
            notes.append(f"the start was not used: {fault}")
    hinted = replace(options, start=start)
    runner = backend
    go = _isolated(solver, program, hinted) if isolate else (lambda control: runner.run(program, hinted, control))
    return _Run(solver, program.form, program.exactness, go, program.decode, program, versions, compiled, [], notes)


def _first_program(problem: Problem, backend: ProgramBackend, relax: bool) -> Program:
    """The problem in the best form that the solver takes; in the best of all where there is none, for the error to say so."""
    first: Program | None = None
    for form in problem.forms():
        if relax or FORMS[form].kind(problem) in backend.kinds:
            program = problem.compile(form, relax=relax)
            first = first or program
            if relax or not backend.lacks(program):
                return program
    return first or problem.compile(relax=relax)


def _isolated(solver: str, target: Problem | Program, options: Options) -> Callable[[Control], RawResult]:
    from .isolation import run_isolated

    return lambda control: run_isolated(solver, target, options, control)


def _heuristic_run(problem: Problem, name: str, options: Options) -> _Run:
    method = HEURISTICS[name]
    missing = method.missing(problem)
    if missing:
        raise UnsupportedError(f"heuristic {name}", missing, [h for h in HEURISTICS if not HEURISTICS[h].missing(problem)])
    method.check_parameters(options.extra)
    outcomes: list[Outcome] = []

    def go(control: Control) -> RawResult:
        def solve_program(program: Program, seconds: float) -> RawResult:
            backend = _backend("highs")
            assert isinstance(backend, ProgramBackend)
            return backend.run(program, Options(time_limit=seconds, seed=options.seed), Control())

        setting = Setting(
            rng=np.random.default_rng(options.seed), seconds=options.time_limit, start=options.start,
            publish=lambda answer: control.publish(answer), stopped=lambda: control.stopped, solve_program=solve_program,
        )  # fmt: skip
        outcome = method.run(problem, setting, **options.extra)
        outcomes.append(outcome)
        return RawResult("unknown", answer=outcome.answer, statistics=outcome.statistics, message=outcome.message)

    return _Run(name, None, Exactness.NEITHER, go, lambda a: a, None, {}, 0.0, outcomes, [])


def _conclude(
    problem: Problem,
    run: _Run,
    searched: Searched,
    control: Control,
    options: Options,
    budget: float,
    progress: Progress | None,
    first: list[Evidence],
    spent: float,
) -> Solution:
    """Believe nothing: decode and judge every answer, bound, certify, and only then say how it ended."""
    result = searched.result
    began = time.perf_counter()
    answer, evaluation = _best_answer(problem, run, result, control, options)
    best = None if evaluation is None else evaluation.values[0]
    claims.check_bound(run.name, problem.sense, result, best, run.exactness)
    check_seconds = time.perf_counter() - began

    began = time.perf_counter()
    outcome = run.outcome[0] if run.outcome else None
    evidence = [*first, *(outcome.evidence if outcome is not None else ())]
    if run.program is not None and result.row_duals is not None and run.program.dual_evidence is not None:
        evidence.append(run.program.dual_evidence(result.row_duals))
    evidence.extend(result.evidence)
    known = tuple(evidence)
    if not searched.interrupted and not result.evidence:
        found = search(
            lambda c: RawResult("unknown", answer=find_bounds(problem, budget, target=best, known=known, control=c, progress=progress)),
            Control(),
            budget,
            overtime=BOUND_OVERTIME,
        )
        evidence.extend(found.result.answer or [])
    bound_seconds = spent + time.perf_counter() - began

    began = time.perf_counter()
    guarantee: Guarantee | None = outcome.guarantee if outcome is not None and evaluation is not None else None
    if outcome is not None and guarantee is None:
        run.notes.append(f"{run.name} guarantees nothing for this instance")
    certificate = in_time(
        lambda: certify(problem, evaluation, evidence, guarantee), lambda: _unproved(problem, evaluation, guarantee, run.notes)
    )
    claims.check_verified(run.name, problem.sense, result, certificate.bound, run.exactness)
    check_seconds += time.perf_counter() - began

    bound, kind, source = _best_bound(problem, run, result, certificate)
    objective = None if evaluation is None else evaluation.objective
    if isinstance(objective, list) and bound is not None:
        bound = [bound if isinstance(bound, float) else None, *[None] * (len(objective) - 1)]
    gap = relative_gap(objective, bound)
    status = _status(problem, run, result, certificate, evaluation, bound)
    messages = [m for m in (result.message, *run.notes) if m]
    return Solution(
        problem=problem,
        answer=answer,
        status=status,
        limit=result.limit,
        objective=objective,
        bound=bound,
        bound_kind=kind,
        bound_source=source,
        gap=gap,
        solver=run.name,
        form=run.form,
        seconds={"compile": run.compile_seconds, "solve": searched.seconds, "bound": bound_seconds, "check": check_seconds},
        seed=options.seed,
        versions=_versions(run),
        certificate=certificate,
        evaluation=evaluation,
        statistics=dict(result.statistics),
        message="; ".join(messages),
    )


def _unproved(problem: Problem, evaluation: Evaluation | None, guarantee: Guarantee | None, notes: list[str]) -> Certificate:
    notes.append("interrupted before the evidence of the bounds was verified")
    return certify(problem, evaluation, (), guarantee)


def _best_answer(problem: Problem, run: _Run, result: RawResult, control: Control, options: Options) -> tuple[Any, Evaluation | None]:
    """The best feasible answer among the engine's last word, its published incumbent and the start."""
    candidates: list[tuple[Any, Evaluation]] = []
    if result.answer is not None:
        answer = _decoded(run, result.answer)
        if answer is not None:
            judged = problem.evaluate(answer)
            claims.check_feasibility(run.name, result, judged, run.exactness)
            if judged.feasible and (run.program is None or run.exactness is Exactness.EXACT):
                claims.check_objective(run.name, result, judged)
            candidates.append((answer, judged))
    if control.answer is not None and control.answer is not result.answer:
        answer = _decoded(run, control.answer)
        if answer is not None:
            candidates.append((answer, problem.evaluate(answer)))
    if candidates and not any(judged.feasible for _, judged in candidates):
        run.notes.append(f"the answer of {run.name} breaks: {candidates[0][1].violations[0].message}")
    if options.start is not None:
        judged = problem.evaluate(options.start)
        candidates.append((options.start, judged))
        if not judged.feasible:
            run.notes.append(f"the start is only a hint, for it breaks: {judged.violations[0].message}")
    feasible = [pair for pair in candidates if pair[1].feasible]
    if not feasible:
        return None, None
    signs = [1.0 if sense == "min" else -1.0 for sense in problem.senses]
    return min(feasible, key=lambda pair: tuple(s * v for s, v in zip(signs, pair[1].values, strict=True)))


def _decoded(run: _Run, raw: Any) -> Any:
    try:
        return run.decode(raw)
    except InputError as fault:
        if run.exactness.answer_is_valid:
            raise
        run.notes.append(f"the relaxation's point is no answer: {fault}")
        return None


def _best_bound(problem: Problem, run: _Run, result: RawResult, certificate: Certificate) -> tuple[Value | None, str | None, str | None]:
    """The best known bound of either kind; a verified one wins a tie."""
    verified = certificate.bound
    claimed = result.bound if run.exactness.bound_is_valid and len(problem.senses) == 1 else None
    if claimed is not None and math.isfinite(claimed):
        ahead = verified is None or better_bound(problem.sense, claimed, verified)
        if ahead and (verified is None or abs(claimed - verified) > CHECK_TOLERANCE * max(1.0, abs(claimed))):
            return claimed, "claimed", f"{run.name} ({run.form})" if run.form else run.name
    return (verified, "verified", certificate.bound_source) if verified is not None else (None, None, None)


def _status(
    problem: Problem, run: _Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None, bound: Value | None
) -> str:
    if evaluation is not None:
        if len(evaluation.values) == 1 and isinstance(bound, float):
            value = evaluation.values[0]
            if abs(bound - value) <= CHECK_TOLERANCE * max(1.0, abs(value)):
                return "optimal"
        if result.status == "optimal" and run.exactness is Exactness.EXACT:
            return "optimal"
        return "feasible"
    if certificate.infeasible:
        return "infeasible"
    if result.status in ("infeasible", "infeasible_or_unbounded") and run.exactness.infeasibility_is_valid:
        return result.status
    if result.status == "unbounded" and run.exactness.answer_is_valid:
        return "unbounded"
    return "error" if result.status == "error" else "unknown"


def _versions(run: _Run) -> dict[str, str]:
    from .._version import __version__

    return {"waybound": __version__, "python": platform.python_version(), **run.versions}
