"""The method: chosen if the user names none, refused if it cannot take the problem, and made ready to run."""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from ..formulations.forms import FORMS, compile_form, default_form, nearest_form, usable_forms
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import CIRCUITS, INTEGERS, LINEAR, Program, described
from ..formulations.programs.size import TooLargeError
from ..formulations.rendering import number
from ..formulations.stop import now
from ..heuristics.heuristic import HEURISTICS, HeuristicWork
from ..instances.errors import UnsupportedError, UsageError, in_words
from ..instances.memory import SHARE, available, fits, readable
from ..solvers.backend import BACKENDS, Control, Engine, Options, RawResult, SolverWork, solver_named
from ..solvers.isolation import run_in_process
from ..solvers.program_backend import ProgramBackend
from .recording import Recorder
from .request import Request
from .search import search

LARGE_PROGRAM = 500_000
"""Variables of a program for which solvers take seconds to make their own model, deaf to any wish: then they do it where they can be
ended, and do not block bounding and judging meanwhile."""

OPENING_SHARE = 0.5
"""Part of the time limit for the heuristic from whose answer the default solver starts."""

LARGEST_WRITTEN = 50
"""Size of a problem beyond which the answer of that heuristic stands alone where the solver takes programs: writing one would take all
the time."""

LEAST_SECONDS = 0.1
"""Time limit that is left to the solver at least."""


# -- which methods can take a problem ----------------------------------------------------------------------------------------


def missing_features(name: str, problem: Problem) -> tuple[frozenset[str], tuple[str, ...]]:
    """The fewest features that solver ``name`` lacks for ``problem`` in any form, and the forms through which it can take it."""
    backend = BACKENDS[name]
    if issubclass(backend, Engine):
        engine: Engine = backend()
        return engine.needs(problem).missing, ()
    assert issubclass(backend, ProgramBackend)
    forms = usable_forms(problem)
    if not forms:
        return nearest_form(problem)[1], ()
    usable = tuple(f for f in forms if backend.takers(FORMS[f].makes(problem)))
    exact = [f for f in forms if FORMS[f].exactness is Exactness.EXACT]
    if not usable:
        return frozenset({f"{described(FORMS[(exact or forms)[0]].makes(problem))} programs"}), ()
    return (frozenset() if set(exact) & set(usable) else frozenset({"an exact form for this problem"})), usable


def able_solvers(problem: Problem) -> list[str]:
    """Installed solvers that can take the problem."""
    return [n for n in BACKENDS if BACKENDS[n].installed() and not missing_features(n, problem)[0]]


def able_heuristics(problem: Problem) -> list[str]:
    """Heuristics that can take the problem."""
    return [name for name in HEURISTICS if not HEURISTICS[name].missing(problem)]


def default_solver(problem: Problem, given: Program | None = None, form: str | None = None, relax: bool = False) -> str:
    """The first installed solver that can take the problem, or the program that is meant, of those that may be used unasked."""
    lacking: dict[str, frozenset[str]] = {}
    meant = given.features() if given is not None else FORMS[form].makes(problem) if form is not None else INTEGERS if relax else None
    if relax and meant is not None:
        meant -= INTEGERS
    for name in sorted(BACKENDS, key=lambda name: BACKENDS[name].order):
        backend = BACKENDS[name]
        if backend.installed() and backend.by_default:
            if meant is None:
                missing, _ = missing_features(name, problem)
                if not missing and issubclass(backend, Engine) and not backend().unasked(problem):
                    continue
            elif issubclass(backend, ProgramBackend):
                missing = frozenset() if backend.takers(meant) else frozenset({f"{described(meant)} programs"})
                if given is not None and not relax and not missing:
                    missing = backend().missing(given)
            else:
                continue
            if not missing:
                return name
            lacking[name] = missing
    if not lacking:
        raise UsageError("no solver is installed", "missing-package")
    if meant is None and usable_forms(problem):
        default_form(problem)  # says so where all of them are inexact
    nearest = min(lacking, key=lambda name: (f"{problem.family} problems" in lacking[name], len(lacking[name])))
    raise UnsupportedError("no installed solver", lacking[nearest], able_heuristics(problem) if meant is None else [], nearest=nearest)


def first_compiled(problem: Problem, backend: ProgramBackend, relax: bool) -> Compiled:
    """The problem in the best exact form that the solver takes; in the best of all where there is none, for the error to say so.

    Solvers that know circuits are fastest with them (docs/measurements.md#circuits), unless they are to be relaxed.
    """
    forms = usable_forms(problem)
    if not forms:
        raise UnsupportedError(backend.name, missing_features(backend.name, problem)[0], able_solvers(problem))
    first: Compiled | None = None
    beyond: TooLargeError | None = None
    for form in sorted(forms, key=lambda form: not FORMS[form].makes(problem) >= CIRCUITS):
        features = FORMS[form].makes(problem) - (INTEGERS if relax else LINEAR)
        if relax and features >= CIRCUITS:
            continue
        if FORMS[form].exactness is Exactness.EXACT and backend.able(features):
            try:
                compiled = compile_form(problem, form, relax=relax)
            except TooLargeError as fault:
                beyond = beyond or fault
                continue
            first = first or compiled
            if not backend.missing(compiled.program):
                return compiled
    if first is None and beyond is not None:
        raise beyond
    return first or compile_form(problem, relax=relax)


