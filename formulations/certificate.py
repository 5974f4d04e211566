"""Certificates: what has been verified about an answer, and the evidence to verify it again without a solver."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import Any

from ..instances.errors import CheckFailedError, InputError, UsageError, in_words
from ..instances.printable import printable
from . import tolerance
from .evaluation import Check, Evaluation, Violation
from .evidence import Evidence, Guarantee
from .levels import LevelBound, check_levels, with_levels
from .problem import Problem
from .rendering import Line, as_html, as_rich, as_text, number, percent
from .stated import compare_answer, real, stated_evidence, stated_guarantee
from .verified_bounds import beats_bound, better_bound, one_check_is_wrong, proves_unbounded, verified_bound

SCHEMA = 1
"""Version of the certificate's JSON."""

SHOWN_VIOLATIONS = 10
"""Violations that are listed one by one; the rest is counted."""


class _Digest:
    """A certificate's ``instance_hash``: what is given is a digest, or makes it when it is first read."""

    def __get__(self, held: Any, owner: type) -> Any:
        if held is None:
            return self
        made = held.__dict__["instance_hash"]
        if callable(made):
            try:
                made = made()
            except Exception:  # of memory, say: the answer stands without it
                made = ""
            held.__dict__["instance_hash"] = made
        return made

    def __set__(self, held: Any, digest: str | Callable[[], str]) -> None:
        held.__dict__["instance_hash"] = digest


@dataclass(frozen=True)
class Certificate:
    """Verified facts about an answer.

    Attributes
    ----------
    instance_hash : str
        SHA-256 of the data, so that a certificate cannot pass for one of another instance.
    problem, sense, convention : str
        Name of the problem, ``min`` or ``max``, and how distances are rounded (empty without distances).
    feasible : bool or None
        None if there is no answer.
    checks : tuple of Check
        What was checked of the answer.
    violations : tuple of Violation
        What it breaks; empty for a feasible answer.
    objective : float, list of float, or None
        Recomputed from the data.
    bound : float or None
        Best verified bound on the first level; None where it is proved that there is no answer to bound.
    bound_source : str or None
        Source of ``bound``, or of the proof that there is no answer, or no best one.
    infeasible : bool
        Whether ``evidence`` proves that the problem has no answer.
    unbounded : bool
        Whether ``evidence`` proves that it has answers as good as one wants.
    gap : float or None
        At the first level of the objective; None where that one is closed and others, without a bound, follow.
    evidence : tuple of Evidence
        What proves ``bound``, ``infeasible`` or ``unbounded``; best first.
    guarantee : Guarantee or None
        The ratio stated for the heuristic that made the answer.
    stated_guarantee : Guarantee or None
        One that a certificate file states; nothing verifies it.
    observed_ratio : float or None
        Worse over better of objective and verified bound: no smaller than the true ratio. None where their signs differ.
    levels : tuple of LevelBound
        Verified bounds of the levels of priority after the first, for answers that are no worse than this one at the levels before.
    from_file : bool
        Whether the names of sources are those of a file, and shown as such.
    """

    instance_hash: str
    problem: str
    sense: str
    convention: str
    feasible: bool | None
    checks: tuple[Check, ...] = ()
    violations: tuple[Violation, ...] = ()
    objective: float | list[float] | None = None
    bound: float | None = None
    bound_source: str | None = None
    infeasible: bool = False
    unbounded: bool = False
    gap: float | None = None
    evidence: tuple[Evidence, ...] = field(default=())
    guarantee: Guarantee | None = None
    observed_ratio: float | None = None
    stated_guarantee: Guarantee | None = None
    from_file: bool = False
    levels: tuple[LevelBound, ...] = ()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "instance_hash": self.instance_hash}

    def to_json(self, *, with_evidence: bool = False) -> dict[str, Any]:
        """The certificate's keys in the JSON of ``solve``; ``with_evidence`` makes it a certificate file."""
        data: dict[str, Any] = {
            "feasible": self.feasible,
            "checks": [c.to_json() for c in self.checks],
            "violations": [v.to_json() for v in self.violations],
            "objective": self.objective,
            "bound": self.bound,
            "bound_source": self.bound_source,
            "infeasible": self.infeasible,
            "unbounded": self.unbounded,
            "gap": self.gap,
            "guarantee": None if self.guarantee is None else self.guarantee.to_json(),
            "observed_ratio": self.observed_ratio,
        }
        if self.levels:
            data["levels"] = [level.to_json(with_evidence=with_evidence) for level in self.levels]
        if self.stated_guarantee is not None:
            data["stated_guarantee"] = self.stated_guarantee.to_json()
        if with_evidence:
            data = {
                "schema": SCHEMA,
                "kind": "certificate",
                "instance_hash": self.instance_hash,
                "problem": self.problem,
                "sense": self.sense,
                "convention": self.convention,
                **data,
                "evidence": [e.to_json() for e in self.evidence],
            }
        return data

    def save(self, path: str | PathLike[str]) -> None:
        """Write a certificate file, with the evidence: ``wb.check(problem, answer, path)`` derives the bound again from it.

        Parameters
        ----------
        path : path-like
            ``.json``; evidence that is large stands in a compressed file beside it.

        Raises
        ------
        UsageError, InputError
            For another suffix; if the file cannot be written.
        """
        from .certificate_files import write_certificate

        if Path(path).suffix.lower() != ".json":
            raise UsageError(f"{path}: a certificate is written as .json", "unknown-name")
        write_certificate(self, path)

    def __repr__(self) -> str:
        return as_text(certificate_title(self), certificate_lines(self))

    def _repr_html_(self) -> str:
        return as_html(certificate_title(self), certificate_lines(self))

    def __rich__(self) -> Any:
        return as_rich(certificate_title(self), certificate_lines(self))


