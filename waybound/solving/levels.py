"""Bounds of objectives in order of priority: level by level, as long as those before are closed."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from ..formulations.certificate import Certificate, certify
from ..formulations.evaluation import Evaluation
from ..formulations.evidence import Evidence
from ..formulations.levels import LevelBound, best_level_bound, with_levels
from ..formulations.problem import Problem
from ..formulations.solution import Value
from ..formulations.verified_bounds import better_bound
from ..solvers.backend import LevelClaim
from ..solvers.linear_programs import LinearPrograms
from ..solvers.program_backend import EQUAL_TOLERANCE
from .bounding import bounded
from .recording import Progress
from .search import in_time


def further_levels(
    problem: Problem, certificate: Certificate, evaluation: Evaluation | None, seconds: float, linear: LinearPrograms, notes: list[str],
    begun: Callable[[str, float], Progress | None] = lambda phase, seconds: None,
) -> Certificate:  # fmt: skip
    """The certificate with verified bounds of the levels after the first, as long as verified bounds close all before.

    A level's bound is given the values of ``evaluation`` at the levels before; without an answer these are the bounds of the levels before,
    so that a bound is one of the answers that meet them, if there are any. ``seconds`` are for all levels together; ``notes`` receives a
    line for each method or checker that fails, ``begun`` hears of each level and of its seconds, and returns what receives the events of
    bounding.

    Raises CheckFailedError if a bound that was verified contradicts the answer.
    """
    levels: list[LevelBound] = []
    before: tuple[float, ...] = ()
    bound, ends, count = certificate.bound, time.perf_counter() + seconds, len(problem.senses)
    while bound is not None and len(before) + 1 < count and (evaluation is None or evaluation.same_at(len(before), bound)):
        before = (*before, bound) if evaluation is None else evaluation.values[: len(before) + 1]
        level, part, seconds_left = len(before), problem.given(before), ends - time.perf_counter()
        if part is None or seconds_left <= 0.0:
            break
        target = None if evaluation is None else evaluation.values[level]
        if target is None:  # nothing ends the search for a bound but its time
            seconds_left /= count - level
        progress = begun(f"bound of level {level + 1}", round(seconds_left, 1))
        searched = bounded(part, seconds_left, target=target, progress=progress, unable=notes, linear=linear)
        level_bound = best_level_bound(problem, before, evaluation, searched.result.evidence, notes)
        if level_bound is None:
            break
        levels.append(level_bound)
        bound = None if searched.interrupted else level_bound.bound
    if not levels:
        return certificate
    return replace(certificate, levels=tuple(levels)) if evaluation is None else with_levels(certificate, evaluation, levels)


def bound_alone(
    problem: Problem, seconds: float, linear: LinearPrograms, notes: list[str], progress: Progress | None = None
) -> tuple[Certificate, list[Evidence], float]:
    """A certificate without an answer, with a bound of each level; all evidence that was found of the first, and the seconds spent.

    ``seconds`` is the budget of all methods and levels together; Ctrl-C keeps what was found. ``notes`` receives a line for each method or
    checker that fails.
    """
    began = time.perf_counter()

    def begun(phase: str, seconds: float) -> Progress | None:
        return None if progress is None else lambda event: progress({**event, "phase": phase})

    searched = bounded(problem, seconds / len(problem.senses), progress=progress, unable=notes, linear=linear)
    evidence = list(searched.result.evidence)
    certificate = in_time(lambda: certify(problem, None, evidence, unproved=notes), lambda: certify(problem, None))
    seconds_left = seconds - (time.perf_counter() - began)
    if seconds_left > 0.0 and not searched.interrupted:
        certificate = further_levels(problem, certificate, None, seconds_left, linear, notes, begun)
    return certificate, evidence, time.perf_counter() - began


def bounds_of_levels(
    senses: Sequence[str], evaluation: Evaluation | None, proved: Sequence[LevelBound], claimed: Mapping[int, LevelClaim], claimant: str,
    first: float, kind: str | None, source: str | None,
) -> tuple[Value, str | None, str | None]:  # fmt: skip
    """The bound of each level up to the first open one, that of the first level given, with kind and source; None beyond.

    What a solver calls closed, as closely as it sees, has the bound that is the answer's own value: a level that is closed is no gap.
    """
    if evaluation is None:
        return [first, *[None] * (len(senses) - 1)], kind, source
    closed = evaluation.same_at(0, first, EQUAL_TOLERANCE)
    bounds: list[float | None] = [evaluation.values[0] if closed else first]
    for level, sense in enumerate(senses[1:], start=1):
        if not closed:
            break
        known = proved[level - 1] if level <= len(proved) else None
        bound = None if known is None else known.bound
        claim = claimed[level].bound if level in claimed else None
        ahead = claim is not None and math.isfinite(claim)
        if ahead and (bound is None or (better_bound(sense, claim, bound) and not evaluation.same_at(level, bound))):  # type: ignore[arg-type]
            bound, known = claim, None
        if bound is None:
            break
        closed = evaluation.same_at(level, bound, EQUAL_TOLERANCE if known is None else 0.0)
        bounds.append(evaluation.values[level] if closed else bound)
        if kind == "verified":
            kind, source = ("claimed", f"{source}, then {claimant}") if known is None else (kind, f"{source}, then {known.source}")
    return [*bounds, *[None] * (len(evaluation.values) - len(bounds))], kind, source
