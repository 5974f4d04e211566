"""Certificates: what has been verified about an answer, and the evidence to verify it again without a solver."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ..instances.errors import CheckFailedError, InputError
from .evaluation import CHECK_TOLERANCE, Check, Evaluation, Violation
from .evidence import CHECKERS, Evidence, Guarantee
from .problem import Problem

SCHEMA = 1
"""Version of the certificate's JSON."""


@dataclass(frozen=True)
class Certificate:
    """Verified facts about an answer.

    Attributes
    ----------
    instance_hash : str
    problem, sense, convention : str
    feasible : bool or None
        None if there is no answer.
    checks : tuple of Check
    violations : tuple of Violation
    objective : float, list of float, or None
        Recomputed from the data.
    bound : float or None
        Best verified bound on the first level.
    bound_source : str or None
    gap : float or None
    evidence : tuple of Evidence
        What proves ``bound``; best first.
    guarantee : Guarantee or None
        The ratio stated for the heuristic that made the answer.
    observed_ratio : float or None
        Worse over better of objective and verified bound: no smaller than the true ratio.
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
    gap: float | None = None
    evidence: tuple[Evidence, ...] = field(default=())
    guarantee: Guarantee | None = None
    observed_ratio: float | None = None

    def to_json(self, *, with_evidence: bool = False) -> dict[str, Any]:
        """The certificate's keys in the JSON of ``solve``; ``with_evidence`` makes it a certificate file."""
        data: dict[str, Any] = {
            "feasible": self.feasible,
            "checks": [c.to_json() for c in self.checks],
            "violations": [v.to_json() for v in self.violations],
            "objective": self.objective,
            "bound": self.bound,
            "bound_source": self.bound_source,
            "gap": self.gap,
            "guarantee": None if self.guarantee is None else self.guarantee.to_json(),
            "observed_ratio": self.observed_ratio,
        }
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


def better_bound(sense: str, a: float, b: float) -> bool:
    """Whether bound ``a`` says more than ``b``."""
    return a > b if sense == "min" else a < b


def beats_bound(sense: str, objective: float, bound: float) -> bool:
    """Whether an objective is better than a bound says is possible, beyond the tolerance of either."""
    slack = CHECK_TOLERANCE * max(1.0, abs(objective))
    return objective < bound - slack if sense == "min" else objective > bound + slack


def verified_bound(problem: Problem, evidence: Evidence) -> float:
    """The bound that the checker derives from ``evidence``; raises InputError where its shape is wrong."""
    try:
        return float(CHECKERS[evidence.kind](problem, evidence.data))
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as fault:
        raise InputError(f"evidence of kind {evidence.kind} is malformed", found=f"{type(fault).__name__}: {fault}") from fault


def certify(
    problem: Problem,
    evaluation: Evaluation | None,
    evidence: Sequence[Evidence] = (),
    guarantee: Guarantee | None = None,
) -> Certificate:
    """Verify all evidence and put what holds into a certificate.

    Raises
    ------
    CheckFailedError
        If a verified bound contradicts the recomputed objective of a feasible answer: both cannot be right.
    """
    proved = [(verified_bound(problem, e), e) for e in evidence]
    proved = [(b, e) for b, e in proved if math.isfinite(b)]
    proved.sort(key=lambda pair: pair[0], reverse=problem.sense == "min")
    bound = proved[0][0] if proved else None
    gap = ratio = None
    if evaluation is not None and evaluation.feasible and bound is not None:
        value = evaluation.values[0]
        if beats_bound(problem.sense, value, bound):
            raise CheckFailedError(
                f"the answer's value {value!r} is better than the bound {bound!r} derived from {proved[0][1].source}: "
                "one of the two checks is wrong; please report this"
            )
        if len(evaluation.values) == 1:
            gap = abs(bound - value) / max(abs(value), 1e-9)
        better, worse = sorted((abs(value), abs(bound)))
        ratio = 1.0 if worse - better <= CHECK_TOLERANCE else (worse / better if better > 0 else None)
    return Certificate(
        instance_hash=problem.digest(),
        problem=problem.problem,
        sense=problem.sense,
        convention=problem.convention,
        feasible=None if evaluation is None else evaluation.feasible,
        checks=() if evaluation is None else evaluation.checks,
        violations=() if evaluation is None else evaluation.violations,
        objective=None if evaluation is None else evaluation.objective,
        bound=bound,
        bound_source=proved[0][1].source if proved else None,
        gap=gap,
        evidence=tuple(e for _, e in proved[:1]),
        guarantee=guarantee,
        observed_ratio=ratio,
    )


def check_certificate(problem: Problem, data: Mapping[str, Any], evaluation: Evaluation | None) -> Certificate:
    """Verify a certificate file against an instance and, if given, the evaluation of an answer.

    Raises
    ------
    InputError
        If it is no certificate, or one for other data.
    CheckFailedError
        If the bound it states is not proved by its evidence, or the objective it states is not the answer's.
    """
    if data.get("kind") != "certificate" or data.get("schema") != SCHEMA:
        raise InputError("not a waybound certificate", expected=f'"kind": "certificate" and "schema": {SCHEMA}')
    for key, own in (("problem", problem.problem), ("convention", problem.convention), ("instance_hash", problem.digest())):
        if data.get(key) != own:
            raise InputError(f"the certificate is for another instance: its {key} differs", expected=own, found=str(data.get(key)))
    entries = data.get("evidence", [])
    if not isinstance(entries, list):
        raise InputError("the certificate's evidence is not a list")
    try:
        evidence = [Evidence.from_json(e) for e in entries]
    except (KeyError, TypeError, ValueError) as fault:
        raise InputError(f"the certificate's evidence is malformed: {type(fault).__name__} {fault}") from fault
    made = certify(problem, evaluation, evidence)
    stated = data.get("bound")
    if stated is not None:
        if not isinstance(stated, int | float):
            raise InputError("the certificate's bound is not a number", found=str(stated))
        if made.bound is None or better_bound(problem.sense, stated, made.bound + _slack(problem.sense, stated)):
            raise CheckFailedError(f"the certificate states the bound {stated!r}, its evidence proves {made.bound!r}")
    value = data.get("objective")
    if value is not None and evaluation is not None:
        stated_values = value if isinstance(value, list) else [value]
        if len(stated_values) != len(evaluation.values) or any(
            abs(a - b) > CHECK_TOLERANCE * max(1.0, abs(b)) for a, b in zip(stated_values, evaluation.values, strict=True)
        ):
            raise CheckFailedError(f"the certificate states the objective {value!r}, the answer's is {evaluation.objective!r}")
    return made


def _slack(sense: str, value: float) -> float:
    size = CHECK_TOLERANCE * max(1.0, abs(value))
    return size if sense == "min" else -size
