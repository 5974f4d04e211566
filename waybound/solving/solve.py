"""``solve``: from a problem to an answer with its evidence, whichever solver does the search."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from ..formulations.arrays.problem import ArrayProblem
from ..formulations.certificate import Certificate, better_bound, certify, judged_only
from ..formulations.evaluation import Evaluation
from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import Program
from ..formulations.solution import Solution, Value, relative_gap
from ..formulations.tolerance import EQUAL, same
from ..heuristics.heuristic import HEURISTICS, HeuristicWork
from ..instances.errors import CheckFailedError, InputError, UnsupportedError, UsageError, WayboundError, in_words
from ..instances.limits import check_number, check_whole
from ..solvers import interrupts
from ..solvers.backend import BACKENDS, Control, Engine, Options, RawResult, solver_named
from ..solvers.isolation import SolverWork, run_in_process
from ..solvers.linear_programs import LinearPrograms, linear_programs
from ..solvers.program_backend import EQUAL_TOLERANCE, ProgramBackend
from . import claims
from .answers import start_given
from .beside import Beside, BoundWork, free_core
from .bounding import find_bounds, proved
from .choice import able_solvers, default_solver, first_compiled
from .goal import SECONDS, Goal, first_evidence
from .judging import Judge
from .levels import bounds_of_levels, further_levels
from .opening import LARGEST, opened, opening_heuristic
from .opinions import claimed, opinion, refuting, second_opinions, unproved
from .recording import Progress, Recorder, pricing
from .search import BOUND_OVERTIME, Searched, in_time, search
from .showing import Log, shown


@dataclass(frozen=True)
class _Run:
    """One search, ready to start: what is searched, and how its raw answers become answers of the problem.

    ``made`` is what a program backend is given; engines and heuristics take problems, and say for what their claims hold. ``bounds`` tells
    whether the search finds bounds of its own.
    """

    name: str
    go: Callable[[Control], RawResult]
    versions: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    made: Compiled | None = None
    compile_seconds: float = 0.0
    bounds: bool = True
    heuristic: bool = False
    isolated: bool = False
    opening: str | None = None

    @property
    def form(self) -> str | None:
        return None if self.made is None else self.made.form

    def exactness(self, result: RawResult) -> Exactness:
        """How the search's points and claims relate to the problem's."""
        if self.heuristic:
            return Exactness.NEITHER
        return result.holds if self.made is None else self.made.exactness.then(result.holds)

    def decode(self, raw: Any) -> Any:
        return raw if self.made is None else self.made.decode(raw)


def solve(
    problem: Problem | Compiled | Program,
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
    log: Log = None,
    isolate: bool = False,
    memory_limit: float | None = None,
    no_improvement: int | None = None,
    lp_solver: str | None = None,
    options: dict[str, Any] | None = None,
    **parameters: Any,
) -> Solution:
    """Solve a problem with a solver or a heuristic, check the answer, and bound it.

    Parameters
    ----------
    problem : Problem, Compiled or Program
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
        Budget for bounding after it, or beside it on a free core, and then for second opinions on what was claimed: a tenth of the limit,
        at least 1 s, by default; 0 turns it off.
    iterations, gap, seed, threads, memory_limit, no_improvement
        See ``Options``. What the solver or heuristic does not keep to is refused by name.
    start : answer, Solution, mapping or path, optional
        What to start from: an answer of the problem, or a list that says one (routing: routes as lists of site indices or ids); a
        ``Solution``; the JSON of either; a solution file.
    progress : callable, optional
        Receives ``{"phase", "seconds", "objective", "bound", "bound_kind", "found_by", "nodes"}`` from a worker thread, the best known of
        each, and the nodes of branch and bound where the solver tells them.
    log : bool, path or SearchLog, optional
        True shows a line per improvement and per few seconds, and at the end what was proved: in the cell of a notebook, else on standard
        error. A path writes it to a file. ``Solution.history`` has the figures in any case.
    lp_solver : str, optional
        Who solves the linear programs that bounds, engines and heuristics meet on their way: a name of ``solvers()``, by default HiGHS.
    isolate : bool
        Run the solver in a process of its own, with hard time and memory limits.
    options : dict, optional
        The solver's or heuristic's own options.

    Returns
    -------
    Solution
        Its answer, if any, passed every check. Ctrl-C returns the best one so far. Where a claim of the solver, or a bound, contradicts
        that answer, ``faults`` says so, and nothing that the solver claims is believed.

    Raises
    ------
    UsageError, UnsupportedError, MissingPackageError, InputError
        Before anything is run.
    CheckFailedError
        If a claim of the solver does not hold up, and there is no answer to hand over.
    """
    if not isinstance(problem, Problem | Compiled | Program):
        raise UsageError(f"solve takes a problem or a program, not {type(problem).__name__}; read(path) makes a problem of a file")
    check_number("time_limit", time_limit, above=0)
    check_number("gap", gap)
    check_whole("seed", seed)
    check_whole("threads", threads, least=1)
    if iterations is not None:
        check_whole("iterations", iterations, least=1)
    if no_improvement is not None:
        check_whole("no_improvement", no_improvement, least=1)
    if bound_time is not None:
        check_number("bound_time", bound_time)
    if memory_limit is not None:
        check_number("memory_limit", memory_limit, above=0)
    isolate = isolate or memory_limit is not None
    budget = max(1.0, time_limit / 10.0) if bound_time is None else bound_time
    given: Compiled | None = None
    if isinstance(problem, Program):
        problem = ArrayProblem(problem)
        given = problem.compile()
    elif isinstance(problem, Compiled):
        given, problem = problem, problem.problem
    start, told = start_given(problem, start)
    linear = linear_programs(lp_solver, seed, threads)
    chosen = Options(
        time_limit, iterations, gap, threads, seed, start, memory_limit, no_improvement, linear.solver, {**(options or {}), **parameters}
    )  # fmt: skip

    if heuristic is not None:
        if solver is not None or form is not None or relax:
            raise UsageError("a heuristic takes no solver, form or relaxation")
        run = _heuristic_run(problem, heuristic, chosen, isolate)
    elif solver is None and form is None and not relax and given is None:
        run = _default_run(problem, chosen, isolate)
    else:
        solver = solver or default_solver(problem, None if given is None else given.program, form, relax)
        run = _solver_run(problem, given, solver, form, relax, chosen, isolate)

    run.notes.extend(told)
    listeners: list[Progress] = [] if progress is None else [progress]
    with shown(log) as written:
        if written is not None:
            listeners.append(written)
            written.begin(problem, _claimant(run), _limits_told(chosen, budget))
        record = Recorder(problem, listeners)
        made = _answered(problem, run, chosen, budget, linear, record, isolate)
        made = replace(made, events=record.end(made))
        if written is not None:
            written.end(made)
    return made


def _answered(
    problem: Problem, run: _Run, options: Options, budget: float, linear: LinearPrograms, record: Recorder, isolate: bool
) -> Solution:
    """Search, with bounds before it and beside it where the search has none of its own, and conclude."""
    exactness = Exactness.EXACT if run.made is None else run.made.exactness
    hear = record.of_search(run.name, answers=exactness.answer_is_valid, bounds=exactness.bound_is_valid and not run.heuristic)
    control = Control(hear if run.made is not None or len(problem.senses) == 1 else lambda event: hear({**event, **priced()}))
    priced = pricing(problem, control)
    crash: Exception | None = None
    with interrupts.held():  # an answer that is found is judged, whatever signal comes then
        before = 0.0
        if run.opening is not None:
            run, options, before = _opened(problem, run, options, isolate)
        began = time.perf_counter()
        first: list[Evidence] = []
        goal: Goal | None = None
        beside: Beside | None = None
        if not run.bounds and options.iterations is None:  # a clock decides when evidence is there, and work limits shall repeat to the bit
            if budget > 0:
                record.begin_phase("bound", min(SECONDS, budget))
            first, goal = first_evidence(problem, min(SECONDS, budget), linear, options.gap)
            if goal is not None and first:
                record.of_bounds(goal.told())
            control.goal = goal
            if goal is not None and goal.infeasible:
                run, budget = replace(run, go=lambda control: RawResult("unknown", message="proved before the search")), 0.0
            elif goal is not None and budget > SECONDS and free_core(options.threads):
                beside = Beside(BoundWork(problem, budget, tuple(first), linear), goal, control, record.of_bounds)
        spent = time.perf_counter() - began
        if goal is None or not goal.infeasible:
            record.begin_phase("solve", options.time_limit)
        try:
            searched = search(run.go, control, options.time_limit)
        except WayboundError:
            raise
        except Exception as fault:  # of the engine, before it published an answer; the start may be one
            crash = fault
            message = f"the engine failed: {in_words(fault)}"
            searched = Searched(RawResult("error", message=message), False, time.perf_counter() - control.started)
        if goal is not None and (goal.reached or goal.infeasible) and not searched.interrupted:
            searched = replace(searched, result=replace(searched.result, limit=goal.limit))
        try:
            made = _conclude(problem, run, searched, control, options, budget, record, crash, first, beside)
        finally:
            if beside is not None:
                beside.stop()
        made.seconds["bound"] += spent
        made.seconds["solve"] += before
        return made


def _default_run(problem: Problem, options: Options, isolate: bool) -> _Run:
    """Where the user names no method: what is run, begun by a heuristic that opens the problem where there is one."""
    opening = opening_heuristic(problem, options)
    try:
        solver = default_solver(problem, None, None, False)
    except (UnsupportedError, UsageError):  # none takes it, or through inexact forms alone
        if opening is None:
            raise
        return _heuristic_run(problem, opening, options, isolate)
    if opening is not None and BACKENDS[solver].takes != "problem" and problem.size > LARGEST and not options.asked():
        return _heuristic_run(problem, opening, options, isolate)
    run = _solver_run(problem, None, solver, None, False, options, isolate)
    return run if opening is None or run.made is None else replace(run, opening=opening)


def _opened(problem: Problem, run: _Run, options: Options, isolate: bool) -> tuple[_Run, Options, float]:
    """A run that goes on from the answer of the heuristic that opens the problem, in the time that is left, and the seconds it took."""
    assert run.opening is not None
    later, seconds, said = opened(problem, run.opening, options, isolate)
    made = _solver_run(problem, run.made, run.name, None, False, later, isolate)
    found = f"{run.name} started from the answer of {run.opening}"
    made.notes.extend([*run.notes, found if later.start is not None else f"{run.opening} found no start: {said or 'no answer'}"])
    return replace(made, compile_seconds=run.compile_seconds), later, seconds


def _limits_told(options: Options, budget: float) -> str:
    """What a search was asked to keep to, for people."""
    asked = [f"{name.replace('_', ' ')} {value:g}" for name, value in options.asked().items()]
    parts = [f"time limit {options.time_limit:g} s", f"bound time {budget:g} s", *asked, f"seed {options.seed}"]
    return ", ".join([*parts, f"{options.threads} thread{'s' if options.threads != 1 else ''}"])


def _solver_run(
    problem: Problem, given: Compiled | None, solver: str, form: str | None, relax: bool, options: Options, isolate: bool
) -> _Run:
    backend = solver_named(solver)
    options = backend.converted(options)
    versions = {backend.package: backend.version()}
    notes: list[str] = []
    isolate = isolate or (backend.apart(problem) if isinstance(backend, Engine) else backend.needs_process)

    if isinstance(backend, Engine):
        if form is not None or relax or given is not None:
            raise UsageError(f"{solver} takes problems as they are: it has no forms and no relaxation")
        missing = backend.missing(problem)
        if missing:
            raise UnsupportedError(solver, missing, able_solvers(problem))
        _refuse_ignored(solver, backend.honours, options)
        if backend.one_thread and options.threads > 1:
            notes.append(f"{solver} searches on one thread")
        return _Run(solver, _going(solver, problem, options, isolate), versions, notes, bounds=backend.bounds_itself)

    assert isinstance(backend, ProgramBackend)
    began = time.perf_counter()
    if given is None:
        made = problem.compile(form, relax=relax) if form is not None else first_compiled(problem, backend, relax)
    elif form is not None:
        raise UsageError(f"the program is already compiled, as {given.form}")
    else:
        made = given.relaxed() if relax else given
    compiled = time.perf_counter() - began
    lacking = backend.lacking(made.program)
    if lacking:
        raise backend.refusal(lacking, made.program)
    _refuse_ignored(solver, backend.honours, options)
    start = None
    if options.start is not None and made.encode is not None:
        try:
            start = made.encode(options.start)
        except InputError as fault:
            notes.append(f"the start was not used: {fault}")
    hinted = replace(options, start=start)
    return _Run(solver, _going(solver, made.program, hinted, isolate), versions, notes, made, compiled, isolated=isolate)


def _linear(options: Options) -> LinearPrograms:
    return LinearPrograms(options.lp_solver, options.seed, options.threads)


def _going(solver: str, target: Problem | Program, options: Options, isolate: bool) -> Callable[[Control], RawResult]:
    work = SolverWork(solver, target, options)
    return (lambda control: run_in_process(work, options, control)) if isolate else work


def _heuristic_run(problem: Problem, name: str, options: Options, isolate: bool) -> _Run:
    method = HEURISTICS[name]
    missing = method.missing(problem)
    if missing:
        raise UnsupportedError(f"heuristic {name}", missing, [h for h in HEURISTICS if not HEURISTICS[h].missing(problem)])
    method.check_parameters(options.extra)
    _refuse_ignored(f"heuristic {name}", method.honours, options)
    work = HeuristicWork(name, problem, options)
    return _Run(name, (lambda control: run_in_process(work, options, control)) if isolate else work, heuristic=True)


def _refuse_ignored(who: str, honours: frozenset[str], options: Options) -> None:
    """Raise UsageError for what the method would not keep to."""
    for name, value in options.asked().items():
        if name not in honours:
            able = sorted(n for n in BACKENDS if name in BACKENDS[n].honours)
            raise UsageError(f"{who} does not keep to {name} ({value:g}); solvers that do: {', '.join(able)}")


def _conclude(
    problem: Problem, run: _Run, searched: Searched, control: Control, options: Options, budget: float, record: Recorder,
    crash: Exception | None, first: list[Evidence], beside: Beside | None,
) -> Solution:  # fmt: skip
    """Believe nothing: decode and judge every answer, bound, certify, and only then say how it ended.

    From the judge's verdict on, whatever fails or is interrupted costs what it would have added, never the answer.
    """
    began = time.perf_counter()
    try:
        judge, found = _verdict(problem, run, searched.result, control, options, crash)
    except KeyboardInterrupt:  # asks for an end, not for the loss of the answer; a second one is heeded
        judge, found = _verdict(problem, run, searched.result, control, options, crash)
    spent = time.perf_counter() - began
    if found[1] is not None:
        record.judged(run.name, found[1].values)
    try:
        return _certified(judge, run, searched, options, found, spent, budget, record, first, beside)
    except CheckFailedError:  # and no answer
        raise
    except (Exception, KeyboardInterrupt) as fault:
        run.notes.append(f"no bound was verified: {in_words(fault)}")
        return _certified(judge, run, searched, options, found, spent, None, None, [], None)


def _verdict(
    problem: Problem, run: _Run, result: RawResult, control: Control, options: Options, crash: Exception | None
) -> tuple[Judge, tuple[Any, Evaluation | None]]:
    """The best of the engine's last word, its published incumbent and the start, and who judged them."""
    judge = Judge(problem, run.name, run.exactness(result), run.decode, run.notes, crash)
    judge.last_word(result, prices=run.made is None or run.exactness(result) is Exactness.EXACT)
    if control.answer is not result.answer:
        judge.incumbent(control.answer)
    judge.start(options.start)
    return judge, judge.best()


