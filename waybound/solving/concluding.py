"""Makes a solution of the result of a search: nothing is believed that was not checked."""

import math
import platform
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from .._version import __version__
from ..formulations.certificate import Certificate, certify, judged_only
from ..formulations.evaluation import Evaluation
from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.solution import Opinion, Solution, Value, relative_gap
from ..formulations.tolerance import EQUAL, same
from ..formulations.verified_bounds import better_bound, proved_bound
from ..instances.errors import CheckFailedError, in_words
from ..solvers.backend import Control, Options, RawResult
from .bounding import Bounding, bounded
from .judging import Claim, Judge, contradictions
from .levels import bounds_of_levels, further_levels
from .method import Run
from .opinions import compared, heard_opinions
from .recording import BOUNDING, Recorder
from .search import Searched, in_time, search


def conclude(
    problem: Problem, run: Run, searched: Searched, control: Control, options: Options, bounding: Bounding, record: Recorder,
    crash: Exception | None,
) -> Solution:  # fmt: skip
    """Believe nothing: decode and judge every answer, bound, certify, and only then say how it ended.

    ``control`` is the line to the search, with the last answer that it published, and ``crash`` what ended it before it left anything; the
    budget of ``bounding`` is that of second opinions, too. From the judge's verdict on, whatever fails or is interrupted costs what it
    would have added, never the answer. Raises CheckFailedError if a claim does not hold up, and there is neither an answer nor a proof that
    there is none.
    """
    began = time.perf_counter()
    try:
        conclusion = _judged(problem, run, searched, control, options, bounding, crash)
    except KeyboardInterrupt:  # asks for an end, not for the loss of the answer; a second one is heeded
        conclusion = _judged(problem, run, searched, control, options, bounding, crash)
    conclusion.seconds["check"] = time.perf_counter() - began
    verdict = replace(conclusion, seconds=dict(conclusion.seconds))
    if conclusion.best is not None:
        record.judged(run.name, conclusion.best.values)
    try:
        conclusion.gather_evidence(record)
        conclusion.verify(record)
        conclusion.bound_later_levels(record)
        conclusion.hear_others()
        return conclusion.solution()
    except CheckFailedError:  # and no answer
        raise
    except (Exception, KeyboardInterrupt) as fault:
        run.notes.append(f"no bound was verified: {in_words(fault)}")
        verdict.certificate = judged_only(problem, verdict.best)
        return verdict.solution()


def _judged(
    problem: Problem, run: Run, searched: Searched, control: Control, options: Options, bounding: Bounding, crash: Exception | None
) -> "Conclusion":
    """The best of the engine's last word, its published incumbent and the start, before anything bounds it."""
    result = searched.result
    exactness = Exactness.NEITHER if run.heuristic else run.exactness.then(result.holds)
    judge = Judge(problem, run.name, exactness, run.decode, run.notes, crash, None if run.compiled is None else run.compiled.program)
    judge.last_word(result, prices=run.compiled is None or exactness is Exactness.EXACT)
    if control.answer is not result.answer:
        judge.incumbent(control.answer)
    judge.start(options.start)
    answer, best = judge.best()
    if result.status == "error" and best is not None:  # what is left is not from this search
        why = result.message if crash is None else in_words(crash)
        judge.faults.append(f"{run.name} failed: {why or 'it does not say why'}")
    return Conclusion(judge, run, searched, options, bounding, answer, best)


