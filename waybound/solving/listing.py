"""Which solvers and heuristics there are, and what each lacks for a problem."""

from dataclasses import dataclass

from ..formulations.problem import Problem
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


def solver_table(problem: Problem | None = None) -> list[SolverInfo]:
    """All solvers, installed or not; with a problem, also what each lacks for it."""
    rows = []
    if problem is not None:
        from .method import missing_features
    for name in BACKENDS:
        backend = BACKENDS[name]
        missing, forms = missing_features(name, problem) if problem is not None else (frozenset(), ())
        takes = f"{backend.family} problems" if issubclass(backend, Engine) else ""
        takes = ", ".join(kinds_of(backend)) if issubclass(backend, ProgramBackend) else takes
        rows.append(
            SolverInfo(
                name, backend.takes, backend.installed(), backend.version(), backend.summary, takes,
                f"pip install {backend.requirement()}", tuple(sorted(missing)), forms,
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
