"""Every word that is shown of a problem against the exact truth about it."""

import json
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from truth.families import Truth

from waybound import Evidence, Problem, Solution
from waybound.formulations.certificate import Certificate, certify, check_certificate

SAME = 1e-9
"""Relative difference up to which two values are one."""

ENDED = 1e-6
"""Relative difference from the optimum up to which a vector may be called optimal: solvers end near it."""

VANISHING = 64 * 5e-324
"""Below this doubles have no digits left to be wrong in."""


def away(a: float | Fraction, b: float | Fraction) -> float:
    """Relative difference; infinite between infinity and anything else."""
    if a == b:
        return 0.0
    if any(isinstance(v, float) and not math.isfinite(v) for v in (a, b)):
        return math.inf
    if abs(Fraction(a) - Fraction(b)) <= VANISHING:
        return 0.0
    a, b = Fraction(a), Fraction(b)
    part = abs(a - b) / max(abs(a), abs(b))
    return float(part)


def ratio(a: float | Fraction, b: float | Fraction) -> float:
    """Worse over better; 1 for equal values, infinite where their signs differ or one is 0."""
    a, b = Fraction(a), Fraction(b)
    if a == b:
        return 1.0
    small, large = sorted((abs(a), abs(b)))
    return math.inf if a * b <= 0 or large / small > 10**300 else float(large / small)


def rounded(truth: Truth, value: float, bound: float) -> bool:
    """Whether the value is the optimum, and the bound says so but for what rounding does to the sums behind it."""
    if truth.best is None:
        return False
    apart = abs(Fraction(value) - truth.best[0])
    if apart > abs(truth.best[0]) * Fraction(SAME) and not (truth.mixed and apart <= truth.size * Fraction(1, 10**12)):
        return False
    return abs(Fraction(bound) - Fraction(value)) <= truth.size * (Fraction(ENDED) if truth.continuous else Fraction(1, 10**12))


def wrong_side(truth: Truth, bound: float) -> bool:
    """Whether a bound says that the optimum cannot be reached."""
    best, limit = truth.best[0], Fraction(bound)
    slack = abs(best) * Fraction(SAME) + (Fraction(VANISHING) if best else 0)
    return limit > best + slack if truth.senses[0] == "min" else limit < best - slack


def of_bound(truth: Truth, bound: float | None, source: str) -> Iterator[str]:
    """What is false about a verified bound."""
    if bound is None or not math.isfinite(bound):
        return
    if truth.unbounded:
        yield f"false bound: {bound!r} by {source} of an unbounded problem"
    elif truth.best is not None and wrong_side(truth, bound):
        yield f"false bound: {bound!r} by {source}, the optimum is {float(truth.best[0])!r}"


def of_answer(truth: Truth, answer: Any, shown: Sequence[float], who: str, close: float = SAME) -> Iterator[str]:
    """What is false about a feasible answer and its value."""
    exact = truth.value(answer)
    if exact is None:
        yield f"infeasible answer shown by {who}: {answer}"
        return
    for told, value in zip(shown, exact, strict=True):
        # Sums of terms of both signs are known as closely as the terms.
        size = max(abs(value), truth.size) if truth.mixed else abs(value)
        if not math.isfinite(told) or abs(Fraction(told) - value) > size * Fraction(close) + Fraction(VANISHING):
            yield f"false value: {told!r} shown by {who}, it is {float(value)!r}"


def of_certificate(truth: Truth, c: Certificate, who: str) -> Iterator[str]:
    """What is false about a certificate as such: bound, infeasibility, and gap and ratio beside them."""
    yield from of_bound(truth, c.bound, f"{c.bound_source} ({who})")
    if c.infeasible and (truth.best is not None or truth.unbounded):
        yield f"false infeasibility proved by {c.bound_source} ({who})"
    value = c.objective[0] if isinstance(c.objective, list) else c.objective
    if value is None or c.bound is None:
        return
    if not math.isfinite(value):
        yield f"the value {value!r} has a certificate ({who})"
        return
    if abs(value) <= VANISHING >= abs(c.bound):
        return
    true, told = ratio(value, c.bound), c.observed_ratio
    true = 1.0 if told == 1.0 and (away(value, c.bound) == 0 or rounded(truth, value, c.bound)) else true
    if told is not None and away(told, true) > ENDED:
        yield f"false ratio: {told!r} between {value!r} and {c.bound!r} ({who})"
    if told is None and 1.0 < true < 1e290 and abs(c.bound) > 1e-290 < abs(value):
        yield f"no ratio between {value!r} and {c.bound!r} ({who})"
    worse = truth.best is not None and truth.better(truth.best[:1], (Fraction(value),))
    if told is not None and worse and away(value, truth.best[0]) > 0 and ratio(value, truth.best[0]) > told * (1.0 + ENDED):
        yield f"false ratio: {told!r}, between the value {value!r} and the optimum {float(truth.best[0])!r} it is more ({who})"
    yield from of_gap(truth, value, c.bound, c.gap, who)


