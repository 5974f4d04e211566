"""Second opinions: other solvers asked about what one claims without evidence."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

from ..formulations.certificate import Certificate, beats_bound
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
    """Whether a solver claims no answer or no best one, or an optimum of a program with integers, without verified evidence."""
    if result.status in ("infeasible", "unbounded"):
        return evaluation is None and not (certificate.infeasible or certificate.unbounded)
    if result.status != "optimal" or evaluation is None or len(evaluation.values) != 1 or not program.is_integer:
        return False
    return not isinstance(certificate.bound, float) or not same(
        certificate.bound, evaluation.values[0], evaluation.size, evaluation.precision
    )


def opinion(name: str, said: RawResult, claim: RawResult, evaluation: Evaluation | None, certificate: Certificate) -> Opinion:
    """What ``name`` said, beside the claim, the best answer that passed every check, and what is proved."""
    return Opinion(name, said.status, said.objective, said.bound, _verdict(said, claim, evaluation, certificate))


def _verdict(said: RawResult, claim: RawResult, evaluation: Evaluation | None, certificate: Certificate) -> str:
    if said.status not in ("optimal", "feasible", "infeasible", "unbounded"):
        return "undecided"
    if said.status == "infeasible" and evaluation is not None:
        return "is refuted"
    if said.status == claim.status != "optimal":
        return "agrees"
    if "infeasible" in (said.status, claim.status):
        return "contradicts" if evaluation is None else "refutes"
    if "unbounded" in (said.status, claim.status) and "optimal" in (said.status, claim.status):
        return "contradicts"
    if evaluation is None or said.status != "optimal" or said.objective is None or claim.objective is None:
        return "undecided"
    theirs, claimed, best = said.objective, claim.objective, evaluation.values[0]

    def close(a: float, b: float) -> bool:
        return same(a, b, evaluation.size, CLAIM_TOLERANCE)

    def better(a: float, b: float) -> bool:
        return not close(a, b) and (a < b if certificate.sense == "min" else a > b)

    if close(theirs, claimed):
        return "agrees"
    if better(best, theirs) or (isinstance(certificate.bound, float) and better(theirs, certificate.bound)):
        return "is refuted"
    return "refutes" if close(theirs, best) and better(best, claimed) else "contradicts"


def claimed(said: RawResult | Opinion) -> str:
    """A claim in words."""
    if said.status in ("optimal", "feasible") and said.objective is not None:
        return f"{'the optimum' if said.status == 'optimal' else 'an answer of'} {said.objective!r}"
    return {"infeasible": "that there is no answer", "unbounded": "that there is no best answer"}.get(said.status, f"to be {said.status}")


def refuting(refuted: Opinion, certificate: Certificate) -> str:
    """What refutes a claim."""
    bound, theirs = certificate.bound, refuted.objective
    ahead = theirs is not None and bound is not None and beats_bound(certificate.sense, theirs, bound)
    return "the verified bound" if ahead else "the answer"