@dataclass
class Conclusion:
    """All that is known after a search: answers are judged first, each step adds bounds or opinions, and ``solution`` sums up.

    ``answer`` and ``best``, its evaluation, passed every check; ``certificate`` is what the checkers make of ``evidence``, from ``verify``
    on, and ``checked`` has what they said of some of it already. ``seconds`` were spent on bounding and on checking; ``opinions`` are what
    other solvers say of a claim that has no evidence, and ``disagreements`` the faults that these show.
    """

    judge: Judge
    run: Run
    searched: Searched
    options: Options
    bounding: Bounding
    answer: Any
    best: Evaluation | None
    certificate: Certificate = field(init=False)
    seconds: dict[str, float] = field(default_factory=lambda: {"bound": 0.0, "check": 0.0})
    evidence: list[Evidence] = field(default_factory=list)
    checked: list[tuple[Evidence, float]] = field(default_factory=list)
    opinions: tuple[Opinion, ...] = ()
    disagreements: list[str] = field(default_factory=list)

    @cached_property
    def claim(self) -> Claim:
        """The search's claims about the problem."""
        return self.judge.claim(self.searched.result)

    @property
    def problem(self) -> Problem:
        return self.judge.problem

    # -- the steps --------------------------------------------------------------------------------------------------------

    def gather_evidence(self, record: Recorder) -> None:
        """Collect what was found before the search, what the search leaves, and what bounding finds where that proves nothing."""
        began = time.perf_counter()
        self.evidence = list(self.bounding.first)
        try:
            self._from_the_search()
            if self.searched.interrupted:
                self.evidence.extend(self.bounding.line.evidence)
                self._hear_bounding(self.bounding.line.answer, record)
            elif not self._search_proves():
                self._from_bounding(record)
        except (Exception, KeyboardInterrupt) as fault:
            self.run.notes.append(f"no further bound was looked for: {in_words(fault)}")
        self.seconds["bound"] += time.perf_counter() - began

    def _from_the_search(self) -> None:
        """Collect the search's own evidence, and that of the duals of its program."""
        result, compiled = self.searched.result, self.run.compiled
        self.evidence.extend(result.evidence)
        if compiled is not None and result.row_duals is not None and compiled.dual_evidence is not None:
            try:
                self.evidence.append(compiled.dual_evidence(result.row_duals))
            except Exception as fault:
                self.run.notes.append(f"the duals of {self.run.name} are no evidence: {in_words(fault)}")

    def _search_proves(self) -> bool:
        """Whether an engine's own evidence bounds the problem: the first piece that does is not checked again.

        The evidence of a heuristic is what costs it nothing, and leaves better bounds to be looked for.
        """
        for one in () if self.run.heuristic else self.searched.result.evidence:
            bound = proved_bound(self.problem, one)
            if bound is not None:
                self.checked.append((one, bound))
                return True
        return False

    def _from_bounding(self, record: Recorder) -> None:
        """Add the evidence that was found beside the search; without such a run, or where it could not begin, look for bounds now."""
        target, known, notes = None if self.best is None else self.best.values[0], tuple(self.evidence), self.run.notes
        bounding = self.bounding
        if bounding.budget > 0:
            record.begin_phase("bound", bounding.budget)
        if bounding.beside:  # it keeps the time itself, without what it compiles
            seen = search(lambda control: RawResult("unknown", answer=bounding.found_beside(control, target)), Control(), math.inf)
            self.evidence.extend(seen.result.answer or [])
            self._hear_bounding(bounding.line.answer, record)
            notes.extend(bounding.unable)
            if seen.interrupted:
                notes.append("bounding ended early: interrupted")
            if seen.interrupted or not bounding.fault:
                return
        best: dict[str, Any] = {"target": target, "answer": None if target is None else self.answer}
        hearing: dict[str, Any] = {"progress": record.of_bounds, "unable": notes}
        seen = bounded(self.problem, bounding.budget, known=known, linear=bounding.linear, **best, **hearing)
        self.evidence.extend(seen.result.evidence)
        self._hear_bounding(seen.result.answer, record)
        if seen.interrupted or seen.result.message:
            notes.append(f"bounding ended early: {seen.result.message or 'interrupted'}")

    def _hear_bounding(self, found: Any, record: Recorder) -> None:
        """Let an answer that bounding came across compete with that of an engine; not where work is limited, which shall repeat to the bit:
        bounding ends by the clock."""
        if found is None or self.run.heuristic or self.options.iterations is not None:
            return
        self.judge.consider(found, "an answer that bounding came across", lambda answer: answer)
        answer, better = self.judge.best()
        if better is not None and better is not self.best:
            self.answer, self.best = answer, better
            record.judged(BOUNDING, better.values)
            self.run.notes.append("the answer was found while its bound was looked for")

    def verify(self, record: Recorder) -> None:
        """Have the checkers derive bounds from the evidence and the guarantee; a bound that contradicts the answer is a fault."""
        began = time.perf_counter()
        record.begin_phase("check")
        guarantee = self.searched.result.guarantee if self.best is not None else None
        if self.run.heuristic and guarantee is None:
            self.run.notes.append(f"{self.run.name} guarantees nothing for this instance")
        self.certificate = self._certified(guarantee)
        self.seconds["check"] += time.perf_counter() - began

    def _certified(self, guarantee: Any = None) -> Certificate:
        notes = self.run.notes
        try:
            certificate = in_time(lambda: certify(self.problem, self.best, self.evidence, guarantee, notes, self.checked), lambda: None)
            if certificate is not None:
                return certificate
            notes.append("interrupted before the evidence of the bounds was verified")
        except CheckFailedError as fault:
            self.judge.faults.append(f"{fault} (the bound is withheld)")
        return certify(self.problem, self.best)

    def bound_later_levels(self, record: Recorder) -> None:
        """Bound the levels after the first priority of the objective, in the time that is left."""
        began, seconds_left = time.perf_counter(), self.bounding.budget - self.seconds["bound"]
        if len(self.problem.senses) > 1 and self.best is not None and seconds_left > 0.0 and not self.searched.interrupted:
            try:
                known = self.problem, self.certificate, self.best, seconds_left
                self.certificate = further_levels(*known, self.bounding.linear, self.run.notes, record.begin_phase)
            except CheckFailedError as fault:
                self.judge.faults.append(f"{fault} (the bound is withheld)")
        self.seconds["check"] += time.perf_counter() - began

    def hear_others(self) -> None:
        """Ask other solvers about a claim that has no evidence; their answers compete with the one that is there."""
        if self.judge.faults or (self.best is not None and self._contradicted()):
            return
        began = time.perf_counter()
        claims: list[Claim] = []
        if not self.searched.interrupted:
            seconds_left = self.bounding.budget - self.seconds["bound"]
            claims = heard_opinions(self.judge, self.run, self.claim, self.best, self.certificate, seconds_left, self.options)
        self.seconds["bound"] += time.perf_counter() - began
        began = time.perf_counter()
        if self.best is None:
            with suppress(Exception):
                answer = self.problem.answer_at_hand()
                self.judge.at_hand(answer, self._contradicted)
        answer, better = self.judge.best()
        if better is not self.best:
            self.answer, self.best = answer, better
            self.certificate = self._certified()
        senses, notes = self.problem.senses, self.run.notes
        self.opinions, self.disagreements = compared(claims, self.claim, senses, self.best, self.certificate, notes)
        self.seconds["check"] += time.perf_counter() - began

    def _contradicted(self, best: Evaluation | None = None) -> list[str]:
        """Parts of the claim that the best answer (or ``best``) or a verified bound refutes."""
        return contradictions(self.claim, self.problem.senses, self.best if best is None else best, self.certificate)

    # -- what is told -------------------------------------------------------------------------------------------------------

    def solution(self) -> Solution:
        """The solution around the best answer, with what bounds it.

        Raises CheckFailedError if there are faults, and neither an answer nor a proof that there is none.
        """
        problem, senses, best, certificate = self.problem, self.problem.senses, self.best, self.certificate
        claim, faults = self.claim, tuple(dict.fromkeys([*self.judge.faults, *self._contradicted(), *self.disagreements]))
        if faults:
            if best is None and not (certificate.infeasible or certificate.unbounded):
                raise CheckFailedError("; ".join(faults))
            claim = replace(claim, said=replace(claim.said, status="unknown", objective=None, bound=None, further=()))
        bound, kind, source = _best_bound(senses, self.run.claimant, claim, certificate, best)
        if isinstance(bound, float) and len(senses) > 1:
            further = {} if best is None else dict(claim.concerned(senses, best))
            bound, kind, source = bounds_of_levels(senses, best, certificate.levels, further, self.run.claimant, bound, kind, source)
        objective, result, run = None if best is None else best.objective, claim.said, self.run
        why = problem.why_none(certificate.evidence[0].kind, certificate.evidence[0].data) if certificate.infeasible else ""
        messages = dict.fromkeys(m for m in (why, result.message, *run.notes) if m)
        return Solution(
            problem=problem,
            answer=self.answer,
            status=_status(claim, senses, certificate, best, bound),
            limit=result.limit,
            objective=objective,
            bound=bound,
            bound_kind=kind,
            bound_source=source,
            gap=relative_gap(objective, bound, *(() if best is None else (best.sizes, best.precision))),
            solver=run.name,
            form=run.form,
            seconds={"compile": run.compile_seconds, "solve": self.searched.seconds, **self.seconds},
            seed=self.options.seed,
            versions={"waybound": __version__, "python": platform.python_version(), **run.versions},
            certificate=certificate,
            evaluation=best,
            statistics=dict(result.statistics),
            message="; ".join(messages),
            opinions=self.opinions,
            chain=(() if run.compiled is None else run.compiled.links) + result.links,
            faults=faults,
        )