Certificate.instance_hash = _Digest()  # type: ignore[assignment]


def certify(
    problem: Problem,
    evaluation: Evaluation | None,
    evidence: Sequence[Evidence] = (),
    guarantee: Guarantee | None = None,
    unproved: list[str] | None = None,
    checked: Sequence[tuple[Evidence, float]] = (),
) -> Certificate:
    """Verify all evidence and put what holds into a certificate.

    ``unproved``: receives a line for each evidence whose checker fails, which is then left out; without it, that failure is raised.
    ``checked``: what ``verified_bound`` already said of some of it. Raises InputError if evidence is malformed and there is no
    ``unproved``. Raises CheckFailedError if a verified bound, or a proof that there is no answer, contradicts a feasible answer: both
    cannot be right.
    """
    verified, endless = _verified(problem, evidence, unproved, {id(e): bound for e, bound in checked})
    worst = math.inf if problem.sense == "min" else -math.inf
    refuting = [e for b, e in verified if b == worst]
    if refuting and evaluation is not None and evaluation.feasible:  # what residuals are worth may be an answer where there is none
        refuting = [e for e in refuting if problem.concession(e, evaluation) != math.inf]
    proved = [(b, e) for b, e in verified if math.isfinite(b)]
    proved.sort(key=lambda pair: pair[0], reverse=problem.sense == "min")
    if endless and (refuting or proved):
        other = refuting[0] if refuting else proved[0][1]
        claim = "that there is no answer" if refuting else "a bound"
        raise one_check_is_wrong(f"{endless[0].source} contradicts {other.source}, which proves {claim}")
    bound = proved[0][0] if proved and not refuting else None
    best = refuting[:1] or endless[:1] or [replace(e, value=b) for b, e in proved[:1]]  # whatever its finder claims of it
    gap = ratio = None
    if evaluation is not None and evaluation.feasible:
        value = evaluation.values[0]
        if refuting:
            raise one_check_is_wrong(f"an answer of value {value!r} passed every check, but {best[0].source} proves that there is none")
        if bound is not None:
            beaten = beats_bound(problem.sense, value, bound, evaluation.size)
            if beaten and not abs(value - bound) <= problem.concession(best[0], evaluation):
                raise one_check_is_wrong(f"the answer's value {value!r} is better than the bound {bound!r} derived from {best[0].source}")
            gap = tolerance.gap(value, bound, evaluation.size, evaluation.precision)
            if len(evaluation.values) > 1 and tolerance.same(value, bound, evaluation.size):
                gap = None
            ratio = tolerance.ratio(value, bound, evaluation.size, evaluation.precision)
    return Certificate(
        instance_hash=problem.digest_later(),  # type: ignore[arg-type]
        problem=problem.problem,
        sense=problem.sense,
        convention=problem.convention,
        feasible=None if evaluation is None else evaluation.feasible,
        checks=() if evaluation is None else evaluation.checks,
        violations=() if evaluation is None else evaluation.violations,
        objective=None if evaluation is None else evaluation.objective,
        bound=bound,
        bound_source=best[0].source if best else None,
        infeasible=bool(refuting),
        unbounded=bool(endless),
        gap=gap,
        evidence=tuple(best),
        guarantee=guarantee,
        observed_ratio=ratio,
    )


