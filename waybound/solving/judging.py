"""What a search left behind, judged: the best answer that passes every check, and each claim that does not hold up beside it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from ..formulations.evaluation import Evaluation
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import Program
from ..instances.errors import CheckFailedError, NoAnswerError, SearchFailedError, WayboundError, in_words
from ..solvers.backend import RawResult
from .claims import Claim, false_answer


@dataclass
class Judge:
    """Decodes and judges candidates one by one; a fault in one costs none of the others.

    Attributes
    ----------
    problem : Problem
    solver : str
    exactness : Exactness
        How the solver's points relate to the problem's answers.
    decode : callable
        From the solver's raw answer to the problem's.
    notes : list of str
        What a user should be told.
    crash : exception, optional
        What ended the search before it left anything.
    program : Program, optional
        That was searched.
    faults : list of str
        Claims of the solver that a check refutes.
    own : Evaluation, optional
        Of the answer that the solver's own result hands over.
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
        """Judge the solver's own result; ``prices`` tells whether its objective is meant for the problem's."""
        claimed = result.status in ("optimal", "feasible") and self.exactness.answer_is_valid
        whose = f"the {result.status} answer claimed by {self.solver}" if claimed else f"the last answer of {self.solver}"
        if self.exactness is Exactness.RELAXATION:
            whose = "the relaxation's point"
        for earlier in result.earlier:
            self._consider(earlier, self.decode, f"an answer of {self.solver} to the levels before the last", False)
        if claimed and result.answer is None:
            self.notes.append(f"{self.solver} says {result.status} and hands over no answer")
        self.own = self._consider(result.answer, self.decode, whose, claimed)
        self.faults.extend(false_answer(self.claim(result, prices), self.problem.senses))

    def claim(self, result: RawResult, prices: bool = True) -> Claim:
        """What the solver says, of its own answer and of the problem."""
        return Claim(self.solver, result, self.exactness, self.own, prices, self.program)

    def incumbent(self, raw: Any) -> None:
        """Judge what the solver published last, which may be all that is left of it."""
        self._consider(raw, self.decode, f"the last incumbent of {self.solver}", False)

    def opinion(self, solver: str, raw: Any, decode: Callable[[Any], Any]) -> None:
        """Judge what another solver found, which was asked in its own terms."""
        self._consider(raw, decode, f"the answer of {solver}", False)

    def start(self, answer: Any) -> None:
        """Judge the user's start, which competes with what was found."""
        judged = self._consider(answer, lambda a: a, "the start", False)
        if judged is not None and not judged.feasible:
            self.notes.append(f"the start is only a hint, for it breaks: {judged.violations[0].message}")

    def at_hand(self, refutes: Callable[[Evaluation], object]) -> None:
        """Judge an answer that needs no search; it counts where it passes and refutes what is claimed, and is not heard of elsewhere."""
        with suppress(Exception):
            answer = self.problem.answer_at_hand()
            judged = None if answer is None else self.problem.evaluate(answer)
            if judged is not None and judged.feasible and refutes(judged):
                self._judged.append((answer, judged))

    def best(self) -> tuple[Any, Evaluation | None]:
        """The best feasible answer with its evaluation; (None, None) where there is none, and nobody claimed one.

        Raises
        ------
        CheckFailedError
            If there is none although the solver claimed one.
        SearchFailedError, NoAnswerError
            If a crash, or a lack of memory, ended the search before there was one.
        BaseException
            What kept the only candidate from being judged.
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

    def _consider(self, raw: Any, decode: Callable[[Any], Any], whose: str, claimed: bool) -> Evaluation | None:
        if raw is None:
            return None
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
