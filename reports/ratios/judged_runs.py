"""Runs of heuristics, judged: their values from the data alone, ratios to the optimum, stated guarantees and bounds."""

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...formulations.certificate import check_certificate
from ...formulations.evidence import Guarantee
from ...formulations.json_text import json_text
from ...formulations.problem import Problem
from ...formulations.stop import NEVER
from ...formulations.verified_bounds import better_bound, verified_bound
from ...heuristics.heuristic import HEURISTICS, Context, Outcome
from ...instances.errors import CheckFailedError, InputError
from ...solvers.linear_programs import LinearPrograms
from .optimum import Optimum, optimum

TOLERANCE = 1e-6
"""Relative difference up to which two values count as the same."""

SECONDS = 60.0
"""Time limit of one run of a heuristic; the small instances of a study need a fraction of it."""

Options = Mapping[str, Any] | Callable[[Problem, np.random.Generator], Mapping[str, Any]]

Expected = float | tuple[float, float] | None
"""The ratio of the literature's own formula, or where it depends on the run the least and the largest it may be; None for no guarantee."""

Checks = Callable[[Any, Mapping[str, Any], int, Outcome], Iterable[tuple[str, str]]]
"""``checks(problem, options, seed, outcome)``: faults of an outcome beside other answers, as (kind, message)."""


@dataclass(frozen=True)
class Case:
    """A problem with its optimum, by construction or to be found by ``optimum``."""

    problem: Problem
    optimum: Optimum | None = None

    def solved(self) -> Optimum:
        """The optimum."""
        return optimum(self.problem) if self.optimum is None else self.optimum


@dataclass(frozen=True)
class Configuration:
    """A heuristic with its options, and the ratio that the literature states for it.

    ``expected`` gives the ratio (>= 1) that must be stated on a problem, no other; it knows nothing of the heuristic. More than one of
    ``repeats`` stands for a guarantee in expectation, which the mean of that many runs tests. Problems that it does not take are left out.
    ``checks`` look at what a run must have in common with other answers.
    """

    label: str
    heuristic: str
    expected: Callable[[Any], Expected]
    options: Options = field(default_factory=dict)
    repeats: int = 1
    takes: Callable[[Any], bool] = lambda problem: True
    checks: Checks = lambda problem, options, seed, outcome: ()

    def chosen(self, problem: Problem, rng: np.random.Generator) -> dict[str, Any]:
        """The options for a problem."""
        return dict(self.options(problem, rng) if callable(self.options) else self.options)


@dataclass(frozen=True)
class Run:
    """One run, judged: ``ratio`` is worse over better, ``stated`` that of the heuristic, ``bound`` the best that the checker proved."""

    value: float
    optimum: float
    ratio: float
    stated: float | None
    bound: float | None
    faults: tuple[tuple[str, str], ...] = ()


def ratio_of(sense: str, value: float, best: float) -> float:
    """Worse over better: optimum over value for ``max``; 1 where both are 0, infinite where the worse one is 0 or negative."""
    better, worse = (best, value) if sense == "max" else (value, best)
    if abs(better - worse) <= 1e-12 * max(1.0, abs(better)):
        return 1.0
    return better / worse if worse > 0 else math.inf


def run_heuristic(problem: Problem, name: str, options: Mapping[str, Any], seed: int) -> Outcome:
    """The heuristic alone, without the search around it: the same as in ``solve``, with the same random draws."""
    context = Context(
        rng=np.random.default_rng(seed), time_limit=SECONDS, start=None, publish=lambda answer: None, stop=NEVER,
        linear=LinearPrograms(seed=seed),
    )  # fmt: skip
    return HEURISTICS[name].run(problem, context, **options)


