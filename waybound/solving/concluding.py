"""From what a search left behind to a solution: nothing is believed that was not checked."""

from __future__ import annotations

import math
import platform
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ..formulations.certificate import Certificate, better_bound, certify, judged_only
from ..formulations.evaluation import Evaluation
from ..formulations.evidence import Evidence, Guarantee
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.solution import Opinion, Solution, Value, relative_gap
from ..formulations.tolerance import EQUAL, same
from ..instances.errors import CheckFailedError, in_words
from ..solvers.backend import Control, Options, RawResult
from ..solvers.linear_programs import LinearPrograms
from .beside import Beside
from .bounding import find_bounds, proved
from .claims import Claim, contradictions
from .judging import Judge
from .levels import bounds_of_levels, further_levels
from .opinions import claimed, opinion, program_of, refuting, second_opinions, unproved
from .recording import Recorder
from .runs import Run
from .search import BOUND_OVERTIME, Searched, in_time, search


def conclude(
    problem: Problem, run: Run, searched: Searched, control: Control, options: Options, budget: float, record: Recorder,
    crash: Exception | None, first: list[Evidence], beside: Beside | None,
) -> Solution:  # fmt: skip
    """Believe nothing: decode and judge every answer, bound, certify, and only then say how it ended.

    From the judge's verdict on, whatever fails or is interrupted costs what it would have added, never the answer.
    """
    began = time.perf_counter()
    try:
        judge, found = _verdict(problem, run, searched.result, control, options, crash)
    except KeyboardInterrupt:  # asks for an end, not for the loss of the answer; a second one is heeded
        judge, found = _verdict(problem, run, searched.result, control, options, crash)
    spent = time.perf_counter() - began
    if found[1] is not None:
        record.judged(run.name, found[1].values)
    try:
        return _certified(judge, run, searched, options, found, spent, budget, record, first, beside)
    except CheckFailedError:  # and no answer
        raise
    except (Exception, KeyboardInterrupt) as fault:
        run.notes.append(f"no bound was verified: {in_words(fault)}")
        return _certified(judge, run, searched, options, found, spent, None, None, [], None)


def _verdict(
    problem: Problem, run: Run, result: RawResult, control: Control, options: Options, crash: Exception | None
) -> tuple[Judge, tuple[Any, Evaluation | None]]:
    """The best of the engine's last word, its published incumbent and the start, and who judged them."""
    judge = Judge(problem, run.name, run.exactness(result), run.decode, run.notes, crash, None if run.made is None else run.made.program)
    judge.last_word(result, prices=run.made is None or run.exactness(result) is Exactness.EXACT)
    if control.answer is not result.answer:
        judge.incumbent(control.answer)
    judge.start(options.start)
    found = judge.best()
    if result.status == "error" and found[1] is not None:  # what is left is not from this search
        why = result.message if crash is None else in_words(crash)
        judge.faults.append(f"{run.name} failed: {why or 'it does not say why'}")
    return judge, found


