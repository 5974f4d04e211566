"""Judge of risk allocations: cost, constraints and risks, recomputed from the data alone.

It knows no program and no solver, and shares no code with the forms.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...instances.number_arrays import Floats
from ..evaluation import Check, Evaluation, Violation, judge
from ..tolerance import LIMIT, ROUNDING, VECTOR
from .normal import ndtr, ndtri

if TYPE_CHECKING:
    from .allocations import Allocation
    from .risk_allocation import RiskAllocation

Judged = tuple[Check, list[Violation]]

SMALLEST_RISK = 1e-300
"""Least risk of which a quantile is taken: 37 standard deviations."""


def evaluate_allocation(problem: RiskAllocation, answer: Allocation) -> Evaluation:
    """Objective and violations of ``answer``; see ``RiskAllocation.evaluate``."""
    p, x, names = problem, answer.decision, problem.instance.decision_names
    known = bool(np.isfinite(x).all())
    with np.errstate(invalid="ignore", over="ignore"):
        outside = np.maximum(p.lower - x, x - p.upper)
        size = np.maximum.reduce([np.where(np.isfinite(side), np.abs(side), 0.0) for side in (p.lower, p.upper)])
        size = np.maximum(size, np.abs(x))
        near = np.clip(x, p.lower, p.upper) if known and (outside <= VECTOR * size).all() else x
        value, terms = p.value(near) if known else (math.nan, math.nan)
        judged = [
            judge("bounds", outside, lambda k: f"{names[k]} is {x[k]:.9g}, outside its bounds", VECTOR * size),
            _judge_rows(p, near),
            *([_judge_cones(p, near)] if p.cones else []),
        ]
        own = safest_risks(p, near) if known else np.ones(len(p.names))
        if p.risk.kind == "allocated":
            allowed = own if answer.risks is None else answer.risks
            judged += [_judge_chance(p, near, allowed), _judge_risks(p, allowed), _judge_budgets(p, allowed)]
        else:
            judged += [_judge_risks(p, own), _judge_joint(p, near, known)]
    checks, violations = tuple(check for check, _ in judged), tuple(v for _, broken in judged for v in broken)
    return Evaluation((value,), checks, violations, _quantities(p, near, own) if known else {}, (terms,), VECTOR)


def safest_risks(p: RiskAllocation, x: Floats) -> Floats:
    """Probability that the safest row of each constraint fails at the decision ``x``."""
    slack, certain = p.limits - p.chance @ x, p.deviation == 0.0
    rows = ndtr(-slack / np.where(certain, 1.0, p.deviation))
    if certain.any():
        rows = np.where(certain, (slack < -VECTOR * _row_sizes(p, x)).astype(np.float64), rows)
    safest = np.ones(len(p.names))
    np.minimum.at(safest, p.constraint, rows)
    return safest


def judged_slack(p: RiskAllocation, x: Floats) -> Floats:
    """Slack of each chance row; none, not less, where one without noise is broken by no more than is let pass."""
    slack = p.limits - p.chance @ x
    passed = (p.deviation == 0.0) & (slack >= -VECTOR * _row_sizes(p, x))
    return np.where(passed, np.maximum(slack, 0.0), slack)


def _row_sizes(p: RiskAllocation, x: Floats) -> Floats:
    """Largest number in each chance row."""
    return np.asarray(np.maximum(np.abs(p.limits), np.abs(p.chance * x).max(axis=1, initial=0.0)))


def _quantities(p: RiskAllocation, x: Floats, own: Floats) -> dict[str, float]:
    joint = next(iter(p.joint_risk(x).values()))
    quantities = {
        "sum_of_risks": float(own.sum()), "joint_risk": joint.value, "joint_risk_low": joint.low, "joint_risk_high": joint.high,
        "joint_risk_confidence": joint.confidence,
    }  # fmt: skip
    if p.risk.total is not None:
        quantities["unused_share_of_risk"] = 1.0 - joint.value / p.risk.total
    return quantities


def _judge_rows(p: RiskAllocation, x: Floats) -> Judged:
    parts = p.rows * x
    activity, size = parts.sum(axis=1), np.abs(parts).max(axis=1, initial=0.0)
    for side in (p.row_lower, p.row_upper):
        size = np.maximum(size, np.where(np.isfinite(side), np.abs(side), 0.0))
    names = p.instance.constraint_names
    excess = np.maximum(p.row_lower - activity, activity - p.row_upper)
    return judge("constraints", excess, lambda k: f"constraint {names[k]} is {activity[k]:.9g}, outside its limits", VECTOR * size)


def _judge_cones(p: RiskAllocation, x: Floats) -> Judged:
    norms = np.array([float(np.linalg.norm(f @ x + c)) for f, c, _, _ in p.cones])
    limits = np.array([float(g @ x + h) for _, _, g, h in p.cones])
    size = np.maximum(norms, np.abs(limits))
    return judge("cones", norms - limits, lambda k: f"cone {k + 1}: the norm is {norms[k]:.9g}, above {limits[k]:.9g}", VECTOR * size)


def _judge_chance(p: RiskAllocation, x: Floats, risks: Floats) -> Judged:
    """Check that each constraint fails no more likely than its risk, counted in deviations, however far its limit is."""
    quantile = -ndtri(np.maximum(risks, SMALLEST_RISK))[p.constraint]
    margin = np.where(p.deviation == 0.0, 0.0, p.deviation * quantile)
    excess = np.where(np.isnan(margin), math.inf, p.chance @ x + margin - p.limits)
    best, size, own = np.full(len(p.names), math.inf), np.zeros(len(p.names)), safest_risks(p, x)
    np.minimum.at(best, p.constraint, excess)
    np.maximum.at(size, p.constraint, np.maximum(_row_sizes(p, x), np.abs(margin)))
    over = np.where(best <= 4.0 * ROUNDING * size, np.minimum(own - risks, 0.0), np.where(np.isnan(risks), math.inf, own - risks))
    return judge(
        "chance", over, lambda k: f"chance constraint {p.names[k]} has the risk {own[k]:.9g}, allowed {risks[k]:.9g}", VECTOR * risks
    )


def _judge_risks(p: RiskAllocation, risks: Floats) -> Judged:
    most = p.risk.each
    excess = np.where(risks < 0.0, -risks, risks - most)
    allowed = np.where(risks < 0.0, 0.0, VECTOR * most)
    return judge("risks", excess, lambda k: f"chance constraint {p.names[k]} has the risk {risks[k]:.9g}, at most {most[k]:.9g}", allowed)


def _judge_budgets(p: RiskAllocation, risks: Floats) -> Judged:
    spent = np.array([math.fsum(risks[b.constraints].tolist()) for b in p.budgets])
    most = np.array([b.risk for b in p.budgets])
    return judge("budgets", spent - most, lambda k: _over(p, k, spent[k]), LIMIT * most)


def _judge_joint(p: RiskAllocation, x: Floats, known: bool) -> Judged:
    """Check of the budgets by the upper limits of the probabilities, so that errors count against the answer; and its confidence."""
    joint = p.joint_risk(x) if known else {}
    spent = np.array([joint[b.name].high if known else math.nan for b in p.budgets])
    most = np.array([b.risk for b in p.budgets])
    check, violations = judge("joint-risk", spent - most, lambda k: _over(p, k, spent[k]), VECTOR * most)
    doubt = math.fsum(1.0 - joint[b.name].kept(b.risk * (1.0 + VECTOR)) for b in p.budgets) if check.passed else 0.0
    return replace(check, confidence=max(0.0, 1.0 - doubt)), violations


def _over(p: RiskAllocation, k: int, spent: float) -> str:
    return f"the risk of {p.budgets[k].name} is {spent:.9g}, at most {p.budgets[k].risk:.9g}"
