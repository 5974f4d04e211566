"""Bound ``convex-allocation``: prices of the convex program of decisions and risks, or of each constraint with all of its budgets."""

from __future__ import annotations

from typing import Any

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.stop import Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod


def missing(problem: Any) -> frozenset[str]:
    """For what it proves nothing; empty if it applies."""
    return frozenset() if problem.family == "risk-allocation" else frozenset({f"{problem.family} problems"})


def compute(problem: RiskAllocation, stop: Stop, linear: LinearPrograms) -> Evidence | None:
    """Prices by successive tangents, for what is left of the problem without alternatives, and without sums where risk is joint."""
    from ...engines.convex_allocation_steps.successive_tangents import SuccessiveTangents

    part, rows = problem.convex_part()
    if not len(rows):
        return None
    found = SuccessiveTangents(part, linear.seed).run(stop)
    if found.prices is not None:
        every = np.zeros(len(problem.limits))
        every[rows] = found.prices["chance"]
        found.prices["chance"] = every
        if len(part.budgets) != len(problem.budgets):
            found.prices["budgets"] = np.zeros(len(problem.budgets))
    return next(iter(found.evidence(problem.sign)), None)


BOUNDS.add(
    "convex-allocation",
    BoundMethod(
        "convex-allocation", missing, compute, order=0,
        replaces=lambda problem: frozenset({"linear-relaxation"}) if problem.family == "risk-allocation" else frozenset(),
    ),
)  # fmt: skip
