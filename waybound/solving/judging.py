"""Answers and claims of a search, judged by one rule for backends, engines and heuristics.

The best answer that passes every check is kept. A claim that what was checked contradicts is an error, loudly, and stands for no answer
that it does not speak of.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ..formulations.certificate import Certificate
from ..formulations.evaluation import Evaluation
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import Program
from ..formulations.programs.reductions.units import objective_unit
from ..formulations.tolerance import same
from ..formulations.verified_bounds import better_bound
from ..instances.errors import CheckFailedError, NoAnswerError, SearchFailedError, WayboundError, in_words
from ..instances.text import an
from ..solvers.backend import LevelClaim, RawResult
from ..solvers.program_backend import EQUAL_TOLERANCE

CLAIM_TOLERANCE = 1e-5
"""Relative: engines accept points that are off by 1e-6 a row and a variable, so their own totals are off by more."""


@dataclass(frozen=True)
class Claim:
    """Claims of a search about a problem.

    ``exactness`` says how what is said relates to the problem: of a heuristic, which is ``NEITHER``, no word is a claim. ``own`` is the
    evaluation of the answer that it hands over, ``prices`` whether its objective is meant for the problem's. What solvers count as 1 in the
    objective of the ``program`` searched is the least size of a sum: where all terms vanish or cancel, theirs are off by a part of it.
    """

    solver: str
    said: RawResult
    exactness: Exactness = Exactness.EXACT
    own: Evaluation | None = None
    prices: bool = True
    program: Program | None = None

    @cached_property
    def _unit(self) -> float:
        return 0.0 if self.program is None else objective_unit(self.program)

    def values(self, levels: int) -> tuple[float, ...]:
        """Claimed values of the best answer, one per level; those of the returned answer if none are claimed; empty without either."""
        said = self.said
        claimed = () if said.objective is None else (said.objective, *(level.objective for level in said.further))
        if len(claimed) == levels:
            return claimed
        return self.own.values if self.own is not None and self.own.feasible else ()

    def bound(self, levels: int) -> float | None:
        """Claimed bound of the first level; a claimed optimum is one."""
        if self.said.bound is None and self.said.status == "optimal" and self.exactness is Exactness.EXACT:
            return next(iter(self.values(levels)), None)
        return self.said.bound if self.exactness.bound_is_valid else None

    def close(self, known: Evaluation, level: int, value: float) -> bool:
        """Whether ``value``, as the solver computes it, is that of an answer at a level."""
        size = known.sizes[level] if known.sizes else 0.0
        return self.near(known.values[level], value, size, known.precision, first=level == 0)

    def near(self, known: float, value: float, size: float = 0.0, precision: float = 0.0, first: bool = True) -> bool:
        """Whether ``value``, as the solver computes it, is ``known``; at the first level no finer than the solver's unit."""
        precision = max(CLAIM_TOLERANCE, precision)
        return same(known, value, size, precision) or (first and same(known, value, self._unit, precision))

    def speaks_of(self, best: Evaluation) -> bool:
        """Whether it claims that this answer is optimal; a relaxation does so by bounds that meet it within solvers' tolerance."""
        levels = len(best.values)
        if self.said.status != "optimal":
            return False
        if self.exactness is Exactness.RELAXATION:
            bounds = [self.said.bound, *(level.bound for level in self.said.further)]
            met = [bound is not None and best.same_at(k, bound, EQUAL_TOLERANCE) for k, bound in enumerate(bounds)]
            return len(met) == levels and all(met)
        values = self.values(levels) if self.exactness is Exactness.EXACT else ()
        return bool(values) and all(self.close(best, k, value) for k, value in enumerate(values))

    def concerned(self, senses: Sequence[str], best: Evaluation) -> Iterator[tuple[int, LevelClaim]]:
        """The claims on later levels that hold for an answer: for what is no worse than the claimed values at the levels before."""
        held = self.said.objective
        for level, claim in enumerate(self.said.further if self.exactness.bound_is_valid else (), start=1):
            before = best.values[level - 1]
            if held is None or (better_bound(senses[level - 1], before, held) and not self.close(best, level - 1, held)):
                return
            yield level, claim
            held = claim.objective

    def status(self, senses: Sequence[str], best: Evaluation | None, certificate: Certificate) -> str:
        """Claimed status; "infeasible or unbounded" is settled by an answer, or by verified bounds, where there are some."""
        if self.said.status == "infeasible_or_unbounded":
            return "infeasible" if _bounded(senses, certificate) else "unbounded" if best is not None else self.said.status
        return self.said.status


def _bounded(senses: Sequence[str], certificate: Certificate) -> bool:
    """Whether it is proved that every level of the objective is bounded."""
    return certificate.bound is not None and math.isfinite(certificate.bound) and len(certificate.levels) + 1 >= len(senses)


