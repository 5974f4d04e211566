"""From what a search left behind to a solution: nothing is believed that was not checked."""

from __future__ import annotations

import math
import platform
import time
from dataclasses import replace
from typing import Any

from ..formulations.certificate import Certificate, better_bound, certify, judged_only
from ..formulations.evaluation import Evaluation
from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.programs.exactness import Exactness
from ..formulations.solution import Solution, Value, relative_gap
from ..formulations.tolerance import EQUAL, same
from ..instances.errors import CheckFailedError, in_words
from ..solvers.backend import Control, Options, RawResult
from ..solvers.linear_programs import LinearPrograms
from ..solvers.program_backend import EQUAL_TOLERANCE
from . import claims
from .beside import Beside
from .bounding import find_bounds, proved
from .judging import Judge
from .levels import bounds_of_levels, further_levels
from .opinions import claimed, opinion, refuting, second_opinions, unproved
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
    judge = Judge(problem, run.name, run.exactness(result), run.decode, run.notes, crash)
    judge.last_word(result, prices=run.made is None or run.exactness(result) is Exactness.EXACT)
    if control.answer is not result.answer:
        judge.incumbent(control.answer)
    judge.start(options.start)
    return judge, judge.best()


def _certified(
    judge: Judge, run: Run, searched: Searched, options: Options, found: tuple[Any, Evaluation | None], spent: float,
    budget: float | None, record: Recorder | None, first: list[Evidence], beside: Beside | None,
) -> Solution:  # fmt: skip
    """The solution around the best answer, with what bounds it; without a ``budget``, with the judge's word alone."""
    result, problem = searched.result, judge.problem
    answer, evaluation = found
    best = None if evaluation is None else evaluation.values[0]
    judge.hear(claims.check_bound, run.name, problem.senses, result, evaluation, run.exactness(result))

    began = time.perf_counter()
    evidence: list[Evidence] = list(first)
    if budget is not None:
        try:
            _gather(evidence, problem, run, searched, _linear(options), budget, best, record, beside)
        except (Exception, KeyboardInterrupt) as fault:
            run.notes.append(f"no further bound was looked for: {in_words(fault)}")
    bound_seconds = time.perf_counter() - began

    began = time.perf_counter()
    if record is not None:
        record.begin_phase("check")
    guarantee = result.guarantee if evaluation is not None else None
    if run.heuristic and guarantee is None and result.holds is Exactness.NEITHER:
        run.notes.append(f"{run.name} guarantees nothing for this instance")
    certificate: Certificate | None = None
    if budget is not None:
        try:
            certificate = in_time(lambda: certify(problem, evaluation, evidence, guarantee, run.notes), lambda: None)
            if certificate is None:
                run.notes.append("interrupted before the evidence of the bounds was verified")
        except CheckFailedError as fault:
            judge.faults.append(f"{fault} (the bound is withheld)")
    certificate = certificate or judged_only(problem, evaluation)
    left = 0.0 if budget is None or record is None else budget - bound_seconds
    if record is not None and len(problem.senses) > 1 and evaluation is not None and left > 0.0 and not searched.interrupted:
        try:
            certificate = further_levels(problem, certificate, evaluation, left, _linear(options), run.notes, record.begin_phase)
        except CheckFailedError as fault:
            judge.faults.append(f"{fault} (the bound is withheld)")
    heard: list[tuple[str, RawResult]] = []
    if budget is not None and not searched.interrupted and not judge.faults:
        asked = time.perf_counter()
        heard = _second_opinions(judge, run, result, certificate, evaluation, budget - bound_seconds, options)
        spent_asking = time.perf_counter() - asked
        bound_seconds, began = bound_seconds + spent_asking, began + spent_asking
    if result.status == "infeasible" and evaluation is None and run.exactness(result).infeasibility_is_valid and not judge.faults:
        judge.at_hand()
    answer, better = judge.best() if not judge.faults else found
    if better is not evaluation:
        evaluation = better
        judge.hear(claims.check_bound, run.name, problem.senses, result, evaluation, run.exactness(result))
        certificate = in_time(lambda: certify(problem, evaluation, evidence, None, run.notes), lambda: judged_only(problem, evaluation))
    opinions = tuple(opinion(name, said, result, evaluation, certificate) for name, said in heard)
    for one in opinions:
        if one.verdict == "is refuted":
            value = "" if one.objective is None else f" {one.objective!r}"
            run.notes.append(f"{one.solver} says {one.status}{value}, which {refuting(one, certificate)} refutes")
        elif one.verdict == "contradicts":
            both = f"{run.name} claims {claimed(result)}, {one.solver} claims {claimed(one)}"
            judge.faults.append(f"{both}: nothing that was checked refutes either, and both cannot be right")
    size = 0.0 if evaluation is None else evaluation.size
    judge.hear(claims.check_verified, run.name, problem.sense, result, certificate.bound, run.exactness(result), size)
    judge.hear(claims.check_unbounded, run.name, result, certificate.unbounded, run.exactness(result))
    check_seconds = spent + time.perf_counter() - began

    faults = tuple(dict.fromkeys(judge.faults))
    if faults:
        if evaluation is None:
            raise CheckFailedError("; ".join(faults))
        result = replace(result, status="unknown", objective=None, bound=None, further=())
    bound, kind, source = _best_bound(problem, run, result, certificate, evaluation)
    objective = None if evaluation is None else evaluation.objective
    if isinstance(bound, float) and len(problem.senses) > 1:
        further = dict(claims.concerned(problem.senses, result, evaluation)) if evaluation and run.exactness(result).bound_is_valid else {}
        bound, kind, source = bounds_of_levels(problem, evaluation, certificate.levels, further, run.claimant, bound, kind, source)
    gap = relative_gap(objective, bound, *(() if evaluation is None else (evaluation.sizes, evaluation.precision)))
    status = _status(problem, run, result, certificate, evaluation, bound)
    messages = dict.fromkeys(m for m in (_why_none(problem, certificate), result.message, *run.notes) if m)
    return Solution(
        problem=problem,
        answer=answer,
        status=status,
        limit=result.limit,
        objective=objective,
        bound=bound,
        bound_kind=kind,
        bound_source=source,
        gap=gap,
        solver=run.name,
        form=run.form,
        seconds={"compile": run.compile_seconds, "solve": searched.seconds, "bound": bound_seconds, "check": check_seconds},
        seed=options.seed,
        versions=_versions(run),
        certificate=certificate,
        evaluation=evaluation,
        statistics=dict(result.statistics),
        message="; ".join(messages),
        opinions=opinions,
        chain=(() if run.made is None else run.made.links) + result.links,
        faults=faults,
    )