def of_gap(truth: Truth, value: float, bound: float, gap: float | None, who: str) -> Iterator[str]:
    """What is false about a gap between a value and a bound: it is in parts of the value, or of 1e-9 of what was added up.

    Where the two are as good as one, it is in parts of what was added up.
    """
    if gap is None or value == 0 or away(value, bound) == 0 or rounded(truth, value, bound):
        return
    apart = abs(Fraction(bound) - Fraction(value))
    true = apart / abs(Fraction(value))
    floor = Fraction(SAME) if gap > ENDED else 1
    floored = gap > 0 and math.isfinite(gap) and apart / Fraction(gap) <= floor * max(abs(Fraction(bound)), truth.size) * 2
    if floored and gap <= true:
        return
    if gap != float(true if true < 10**300 else math.inf) and abs(Fraction(gap) - true) > Fraction(ENDED) * max(true, Fraction(ENDED)):
        yield f"false gap: {gap!r} between {value!r} and {bound!r} ({who})"


def of_round_trip(problem: Problem, c: Certificate, answer: Any) -> Iterator[str]:
    """What is lost of a certificate and an answer on their way through JSON."""
    data = json.loads(json.dumps(c.to_json(with_evidence=True), allow_nan=False))
    evaluation = None
    if answer is not None:
        back = json.loads(json.dumps(problem.answer_to_json(answer), allow_nan=False))
        evaluation = problem.evaluate(problem.answer_from_json(back))
        if not evaluation.feasible:
            yield f"an answer read back breaks {evaluation.violations[0].message}"
            return
    made = check_certificate(problem, data, evaluation)
    if made.bound != c.bound or made.infeasible != c.infeasible:
        yield f"a certificate read back proves {made.bound!r}, {made.infeasible}, not {c.bound!r}, {c.infeasible}"


def of_solution(truth: Truth, s: Solution, *, ours: bool = True) -> Iterator[str]:
    """What is false about a solution. ``ours``: its status is our own word, not a solver's claim."""
    who, c = s.solver, s.certificate
    yield from of_certificate(truth, c, who)
    yield from of_round_trip(s.problem, c, s.answer)
    verified = s.bound_kind == "verified"
    if s.answer is None:
        if s.status == "infeasible" and (ours or c.infeasible) and truth.best is not None:
            yield f"false infeasibility: {who}, optimum {float(truth.best[0])!r}"
        return
    shown = s.objective if isinstance(s.objective, list) else [s.objective]
    yield from of_answer(truth, s.answer, shown, who, 10 * ENDED if truth.continuous and not ours else SAME)
    bound = s.bound[0] if isinstance(s.bound, list) else s.bound
    if s.status == "infeasible":
        yield f"infeasible with an answer: {who}"
    if bound is not None and verified and len(shown) == 1:
        yield from of_gap(truth, shown[0], bound, s.gap, who)
        if s.status == "optimal" and ours and away(shown[0], bound) > ENDED and not rounded(truth, shown[0], bound):
            yield f"optimal beside a verified bound {bound!r} for {shown[0]!r} ({who})"
    if s.status == "optimal" and ours and truth.best is not None:
        exact = truth.value(s.answer)
        worse = exact is not None and truth.better(truth.best, exact)
        if worse and any(away(a, b) > (ENDED if truth.continuous else SAME) for a, b in zip(exact or (), truth.best, strict=True)):
            yield f"false optimality: {shown!r} by {who}, the optimum is {[float(v) for v in truth.best]!r}"
    stated = c.guarantee
    if stated is not None and truth.best is not None and "E[" not in stated.statement:
        exact = truth.value(s.answer)
        if exact is not None and truth.better(truth.best, exact) and ratio(exact[0], truth.best[0]) > stated.ratio * (1.0 + SAME):
            yield f"false guarantee: {stated.ratio!r} stated by {who}, the ratio is {ratio(exact[0], truth.best[0])!r}"


def of_samples(problem: Problem, truth: Truth, evidence: Sequence[Evidence], most: int = 3) -> Iterator[str]:
    """What is false when exact answers meet all the evidence there is: judged, certified and read back."""
    for answer in truth.samples[:most]:
        evaluation = problem.evaluate(answer)
        if not evaluation.feasible:
            if not truth.continuous:  # a vertex in doubles may lie outside
                yield f"an exact answer is refused: {evaluation.violations[0].message}"
            continue
        c = certify(problem, evaluation, evidence)
        if not truth.continuous:
            yield from of_answer(truth, answer, evaluation.values, "the judge")
        yield from of_certificate(truth, c, "certify")
        yield from of_round_trip(problem, c, answer)