def false_answer(claim: Claim, senses: Sequence[str]) -> Iterator[str]:
    """Claims about the returned answer that the answer itself refutes.

    One better than claimed refutes nothing: an incumbent's auxiliary variables may be slack. What it must not beat is a claimed bound or
    optimum.
    """
    own, said = claim.own, claim.said
    if own is None:
        return
    if said.status in ("optimal", "feasible") and claim.exactness.answer_is_valid and not own.feasible:
        worst = max(own.violations, key=lambda v: v.amount)
        yield (
            f"{claim.solver} claims {an(said.status)} answer, but it breaks {len(own.violations)} constraints; "
            f"the worst: {worst.message} (by {worst.amount:g})"
        )
    if own.feasible and claim.prices and said.objective is not None and (len(own.values) == 1 or said.further):
        claimed = (said.objective, *(level.objective for level in said.further))
        for level, (sense, value) in enumerate(zip(senses, claimed, strict=False)):
            if better_bound(sense, own.values[level], value) and not claim.close(own, level, value):
                yield f"{claim.solver} claims the objective {value!r}, the answer's value recomputed from the data is {own.values[level]!r}"


def contradictions(claim: Claim, senses: Sequence[str], best: Evaluation | None, certificate: Certificate) -> list[str]:
    """The claims that the best answer that passed every check, or a proof, refutes."""
    return [f"{claim.solver} claims {words}" for words in _refuted(claim, senses, best, certificate)]


def _refuted(claim: Claim, senses: Sequence[str], best: Evaluation | None, certificate: Certificate) -> Iterator[str]:
    if best is not None:
        yield from _refuted_by_answer(claim, senses, best, claim.status(senses, best, certificate))
    yield from _refuted_by_proof(claim, senses, best, certificate)


def _refuted_by_answer(claim: Claim, senses: Sequence[str], best: Evaluation, status: str) -> Iterator[str]:
    said, exactness = claim.said, claim.exactness
    passed = f"an answer of value {best.values[0]!r} passed every check"
    if status == "infeasible" and exactness.infeasibility_is_valid:
        yield f"that there is no answer, but one of value {best.values[0]!r} passed every check"
    if said.bound is not None and exactness.bound_is_valid and _beaten(claim, senses, best, 0, said.bound):
        yield f"the bound {said.bound!r}, but {passed}"
    if status == "optimal" and exactness is Exactness.EXACT:
        values = claim.values(len(senses))
        apart = next((k for k, value in enumerate(values) if not claim.close(best, k, value)), None)
        if apart is not None and _beaten(claim, senses, best, apart, values[apart]):
            there = f" at level {apart + 1}" if apart else ""
            yield f"the optimum {values[apart]!r}{there}, but an answer of value {best.values[apart]!r}{there} passed every check"
    for level, further in claim.concerned(senses, best):
        if further.bound is not None and _beaten(claim, senses, best, level, further.bound):
            passed_there = f"an answer of value {best.values[level]!r} there passed every check"
            yield f"the bound {further.bound!r} at level {level + 1}, but {passed_there}"


def _refuted_by_proof(claim: Claim, senses: Sequence[str], best: Evaluation | None, certificate: Certificate) -> Iterator[str]:
    exactness, levels, verified = claim.exactness, len(senses), certificate.bound
    status, values = claim.status(senses, best, certificate), claim.values(levels)
    if exactness.answer_is_valid:
        size = 0.0 if best is None else best.size
        if status == "optimal" and values and verified is not None:
            ahead = better_bound(senses[0], verified, values[0]) and not claim.near(verified, values[0], size)
            if ahead:
                yield f"the optimum {values[0]!r}, but the verified bound is {verified!r}"
        if status == "unbounded" and _bounded(senses, certificate):
            yield f"that there is no best answer, but the verified bound is {verified!r}"
        if certificate.infeasible and (status == "unbounded" or (status == "optimal" and values)):
            yield f"{'a best answer' if status == 'optimal' else 'answers as good as one wants'}, but it is proved that there is none"
    if certificate.unbounded:
        what = "that there is no answer" if status == "infeasible" and exactness.infeasibility_is_valid else ""
        what = what or ("a best answer" if status == "optimal" and exactness is Exactness.EXACT else "")
        what = what or ("a bound" if claim.bound(levels) is not None else "")
        if what:
            yield f"{what}, but it is proved that answers are as good as one wants"


def _beaten(claim: Claim, senses: Sequence[str], best: Evaluation, level: int, value: float) -> bool:
    """Whether an answer is better at a level than ``value``, which nothing should be."""
    return better_bound(senses[level], value, best.values[level]) and not claim.close(best, level, value)


