"""Which solvers and heuristics there are, and what each lacks for a problem."""

from __future__ import annotations

from dataclasses import dataclass

from ..formulations.forms import FORMS, nearest_form
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import described
from ..heuristics.heuristic import HEURISTICS
from ..solvers.backend import BACKENDS, Engine
from ..solvers.program_backend import ProgramBackend, kinds_of


@dataclass(frozen=True)
class SolverInfo:
    """One row of ``waybound solvers``.

    ``missing`` lists what it lacks for the problem asked about; ``options`` those of its own, None where they are its library's.
    """

    name: str
    kind: str
    installed: bool
    version: str
    summary: str
    takes: str
    install: str
    missing: tuple[str, ...] = ()
    forms: tuple[str, ...] = ()
    options: tuple[str, ...] | None = ()


@dataclass(frozen=True)
class HeuristicInfo:
    """One row of ``waybound heuristics``."""

    name: str
    family: str
    summary: str
    guarantee: str
    parameters: tuple[str, ...]
    missing: tuple[str, ...] = ()


def missing_features(name: str, problem: Problem) -> tuple[frozenset[str], tuple[str, ...]]:
    """What solver ``name`` lacks for ``problem`` where no form is named, at least, and the forms through which it can take it."""
    backend = BACKENDS[name]
    if issubclass(backend, Engine):
        return backend().missing(problem), ()
    assert issubclass(backend, ProgramBackend)
    forms = problem.forms()
    if not forms:
        return nearest_form(problem)[1], ()
    usable = tuple(f for f in forms if backend.takers(FORMS[f].makes(problem)))
    exact = [f for f in forms if FORMS[f].exactness is Exactness.EXACT]
    if not usable:
        return frozenset({f"{described(FORMS[(exact or forms)[0]].makes(problem))} programs"}), ()
    return (frozenset() if set(exact) & set(usable) else frozenset({"an exact form for this problem"})), usable


def solver_table(problem: Problem | None = None) -> list[SolverInfo]:
    """All solvers, installed or not; with a problem, also what each lacks for it."""
    rows = []
    for name in BACKENDS:
        backend = BACKENDS[name]
        missing, forms = missing_features(name, problem) if problem is not None else (frozenset(), ())
        takes = f"{backend.family} problems" if issubclass(backend, Engine) else ""
        takes = ", ".join(kinds_of(backend)) if issubclass(backend, ProgramBackend) else takes
        rows.append(
            SolverInfo(
                name, backend.takes, backend.installed(), backend.version(), backend.summary, takes,
                f"pip install {backend.package}", tuple(sorted(missing)), forms,
                None if backend.options is None else tuple(backend.options),
            )
        )  # fmt: skip
    return rows


def heuristic_table(problem: Problem | None = None) -> list[HeuristicInfo]:
    """All heuristics with their stated guarantees; with a problem, also what each lacks for it."""
    return [
        HeuristicInfo(
            h.name, ", ".join(h.families), h.summary, h.stated, tuple(h.parameters()),
            tuple(sorted(h.missing(problem))) if problem is not None else (),
        )
        for h in HEURISTICS.values()
    ]  # fmt: skip