def _certified(
    judge: Judge, run: Run, searched: Searched, options: Options, found: tuple[Any, Evaluation | None], spent: float,
    budget: float | None, record: Recorder | None, first: list[Evidence], beside: Beside | None,
) -> Solution:  # fmt: skip
    """The solution around the best answer, with what bounds it; without a ``budget``, with the judge's word alone."""
    problem, senses, claim = judge.problem, judge.problem.senses, judge.claim(searched.result)
    answer, best = found

    began = time.perf_counter()
    evidence: list[Evidence] = list(first)
    checked: list[tuple[Evidence, float]] = []
    if budget is not None:
        try:
            value = None if best is None else best.values[0]
            _gather(evidence, checked, problem, run, searched, _linear(options), budget, value, record, beside)
        except (Exception, KeyboardInterrupt) as fault:
            run.notes.append(f"no further bound was looked for: {in_words(fault)}")
    seconds = {"bound": time.perf_counter() - began, "check": spent}

    began = time.perf_counter()
    if record is not None:
        record.begin_phase("check")
    guarantee = searched.result.guarantee if best is not None else None
    if run.heuristic and guarantee is None and claim.exactness is Exactness.NEITHER:
        run.notes.append(f"{run.name} guarantees nothing for this instance")
    certificate = judged_only(problem, best) if budget is None else _certificate(judge, run, best, evidence, guarantee, checked)
    left = 0.0 if budget is None or record is None else budget - seconds["bound"]
    if record is not None and len(senses) > 1 and best is not None and left > 0.0 and not searched.interrupted:
        try:
            certificate = further_levels(problem, certificate, best, left, _linear(options), run.notes, record.begin_phase)
        except CheckFailedError as fault:
            judge.faults.append(f"{fault} (the bound is withheld)")
    refuted = contradictions(claim, senses, best, certificate)
    seconds["check"] += time.perf_counter() - began

    opinions: tuple[Opinion, ...] = ()
    if budget is not None and not judge.faults and (best is None or not refuted):
        began = time.perf_counter()
        heard = () if searched.interrupted else _second_opinions(judge, run, claim, best, certificate, budget - seconds["bound"], options)
        seconds["bound"] += time.perf_counter() - began
        began = time.perf_counter()
        if best is None:
            judge.at_hand(lambda answer: contradictions(claim, senses, answer, certificate))
        answer, better = judge.best()
        if better is not best:
            best = better
            certificate = _certificate(judge, run, best, evidence, None, checked)
            refuted = contradictions(claim, senses, best, certificate)
        opinions = tuple(opinion(theirs, claim, senses, best, certificate) for theirs in heard)
        refuted += _disagreements(claim, opinions, certificate, run.notes)
        seconds["check"] += time.perf_counter() - began

    faults = tuple(dict.fromkeys([*judge.faults, *refuted]))
    if faults:
        if best is None and not (certificate.infeasible or certificate.unbounded):
            raise CheckFailedError("; ".join(faults))
        claim = replace(claim, said=replace(claim.said, status="unknown", objective=None, bound=None, further=()))
    bound, kind, source = _best_bound(problem, run.claimant, claim, certificate, best)
    if isinstance(bound, float) and len(senses) > 1:
        further = {} if best is None else dict(claim.concerned(senses, best))
        bound, kind, source = bounds_of_levels(problem, best, certificate.levels, further, run.claimant, bound, kind, source)
    objective, result = None if best is None else best.objective, claim.said
    messages = dict.fromkeys(m for m in (_why_none(problem, certificate), result.message, *run.notes) if m)
    return Solution(
        problem=problem,
        answer=answer,
        status=_status(claim, senses, certificate, best, bound),
        limit=result.limit,
        objective=objective,
        bound=bound,
        bound_kind=kind,
        bound_source=source,
        gap=relative_gap(objective, bound, *(() if best is None else (best.sizes, best.precision))),
        solver=run.name,
        form=run.form,
        seconds={"compile": run.compile_seconds, "solve": searched.seconds, **seconds},
        seed=options.seed,
        versions=_versions(run),
        certificate=certificate,
        evaluation=best,
        statistics=dict(result.statistics),
        message="; ".join(messages),
        opinions=opinions,
        chain=(() if run.made is None else run.made.links) + result.links,
        faults=faults,
    )


def _certificate(
    judge: Judge, run: Run, best: Evaluation | None, evidence: list[Evidence], guarantee: Guarantee | None,
    checked: Sequence[tuple[Evidence, float]],
) -> Certificate:  # fmt: skip
    """What the checkers make of the evidence; without what contradicts the answer, which is a fault."""
    try:
        certificate = in_time(lambda: certify(judge.problem, best, evidence, guarantee, run.notes, checked), lambda: None)
        if certificate is not None:
            return certificate
        run.notes.append("interrupted before the evidence of the bounds was verified")
    except CheckFailedError as fault:
        judge.faults.append(f"{fault} (the bound is withheld)")
    return judged_only(judge.problem, best)


def _disagreements(claim: Claim, opinions: Sequence[Opinion], certificate: Certificate, notes: list[str]) -> Iterator[str]:
    """Faults of opinions that contradict a claim while nothing refutes either; those that are refuted are told."""
    for one in opinions:
        if one.verdict == "is refuted":
            value = "" if one.objective is None else f" {one.objective!r}"
            notes.append(f"{one.solver} says {one.status}{value}, which {refuting(one, certificate)} refutes")
        elif one.verdict == "contradicts":
            both = f"{claim.solver} claims {claimed(claim.said)}, {one.solver} claims {claimed(one)}"
            yield f"{both}: nothing that was checked refutes either, and both cannot be right"


def _why_none(problem: Problem, certificate: Certificate) -> str:
    """What proves that there is no answer, where the problem has words of its own for it."""
    for evidence in certificate.evidence[:1] if certificate.infeasible else ():
        told = problem.why_none(evidence.kind, evidence.data)
        if told != Problem.why_none(problem, evidence.kind, evidence.data):
            return told
    return ""