# -- a run ---------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Run:
    """A search, ready to start: the method, its target, and the way back from its raw answers to those of the problem.

    ``target`` is the program of ``compiled`` for a program backend; engines and heuristics take problems, and say for what their claims
    hold. The start in ``options`` is in the terms of ``target``. ``bounds`` tells whether the search finds bounds of its own; ``opening``
    names the heuristic from whose answer it is to start; ``apart`` whether it goes on in a process of its own, and ``isolated`` whether
    the solvers that are asked for a second opinion do, too.
    """

    name: str
    target: Problem | Program
    options: Options
    versions: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    compiled: Compiled | None = None
    compile_seconds: float = 0.0
    bounds: bool = True
    heuristic: bool = False
    apart: bool = False
    isolated: bool = False
    opening: str | None = None

    @property
    def form(self) -> str | None:
        return None if self.compiled is None else self.compiled.form

    @property
    def claimant(self) -> str:
        """The name under which its bounds are reported: the solver, with the form in brackets if it searches a program."""
        return f"{self.name} ({self.form})" if self.form else self.name

    @property
    def exactness(self) -> Exactness:
        """How the target relates to the problem."""
        return Exactness.EXACT if self.compiled is None else self.compiled.exactness

    def go(self, control: Control) -> RawResult:
        """Search."""
        kind: Callable[..., SolverWork | HeuristicWork] = HeuristicWork if self.heuristic else SolverWork
        work = kind(self.name, self.target, self.options)
        return run_in_process(work, self.options, control) if self.apart else work(control)

    def decode(self, raw: Any) -> Any:
        return raw if self.compiled is None else self.compiled.decode(raw)


def requested_run(problem: Problem, given: Compiled | None, request: Request, options: Options) -> Run:
    """The run that is asked for; by the default solver, perhaps begun by a heuristic, if no method, form or relaxation is named.

    Raises UsageError, UnsupportedError, MissingPackageError of what the method cannot take or keep to.
    """
    if request.heuristic is not None:
        return heuristic_run(problem, request.heuristic, options, request.isolated)
    if request.solver is None and request.form is None and not request.relax and given is None:
        return default_run(problem, options, request.isolated)
    solver = request.solver or default_solver(problem, None if given is None else given.program, request.form, request.relax)
    return solver_run(problem, given, solver, request.form, request.relax, options, request.isolated)


def default_run(problem: Problem, options: Options, isolate: bool) -> Run:
    """The default solver, begun by a heuristic that opens the problem where there is one.

    The heuristic stands alone where no solver takes the problem, where it is too large for the program that one would need, or for the
    memory that an engine would.
    """
    opening, solver = opening_heuristic(problem, options), ""
    try:
        solver = default_solver(problem)
        if opening is not None:
            _refuse_in_vain(problem, solver, options)
        return replace(solver_run(problem, None, solver, None, False, options, isolate), opening=opening)
    except (UnsupportedError, UsageError) as fault:
        if opening is None:
            raise
        notes = [f"{solver} was not used: {in_words(fault)}"] if solver else []
    alone = heuristic_run(problem, opening, options, isolate)
    alone.notes.extend(notes)
    return alone


def _refuse_in_vain(problem: Problem, solver: str, options: Options) -> None:
    """Raise UsageError where a solver would not come to its search within the time limit."""
    backend = solver_named(solver)
    if not isinstance(backend, Engine):
        if problem.size > LARGEST_WRITTEN and not options.asked():
            raise UsageError(f"a program of size {problem.size:,} takes long to be written")
    elif (seconds := backend.needs(problem).set_up_seconds) > options.time_limit:
        raise UsageError(f"it takes some {seconds:.0f} s to set up for a problem of size {problem.size:,}")


