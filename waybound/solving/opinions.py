"""Second opinions: other solvers asked about what one claims without evidence."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

from ..formulations.certificate import Certificate
from ..formulations.evaluation import Evaluation
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.program import Program
from ..formulations.solution import Opinion
from ..formulations.tolerance import same
from ..solvers.backend import Control, Options, RawResult, solver_named
from ..solvers.isolation import SolverWork, run_in_process
from ..solvers.program_backend import ProgramBackend, takers
from .claims import CLAIM_TOLERANCE
from .search import search

MOST = 2
"""Opinions that are asked for."""

LEAST_SECONDS = 0.05


def independent(made: Compiled, solver: str) -> list[str]:
    """Installed solvers that take the program by another engine than ``solver``, one for each engine, the quick to ask first."""
    asked = solver_named(solver)
    found: dict[str, tuple[bool, int, str]] = {}
    for name in takers(made.program.features()):
        backend = solver_named(name)
        assert isinstance(backend, ProgramBackend)
        if not isinstance(asked, ProgramBackend) or backend.engine != asked.engine:
            rank = (backend.needs_process, backend.order, name)
            found[backend.engine] = min(rank, found.get(backend.engine, rank))
    return [name for *_, name in sorted(found.values())]


def second_opinions(made: Compiled, solver: str, seconds: float, options: Options, isolate: bool) -> Iterator[tuple[str, RawResult]]:
    """What at most ``MOST`` other engines say of the program within ``seconds``, each in a process of its own where the first was.

    Who fails says nothing.
    """
    began, heard = time.perf_counter(), 0
    for name in independent(made, solver):
        left = seconds - (time.perf_counter() - began)
        if heard >= MOST or left < LEAST_SECONDS:
            return
        backend = solver_named(name)
        told = replace(options, time_limit=left, iterations=None, no_improvement=None, gap=0.0, start=None, extra={})
        work = SolverWork(name, made.program, told)

        def ask(
            control: Control, work: SolverWork = work, told: Options = told, alone: bool = isolate or backend.needs_process
        ) -> RawResult:
            return run_in_process(work, told, control) if alone else work(control)

        try:
            found = search(ask, Control(), left)
        except Exception:  # of whatever kind: an opinion never costs what it is about
            continue
        if found.interrupted:
            return
        heard += 1
        yield name, found.result


def unproved(result: RawResult, certificate: Certificate, evaluation: Evaluation | None, program: Program) -> bool:
    """Whether a solver claims infeasibility, or an optimum of a program with integers, that no verified evidence reaches."""
    if result.status == "infeasible":
        return evaluation is None and not certificate.infeasible
    if result.status != "optimal" or evaluation is None or len(evaluation.values) != 1 or not program.is_integer:
        return False
    return not isinstance(certificate.bound, float) or not same(
        certificate.bound, evaluation.values[0], evaluation.size, evaluation.precision
    )


def opinion(name: str, said: RawResult, claim: RawResult, evaluation: Evaluation | None) -> Opinion:
    """What ``name`` said, beside the claim and the best answer that passed every check."""
    verdict = "undecided"
    if evaluation is None:
        verdict = "agrees" if said.status == claim.status else "undecided"
    elif said.status == "infeasible":
        verdict = "is refuted"
    elif claim.status == "infeasible":
        verdict = "refutes"
    elif said.status == "optimal" and said.objective is not None and claim.objective is not None:
        close = same(said.objective, claim.objective, evaluation.size, CLAIM_TOLERANCE)
        met = same(claim.objective, evaluation.values[0], evaluation.size, CLAIM_TOLERANCE)
        verdict = "agrees" if close else "is refuted" if met else "refutes"
    return Opinion(name, said.status, said.objective, said.bound, verdict)
