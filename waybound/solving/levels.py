"""Bounds of objectives in order of priority: a level after the other, as long as those before are closed."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence

from ..formulations.certificate import Certificate, better_bound
from ..formulations.evaluation import Evaluation
from ..formulations.levels import LevelBound, best_level_bound, with_levels
from ..formulations.problem import Problem
from ..formulations.solution import Value
from ..solvers.backend import Control, LevelClaim, RawResult
from ..solvers.linear_programs import LinearPrograms
from ..solvers.program_backend import EQUAL_TOLERANCE
from .bounding import find_bounds
from .recording import Recorder
from .search import BOUND_OVERTIME, search


def further_levels(
    problem: Problem, certificate: Certificate, evaluation: Evaluation, seconds: float, linear: LinearPrograms, record: Recorder,
    notes: list[str],
) -> Certificate:  # fmt: skip
    """The certificate with verified bounds of the levels after the first, as long as verified bounds close all before.

    Parameters
    ----------
    problem : Problem
    certificate : Certificate
        With a bound of the first level.
    evaluation : Evaluation
        Of the answer: its values at the levels before are what a level's bound is given.
    seconds : float
        For all levels together.
    linear : LinearPrograms
    record : Recorder
        Hears of each level that is begun.
    notes : list of str
        Receives a line for each method or checker that fails.

    Raises
    ------
    CheckFailedError
        If a bound that was verified contradicts the answer.
    """
    levels: list[LevelBound] = []
    closed, ends = certificate.bound is not None and evaluation.same_at(0, certificate.bound), time.perf_counter() + seconds
    while closed and len(levels) + 1 < len(problem.senses):
        level, left = len(levels) + 1, ends - time.perf_counter()
        part = problem.given(evaluation.values[:level])
        if part is None or left <= 0.0:
            break
        record.begin_phase(f"bound of level {level + 1}", round(left, 1))
        target = evaluation.values[level]

        def find(control: Control, part: Problem = part, left: float = left, target: float = target) -> RawResult:
            found = find_bounds(part, left, target=target, control=control, unable=notes, linear=linear)
            return RawResult("unknown", answer=found)

        searched = search(find, Control(), left, overtime=BOUND_OVERTIME)
        found = best_level_bound(problem, evaluation, level, searched.result.answer or (), notes)
        if found is None:
            break
        levels.append(found)
        closed = evaluation.same_at(level, found.bound) and not searched.interrupted
    return with_levels(certificate, evaluation, levels) if levels else certificate


def bounds_of_levels(
    problem: Problem, evaluation: Evaluation | None, proved: Sequence[LevelBound], claimed: Mapping[int, LevelClaim], claimant: str,
    first: float, kind: str | None, source: str | None,
) -> tuple[Value, str | None, str | None]:  # fmt: skip
    """The bound of each level up to the first open one, that of the first level given, with kind and source; None beyond.

    What a solver calls closed, as closely as it sees, has the bound that is the answer's own value: a level that is closed is no gap.
    """
    if evaluation is None:
        return [first, *[None] * (len(problem.senses) - 1)], kind, source
    closed = evaluation.same_at(0, first, EQUAL_TOLERANCE)
    bounds: list[float | None] = [evaluation.values[0] if closed else first]
    for level, sense in enumerate(problem.senses[1:], start=1):
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
