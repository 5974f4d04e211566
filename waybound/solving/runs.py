"""One search, ready to start, of whatever method the user named or left to us."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import Program
from ..formulations.rendering import number
from ..heuristics.heuristic import HEURISTICS, HeuristicWork
from ..instances.errors import InputError, UnsupportedError, UsageError, in_words
from ..instances.memory import SHARE, available, fits, readable
from ..solvers.backend import BACKENDS, Control, Engine, Options, RawResult, solver_named
from ..solvers.isolation import SolverWork, run_in_process
from ..solvers.program_backend import ProgramBackend
from .choice import able_solvers, default_solver, first_compiled
from .opening import LARGEST, opened, opening_heuristic
from .opening import SHARE as OPENING_SHARE
from .recording import Recorder

LARGE = 500_000
"""Variables of a program for which solvers take seconds to make their own model, deaf to any wish: then they do it where they can be
ended, and do not keep those who bound and judge meanwhile from working."""


@dataclass(frozen=True)
class Run:
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

    @property
    def claimant(self) -> str:
        """Whose claims its bounds are."""
        return f"{self.name} ({self.form})" if self.form else self.name

    def exactness(self, result: RawResult) -> Exactness:
        """How the search's points and claims relate to the problem's."""
        if self.heuristic:
            return Exactness.NEITHER
        return result.holds if self.made is None else self.made.exactness.then(result.holds)

    def decode(self, raw: Any) -> Any:
        return raw if self.made is None else self.made.decode(raw)


def default_run(problem: Problem, options: Options, isolate: bool) -> Run:
    """Where the user names no method: what is run, begun by a heuristic that opens the problem where there is one.

    The heuristic stands alone where no solver takes the problem, where it is too large for the program that one would need, or for the
    memory that an engine would.
    """
    opening, solver = opening_heuristic(problem, options), ""
    try:
        solver = default_solver(problem, None, None, False)
        why = "" if opening is None else _in_vain(problem, solver, options)
        if not why:
            run = solver_run(problem, None, solver, None, False, options, isolate)
            return run if opening is None else replace(run, opening=opening)
    except (UnsupportedError, UsageError) as fault:
        if opening is None:
            raise
        why = in_words(fault) if solver else ""
    assert opening is not None
    alone = heuristic_run(problem, opening, options, isolate)
    alone.notes.extend([f"{solver} was not used: {why}"] if why else [])
    return alone


def _in_vain(problem: Problem, solver: str, options: Options) -> str:
    """Why a solver would not come to its search within the time limit; empty if it would."""
    backend = solver_named(solver)
    if not isinstance(backend, Engine):
        large = problem.size > LARGEST and not options.asked()
        return f"a program of size {problem.size:,} takes long to be written" if large else ""
    seconds = backend.set_up_seconds(problem)
    return f"it takes some {seconds:.0f} s to set up for a problem of size {problem.size:,}" if seconds > options.time_limit else ""


def continued(problem: Problem, run: Run, options: Options, isolate: bool, record: Recorder) -> tuple[Run, Options, float]:
    """A run that goes on from the answer of the heuristic that opens the problem, in the time that is left, and the seconds it took.

    The answer is judged before the search begins: whatever becomes of that, it is there, and told.
    """
    assert run.opening is not None
    record.begin_phase(f"start by {run.opening}", OPENING_SHARE * options.time_limit)
    later, seconds, said = opened(problem, run.opening, options, isolate)
    made = solver_run(problem, run.made, run.name, None, False, later, isolate)
    found = f"{run.name} started from the answer of {run.opening}"
    if later.start is None:
        found = f"{run.opening} found no start: {said or 'no answer'}"
    else:
        with suppress(Exception):  # of the judge: told when it judges what the search leaves, and the start once more
            judged = problem.evaluate(later.start)
            if judged.feasible:
                record.judged(run.opening, judged.values)
                found += f", worth {number(judged.values)}"
    made.notes.extend([*run.notes, found])
    return replace(made, compile_seconds=run.compile_seconds), later, seconds


def solver_run(
    problem: Problem, given: Compiled | None, solver: str, form: str | None, relax: bool, options: Options, isolate: bool
) -> Run:
    """A search by a solver: of the problem itself by an engine, of a program made of it by a backend.

    Raises
    ------
    UsageError, UnsupportedError, MissingPackageError
        Of what it cannot take or keep to.
    """
    backend = solver_named(solver)
    options = backend.converted(options)
    versions = {backend.package: backend.version()}
    notes: list[str] = []
    apart = isolate or (backend.apart(problem) if isinstance(backend, Engine) else backend.needs_process)

    if isinstance(backend, Engine):
        if form is not None or relax or given is not None:
            raise UsageError(f"{solver} takes problems as they are: it has no forms and no relaxation")
        missing = backend.missing(problem)
        if missing:
            raise UnsupportedError(solver, missing, able_solvers(problem))
        _refuse_ignored(solver, backend.honours, options)
        needed = backend.memory(problem)
        if not fits(needed):
            most = f"more than the {readable(SHARE * available())} that may be taken of what is free"
            raise UsageError(f"{solver} needs {readable(needed)} for a problem of size {problem.size:,}, {most}")
        if backend.one_thread and options.threads > 1:
            notes.append(f"{solver} searches on one thread")
        going = _going(solver, problem, options, apart)
        return Run(solver, going, versions, notes, bounds=backend.bounds_itself, isolated=isolate)

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
    apart = apart or made.program.num_variables > LARGE
    return Run(solver, _going(solver, made.program, hinted, apart), versions, notes, made, compiled, isolated=apart)


def _going(solver: str, target: Problem | Program, options: Options, isolate: bool) -> Callable[[Control], RawResult]:
    work = SolverWork(solver, target, options)
    return (lambda control: run_in_process(work, options, control)) if isolate else work


def heuristic_run(problem: Problem, name: str, options: Options, isolate: bool) -> Run:
    """A search by a heuristic.

    Raises
    ------
    UsageError, UnsupportedError
        Of what it cannot take or keep to.
    """
    method = HEURISTICS[name]
    missing = method.missing(problem)
    if missing:
        raise UnsupportedError(f"heuristic {name}", missing, [h for h in HEURISTICS if not HEURISTICS[h].missing(problem)])
    method.check_parameters(options.extra)
    _refuse_ignored(f"heuristic {name}", method.honours, options)
    work = HeuristicWork(name, problem, options)
    return Run(name, (lambda control: run_in_process(work, options, control)) if isolate else work, heuristic=True)


def _refuse_ignored(who: str, honours: frozenset[str], options: Options) -> None:
    """Raise UsageError for what the method would not keep to."""
    for name, value in options.asked().items():
        if name not in honours:
            able = sorted(n for n in BACKENDS if name in BACKENDS[n].honours)
            raise UsageError(f"{who} does not keep to {name} ({value:g}); solvers that do: {', '.join(able)}")
