"""Verified bounds of the levels of priority after the first: each holds for all answers that are no worse at the levels before."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..instances.errors import CheckFailedError, InputError, in_words
from . import tolerance
from .evaluation import Evaluation
from .evidence import Evidence
from .problem import Problem
from .rendering import number
from .stated import real, stated_evidence
from .verified_bounds import beats_bound, better_bound, one_check_is_wrong, verified_bound

if TYPE_CHECKING:
    from .certificate import Certificate

MOST_LEVELS = 20
"""More levels in a certificate file are refused."""


@dataclass(frozen=True)
class LevelBound:
    """A verified bound of one level of an objective in order of priority.

    ``given`` holds values of the levels before: the bound holds for all answers that are no worse there. ``evidence``: on
    ``problem.given(given)``, whose first level is the one that is bounded.
    """

    given: tuple[float, ...]
    bound: float
    evidence: Evidence

    @property
    def source(self) -> str:
        """The source of its proof, in words."""
        return self.evidence.source

    def to_json(self, *, with_evidence: bool = False) -> dict[str, Any]:
        """Plain data; ``evidence`` only where it is asked for."""
        data = {"given": list(self.given), "bound": self.bound, "source": self.source}
        return {**data, "evidence": self.evidence.to_json()} if with_evidence else data


def best_level_bound(
    problem: Problem,
    before: tuple[float, ...],
    evaluation: Evaluation | None,
    evidence: Sequence[Evidence],
    unproved: list[str] | None = None,
) -> LevelBound | None:
    """The best of ``evidence`` on ``problem.given(before)``, each piece read by its checker; None where nothing is proved.

    ``before`` holds values of the levels before: the answer's, or, where there is none, any. ``evaluation``: of an answer, whose value at
    the level no bound may contradict. ``unproved``: receives a line for each piece whose checker fails, and where no answer is worth
    ``before``. Raises CheckFailedError if a verified bound contradicts the value that a feasible answer has at the level.
    """
    level = len(before)
    part, sense = problem.given(before), problem.senses[level]
    best: LevelBound | None = None
    if part is None:
        return None
    for piece in evidence:
        try:
            bound = verified_bound(part, piece)
        except Exception as fault:
            if unproved is not None:
                unproved.append(f"{piece.source} is no bound of level {level + 1}: {in_words(fault)}")
            continue
        if math.isfinite(bound) and (best is None or better_bound(sense, bound, best.bound)):
            best = LevelBound(before, bound, replace(piece, value=bound))
        elif bound == (math.inf if sense == "min" else -math.inf):
            if evaluation is None:
                if unproved is not None:
                    unproved.append(f"no solution is worth {number(before)} before level {level + 1}: {piece.source}")
                return None
            known = f"an answer passed every check, but {piece.source} proves that none is as good"
            raise one_check_is_wrong(f"{known} before level {level + 1}")
    if best is not None and evaluation is not None and evaluation.feasible:
        size = evaluation.sizes[level] if evaluation.sizes else 0.0
        if beats_bound(sense, evaluation.values[level], best.bound, size):
            value = f"the answer's value {evaluation.values[level]!r} at level {level + 1}"
            raise one_check_is_wrong(f"{value} is better than the bound {best.bound!r} derived from {best.source}")
    return best


def with_levels(certificate: "Certificate", evaluation: Evaluation, levels: Sequence[LevelBound]) -> "Certificate":
    """The certificate with the bounds of further levels, and the gap of the first level that is open."""
    extended = replace(certificate, levels=tuple(levels))
    for level, bound in enumerate([certificate.bound, *(one.bound for one in levels)]):
        if bound is None:
            return extended
        size = evaluation.sizes[level] if evaluation.sizes else 0.0
        value = evaluation.values[level]
        extended = replace(extended, gap=tolerance.gap(value, bound, size, evaluation.precision))
        if not evaluation.same_at(level, bound):
            return extended
    return extended if len(levels) + 1 == len(evaluation.values) else replace(extended, gap=None)


def check_levels(problem: Problem, data: Any, evaluation: Evaluation | None, of_answer: bool = True) -> tuple[LevelBound, ...]:
    """Verify the further levels of a certificate file, which is one ``of_answer`` or of bounds alone.

    Bounds alone are given bounds: what they say of other answers than the one at hand is verified and left out.

    Raises InputError if they are malformed. Raises CheckFailedError if one states more than its evidence proves, or speaks of other values
    than the answer's.
    """
    if data is None:
        return ()
    if not isinstance(data, list) or len(data) > min(MOST_LEVELS, len(problem.senses) - 1):
        raise InputError("the certificate's levels are malformed", expected=f"a list of at most {len(problem.senses) - 1} objects")
    bounds = []
    for level, entry in enumerate(data, start=1):
        if not isinstance(entry, Mapping) or not {"given", "bound", "evidence"} <= entry.keys() or not isinstance(entry["given"], list):
            raise InputError("the certificate's levels are malformed", expected="objects with given, bound and evidence")
        values = tuple(real(value, "level") for value in entry["given"])
        if len(values) != level:
            expected = f"{level} values before level {level + 1}"
            raise InputError("the certificate's levels are malformed", "wrong-shape", expected=expected, found=str(len(values)))
        concerned = evaluation is None or all(evaluation.same_at(k, value) for k, value in enumerate(values))
        if evaluation is not None and of_answer and not concerned:
            raise CheckFailedError(
                f"the certificate's bound of level {level + 1} is given {list(values)}, the answer is worth {evaluation.objective}"
            )
        (piece,) = stated_evidence({"evidence": [entry["evidence"]]})
        part = problem.given(values)
        proved = None if part is None else verified_bound(part, piece)
        stated, sense = real(entry["bound"], "bound of a level"), problem.senses[level]
        if proved is None or not math.isfinite(proved) or (better_bound(sense, stated, proved) and not tolerance.same(stated, proved)):
            raise CheckFailedError(f"the certificate states the bound {stated!r} at level {level + 1}, its evidence proves {proved!r}")
        if concerned:
            bounds.append(LevelBound(values, proved, replace(piece, value=proved)))
    return tuple(bounds)