def _verified(
    problem: Problem, evidence: Sequence[Evidence], unproved: list[str] | None, known: Mapping[int, float]
) -> tuple[list[tuple[float, Evidence]], list[Evidence]]:
    """The bound that each piece of evidence proves, and the pieces that prove the problem unbounded; ``known`` are bounds by ``id``."""
    verified, endless = [], []
    for e in evidence:
        try:
            verified.append((known[id(e)] if id(e) in known else verified_bound(problem, e), e))
            if proves_unbounded(problem, e):
                endless.append(e)
        except (Exception, KeyboardInterrupt) as fault:
            if unproved is None:
                raise
            unproved.append(f"{e.source} is no bound: {in_words(fault)}")
    return verified, endless


def judged_only(problem: Problem, evaluation: Evaluation | None) -> Certificate:
    """A certificate of the judge's verdict alone, where bounds could not be certified."""
    digest: Any
    try:
        digest = problem.digest_later()
    except Exception:  # of memory, say: the answer stands without it
        digest = ""
    judged: dict[str, Any] = {"feasible": None}
    if evaluation is not None:
        judged = {name: getattr(evaluation, name) for name in ("feasible", "checks", "violations", "objective")}
    return Certificate(digest, problem.problem, problem.sense, problem.convention, **judged)


def check_certificate(problem: Problem, data: Mapping[str, Any], evaluation: Evaluation | None) -> Certificate:
    """Verify a certificate file against an instance and, if given, the evaluation of an answer.

    Raises InputError if it is no certificate, or one for other data, or a field is malformed. Raises CheckFailedError if what it states is
    not proved by its evidence (bound, infeasibility), or is not so of the answer (feasibility, checks, violations, objective, gap, ratio).
    """
    if (
        not isinstance(data, Mapping)
        or data.get("kind") != "certificate"
        or type(data.get("schema")) is not int
        or data["schema"] != SCHEMA
    ):
        raise InputError("not a waybound certificate", expected=f'"kind": "certificate" and "schema": {SCHEMA}')
    for key, own in (
        ("problem", problem.problem), ("sense", problem.sense), ("convention", problem.convention), ("instance_hash", problem.digest()),
    ):  # fmt: skip
        if data.get(key) != own:
            raise InputError(
                f"the certificate is for another instance: its {key} differs", "foreign", expected=own, found=printable(data.get(key), 80)
            )
    evidence = stated_evidence(data)
    recomputed = certify(problem, evaluation, evidence)
    if data.get("infeasible") and not recomputed.infeasible:
        raise CheckFailedError("the certificate states that there is no answer, its evidence does not prove it")
    if data.get("unbounded") and not recomputed.unbounded:
        raise CheckFailedError("the certificate states that there is no best answer, its evidence does not prove it")
    compare_answer(data, evaluation, infeasible=recomputed.infeasible)
    if data.get("bound") is not None and not recomputed.infeasible:
        _compare_bound(problem, real(data["bound"], "bound"), recomputed.bound, "the certificate")
    for piece in evidence:
        _compare_evidence(problem, piece, recomputed)
    levels = check_levels(problem, data.get("levels"), evaluation, data.get("objective") is not None)
    if levels:
        recomputed = replace(recomputed, levels=levels) if evaluation is None else with_levels(recomputed, evaluation, levels)
    _compare_figures(data, recomputed)
    return replace(recomputed, from_file=True, stated_guarantee=stated_guarantee(data))


