"""A solver's claims against what was checked: a contradiction is an error, loudly."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..formulations.certificate import beats_bound, better_bound
from ..formulations.evaluation import Evaluation
from ..formulations.programs.exactness import Exactness
from ..formulations.tolerance import same
from ..instances.errors import CheckFailedError
from ..solvers.backend import LevelClaim, RawResult

CLAIM_TOLERANCE = 1e-5
"""Relative: engines accept points that are off by 1e-6 a row and a variable, so their own totals are off by more."""


def _far(claimed: float, known: float, size: float = 0.0) -> bool:
    return not same(claimed, known, size, CLAIM_TOLERANCE)


def check_objective(solver: str, senses: Sequence[str], result: RawResult, evaluation: Evaluation) -> None:
    """Raise CheckFailedError if the answer is worse than the solver claims.

    A better one refutes nothing: an incumbent's auxiliary variables may be slack. What it must not beat is the claimed bound or optimum.
    """
    if result.objective is None or (len(evaluation.values) != 1 and not result.further):
        return
    claimed = (result.objective, *(level.objective for level in result.further))
    for level, (direction, value) in enumerate(zip(senses, claimed, strict=False)):
        found = evaluation.values[level]
        worse = found > value if direction == "min" else found < value
        if worse and not evaluation.same_at(level, value, CLAIM_TOLERANCE):
            raise CheckFailedError(f"{solver} claims the objective {value!r}, the answer's value recomputed from the data is {found!r}")


def check_feasibility(solver: str, result: RawResult, evaluation: Evaluation, exactness: Exactness) -> None:
    """Raise CheckFailedError if an answer that should be feasible is not."""
    if result.status in ("optimal", "feasible") and exactness.answer_is_valid and not evaluation.feasible:
        worst = max(evaluation.violations, key=lambda v: v.amount)
        raise CheckFailedError(
            f"{solver} claims a {result.status} answer, but it breaks {len(evaluation.violations)} constraints; "
            f"the worst: {worst.message} (by {worst.amount:g})"
        )


def check_bound(solver: str, senses: Sequence[str], result: RawResult, evaluation: Evaluation | None, exactness: Exactness) -> None:
    """Raise CheckFailedError if the solver claims a bound, an optimum or infeasibility that a verified answer refutes."""
    if evaluation is None or not exactness.bound_is_valid:
        return
    best, size, sense = evaluation.values[0], evaluation.size, senses[0]
    if result.status == "infeasible":
        raise CheckFailedError(f"{solver} claims that there is no answer, but one of value {best!r} passed every check")
    if result.bound is not None and _far(result.bound, best, size) and beats_bound(sense, best, result.bound, size):
        raise CheckFailedError(f"{solver} claims the bound {result.bound!r}, but an answer of value {best!r} passed every check")
    if result.status == "optimal" and result.objective is not None and exactness is Exactness.EXACT:
        worse = result.objective > best if sense == "min" else result.objective < best
        if worse and _far(result.objective, best, size):
            raise CheckFailedError(f"{solver} claims the optimum {result.objective!r}, but an answer of value {best!r} passed every check")
    for level, claim in concerned(senses, result, evaluation):
        value, size = evaluation.values[level], evaluation.sizes[level] if evaluation.sizes else 0.0
        if claim.bound is not None and _far(claim.bound, value, size) and beats_bound(senses[level], value, claim.bound, size):
            raise CheckFailedError(
                f"{solver} claims the bound {claim.bound!r} at level {level + 1}, but an answer of value {value!r} there passed every check"
            )


def concerned(senses: Sequence[str], result: RawResult, evaluation: Evaluation) -> Iterator[tuple[int, LevelClaim]]:
    """The claims on levels after the first one that hold for the answer: for what is no worse than the claimed values at those before."""
    held = result.objective
    for level, claim in enumerate(result.further, start=1):
        before = evaluation.values[level - 1]
        if held is None or (better_bound(senses[level - 1], before, held) and not evaluation.same_at(level - 1, held, CLAIM_TOLERANCE)):
            return
        yield level, claim
        held = claim.objective


def check_verified(solver: str, sense: str, result: RawResult, verified: float | None, exactness: Exactness, size: float = 0.0) -> None:
    """Raise CheckFailedError if the solver claims an optimum better than a verified bound allows; ``size`` is that of the terms of one."""
    if verified is None or result.objective is None or result.status != "optimal" or not exactness.answer_is_valid:
        return
    if _far(result.objective, verified, size) and beats_bound(sense, result.objective, verified, size):
        raise CheckFailedError(f"{solver} claims the optimum {result.objective!r}, but the verified bound is {verified!r}")


def check_unbounded(solver: str, result: RawResult, unbounded: bool, exactness: Exactness) -> None:
    """Raise CheckFailedError if the solver claims an optimum, a bound, or no answer, where there are answers as good as one wants."""
    if unbounded and exactness is Exactness.EXACT and (result.status in ("optimal", "infeasible") or result.bound is not None):
        said = "that there is no answer" if result.status == "infeasible" else "a best answer" if result.status == "optimal" else "a bound"
        raise CheckFailedError(f"{solver} claims {said}, but it is proved that answers are as good as one wants")
