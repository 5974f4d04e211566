"""Which solver is taken, and which form of the problem it is given, where the user names none."""

from __future__ import annotations

from ..formulations.forms import FORMS, default_form, nearest_form
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import CIRCUITS, INTEGERS, LINEAR, Program, described
from ..formulations.programs.size import TooLargeError
from ..heuristics.heuristic import HEURISTICS
from ..instances.errors import UnsupportedError, UsageError
from ..solvers.backend import BACKENDS
from ..solvers.program_backend import ProgramBackend
from .listing import missing_features


def default_solver(problem: Problem, given: Program | None, form: str | None, relax: bool) -> str:
    """The first installed solver that can take the problem, or the program that is meant."""
    lacking: dict[str, frozenset[str]] = {}
    meant = given.features() if given is not None else FORMS[form].makes(problem) if form is not None else INTEGERS if relax else None
    if relax and meant is not None:
        meant -= INTEGERS
    for name in sorted(BACKENDS, key=lambda name: BACKENDS[name].order):
        backend = BACKENDS[name]
        if backend.installed():
            if meant is None:
                missing, _ = missing_features(name, problem)
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
        raise UsageError("no solver is installed")
    if meant is None and problem.forms():
        default_form(problem)  # says so where all of them are inexact
    nearest = min(lacking, key=lambda name: (f"{problem.family} problems" in lacking[name], len(lacking[name])))
    able = [name for name in HEURISTICS if not HEURISTICS[name].missing(problem)] if meant is None else []
    raise UnsupportedError("no installed solver", lacking[nearest], able, nearest=nearest)


def able_solvers(problem: Problem) -> list[str]:
    """Installed solvers that can take the problem."""
    return [n for n in BACKENDS if BACKENDS[n].installed() and not missing_features(n, problem)[0]]


def first_compiled(problem: Problem, backend: ProgramBackend, relax: bool) -> Compiled:
    """The problem in the best exact form that the solver takes; in the best of all where there is none, for the error to say so.

    Who knows circuits is best off with them (docs/measurements.md#circuits), unless they are to be relaxed.
    """
    if not problem.forms():
        raise UnsupportedError(backend.name, nearest_form(problem)[1], able_solvers(problem))
    first: Compiled | None = None
    beyond: TooLargeError | None = None
    for form in sorted(problem.forms(), key=lambda form: not FORMS[form].makes(problem) >= CIRCUITS):
        features = FORMS[form].makes(problem) - (INTEGERS if relax else LINEAR)
        if relax and features >= CIRCUITS:
            continue
        if FORMS[form].exactness is Exactness.EXACT and backend.able(features):
            try:
                made = problem.compile(form, relax=relax)
            except TooLargeError as fault:
                beyond = beyond or fault
                continue
            first = first or made
            if not backend.missing(made.program):
                return made
    if first is None and beyond is not None:
        raise beyond
    return first or problem.compile(relax=relax)