def solver_run(
    problem: Problem, given: Compiled | None, solver: str, form: str | None, relax: bool, options: Options, isolate: bool
) -> Run:
    """A search by a solver: of the problem itself by an engine, of a program made of it by a backend.

    Raises UsageError, UnsupportedError, MissingPackageError of what it cannot take or keep to.
    """
    backend = solver_named(solver)
    options = backend.converted(options)
    versions, notes = {backend.package: backend.version()}, list[str]()
    if isinstance(backend, Engine):
        if form is not None or relax or given is not None:
            raise UsageError(f"{solver} takes problems as they are: it has no forms and no relaxation", "unsupported")
        needs = backend.needs(problem)
        if needs.missing:
            raise UnsupportedError(solver, needs.missing, able_solvers(problem))
        _refuse_ignored(solver, backend.honours, options)
        if not fits(needs.memory):
            most = f"more than the {readable(SHARE * available())} that may be taken of what is free"
            raise UsageError(f"{solver} needs {readable(needs.memory)} for a problem of size {problem.size:,}, {most}", "too-large")
        if backend.one_thread and options.threads > 1:
            notes.append(f"{solver} searches on one thread")
        apart, bounds = isolate or needs.apart, backend.bounds_itself
        return Run(solver, problem, options, versions, notes, bounds=bounds, apart=apart, isolated=isolate)

    assert isinstance(backend, ProgramBackend)
    began = time.perf_counter()
    if given is None:
        compiled = first_compiled(problem, backend, relax) if form is None else compile_form(problem, form, relax=relax)
    elif form is not None:
        raise UsageError(f"the program is already compiled, as {given.form}")
    else:
        compiled = given.relaxed() if relax else given
    seconds = time.perf_counter() - began
    lacking = backend.lacking(compiled.program)
    if lacking:
        raise backend.refusal(lacking, compiled.program)
    _refuse_ignored(solver, backend.honours, options)
    apart = isolate or backend.needs_process or compiled.program.num_variables > LARGE_PROGRAM
    options = replace(options, start=compiled.start(options.start, notes))
    return Run(solver, compiled.program, options, versions, notes, compiled, seconds, apart=apart, isolated=apart)


def heuristic_run(problem: Problem, name: str, options: Options, isolate: bool) -> Run:
    """A search by a heuristic.

    Raises UsageError, UnsupportedError of what it cannot take or keep to.
    """
    heuristic = HEURISTICS[name]
    missing = heuristic.missing(problem)
    if missing:
        raise UnsupportedError(f"heuristic {name}", missing, able_heuristics(problem))
    heuristic.check_parameters(options.extra)
    _refuse_ignored(f"heuristic {name}", heuristic.honours, options)
    return Run(name, problem, options, heuristic=True, apart=isolate)


def _refuse_ignored(who: str, honours: frozenset[str], options: Options) -> None:
    """Raise UsageError for a limit that the method does not keep to."""
    for name, value in options.asked().items():
        if name not in honours:
            able = sorted(n for n in BACKENDS if name in BACKENDS[n].honours)
            raise UsageError(f"{who} does not keep to {name} ({value:g}); solvers that do: {', '.join(able)}", "unsupported")


# -- the heuristic that opens --------------------------------------------------------------------------------------------------


def opening_heuristic(problem: Problem, options: Options) -> str | None:
    """The heuristic that says that it opens ``problem``; None where there is none, or the user asks for what it does not keep to."""
    if options.start is not None or options.extra or options.iterations is not None or options.no_improvement is not None:
        return None
    return next((name for name in HEURISTICS if HEURISTICS[name].opens(problem) and not HEURISTICS[name].missing(problem)), None)


def opened(problem: Problem, name: str, options: Options, isolate: bool) -> tuple[Options, float, str]:
    """The options for a solver that goes on from the heuristic's answer in the time that is left, the seconds that it took, and why it has
    no answer, if so."""
    began = now()  # what is compiled for it counts against no limit
    own = replace(options, time_limit=OPENING_SHARE * options.time_limit, gap=0.0)
    answer, message = None, ""
    try:
        result = search(heuristic_run(problem, name, own, isolate).go, Control(), own.time_limit).result
        answer, message = result.answer, result.message
    except Exception as fault:  # the solver goes on without
        message = in_words(fault)
    seconds = now() - began
    rest = replace(options, start=answer, time_limit=max(options.time_limit - seconds, LEAST_SECONDS))
    return rest, seconds, "" if answer is not None else message


def continued(problem: Problem, run: Run, options: Options, isolate: bool, record: Recorder) -> tuple[Run, Options, float]:
    """A run that goes on from the answer of the heuristic that opens the problem, in the time that is left, and the seconds it took.

    The answer is judged before the search begins: whatever becomes of that, it is there, and told.
    """
    assert run.opening is not None
    record.begin_phase(f"start by {run.opening}", OPENING_SHARE * options.time_limit)
    rest, seconds, message = opened(problem, run.opening, options, isolate)
    start = rest.start if run.compiled is None else run.compiled.start(rest.start, run.notes)
    note = f"{run.name} started from the answer of {run.opening}"
    if rest.start is None:
        note = f"{run.opening} found no start: {message or 'no answer'}"
    else:
        with suppress(Exception):  # of the judge: told when it judges what the search leaves, and the start once more
            judged = problem.evaluate(rest.start)
            if judged.feasible:
                record.judged(run.opening, judged.values)
                note += f", worth {number(judged.values)}"
    run.notes.append(note)
    return replace(run, options=replace(run.options, start=start, time_limit=rest.time_limit)), rest, seconds