def _compare_bound(problem: Problem, stated: float, proved: float | None, who: str) -> None:
    if proved is None or (better_bound(problem.sense, stated, proved) and not tolerance.same(stated, proved)):
        raise CheckFailedError(f"{who} states the bound {stated!r}, its evidence proves {proved!r}")


def _compare_evidence(problem: Problem, piece: Evidence, made: Certificate) -> None:
    """Raise CheckFailedError if a file states a better value beside evidence than the evidence proves."""
    if made.infeasible:
        return
    proved = made.bound if piece in made.evidence else verified_bound(problem, piece)
    if math.isfinite(piece.value):
        _compare_bound(problem, piece.value, proved if proved is not None and math.isfinite(proved) else None, "a piece of evidence")
    elif piece.value == (math.inf if problem.sense == "min" else -math.inf):
        raise CheckFailedError("a piece of evidence states that there is no answer, and does not prove it")


def _compare_figures(data: Mapping[str, Any], made: Certificate) -> None:
    """Compare source, gap and ratio with what the evidence proves of the answer; raises as ``compare_answer`` does.

    A gap or ratio that is larger than the proved one is true as far as it goes, and passes only beside a weaker bound.
    """
    source = data.get("bound_source")
    if source is not None and source != made.bound_source:
        raise CheckFailedError(f"the certificate names the source {printable(source, 80)!r}, its bound is from {made.bound_source!r}")
    weaker = data.get("bound") is None or made.bound is None or not tolerance.same(real(data["bound"], "bound"), made.bound)
    for key, proved in (("gap", made.gap), ("observed_ratio", made.observed_ratio)):
        if data.get(key) is None:
            continue
        stated = real(data[key], key)
        if made.feasible is None:
            continue  # nothing to compare with
        if proved is None or not (tolerance.same(stated, proved, 1.0) or (weaker and stated > proved)):
            raise CheckFailedError(f"the certificate states the {key} {stated!r}, what it proves is {proved!r}")


# -- for people ------------------------------------------------------------------------------------------------------------


def certificate_title(certificate: Certificate) -> str:
    """Heading of a certificate."""
    return f"Certificate: {certificate.problem}, {certificate.sense}, convention {certificate.convention}"


def certificate_lines(certificate: Certificate) -> list[Line]:
    """The facts of a certificate, one a line."""
    return [*answer_lines(certificate), *_bound_lines(certificate)]


def answer_lines(c: Certificate) -> list[Line]:
    """Lines about the answer."""
    if c.feasible is None:
        return [Line("answer", "none", "quiet")]
    if c.feasible:
        sure = min((check.confidence for check in c.checks), default=1.0)
        known = "" if sure == 1.0 else f", with confidence {percent(sure)}"
        lines = [Line("answer", f"feasible: all {len(c.checks)} checks hold{known}", "good")]
    else:
        broken = len(c.violations)
        lines = [Line("answer", f"infeasible: {broken} violation{'s' if broken != 1 else ''}", "bad")]
    for check in c.checks:
        if check.tested:
            text = f"{check.tested} tested, largest residual {check.residual:.3g}"
            text += "" if check.confidence == 1.0 else f", with confidence {percent(check.confidence)}"
            lines.append(Line(f"  {check.name}", text if check.passed else f"broken: {text}", "quiet" if check.passed else "bad"))
        else:
            lines.append(Line(f"  {check.name}", "nothing to test", "quiet"))
    lines += [
        Line("  !", v.message if v.amount == float("inf") else f"{v.message} (by {v.amount:.6g})", "bad")
        for v in c.violations[:SHOWN_VIOLATIONS]
    ]
    if len(c.violations) > SHOWN_VIOLATIONS:
        lines.append(Line("  !", f"and {len(c.violations) - SHOWN_VIOLATIONS} more", "bad"))
    lines.append(Line("objective", f"{number(c.objective)}, recomputed from the data"))
    return lines