def _best_bound(
    senses: Sequence[str], claimant: str, claim: Claim, certificate: Certificate, best: Evaluation | None
) -> tuple[Value | None, str | None, str | None]:
    """The best known bound of either kind; a verified one wins a tie, and where the answer meets it: a claim ahead of both is false."""
    size, precision = (0.0, EQUAL) if best is None else (best.size, best.precision)
    verified, claimed = certificate.bound, claim.bound(len(senses))
    met = verified is not None and best is not None and same(verified, best.values[0], size, precision)
    if claimed is not None and math.isfinite(claimed) and not met:
        ahead = verified is None or better_bound(senses[0], claimed, verified)
        if ahead and (verified is None or not same(claimed, verified, size, precision)):
            return claimed + 0.0, "claimed", claimant
    return (verified, "verified", certificate.bound_source) if verified is not None else (None, None, None)


def _status(claim: Claim, senses: Sequence[str], certificate: Certificate, best: Evaluation | None, bound: Value | None) -> str:
    """The status: optimal or infeasible or unbounded, proved or claimed; feasible or unknown otherwise."""
    if best is not None:
        verified = [] if certificate.bound is None else [certificate.bound, *(level.bound for level in certificate.levels)]
        if len(best.values) == 1 and isinstance(bound, float):
            verified = [bound]
        closed = len(verified) == len(best.values) and all(best.same_at(k, known) for k, known in enumerate(verified))
        return "optimal" if closed or claim.speaks_of(best) else "feasible"
    if certificate.infeasible or certificate.unbounded:
        return "infeasible" if certificate.infeasible else "unbounded"
    status, exactness = claim.status(senses, best, certificate), claim.exactness
    if status in ("infeasible", "infeasible_or_unbounded") and exactness.infeasibility_is_valid:
        return status
    if status == "unbounded" and exactness.answer_is_valid:
        return status
    return "error" if status == "error" else "unknown"