def _certified(
    judge: Judge, run: _Run, searched: Searched, options: Options, found: tuple[Any, Evaluation | None], spent: float,
    budget: float | None, record: Recorder | None, first: list[Evidence], beside: Beside | None,
) -> Solution:  # fmt: skip
    """The solution around the best answer, with what bounds it; without a ``budget``, with the judge's word alone."""
    result, problem = searched.result, judge.problem
    answer, evaluation = found
    best = None if evaluation is None else evaluation.values[0]
    judge.hear(claims.check_bound, run.name, problem.senses, result, evaluation, run.exactness(result))

    began = time.perf_counter()
    evidence: list[Evidence] = list(first)
    if budget is not None:
        try:
            _gather(evidence, problem, run, searched, _linear(options), budget, best, record, beside)
        except (Exception, KeyboardInterrupt) as fault:
            run.notes.append(f"no further bound was looked for: {in_words(fault)}")
    bound_seconds = time.perf_counter() - began

    began = time.perf_counter()
    if record is not None:
        record.begin_phase("check")
    guarantee = result.guarantee if evaluation is not None else None
    if run.heuristic and guarantee is None and result.holds is Exactness.NEITHER:
        run.notes.append(f"{run.name} guarantees nothing for this instance")
    certificate: Certificate | None = None
    if budget is not None:
        try:
            certificate = in_time(lambda: certify(problem, evaluation, evidence, guarantee, run.notes), lambda: None)
            if certificate is None:
                run.notes.append("interrupted before the evidence of the bounds was verified")
        except CheckFailedError as fault:
            judge.faults.append(f"{fault} (the bound is withheld)")
    certificate = certificate or judged_only(problem, evaluation)
    left = 0.0 if budget is None or record is None else budget - bound_seconds
    if record is not None and len(problem.senses) > 1 and evaluation is not None and left > 0.0 and not searched.interrupted:
        try:
            certificate = further_levels(problem, certificate, evaluation, left, _linear(options), run.notes, record.begin_phase)
        except CheckFailedError as fault:
            judge.faults.append(f"{fault} (the bound is withheld)")
    heard: list[tuple[str, RawResult]] = []
    if budget is not None and not searched.interrupted and not judge.faults:
        asked = time.perf_counter()
        heard = _second_opinions(judge, run, result, certificate, evaluation, budget - bound_seconds, options)
        spent_asking = time.perf_counter() - asked
        bound_seconds, began = bound_seconds + spent_asking, began + spent_asking
    if result.status == "infeasible" and evaluation is None and run.exactness(result).infeasibility_is_valid and not judge.faults:
        judge.at_hand()
    answer, better = judge.best() if not judge.faults else found
    if better is not evaluation:
        evaluation = better
        judge.hear(claims.check_bound, run.name, problem.senses, result, evaluation, run.exactness(result))
        certificate = in_time(lambda: certify(problem, evaluation, evidence, None, run.notes), lambda: judged_only(problem, evaluation))
    opinions = tuple(opinion(name, said, result, evaluation, certificate) for name, said in heard)
    for one in opinions:
        if one.verdict == "is refuted":
            value = "" if one.objective is None else f" {one.objective!r}"
            run.notes.append(f"{one.solver} says {one.status}{value}, which {refuting(one, certificate)} refutes")
        elif one.verdict == "contradicts":
            both = f"{run.name} claims {claimed(result)}, {one.solver} claims {claimed(one)}"
            judge.faults.append(f"{both}: nothing that was checked refutes either, and both cannot be right")
    size = 0.0 if evaluation is None else evaluation.size
    judge.hear(claims.check_verified, run.name, problem.sense, result, certificate.bound, run.exactness(result), size)
    judge.hear(claims.check_unbounded, run.name, result, certificate.unbounded, run.exactness(result))
    check_seconds = spent + time.perf_counter() - began

    faults = tuple(dict.fromkeys(judge.faults))
    if faults:
        if evaluation is None:
            raise CheckFailedError("; ".join(faults))
        result = replace(result, status="unknown", objective=None, bound=None, further=())
    bound, kind, source = _best_bound(problem, run, result, certificate, evaluation)
    objective = None if evaluation is None else evaluation.objective
    if isinstance(bound, float) and len(problem.senses) > 1:
        further = dict(claims.concerned(problem.senses, result, evaluation)) if evaluation and run.exactness(result).bound_is_valid else {}
        bound, kind, source = bounds_of_levels(problem, evaluation, certificate.levels, further, _claimant(run), bound, kind, source)
    gap = relative_gap(objective, bound, *(() if evaluation is None else (evaluation.sizes, evaluation.precision)))
    status = _status(problem, run, result, certificate, evaluation, bound)
    messages = dict.fromkeys(m for m in (_why_none(problem, certificate), result.message, *run.notes) if m)
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
        opinions=opinions,
        chain=(() if run.made is None else run.made.links) + result.links,
        faults=faults,
    )


