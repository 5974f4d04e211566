"""The form of risk allocation that keeps a confidence ellipsoid of the noise within the constraints.

    a_i x + s_i rho <= b_i,      rho^2 = the number that a chi-square variable of d degrees of freedom exceeds with the total risk

where d is the rank of the covariance. Whatever the constraints, none of them fails as long as the noise is in the ellipsoid: a restriction
of the joint problem, and of the allocated one where N constraints of risk tail(rho) keep within the total.
Source: van Hessem and Bosgra (2002), "A conic reformulation of model predictive control including bounded and stochastic disturbances".
"""

from __future__ import annotations

import math

import numpy as np

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ..normal import ndtr
from ..risk_allocation import RiskAllocation
from ._blocks import size_of
from ._fixed_risks import FEATURES, compiled, makes
from ._fixed_risks import refuses as lacks_bounds

RANK = 1e-10
"""Part of the largest eigenvalue below which one counts as 0."""


def radius(problem: RiskAllocation) -> float:
    """rho: in deviations, of the ellipsoid that the noise leaves with the total risk."""
    from scipy.stats import chi2

    assert problem.risk.total is not None
    values = np.linalg.eigvalsh(problem.covariance)
    rank = max(1, int((values > RANK * values[-1]).sum()))
    return math.sqrt(float(chi2.isf(problem.risk.total, rank)))


def refuses(problem: RiskAllocation) -> frozenset[str]:
    """Budgets of parts, and risks that add up to more than the total."""
    lacking = set(lacks_bounds(problem))
    if problem.risk.total is None or len(problem.budgets) > 1 or (problem.risk.each < problem.risk.total).any():
        return frozenset(lacking | {"budgets other than the total"})
    if problem.risk.kind == "allocated" and float(ndtr(-radius(problem))) * len(problem.names) > problem.risk.total:
        lacking.add("risks that add up to more than the total in an ellipsoid of few dimensions (risk=joint has no such limit)")
    return frozenset(lacking)


def build(problem: RiskAllocation) -> Compiled:
    """The program; see the module's text."""
    rho = radius(problem)
    every = np.full(len(problem.names), rho)
    return compiled(problem, "ellipsoid", every, np.full(len(problem.names), float(ndtr(-rho))))


FORMS.add(
    "ellipsoid",
    Form("ellipsoid", "risk-allocation", FEATURES, build, Exactness.RESTRICTION, refuses=refuses, makes=makes, order=3, size=size_of),
)
