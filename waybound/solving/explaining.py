"""Why a problem has no answer: sites out of reach, a fleet too small, or else a smallest set of rows that contradict each other.

Each reason from the data is evidence that a checker of ``formulations.checking`` confirms by itself; rows are a solver's word, said so.
That there is no answer is then proved by other evidence where it can be, case by case. Problems that no form writes down exactly are told
by that evidence alone.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..formulations.evidence import Evidence, Reason
from ..formulations.forms import FORMS
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import Program, Rows
from ..formulations.programs.size import TooLargeError
from ..formulations.rendering import Line, as_html, as_rich, as_text
from ..formulations.solution import Solution
from ..formulations.verified_bounds import proved_bound
from ..heuristics.heuristic import HEURISTICS
from ..instances.errors import InputError, MissingPackageError, UnsupportedError, UsageError, WayboundError
from ..instances.number_arrays import Flags, Integers
from ..solvers.backend import BACKENDS, Control, Options, RawResult
from ..solvers.program_backend import ProgramBackend
from .bounding import find_bounds
from .request import Request, vector_problem
from .search import search
from .solve import solve

FILTER_SOLVER = "highs"


VERDICTS = {
    "infeasible": ("there is no solution", "bad"),
    "feasible": ("there is a solution", "good"),
    "undecided": ("undecided", "plain"),
}
"""Each verdict in words, and its tone."""


@dataclass(frozen=True, repr=False)
class Explanation:
    """Why a problem has no answer.

    Attributes
    ----------
    verdict : str
        ``infeasible``, ``feasible`` (there is nothing to explain), or ``undecided``.
    according_to : str
        ``the data`` (each reason is a proof that a checker confirmed, or ``evidence`` is; or an answer passed every check), a solver's name
        (its word for it), or "" if undecided.
    reasons : tuple of Reason
        Sites, vehicles or rows that contradict each other, and why.
    minimal : bool
        For rows: whether leaving out any one of them was found to allow an answer.
    form : str or None
        The form whose rows are named.
    message : str
        What else a user should read.
    evidence : Evidence or None
        Proves that there is no answer, as its checker confirmed; reasons that do so by themselves have their own.
    proof : tuple of str
        Line by line what that says in the problem's words, where it is short.
    interrupted : bool
        Whether the user ended the search; what was found until then is kept.
    """

    verdict: str
    according_to: str = ""
    reasons: tuple[Reason, ...] = ()
    minimal: bool = False
    form: str | None = None
    message: str = ""
    evidence: Evidence | None = None
    proof: tuple[str, ...] = ()
    interrupted: bool = False

    def lines(self) -> list[Line]:
        """The explanation in words: the verdict, its source, proof and reasons."""
        verdict, tone = VERDICTS[self.verdict]
        rows = [Line("verdict", verdict + (f", according to {self.according_to}" if self.according_to else ""), tone)]
        rows += [Line("", self.message)] if self.message else []
        if self.evidence is not None:
            rows.append(Line("proof", f"verified: {self.evidence.source}", "good"))
        return [*rows, *(Line("", line) for line in self.proof)]

    def _all_lines(self) -> list[Line]:
        return [*self.lines(), *(Line(reason.name, reason.message) for reason in self.reasons)]

    def __repr__(self) -> str:
        return as_text("Explanation", self._all_lines())

    def _repr_html_(self) -> str:
        return as_html("Explanation", self._all_lines())

    def __rich__(self) -> Any:
        return as_rich("Explanation", self._all_lines())

    def to_json(self) -> dict[str, Any]:
        return {
            "verdict": self.verdict,
            "according_to": self.according_to,
            "reasons": [r.to_json() for r in self.reasons],
            "minimal": self.minimal,
            "form": self.form,
            "message": self.message,
            "evidence": None if self.evidence is None else self.evidence.to_json(),
            "proof": list(self.proof),
        }


def explain(problem: Problem | Compiled | Program, *, time_limit: float = 60.0, form: str | None = None) -> Explanation:
    """Why ``problem`` has no answer, in its own words.

    First arguments from the data alone (routing: sites that no vehicle can reach, a fleet too small), then a deletion
    filter over the row blocks and the rows of a form, through HiGHS. Where no form is exact: an answer by any method, or evidence.

    Parameters as of ``waybound.explain``. Source of the filter: Chinneck and Dravnieks 1991, "Locating minimal infeasible constraint sets
    in linear programs", ORSA Journal on Computing 3(2). Rows are dropped in halving groups first, so that few of many rows take few solves.
    """
    if not time_limit > 0:
        raise UsageError(f"the time limit must be positive, not {time_limit!r}", "out-of-range")
    if form is not None and not isinstance(problem, Problem):
        raise UsageError(f"the program is already compiled, as {problem.form if isinstance(problem, Compiled) else problem.name}")
    end = time.perf_counter() + time_limit

    def work(control: Control) -> RawResult:
        def stop() -> bool:
            return control.stopped or time.perf_counter() >= end

        reasons: list[Reason] = []
        for reason in reasons_from_data(problem, stop):
            reasons.append(reason)
            control.publish(Explanation("infeasible", "the data", tuple(reasons)))
        if reasons or control.stopped:
            return RawResult("unknown", answer=control.answer)
        return RawResult("unknown", answer=_explain_by_rows(problem, form, end, control))

    searched = search(work, Control(), time_limit, overtime=1.0)
    explanation: Explanation | None = searched.result.answer
    if searched.interrupted:
        explanation = explanation or Explanation("undecided")
        return replace(explanation, interrupted=True, message="; ".join(m for m in ("interrupted", explanation.message) if m))
    return explanation or Explanation("undecided", message=f"undecided within {time_limit:g} s")


def reasons_from_data(problem: Problem | Compiled | Program, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
    """Reasons that are proofs by themselves, each confirmed by its checker."""
    return problem.infeasibility_reasons(stopped) if isinstance(problem, Problem) else iter(())


def _explain_by_rows(problem: Problem | Compiled | Program, form: str | None, end: float, control: Control) -> Explanation:
    if form is not None and isinstance(problem, Problem):
        _refuse_restriction(form, FORMS[form].exactness)  # and a name that does not exist, before anything is tried
    notes: list[str] = []
    if isinstance(problem, Problem):
        with suppress(WayboundError):
            at_hand = problem.answer_at_hand()
            if at_hand is not None and problem.evaluate(at_hand).feasible:
                return _FEASIBLE
        quick = [name for name in _QUICK if not HEURISTICS[name].missing(problem)]
        if _has_answer(problem, quick, (end - time.perf_counter()) / 4.0, notes):
            return _FEASIBLE
    if control.stopped:
        return Explanation("undecided")
    if isinstance(problem, Problem) and form is None and not _exact_form(problem):
        explanation = _explain_by_methods(problem, end, control, notes)
    else:
        explanation = _explain_rows(problem, form, end, control, notes)
    if explanation.verdict == "infeasible" and explanation.evidence is None and not control.stopped:
        asked = problem if isinstance(problem, Problem) else problem.problem if isinstance(problem, Compiled) else vector_problem(problem)
        evidence = _proof(asked, end - time.perf_counter(), control)
        if evidence is not None:
            explanation = replace(explanation, according_to="the data", evidence=evidence, proof=tuple(in_words(asked, evidence)))
    return replace(explanation, message="; ".join(m for m in (explanation.message, *notes) if m))


def _refuse_restriction(form: str | None, exactness: Exactness) -> None:
    if not exactness.infeasibility_is_valid:
        what = "neither relaxation nor restriction" if exactness is Exactness.NEITHER else f"a {exactness.value}"
        raise UsageError(f"form {form} is {what}: that it has no point would prove nothing", "unsupported")


def _exact_form(problem: Problem) -> bool:
    return any(FORMS[name].exactness is Exactness.EXACT for name in problem.forms())


def _relaxation(problem: Problem) -> str | None:
    """The first form whose rows prove that there is no answer where they contradict each other."""
    bounding = (name for name in problem.forms() if FORMS[name].exactness.infeasibility_is_valid)
    return next((name for name in bounding if problem.compile(name).exactness.infeasibility_is_valid), None)


def _explain_by_methods(problem: Problem, end: float, control: Control, notes: list[str]) -> Explanation:
    """An answer by any method, or evidence that there is none, or else rows of a relaxation."""
    others = [name for name in HEURISTICS if name not in _QUICK and not HEURISTICS[name].missing(problem)]
    decided = _decided(problem, [None, *others], (end - time.perf_counter()) / 2.0, notes)
    if decided is not None and decided.answer is not None:
        return _FEASIBLE
    evidence = None if decided is None else next(_proofs(problem, decided.certificate.evidence), None)
    if evidence is None and not control.stopped:
        evidence = _proof(problem, end - time.perf_counter(), control)
    if evidence is not None:
        return Explanation("infeasible", "the data", evidence=evidence, proof=tuple(in_words(problem, evidence)))
    try:
        form = None if control.stopped else _relaxation(problem)
    except TooLargeError as fault:
        return Explanation("undecided", message=f"no rows can be named: {fault}")
    if form is None:
        return Explanation(
            "undecided", message="no method found an answer or a proof that there is none, and no form names rows that prove it"
        )
    return _explain_rows(problem, form, end, control, notes)


PROOF_SECONDS = 10.0

MOST_NODES = 15
"""Most nodes of a proof tree that is told in words: eight cases."""


def _proof(problem: Problem, seconds: float, control: Control) -> Evidence | None:
    """Evidence that there is no answer, if it is found in time."""
    return next(_proofs(problem, find_bounds(problem, max(0.0, min(seconds, PROOF_SECONDS)), control=_under(control))), None)


def _proofs(problem: Problem, found: Sequence[Evidence]) -> Iterator[Evidence]:
    """The first piece of evidence that proves that there is no answer."""
    none = math.inf if problem.sense == "min" else -math.inf
    return (evidence for evidence in found if proved_bound(problem, evidence) == none)


def _under(control: Control) -> Control:
    """A control that ends with another, and to which something else is published."""
    inner = Control()
    control.on_stop(inner.stop)
    return inner


def in_words(problem: Problem, evidence: Evidence) -> Iterator[str]:
    """The cases of a proof that there is no answer, in words; nothing where there are many."""
    nodes = evidence.data.get("nodes", [{"kind": evidence.kind, "data": evidence.data}])
    if len(nodes) > MOST_NODES:
        return
    waiting = [("", 0, "")]  # what is supposed, depth, reason above
    for node in nodes:
        supposed, depth, reason = waiting.pop()
        if "kind" in node:
            reason = problem.why_none(node["kind"], node["data"]) or f"there is no answer, by evidence of kind {node['kind']}"
        lead, inner = "  " * max(0, depth - 1) + supposed, depth + 1
        if "branch" not in node:
            yield lead + reason
            continue
        if supposed:
            yield lead.rstrip()
        waiting.append((f"otherwise, {problem.in_words(node['branch'], False)}: ", inner, reason))
        waiting.append((f"if {problem.in_words(node['branch'], True)}: ", inner, reason))


_FEASIBLE = Explanation("feasible", "the data", message="there is an answer that passes every check")


def _explain_rows(problem: Problem | Compiled | Program, form: str | None, end: float, control: Control, notes: list[str]) -> Explanation:
    if not BACKENDS[FILTER_SOLVER].installed():
        return Explanation("undecided", message=f"naming rows needs {FILTER_SOLVER}: pip install {BACKENDS[FILTER_SOLVER].requirement()}")
    try:
        if isinstance(problem, Compiled):
            compiled = problem
        else:
            compiled = vector_problem(problem).compile() if isinstance(problem, Program) else problem.compile(form)
    except (UnsupportedError, TooLargeError) as error:
        if form is not None:
            raise
        return Explanation("undecided", message=f"no rows can be named: {error}")
    _refuse_restriction(compiled.form, compiled.exactness)
    program = compiled.program.first_level()
    if any(_is_answer(problem, compiled, np.clip(np.full(program.num_variables, x), program.lower, program.upper)) for x in (0.0, 1.0)):
        return _FEASIBLE
    plain = replace(
        program, sense="min", quadratic=None, offset=0.0, variables=tuple(replace(b, cost=np.zeros(b.size)) for b in program.variables)
    )
    inner = _under(control)

    def stop() -> bool:
        return control.stopped or time.perf_counter() >= end

    relaxation = replace(compiled, program=plain).relaxed().program if plain.is_integer and not (plain.cones or plain.circuits) else None
    if relaxation is not None:
        test = _Tester(relaxation, end, inner)
        if test(np.ones(plain.num_rows, dtype=bool)) is True:
            return _from_rows(relaxation, *deletion_filter(relaxation, test, stop))
    if isinstance(problem, Problem) and (relaxation is not None or program.cones):
        slow = [name for name in HEURISTICS if name not in _QUICK and not HEURISTICS[name].missing(problem)]
        if _has_answer(problem, [*slow, None], (end - time.perf_counter()) / 4.0, notes):
            return _FEASIBLE
    if program.cones and form is None and isinstance(problem, Problem):
        why = f"no rows can be named, for {FILTER_SOLVER} takes none of the form's cones"
        return Explanation("undecided", form=compiled.form, message=why)
    test = _Tester(plain, end, inner)
    whole = test(np.ones(plain.num_rows, dtype=bool))
    if whole is True:
        return _from_rows(plain, *deletion_filter(plain, test, stop))
    if whole is False and compiled.exactness.answer_is_valid:
        if _is_answer(problem, compiled, test.point):
            return replace(_FEASIBLE, form=compiled.form)
        return Explanation("feasible", FILTER_SOLVER, form=compiled.form, message=f"{FILTER_SOLVER} finds a point that satisfies all rows")
    return Explanation("undecided", form=compiled.form, message=f"{FILTER_SOLVER} found neither an answer nor a proof that there is none")


def _is_answer(problem: Problem | Compiled | Program, made: Compiled, point: Any) -> bool:
    """Whether ``point`` of the program satisfies all its rows, or stands for an answer that passes every check."""
    if isinstance(problem, Program):
        return point is not None and problem.residual(point) == 0.0
    try:
        return point is not None and made.problem.evaluate(made.decode(point)).feasible
    except InputError:
        return False


_TRIAL_SECONDS = 5.0

_QUICK = ("savings", "random", "greedy")
"""Heuristics that find an answer at once, if any, tried before all else; the others follow where the relaxation has a point."""


def _has_answer(problem: Problem, methods: Sequence[str | None], seconds: float, notes: list[str]) -> bool:
    """Whether a heuristic or the default solver (None) finds a verified answer quickly; the MILP may take long to find one."""
    solution = _decided(problem, methods, seconds, notes)
    return solution is not None and solution.answer is not None


def _decided(problem: Problem, methods: Sequence[str | None], seconds: float, notes: list[str]) -> Solution | None:
    """The solution of the first heuristic, or default solver (None), that quickly finds a verified answer or a proof that there is none.

    What a method says where it fails is noted, unless it is that it does not take the problem.
    """
    end = time.perf_counter() + min(seconds, _TRIAL_SECONDS)
    for heuristic in methods:
        seconds_left = end - time.perf_counter()
        if seconds_left <= 0:
            return None
        try:
            solution = solve(problem, Request(heuristic=heuristic, time_limit=seconds_left, bound_time=0.0))
            if solution.answer is not None or solution.certificate.infeasible:
                return solution
        except (UsageError, UnsupportedError, MissingPackageError):
            continue
        except WayboundError as fault:
            notes.append(f"{heuristic or 'the default solver'} failed: {fault}")
    return None


class _Tester:
    """``test(keep)``: whether the rows ``keep`` contradict each other; None if that was not found out in time.

    The first call may take all the time, later ones an eighth of what is left, so that one hard trial does not starve the rest.
    """

    def __init__(self, program: Program, end: float, control: Control) -> None:
        self.program, self.end, self.control = program, end, control
        self.matrix, self.calls = program.matrix, 0
        backend = BACKENDS[FILTER_SOLVER]()
        assert isinstance(backend, ProgramBackend)
        self.backend, self.point = backend, None

    def __call__(self, keep: Flags) -> bool | None:
        seconds_left = self.end - time.perf_counter()
        if seconds_left <= 0 or self.control.stopped:
            return None
        limit = seconds_left if self.calls == 0 else max(0.5, seconds_left / 8.0)
        self.calls += 1
        part = self.matrix[keep]
        rows = Rows(
            "kept", indptr=part.indptr.astype(np.int32), indices=part.indices.astype(np.int32), data=part.data,
            lower=self.program.row_lower[keep], upper=self.program.row_upper[keep],
        )  # fmt: skip
        trial = replace(self.program, rows=(rows,))
        result = self.backend.run(trial, Options(time_limit=limit), self.control)
        if result.status in ("infeasible", "infeasible_or_unbounded"):  # without costs nothing is unbounded
            return True
        self.point = result.answer
        return False if result.status in ("optimal", "feasible") else None


def deletion_filter(program: Program, test: Callable[[Flags], bool | None], stop: Callable[[], bool]) -> tuple[list[int], bool]:
    """Rows of an infeasible program that are infeasible together, as few as the time allows; and whether each was found to be needed.

    ``test`` says of flags of shape (rows,) whether those rows alone are infeasible, None if unknown; ``stop`` whether time is up.
    """
    keep = np.ones(program.num_rows, dtype=bool)
    starts = np.cumsum([0, *(block.size for block in program.rows)])
    decided = True

    def drop(rows: Integers) -> bool:
        nonlocal decided
        trial = keep.copy()
        trial[rows] = False
        verdict = test(trial)
        decided &= verdict is not None
        if verdict:
            keep[rows] = False
        return bool(verdict)

    for k in sorted(range(len(program.rows)), key=lambda k: -program.rows[k].size):
        if program.rows[k].size:
            drop(np.arange(starts[k], starts[k + 1]))
    size = max(1, int(keep.sum()) // 2)
    while not stop():
        decided = True
        at = np.nonzero(keep)[0]
        for first in range(0, len(at), size):
            if stop():
                decided = False
                break
            drop(at[first : first + size])
        if size == 1:
            return np.nonzero(keep)[0].tolist(), decided
        size = max(1, size // 2)
    return np.nonzero(keep)[0].tolist(), False


def _from_rows(program: Program, kept: list[int], minimal: bool) -> Explanation:
    names = [program.row_name(row) for row in kept]
    reasons = tuple(Reason("row", name, _row_text(program, row)) for name, row in zip(names, kept, strict=True))
    who, many = FILTER_SOLVER, "this row" if len(kept) == 1 else f"these {len(kept)} rows"
    if not kept:
        message = f"{who} finds no answer even within the bounds of the variables alone"
    elif minimal:
        message = f"{who} finds no point for {many} within the variables' bounds, and one wherever a row is left out"
    else:
        message = f"{who} finds no point for {many} within the variables' bounds; the search ended before the set was known to be smallest"
    return Explanation("infeasible", who, reasons, minimal, program.name, message)


_SHOWN_TERMS = 6


def _row_text(program: Program, row: int) -> str:
    """The row as a formula, long ones cut."""
    span = slice(program.indptr[row], program.indptr[row + 1])
    entries = list(zip(program.data[span].tolist(), program.indices[span].tolist(), strict=True))
    terms = [
        f"{'-' if a < 0 else '+'} {'' if abs(a) == 1 else f'{abs(a):g} '}{program.variable_name(j)}" for a, j in entries[:_SHOWN_TERMS]
    ]
    more = f" + ({len(entries) - _SHOWN_TERMS} more terms)" if len(entries) > _SHOWN_TERMS else ""
    body = (" ".join(terms) + more).removeprefix("+ ")
    low, high = float(program.row_lower[row]), float(program.row_upper[row])
    if low == high:
        return f"{body} = {low:g}"
    left = f"{low:g} <= " if np.isfinite(low) else ""
    right = f" <= {high:g}" if np.isfinite(high) else ""
    return f"{left}{body}{right}"


__all__ = ["Explanation", "Reason", "deletion_filter", "explain", "reasons_from_data"]
