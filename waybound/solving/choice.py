"""Which solver is taken, and which form of the problem it is given, where the user names none."""

from __future__ import annotations

from ..formulations.forms import FORMS, nearest_form
from ..formulations.problem import Problem
from ..formulations.programs.program import Program
from ..instances.errors import MissingPackageError, UnsupportedError, UsageError
from ..solvers.backend import BACKENDS, Backend, ProgramBackend
from .listing import missing_features

PREFERENCE = ("pyvrp", "ortools", "highs", "scip", "mathopt", "cpsat", "pulp", "cvxpy")
"""Order in which ``solve`` looks for a solver when none is named: by measured quality on routing files, then by measured speed on the
linear forms of the other families, then those that take nonconvex products whatever the bounds of their variables."""


def default_solver(problem: Problem, given: Program | None, form: str | None, relax: bool) -> str:
    """The first installed solver that can take the problem, or the program that is meant."""
    lacking: dict[str, frozenset[str]] = {}
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
            lacking[name] = missing
    if not lacking:
        raise UsageError("no solver is installed")
    nearest = min(lacking, key=lambda name: (f"{problem.family} problems" in lacking[name], len(lacking[name])))
    raise UnsupportedError("no installed solver", lacking[nearest], nearest=nearest)


def solver_named(name: str) -> Backend:
    """The solver of that name, ready to run; raises UsageError or MissingPackageError where there is none."""
    base, colon, variant = name.partition(":")
    kind = BACKENDS[base]
    if colon and not variant:
        raise UsageError(f"{name!r} names no solver within {base}; write {base} or {base}:NAME")
    if not kind.installed():
        raise MissingPackageError(f"solver {base} needs the package {kind.package}: pip install {kind.package}")
    return kind(variant) if variant else kind()


def able_solvers(problem: Problem) -> list[str]:
    """Installed solvers that can take the problem."""
    return [n for n in BACKENDS if BACKENDS[n].installed() and not missing_features(n, problem)[0]]


def first_program(problem: Problem, backend: ProgramBackend, relax: bool) -> Program:
    """The problem in the best form that the solver takes; in the best of all where there is none, for the error to say so."""
    if not problem.forms():
        raise UnsupportedError(backend.name, nearest_form(problem)[1], able_solvers(problem))
    first: Program | None = None
    for form in problem.forms():
        if relax or FORMS[form].kind(problem) in backend.kinds:
            program = problem.compile(form, relax=relax)
            first = first or program
            if relax or not backend.lacks(program):
                return program
    return first or problem.compile(relax=relax)