@dataclass
class Judge:
    """Decodes and judges candidates one by one; a fault in one costs none of the others.

    ``exactness`` says how the solver's points relate to the problem's answers, ``decode`` makes one of the other. ``crash`` is what ended
    the search before it left anything, ``program`` what was searched, if any, and ``own`` the evaluation of the answer in the solver's own
    result.
    """

    problem: Problem
    solver: str
    exactness: Exactness
    decode: Callable[[Any], Any]
    notes: list[str]
    crash: Exception | None = None
    program: Program | None = None
    faults: list[str] = field(default_factory=list)
    own: Evaluation | None = None
    _judged: list[tuple[Any, Evaluation]] = field(default_factory=list)
    _lost: list[BaseException] = field(default_factory=list)

    def last_word(self, result: RawResult, *, prices: bool) -> None:
        """Judge the solver's own result; ``prices``: whether its objective is that of the problem."""
        claimed = result.status in ("optimal", "feasible") and self.exactness.answer_is_valid
        whose = f"the {result.status} answer claimed by {self.solver}" if claimed else f"the last answer of {self.solver}"
        if self.exactness is Exactness.RELAXATION:
            whose = "the relaxation's point"
        for earlier in result.earlier:
            self.consider(earlier, f"an answer of {self.solver} to the levels before the last")
        if claimed and result.answer is None:
            self.notes.append(f"{self.solver} says {result.status} and hands over no answer")
        self.own = self.consider(result.answer, whose, claimed=claimed)
        self.faults.extend(false_answer(self.claim(result, prices), self.problem.senses))

    def claim(self, result: RawResult, prices: bool = True) -> Claim:
        """The solver's claims about its answer and the problem."""
        return Claim(self.solver, result, self.exactness, self.own, prices, self.program)

    def incumbent(self, raw: Any) -> None:
        """Judge what the solver published last, which may be all that is left of it."""
        self.consider(raw, f"the last incumbent of {self.solver}")

    def start(self, answer: Any) -> None:
        """Judge the user's start, which competes with what was found."""
        judged = self.consider(answer, "the start", lambda a: a)
        if judged is not None and not judged.feasible:
            self.notes.append(f"the start is only a hint, for it breaks: {judged.violations[0].message}")

    def at_hand(self, answer: Any, refutes: Callable[[Evaluation], object]) -> None:
        """Judge an answer that needs no search; it is kept only if it passes every check and refutes a claim."""
        judged = None if answer is None else self.problem.evaluate(answer)
        if judged is not None and judged.feasible and refutes(judged):
            self._judged.append((answer, judged))

    def best(self) -> tuple[Any, Evaluation | None]:
        """The best feasible answer with its evaluation; (None, None) where there is none, and nobody claimed one.

        Raises CheckFailedError if there is none although the solver claimed one; SearchFailedError, NoAnswerError if a crash, or a lack of
        memory, ended the search before there was one; or what kept the only candidate from being judged.
        """
        feasible = [pair for pair in self._judged if pair[1].feasible]
        if feasible:
            for level, sense in enumerate(self.problem.senses):
                best = (min if sense == "min" else max)((e for _, e in feasible), key=lambda e: e.values[level])
                if level + 1 < len(best.values):  # rounding of one level does not decide before the next
                    feasible = [pair for pair in feasible if pair[1].same_at(level, best.values[level])]
                else:
                    feasible = [pair for pair in feasible if pair[1].values[level] == best.values[level]]
            return feasible[0]
        if self.faults:
            raise CheckFailedError("; ".join(self.faults))
        if self.crash is not None:
            kind = NoAnswerError if isinstance(self.crash, MemoryError) else SearchFailedError
            raise kind(f"{self.solver} failed: {in_words(self.crash)}") from self.crash
        for fault in self._lost:
            raise fault
        return None, None

    def consider(self, raw: Any, whose: str, decode: Callable[[Any], Any] | None = None, *, claimed: bool = False) -> Evaluation | None:
        """Evaluate a candidate, ``whose`` in messages, and remember it; None, with a note, if it cannot be decoded or judged.

        ``decode`` turns ``raw`` into an answer, by default as for the solver's own results.
        """
        if raw is None:
            return None
        decode = decode or self.decode
        try:
            try:
                answer, judged = self._evaluated(raw, decode)
            except KeyboardInterrupt:  # asks for an end, not for the loss of the answer; the second one is heeded
                answer, judged = self._evaluated(raw, decode)
        except WayboundError as fault:
            (self.faults if claimed else self.notes).append(f"{whose} is no answer: {in_words(fault)}")
            return None
        except (Exception, KeyboardInterrupt) as fault:
            self._lost.append(fault)
            self.notes.append(f"{whose} could not be judged: {in_words(fault)}")
            return None
        self._judged.append((answer, judged))
        if not judged.feasible and not claimed and whose != "the start":
            self.notes.append(f"{whose} breaks: {judged.violations[0].message}")
        return judged

    def _evaluated(self, raw: Any, decode: Callable[[Any], Any]) -> tuple[Any, Evaluation]:
        answer = decode(raw)
        return answer, self.problem.evaluate(answer)