def _why_none(problem: Problem, certificate: Certificate) -> str:
    """What proves that there is no answer, where the problem has words of its own for it."""
    for evidence in certificate.evidence[:1] if certificate.infeasible else ():
        told = problem.why_none(evidence.kind, evidence.data)
        if told != Problem.why_none(problem, evidence.kind, evidence.data):
            return told
    return ""


def _second_opinions(
    judge: Judge, run: Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None, seconds: float, options: Options
) -> list[tuple[str, RawResult]]:
    """What other engines say of a claim without evidence; their answers are judged."""
    made = run.made
    exactness = run.exactness(result)
    if evaluation is not None:
        claims_it = _claims_optimum(exactness, result, evaluation)
    else:
        claims_it = exactness.answer_is_valid if result.status == "unbounded" else exactness.infeasibility_is_valid
    if made is None or not claims_it or not unproved(result, certificate, evaluation, made.program):
        return []
    heard = list(second_opinions(made, run.name, seconds, options, run.isolated))
    for name, said in heard:
        judge.opinion(name, said.answer)
    return heard


def _gather(
    evidence: list[Evidence],
    problem: Problem,
    run: Run,
    searched: Searched,
    linear: LinearPrograms,
    budget: float,
    best: float | None,
    record: Recorder | None,
    beside: Beside | None,
) -> None:
    """Add to ``evidence`` what the search left of it, and what bounding finds where that proves nothing."""
    result = searched.result
    evidence.extend(result.evidence)
    if run.made is not None and result.row_duals is not None and run.made.dual_evidence is not None:
        try:
            evidence.append(run.made.dual_evidence(result.row_duals))
        except Exception as fault:
            run.notes.append(f"the duals of {run.name} are no evidence: {in_words(fault)}")
    if searched.interrupted and beside is not None:
        evidence.extend(beside.answer or ())
    if searched.interrupted or any(proved(problem, e) is not None for e in result.evidence):
        return
    known = tuple(evidence)

    if record is not None and budget > 0:
        record.begin_phase("bound", budget)

    def find(control: Control) -> RawResult:
        if beside is not None:
            found = beside.found(control, best)
            run.notes.extend(beside.unable)
            if not beside.fault:
                return RawResult("unknown", answer=found)
        hear = None if record is None else record.of_bounds
        found = find_bounds(problem, budget, target=best, known=known, control=control, progress=hear, unable=run.notes, linear=linear)
        return RawResult("unknown", answer=found)

    found = search(find, Control(), budget, overtime=BOUND_OVERTIME)
    evidence.extend(found.result.answer or [])
    if found.interrupted or found.result.message:
        run.notes.append(f"bounding ended early: {found.result.message or 'interrupted'}")


