"""Bounds that checkers derive from evidence, and their comparison."""

import math
from dataclasses import replace
from typing import Any

from ..instances.errors import CheckFailedError, InputError
from . import tolerance
from .evidence import CHECKERS, ENDLESS, Evidence
from .problem import Problem


def better_bound(sense: str, a: float, b: float) -> bool:
    """Whether bound ``a`` is tighter than ``b``."""
    return a > b if sense == "min" else a < b


def beats_bound(sense: str, objective: float, bound: float, size: float = 0.0) -> bool:
    """Whether an objective is better than a bound allows, beyond rounding."""
    return better_bound(sense, bound, objective) and not tolerance.same(objective, bound, size)


def one_check_is_wrong(contradiction: str) -> CheckFailedError:
    """The error for two checks that cannot both be right."""
    return CheckFailedError(f"{contradiction}: one of the two checks is wrong; please report this")


def verified_bound(problem: Problem, evidence: Evidence) -> float:
    """The bound that the checker derives from ``evidence``; raises InputError where its shape is wrong.

    It is infinite where ``evidence`` proves nothing, or (with the other sign) that there is no answer: see ``EvidenceChecker``.
    """
    if evidence.kind in ENDLESS:
        return -math.inf if problem.sense == "min" else math.inf
    try:
        return float(CHECKERS[evidence.kind](problem, evidence.data)) + 0.0  # -0.0 is 0
    except _MALFORMED as fault:
        raise _malformed(evidence, fault) from fault


def proved(problem: Problem, kind: str, source: str, data: dict[str, Any]) -> Evidence:
    """The evidence, with the value that its checker derives from it."""
    evidence = Evidence(kind, source, 0.0, data)
    return replace(evidence, value=verified_bound(problem, evidence))


def proved_bound(problem: Problem, evidence: Evidence) -> float | None:
    """The bound that the checker derives from ``evidence``; None where it proves nothing, or its checker fails."""
    try:
        bound = verified_bound(problem, evidence)
    except Exception:  # told when the certificate is made, which asks every checker
        return None
    return bound if bound != (-math.inf if problem.sense == "min" else math.inf) else None


def proves_unbounded(problem: Problem, evidence: Evidence) -> bool:
    """Whether ``evidence`` proves that answers are as good as one wants; raises InputError where its shape is wrong."""
    try:
        return evidence.kind in ENDLESS and bool(ENDLESS[evidence.kind](problem, evidence.data))
    except _MALFORMED as fault:
        raise _malformed(evidence, fault) from fault


_MALFORMED = (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError)


def _malformed(evidence: Evidence, fault: Exception) -> InputError:
    return InputError(f"evidence of kind {evidence.kind} is malformed", found=f"{type(fault).__name__}: {fault}")
