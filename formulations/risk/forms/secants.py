"""The form of risk allocation with secants of the normal tail: its points are answers, of the joint problem too.

See the mathematics in ``_piecewise.py`` and docs/formulations/risk-allocation.md.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ..allocations import Allocation
from ..risk_allocation import RiskAllocation
from ._fixed_risks import FEATURES, makes, refuses
from ._piecewise import mean_risk, piecewise_program, points

Floats = NDArray[np.float64]

POINTS = 60


def build(problem: RiskAllocation) -> Compiled:
    """The program; see the module's text."""
    made = piecewise_program(problem, "secants", points(problem, mean_risk(problem), POINTS), above=True)
    n, many = len(problem.lower), len(problem.names)

    def decode(vector: Floats) -> Allocation:
        if problem.risk.kind == "joint":
            return Allocation(np.array(vector[:n]))
        risks = np.clip(vector[made.risk : made.risk + many] * made.unit, 0.0, problem.caps)
        over = max([1.0, *(float(risks[b.constraints].sum()) / b.risk for b in problem.budgets)])  # by a solver's rounding
        return Allocation(np.array(vector[:n]), risks / over * (1.0 - 1e-14) if over > 1.0 else risks)

    return Compiled(made.program, problem, decode)


FORMS.add("secants", Form("secants", "risk-allocation", FEATURES, build, Exactness.RESTRICTION, refuses=refuses, makes=makes, order=0))
