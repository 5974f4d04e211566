"""The form of risk allocation with tangents of the normal tail: its optimum is a bound on that of the allocated problem.

See the mathematics in ``_piecewise.py`` and docs/formulations/risk-allocation.md. Towards the joint problem it is neither relaxation nor
restriction, as the allocated problem is a restriction of that.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ..allocations import Allocation
from ..risk_allocation import RiskAllocation
from ._blocks import evidence_of, prices, size_of
from ._fixed_risks import FEATURES, makes, refuses
from ._piecewise import mean_risk, piecewise_program, points

Floats = NDArray[np.float64]

POINTS = 60


def build(problem: RiskAllocation) -> Compiled:
    """The program; see the module's text."""
    made = piecewise_program(problem, "tangents", points(problem, mean_risk(problem), POINTS), above=False)
    n, allocated = len(problem.lower), problem.risk.kind == "allocated"

    def decode(vector: Floats) -> Allocation:
        return problem.allocated(np.array(vector[:n]))

    def dual_evidence(duals: Floats) -> Evidence:
        found = prices(problem, made.program, np.zeros(made.program.num_variables), duals)
        spent = -problem.sign * duals[made.budget : made.budget + len(problem.budgets)] / made.unit
        return evidence_of({**found, "budgets": np.maximum(spent, 0.0)}, float("nan"), "duals of tangents")

    linear = allocated and not made.program.cones and made.program.quadratic is None
    exactness = Exactness.EXACT if allocated else Exactness.RESTRICTION
    return Compiled(made.program, problem, decode, dual_evidence=dual_evidence if linear else None, exactness=exactness)


FORMS.add(
    "tangents",
    Form(
        "tangents",
        "risk-allocation",
        FEATURES,
        build,
        Exactness.RELAXATION,
        refuses=refuses,
        makes=makes,
        order=1,
        size=partial(size_of, pieces=POINTS),
    ),
)