def _second_opinions(
    judge: Judge, run: Run, claim: Claim, best: Evaluation | None, certificate: Certificate, seconds: float, options: Options
) -> list[Claim]:
    """What other solvers say of a claim without evidence; their answers are judged."""
    senses, whole = judge.problem.senses, run.made is None or run.made.program.is_integer
    if not unproved(claim, senses, best, certificate, whole) and not contradictions(claim, senses, best, certificate):
        return []
    began = time.perf_counter()
    made = run.made or (program_of(judge.problem) if seconds > 0.0 else None)
    if made is None:
        return []
    heard = []
    for name, said in second_opinions(made, run.name, seconds - (time.perf_counter() - began), options, run.isolated):
        judge.opinion(name, said.answer, made.decode)
        heard.append(Claim(name, said, made.exactness.then(said.holds), program=made.program))
    return heard


def _gather(
    evidence: list[Evidence],
    checked: list[tuple[Evidence, float]],
    problem: Problem,
    run: Run,
    searched: Searched,
    linear: LinearPrograms,
    budget: float,
    best: float | None,
    record: Recorder | None,
    beside: Beside | None,
) -> None:
    """Add to ``evidence`` what the search left of it, and what bounding finds where that proves nothing; to ``checked``, what was."""
    result = searched.result
    evidence.extend(result.evidence)
    if run.made is not None and result.row_duals is not None and run.made.dual_evidence is not None:
        try:
            evidence.append(run.made.dual_evidence(result.row_duals))
        except Exception as fault:
            run.notes.append(f"the duals of {run.name} are no evidence: {in_words(fault)}")
    if searched.interrupted and beside is not None:
        evidence.extend(beside.answer or ())
    if searched.interrupted:
        return
    for one in result.evidence:
        bound = proved(problem, one)
        if bound is not None:
            checked.append((one, bound))
            return
    known = tuple(evidence)

    if record is not None and budget > 0:
        record.begin_phase("bound", budget)

    if beside is not None:  # it keeps the time itself, without what it compiles
        seen = search(lambda control: RawResult("unknown", answer=beside.found(control, best, budget)), Control(), math.inf)
        evidence.extend(seen.result.answer or [])
        run.notes.extend(beside.unable)
        if seen.interrupted:
            run.notes.append("bounding ended early: interrupted")
        if seen.interrupted or not beside.fault:
            return

    def find(control: Control) -> RawResult:
        hear = None if record is None else record.of_bounds
        found = find_bounds(problem, budget, target=best, known=known, control=control, progress=hear, unable=run.notes, linear=linear)
        return RawResult("unknown", answer=found)

    found = search(find, Control(), budget, overtime=BOUND_OVERTIME)
    evidence.extend(found.result.answer or [])
    if found.interrupted or found.result.message:
        run.notes.append(f"bounding ended early: {found.result.message or 'interrupted'}")


def _best_bound(
    problem: Problem, claimant: str, claim: Claim, certificate: Certificate, best: Evaluation | None
) -> tuple[Value | None, str | None, str | None]:
    """The best known bound of either kind; a verified one wins a tie, and where the answer meets it: a claim ahead of both is false."""
    size, precision = (0.0, EQUAL) if best is None else (best.size, best.precision)
    verified, claimed = certificate.bound, claim.bound(len(problem.senses))
    met = verified is not None and best is not None and same(verified, best.values[0], size, precision)
    if claimed is not None and math.isfinite(claimed) and not met:
        ahead = verified is None or better_bound(problem.sense, claimed, verified)
        if ahead and (verified is None or not same(claimed, verified, size, precision)):
            return claimed + 0.0, "claimed", claimant
    return (verified, "verified", certificate.bound_source) if verified is not None else (None, None, None)


def _linear(options: Options) -> LinearPrograms:
    return LinearPrograms(options.lp_solver, options.seed, options.threads)


def _status(claim: Claim, senses: Sequence[str], certificate: Certificate, best: Evaluation | None, bound: Value | None) -> str:
    if best is not None:
        verified = [] if certificate.bound is None else [certificate.bound, *(level.bound for level in certificate.levels)]
        if len(best.values) == 1 and isinstance(bound, float):
            verified = [bound]
        proved = len(verified) == len(best.values) and all(best.same_at(k, known) for k, known in enumerate(verified))
        return "optimal" if proved or claim.speaks_of(best) else "feasible"
    if certificate.infeasible or certificate.unbounded:
        return "infeasible" if certificate.infeasible else "unbounded"
    status, exactness = claim.status(senses, best, certificate), claim.exactness
    if status in ("infeasible", "infeasible_or_unbounded") and exactness.infeasibility_is_valid:
        return status
    if status == "unbounded" and exactness.answer_is_valid:
        return status
    return "error" if status == "error" else "unknown"


def _versions(run: Run) -> dict[str, str]:
    from .._version import __version__

    return {"waybound": __version__, "python": platform.python_version(), **run.versions}
