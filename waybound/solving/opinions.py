"""Second opinions: other solvers are asked about a claim that has no evidence."""

import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from ..formulations.certificate import Certificate
from ..formulations.evaluation import Evaluation
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.program import Program
from ..formulations.solution import Opinion
from ..formulations.tolerance import same
from ..formulations.verified_bounds import beats_bound
from ..solvers.backend import BACKENDS, Control, Options, RawResult, solver_named
from ..solvers.program_backend import ProgramBackend, takers
from .judging import Claim, Judge, contradictions
from .method import Run, able_solvers, first_compiled
from .search import in_time, search

MOST = 2
"""Opinions that are asked for."""

LEAST_SECONDS = 0.05

MOST_ENTRIES = 100_000
"""Coefficients of a program beyond which it is not written only to ask others about it."""


def independent(program: Program, solver: str) -> list[str]:
    """Installed solvers that take the program with another engine than ``solver``, one per engine, the quickest to start first."""
    first = solver_named(solver)
    quickest: dict[str, tuple[bool, int, str]] = {}
    for name in takers(program.features()):
        backend = solver_named(name)
        assert isinstance(backend, ProgramBackend)
        if not isinstance(first, ProgramBackend) or backend.engine != first.engine:
            rank = (backend.needs_process, backend.order, name)
            quickest[backend.engine] = min(rank, quickest.get(backend.engine, rank))
    return [name for *_, name in sorted(quickest.values())]


def program_of(problem: Problem) -> Compiled | None:
    """The problem in an exact form, for other solvers, where no program was searched.

    None where no solver takes one, where it cannot be written, or where writing it would take too long.
    """
    if problem.linear_entries() > MOST_ENTRIES:
        return None
    able = [name for name in able_solvers(problem) if issubclass(BACKENDS[name], ProgramBackend)]
    for name in sorted(able, key=lambda name: BACKENDS[name].order):
        backend = solver_named(name)
        assert isinstance(backend, ProgramBackend)
        with suppress(Exception):  # an opinion never costs what it is about
            return in_time(partial(first_compiled, problem, backend, False), lambda: None)
    return None


def second_opinions(program: Program, solver: str, seconds: float, options: Options, isolate: bool) -> Iterator[tuple[str, RawResult]]:
    """Results of up to ``MOST`` other engines for the program within ``seconds``, each in a process of its own where the first was.

    Solvers that fail are left out.
    """
    began, heard = time.perf_counter(), 0
    for name in independent(program, solver):
        seconds_left = seconds - (time.perf_counter() - began)
        if heard >= MOST or seconds_left < LEAST_SECONDS:
            return
        own = replace(options, time_limit=seconds_left, iterations=None, no_improvement=None, gap=0.0, start=None, extra={})
        run = Run(name, program, own, apart=isolate or solver_named(name).needs_process)
        try:
            searched = search(run.go, Control(), seconds_left)
        except Exception:  # of whatever kind: an opinion never costs what it is about
            continue
        if searched.interrupted:
            return
        heard += 1
        yield name, searched.result


def unproved(claim: Claim, senses: Sequence[str], best: Evaluation | None, certificate: Certificate, whole: bool = True) -> bool:
    """Whether it claims no answer or no best one, or an optimum of a problem with choices (``whole``), without verified evidence."""
    status, exactness = claim.status(senses, best, certificate), claim.exactness
    if status in ("infeasible", "unbounded", "infeasible_or_unbounded"):
        heard = exactness.answer_is_valid if status == "unbounded" else exactness.infeasibility_is_valid and best is None
        return heard and not (certificate.infeasible or certificate.unbounded)
    if best is None or len(senses) > 1 or not whole or not claim.speaks_of(best):
        return False
    return certificate.bound is None or not same(certificate.bound, best.values[0], best.size, best.precision)


def heard_opinions(
    judge: Judge, run: Run, claim: Claim, best: Evaluation | None, certificate: Certificate, seconds: float, options: Options
) -> list[Claim]:
    """Claims of other solvers, found within ``seconds``, where a claim has no evidence or is refuted; ``judge`` judges their answers."""
    senses, compiled = judge.problem.senses, run.compiled
    whole = compiled is None or compiled.program.is_integer
    if not unproved(claim, senses, best, certificate, whole) and not contradictions(claim, senses, best, certificate):
        return []
    began = time.perf_counter()
    compiled = compiled or (program_of(judge.problem) if seconds > 0.0 else None)
    if compiled is None:
        return []
    claims = []
    for name, said in second_opinions(compiled.program, run.name, seconds - (time.perf_counter() - began), options, run.isolated):
        judge.consider(said.answer, f"the answer of {name}", compiled.decode)
        claims.append(Claim(name, said, compiled.exactness.then(said.holds), program=compiled.program))
    return claims


def compared(
    heard: Sequence[Claim], claim: Claim, senses: Sequence[str], best: Evaluation | None, certificate: Certificate, notes: list[str]
) -> tuple[tuple[Opinion, ...], list[str]]:
    """The opinions beside the claim, and the faults that they show: contradictions of which nothing refutes either side.

    ``notes`` receives those that are refuted.
    """
    opinions, faults = [], []
    for theirs in heard:
        said = theirs.said
        verdict = _verdict(theirs, claim, senses, best, certificate)
        one = Opinion(theirs.solver, said.status, said.objective, said.bound, verdict)
        opinions.append(one)
        if verdict == "is refuted":
            value = "" if one.objective is None else f" {one.objective!r}"
            notes.append(f"{one.solver} says {one.status}{value}, which {_refuting(one, certificate)} refutes")
        elif verdict == "contradicts":
            both = f"{claim.solver} claims {_in_words(claim.said)}, {one.solver} claims {_in_words(one)}"
            faults.append(f"{both}: nothing that was checked refutes either, and both cannot be right")
    return tuple(opinions), faults


def _verdict(theirs: Claim, ours: Claim, senses: Sequence[str], best: Evaluation | None, certificate: Certificate) -> str:
    said, status = theirs.said.status, ours.said.status
    if said not in ("optimal", "feasible", "infeasible", "unbounded"):
        return "undecided"
    if contradictions(theirs, senses, best, certificate):
        return "is refuted"
    if said == status == "optimal":
        their, our = theirs.values(len(senses)), ours.values(len(senses))
        if not (their and our):
            return "undecided"
        alike = theirs.near(our[0], their[0], 0.0 if best is None else best.size)
    else:
        alike = said == status or (status == "infeasible_or_unbounded" and said in ("infeasible", "unbounded"))
    if alike:
        return "agrees"
    if contradictions(ours, senses, best, certificate):
        return "refutes"
    return "undecided" if said == "feasible" and status != "infeasible" else "contradicts"


def _in_words(said: RawResult | Opinion) -> str:
    """A solver's claim as words for a message: ``the optimum 12.0``, ``that there is no answer``."""
    if said.status in ("optimal", "feasible") and said.objective is not None:
        return f"{'the optimum' if said.status == 'optimal' else 'an answer of'} {said.objective!r}"
    words = {"infeasible": "that there is no answer", "unbounded": "that there is no best answer"}
    return words.get(said.status, "that there is no answer or no best one" if said.status == "infeasible_or_unbounded" else said.status)


def _refuting(refuted: Opinion, certificate: Certificate) -> str:
    """The kind of fact that refutes a claim, in words."""
    bound, theirs = certificate.bound, refuted.objective
    ahead = theirs is not None and bound is not None and beats_bound(certificate.sense, theirs, bound)
    return "the verified bound" if ahead or refuted.status == "unbounded" else "the answer"