def judge(
    problem: Problem,
    best: Optimum,
    outcome: Outcome,
    expected: Expected = None,
    *,
    in_expectation: bool = False,
    tolerance: float = TOLERANCE,
) -> Run:
    """Judge the outcome of a heuristic, which must state the ratio ``expected``, neither a weaker nor a stronger one.

    With ``in_expectation`` the ratio of this single run is no fault: only a mean can break the guarantee.
    """
    judged = problem.evaluate(outcome.answer)
    value, faults = judged.values[0], []
    if not judged.feasible:
        faults.append(("answer", f"the answer fails its check: {judged.violations[0].message}"))
    ratio = ratio_of(problem.sense, value, best.value)
    slack = tolerance * max(1e-9, abs(best.value))
    ahead = value - best.value if problem.sense == "max" else best.value - value
    if judged.feasible and ahead > slack:
        faults.append(("optimum", f"a value of {value!r} is better than the optimum {best.value!r} by {best.source}"))
    faults += _guarantee_faults(outcome.guarantee, expected)
    stated = None if outcome.guarantee is None else outcome.guarantee.ratio
    if stated is not None and not in_expectation and not ratio <= stated * (1.0 + tolerance):
        faults.append(("ratio", f"value {value!r} against the optimum {best.value!r}: ratio {ratio:.9g}, stated {stated:.9g}"))
    bound = None
    for evidence in outcome.evidence:
        try:
            proved = verified_bound(problem, evidence)
        except InputError as error:
            faults.append(("bound", str(error)))
            continue
        short = best.value - proved if problem.sense == "max" else proved - best.value
        if short > slack:
            faults.append(("bound", f"evidence {evidence.kind} proves {proved!r}, and the optimum is {best.value!r}"))
        if bound is None or better_bound(problem.sense, proved, bound):
            bound = proved
    return Run(value, best.value, ratio, stated, bound, tuple(faults))


def _guarantee_faults(guarantee: Guarantee | None, expected: Expected) -> list[tuple[str, str]]:
    least, most = expected if isinstance(expected, tuple) else (expected, expected)
    if guarantee is None:
        return [] if most is None else [("guarantee", f"no guarantee is stated, where the literature has a ratio of {most:.9g}")]
    if not guarantee.ratio >= 1.0:
        return [("guarantee", f"a stated ratio of {guarantee.ratio!r}; ratios are at least 1")]
    if least is None or most is None:
        return [("guarantee", f"a ratio of {guarantee.ratio:.9g} is stated, where none is known")]
    if guarantee.ratio > most * (1.0 + TOLERANCE):
        return [("guarantee", f"the stated ratio {guarantee.ratio:.9g} is weaker than that of the literature, {most:.9g}")]
    if guarantee.ratio < least * (1.0 - TOLERANCE):
        return [("guarantee", f"the stated ratio {guarantee.ratio:.9g} is stronger than that of the literature, {least:.9g}")]
    return []


def audit(
    problem: Problem, name: str, options: Mapping[str, Any], seed: int, best: Optimum, direct: Outcome
) -> tuple[tuple[str, str], ...]:
    """Faults of the same run through ``solve``, its certificate written, read back and verified.

    The answer must have the value of the ``direct`` run and the guarantee must be the same, and no bound may contradict the optimum.
    """
    from ...solving.request import Request
    from ...solving.solve import solve

    faults: list[tuple[str, str]] = []
    try:
        solution = solve(problem, Request(heuristic=name, seed=seed, time_limit=SECONDS, bound_time=1.0, options=dict(options)))
        if solution.answer is None:
            return (("certificate", f"solve brought no answer: {solution.message}"),)
        again = problem.evaluate(solution.answer)
        verified = check_certificate(problem, json.loads(json_text(solution.certificate.to_json(with_evidence=True))), again)
    except (CheckFailedError, InputError) as error:
        return (("certificate", str(error)),)
    faults.extend(("certificate", fault) for fault in solution.faults)
    value = problem.evaluate(direct.answer).values[0]
    if abs(again.values[0] - value) > TOLERANCE * max(1.0, abs(value)):
        faults.append(("certificate", f"solve brought a value of {again.values[0]!r}, the run by itself {value!r}"))
    stated = None if solution.certificate.guarantee is None else solution.certificate.guarantee.ratio
    own = None if direct.guarantee is None else direct.guarantee.ratio
    if stated != own:
        faults.append(("certificate", f"the certificate states the ratio {stated}, the run by itself {own}"))
    slack = TOLERANCE * max(1e-9, abs(best.value))
    if verified.bound is not None and (best.value - verified.bound if problem.sense == "max" else verified.bound - best.value) > slack:
        faults.append(("bound", f"the certificate proves {verified.bound!r} by {verified.bound_source}, and the optimum is {best.value!r}"))
    return tuple(faults)