def _why_none(problem: Problem, certificate: Certificate) -> str:
    """What proves that there is no answer, where the problem has words of its own for it."""
    for evidence in certificate.evidence[:1] if certificate.infeasible else ():
        told = problem.why_none(evidence.kind, evidence.data)
        if told != Problem.why_none(problem, evidence.kind, evidence.data):
            return told
    return ""


def _second_opinions(
    judge: Judge, run: _Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None, seconds: float, options: Options
) -> list[tuple[str, RawResult]]:
    """What other engines say of a claim without evidence; their answers are judged."""
    made = run.made
    exactness = run.exactness(result)
    if evaluation is not None:
        claims_it = _claims_optimum(exactness, result, evaluation)
    else:
        claims_it = exactness.answer_is_valid if result.status == "unbounded" else exactness.infeasibility_is_valid
    if made is None or not claims_it or not unproved(result, certificate, evaluation, made.program):
        return []
    heard = list(second_opinions(made, run.name, seconds, options, run.isolated))
    for name, said in heard:
        judge.opinion(name, said.answer)
    return heard


def _gather(
    evidence: list[Evidence],
    problem: Problem,
    run: _Run,
    searched: Searched,
    linear: LinearPrograms,
    budget: float,
    best: float | None,
    record: Recorder | None,
    beside: Beside | None,
) -> None:
    """Add to ``evidence`` what the search left of it, and what bounding finds where that proves nothing."""
    result = searched.result
    evidence.extend(result.evidence)
    if run.made is not None and result.row_duals is not None and run.made.dual_evidence is not None:
        try:
            evidence.append(run.made.dual_evidence(result.row_duals))
        except Exception as fault:
            run.notes.append(f"the duals of {run.name} are no evidence: {in_words(fault)}")
    if searched.interrupted and beside is not None:
        evidence.extend(beside.answer or ())
    if searched.interrupted or any(proved(problem, e) is not None for e in result.evidence):
        return
    known = tuple(evidence)

    if record is not None and budget > 0:
        record.begin_phase("bound", budget)

    def find(control: Control) -> RawResult:
        if beside is not None:
            found = beside.found(control, best)
            run.notes.extend(beside.unable)
            if not beside.fault:
                return RawResult("unknown", answer=found)
        hear = None if record is None else record.of_bounds
        found = find_bounds(problem, budget, target=best, known=known, control=control, progress=hear, unable=run.notes, linear=linear)
        return RawResult("unknown", answer=found)

    found = search(find, Control(), budget, overtime=BOUND_OVERTIME)
    evidence.extend(found.result.answer or [])
    if found.interrupted or found.result.message:
        run.notes.append(f"bounding ended early: {found.result.message or 'interrupted'}")


