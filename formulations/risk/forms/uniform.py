"""The form of risk allocation that gives all constraints of a budget the same risk.

    a_i x + s_i z(r_i) <= b_i,      r_i = the least of budget / constraints of the budget, over its budgets, and of its own limit

with z the quantile of the normal tail: linear, quadratic or conic, as the cost is. A restriction of the allocated problem, and with it
(Boole) of the joint one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ..normal import ndtri
from ..risk_allocation import RiskAllocation
from ._blocks import size_of
from ._fixed_risks import FEATURES, compiled, makes, refuses

Floats = NDArray[np.float64]


def uniform_risks(problem: RiskAllocation) -> Floats:
    """The risk of each constraint; shape (constraints,)."""
    made = problem.caps.copy()
    for budget in problem.budgets:
        made[budget.constraints] = np.minimum(made[budget.constraints], budget.risk / len(budget.constraints))
    return np.asarray(made * (1.0 - 1e-15 * len(made)))  # so that their sum keeps within the budget


def build(problem: RiskAllocation) -> Compiled:
    """The program; see the module's text."""
    risks = uniform_risks(problem)
    return compiled(problem, "uniform", -ndtri(risks), risks)


FORMS.add(
    "uniform",
    Form("uniform", "risk-allocation", FEATURES, build, Exactness.RESTRICTION, refuses=refuses, makes=makes, order=2, size=size_of),
)
