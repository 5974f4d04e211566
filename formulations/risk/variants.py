"""Risk allocations made from another one: with wider limits, fewer rows or answers, another way to count risk."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...instances.risk.allocation import MOST_RISK, Risk

if TYPE_CHECKING:
    from ..problem import Decision
    from .risk_allocation import RiskAllocation

Ints = NDArray[np.int64]


def widened(problem: RiskAllocation, residual: Mapping[str, float]) -> RiskAllocation:
    """See ``RiskAllocation.widened``."""
    made = copy.copy(problem)
    wider = residual.get("constraints", 0.0)
    made.row_lower, made.row_upper = made.row_lower - wider, made.row_upper + wider
    made.limits = made.limits + residual.get("chance", 0.0)
    made.cones = tuple((f, c, g, h + residual.get("cones", 0.0)) for f, c, g, h in made.cones)
    more = residual.get("budgets", 0.0) + residual.get("joint-risk", 0.0)
    made.budgets = tuple(replace(b, risk=b.risk + more) for b in made.budgets)
    made.caps = np.minimum(made.caps + residual.get("risks", 0.0) + more, MOST_RISK)
    return made


def choosing(problem: RiskAllocation, rows: Ints) -> RiskAllocation:
    """See ``RiskAllocation.choosing``."""
    p, made = problem, copy.copy(problem)
    kept, constraint = np.unique(p.constraint[rows], return_inverse=True)
    made.chance, made.limits, made.deviation = p.chance[rows], p.limits[rows], p.deviation[rows]
    made.covariance, made.constraint, made.open = p.covariance[np.ix_(rows, rows)], constraint, np.ones(len(rows), dtype=bool)
    made.names, made.caps = tuple(p.names[k] for k in kept.tolist()), p.caps[kept]
    made.risk = Risk(p.risk.kind, p.risk.total, p.risk.each[kept])
    members = [(b, np.nonzero(np.isin(kept, b.constraints))[0]) for b in p.budgets]
    made.budgets = tuple(replace(b, constraints=at) for b, at in members if len(at))
    made._joint = ((b"", None), {})
    return made


def by_allocation(problem: RiskAllocation) -> RiskAllocation:
    """See ``RiskAllocation.by_allocation``."""
    made = copy.copy(problem)
    made.risk = replace(problem.risk, kind="allocated", budgets=())
    made._joint = ((b"", None), {})
    return made


def convex_part(problem: RiskAllocation) -> tuple[RiskAllocation, Ints]:
    """See ``RiskAllocation.convex_part``."""
    left = np.bincount(problem.constraint, weights=problem.open)
    rows = np.nonzero(problem.open & (left[problem.constraint] == 1))[0]
    made = choosing(problem, rows) if problem.disjunctive else copy.copy(problem)
    if problem.risk.kind == "joint":
        made.risk, made.budgets = Risk("allocated", None, made.caps), ()
    return made, rows


def restricted(problem: RiskAllocation, decisions: Sequence[Decision]) -> RiskAllocation:
    """See ``RiskAllocation.restricted``."""
    made = copy.copy(problem)
    made.open = problem.open.copy()
    for statement, holds in decisions:
        row = statement["safest"]
        if holds:
            kept = made.open[row]
            made.open[problem.constraint == problem.constraint[row]] = False
            made.open[row] = kept
        else:
            made.open[row] = False
    return made
