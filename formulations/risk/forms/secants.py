"""The form of risk allocation with secants of the normal tail: its points are answers, of the joint problem too.

See the mathematics in ``_piecewise.py`` and docs/formulations/risk-allocation.md.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ..allocations import Allocation
from ..risk_allocation import RiskAllocation
from ._blocks import size_of
from ._fixed_risks import FEATURES, makes, refuses
from ._piecewise import mean_risk, piecewise_program, points

Floats = NDArray[np.float64]

POINTS = 60


def build(problem: RiskAllocation) -> Compiled:
    """The program; see the module's text."""
    made = piecewise_program(problem, "secants", points(problem, mean_risk(problem), POINTS), above=True)
    n = len(problem.lower)

    def decode(vector: Floats) -> Allocation:
        return problem.allocated(np.array(vector[:n]))

    return Compiled(made.program, problem, decode)


FORMS.add(
    "secants",
    Form(
        "secants",
        "risk-allocation",
        FEATURES,
        build,
        Exactness.RESTRICTION,
        refuses=refuses,
        makes=makes,
        order=0,
        size=partial(size_of, pieces=POINTS),
    ),
)