def _best_bound(
    problem: Problem, run: Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None
) -> tuple[Value | None, str | None, str | None]:
    """The best known bound of either kind; a verified one wins a tie, and where the answer meets it: a claim ahead of both is false."""
    size, precision = (0.0, EQUAL) if evaluation is None else (evaluation.size, evaluation.precision)
    verified = certificate.bound
    met = verified is not None and evaluation is not None and same(verified, evaluation.values[0], size, precision)
    claimed = result.bound if run.exactness(result).bound_is_valid else None
    if claimed is not None and math.isfinite(claimed) and not met:
        ahead = verified is None or better_bound(problem.sense, claimed, verified)
        if ahead and (verified is None or not same(claimed, verified, size, precision)):
            return claimed + 0.0, "claimed", run.claimant
    return (verified, "verified", certificate.bound_source) if verified is not None else (None, None, None)


def _linear(options: Options) -> LinearPrograms:
    return LinearPrograms(options.lp_solver, options.seed, options.threads)


def _status(
    problem: Problem, run: Run, result: RawResult, certificate: Certificate, evaluation: Evaluation | None, bound: Value | None
) -> str:
    if evaluation is not None:
        if len(evaluation.values) == 1 and isinstance(bound, float):
            value = evaluation.values[0]
            if same(bound, value, evaluation.size, evaluation.precision):
                return "optimal"
        verified = [] if certificate.bound is None else [certificate.bound, *(level.bound for level in certificate.levels)]
        if 1 < len(verified) == len(evaluation.values) and all(evaluation.same_at(k, known) for k, known in enumerate(verified)):
            return "optimal"
        reached = all(evaluation.same_at(k, claim.objective, EQUAL_TOLERANCE) for k, claim in enumerate(result.further, start=1))
        claimed = result.status == "optimal" and reached and _claims_optimum(run.exactness(result), result, evaluation)
        return "optimal" if claimed else "feasible"
    if certificate.infeasible or certificate.unbounded:
        return "infeasible" if certificate.infeasible else "unbounded"
    if result.status in ("infeasible", "infeasible_or_unbounded") and run.exactness(result).infeasibility_is_valid:
        return result.status
    if result.status == "unbounded" and run.exactness(result).answer_is_valid:
        return "unbounded"
    return "error" if result.status == "error" else "unknown"


def _claims_optimum(exactness: Exactness, result: RawResult, evaluation: Evaluation) -> bool:
    """Whether a claimed optimum is one of the problem: of a relaxation if it is met, up to what solvers see."""
    if exactness is not Exactness.RELAXATION:
        return exactness is Exactness.EXACT
    bounds = [result.bound, *(level.bound for level in result.further)]
    met = [bound is not None and evaluation.same_at(k, bound, EQUAL_TOLERANCE) for k, bound in enumerate(bounds)]
    return len(met) == len(evaluation.values) and all(met)


def _versions(run: Run) -> dict[str, str]:
    from .._version import __version__

    return {"waybound": __version__, "python": platform.python_version(), **run.versions}