def bound_line(c: Certificate) -> Line:
    """Line about the bound on all answers."""
    if c.infeasible or c.unbounded:
        return Line("bound", f"none: there is no {'solution' if c.infeasible else 'best solution'}, verified: {_source(c)}", "bad")
    if c.bound is None:
        return Line("bound", "none verified", "quiet")
    bounds, sources = [c.bound, *(level.bound for level in c.levels)], [_source(c), *(_level_source(c, level) for level in c.levels)]
    return Line("bound", f"{number(bounds if c.levels else c.bound)}, verified: {', then '.join(sources)}", "good")


def bound_lines(c: Certificate) -> list[Line]:
    """Lines about the bounds on all answers, level by level; without an answer they say for which answers each holds."""
    lines = [bound_line(c)]
    if c.feasible is None:
        lines += [
            Line("", f"level {k}: of solutions that are worth {number(level.given)} before it", "quiet")
            for k, level in enumerate(c.levels, start=2)
        ]
    return lines


def _bound_lines(c: Certificate) -> list[Line]:
    lines = bound_lines(c)
    if c.gap is not None:
        lines.append(gap_line(c.objective, [c.bound, *(level.bound for level in c.levels)], c.gap))
    return [*lines, *ratio_lines(c)]


def _source(c: Certificate) -> str:
    """Source of the bound; a name taken from a file stands in quotes behind the kind of evidence that was checked."""
    return f"{c.evidence[0].kind}, in the file {printable(c.bound_source, 200)!r}" if c.from_file and c.evidence else str(c.bound_source)


def _level_source(c: Certificate, level: LevelBound) -> str:
    return f"{level.evidence.kind}, in the file {printable(level.source, 200)!r}" if c.from_file else level.source


def ratio_lines(c: Certificate) -> list[Line]:
    """Lines about the guaranteed and the observed ratio."""
    lines = []
    if c.guarantee is not None:
        text = f"ratio {number(c.guarantee.ratio)}: {c.guarantee.statement} ({c.guarantee.source})"
        if c.guarantee.assumptions:
            text += f"; checked on this instance: {', '.join(c.guarantee.assumptions)}"
        lines.append(Line("guarantee", text))
    if c.stated_guarantee is not None:
        g = c.stated_guarantee
        text = f"ratio {number(g.ratio)}: {printable(g.statement, 300)!r} ({printable(g.source, 300)!r})"
        lines.append(Line("guarantee", f"stated in the file, not verified: {text}", "quiet"))
    if c.observed_ratio is not None:
        lines.append(Line("ratio", f"at most {c.observed_ratio:.6g}{_at_level(c.objective, 0)}, observed against the verified bound"))
    return lines


def gap_line(objective: Any, bound: Any, gap: float, against: str = "") -> Line:
    """A gap, and of which level it is where there are several: the first one that is open."""
    if not isinstance(objective, list) or not isinstance(bound, list):
        return Line("gap", percent(gap) + against)
    pairs = [(value, limit) for value, limit in zip(objective, bound, strict=False) if limit is not None]
    level = next((k for k, (value, limit) in enumerate(pairs) if not tolerance.same(value, limit)), len(pairs) - 1)
    return Line("gap", f"{percent(gap)}{_at_level(objective, level)}{against}")


def _at_level(objective: Any, level: int) -> str:
    return f" at level {level + 1}" if isinstance(objective, list) and len(objective) > 1 else ""