def _best_bound(
    problem: Problem, run: _Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None
) -> tuple[Value | None, str | None, str | None]:
    """The best known bound of either kind; a verified one wins a tie, and where the answer meets it: a claim ahead of both is false."""
    size, precision = (0.0, EQUAL) if evaluation is None else (evaluation.size, evaluation.precision)
    verified = certificate.bound
    met = verified is not None and evaluation is not None and same(verified, evaluation.values[0], size, precision)
    claimed = result.bound if run.exactness(result).bound_is_valid else None
    if claimed is not None and math.isfinite(claimed) and not met:
        ahead = verified is None or better_bound(problem.sense, claimed, verified)
        if ahead and (verified is None or not same(claimed, verified, size, precision)):
            return claimed, "claimed", _claimant(run)
    return (verified, "verified", certificate.bound_source) if verified is not None else (None, None, None)


def _claimant(run: _Run) -> str:
    return f"{run.name} ({run.form})" if run.form else run.name


def _status(
    problem: Problem, run: _Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None, bound: Value | None
) -> str:
    if evaluation is not None:
        if len(evaluation.values) == 1 and isinstance(bound, float):
            value = evaluation.values[0]
            if same(bound, value, evaluation.size, evaluation.precision):
                return "optimal"
        verified = [] if certificate.bound is None else [certificate.bound, *(level.bound for level in certificate.levels)]
        if 1 < len(verified) == len(evaluation.values) and all(evaluation.same_at(k, known) for k, known in enumerate(verified)):
            return "optimal"
        reached = all(evaluation.same_at(k, claim.objective, EQUAL_TOLERANCE) for k, claim in enumerate(result.further, start=1))
        claimed = result.status == "optimal" and reached and _claims_optimum(run.exactness(result), result, evaluation)
        return "optimal" if claimed else "feasible"
    if certificate.infeasible or certificate.unbounded:
        return "infeasible" if certificate.infeasible else "unbounded"
    if result.status in ("infeasible", "infeasible_or_unbounded") and run.exactness(result).infeasibility_is_valid:
        return result.status
    if result.status == "unbounded" and run.exactness(result).answer_is_valid:
        return "unbounded"
    return "error" if result.status == "error" else "unknown"


def _claims_optimum(exactness: Exactness, result: RawResult, evaluation: Evaluation) -> bool:
    """Whether a claimed optimum is one of the problem: of a relaxation if it is met, up to what solvers see."""
    if exactness is not Exactness.RELAXATION:
        return exactness is Exactness.EXACT
    bounds = [result.bound, *(level.bound for level in result.further)]
    met = [bound is not None and evaluation.same_at(k, bound, EQUAL_TOLERANCE) for k, bound in enumerate(bounds)]
    return len(met) == len(evaluation.values) and all(met)


def _versions(run: _Run) -> dict[str, str]:
    from .._version import __version__

    return {"waybound": __version__, "python": platform.python_version(), **run.versions}
