"""Forms of risk allocation in which the margin of every chance constraint is known beforehand: ``uniform`` and ``ellipsoid``.

    a_i x + s_i z_i <= b_i,      z_i = z(r_i), the quantile of the normal tail: linear, quadratic or conic, as the cost is

``uniform`` gives all constraints of a budget the same risk: r_i is the least of budget / constraints of the budget, over its budgets, and
of its own limit. A restriction of the allocated problem, and with it (Boole) of the joint one.

``ellipsoid`` keeps a confidence ellipsoid of the noise within the constraints: z_i = rho, where rho^2 is the number that a chi-square
variable of d degrees of freedom, the rank of the covariance, exceeds with the total risk. None of the constraints fails as long as the
noise is in the ellipsoid: a restriction of the joint problem, and of the allocated one where N constraints of risk tail(rho) keep within
the total. Source: van Hessem and Bosgra (2002), "A conic reformulation of model predictive control including bounded and stochastic
disturbances".
"""

import math

import numpy as np

from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.exactness import Exactness
from ...programs.program import INTEGERS, LINEAR, QUADRATIC, Program, Variables
from ...programs.rows import rows
from ..allocations import Allocation, Floats
from ..normal import ndtr, ndtri
from ..risk_allocation import RiskAllocation
from ._blocks import Blocks, dense_rows, size_of

FEATURES = frozenset({"allocated-risk", "joint-risk", "alternatives", "quadratic-cost", "cones"})

ROUNDED = 2e-8
"""Part of a limit that restrictions leave to rounding: beside small deviations it is enough to change a risk by a lot."""

RANK = 1e-10
"""Part of the largest eigenvalue below which one counts as 0."""


def makes(problem: RiskAllocation) -> frozenset[str]:
    """Features of the program of a problem: cones and quadratic costs where it has them, integers for alternatives."""
    has = problem.features()
    cones = frozenset({"second-order-cones"}) if "cones" in has else LINEAR
    return cones | (QUADRATIC if "quadratic-cost" in has else LINEAR) | (INTEGERS if problem.disjunctive else LINEAR)


def refuses(problem: RiskAllocation) -> frozenset[str]:
    """Alternatives need bounds of all decisions."""
    endless = problem.disjunctive and not np.isfinite([problem.lower, problem.upper]).all()
    return frozenset({"alternatives of decisions without bounds"}) if endless else frozenset()


def largest(problem: RiskAllocation) -> Floats:
    """Largest mean of each chance row within the bounds of the decisions."""
    up = np.where(problem.chance > 0, problem.upper, problem.lower)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(problem.chance == 0, 0.0, problem.chance * up).sum(axis=1))


def add_choices(blocks: Blocks) -> int:
    """Add a binary for each row, 1 where it is the one of its constraint that holds; the column of the first."""
    p = blocks.problem
    size = len(p.constraint)
    alone = np.bincount(p.constraint)[p.constraint] == 1
    choice = Variables(
        "choice", (p.constraint, np.arange(size)), (p.names,), alone.astype(float), np.ones(size), np.zeros(size), integer=True
    )
    start = blocks.add(choice)
    blocks.rows.append(rows("choose", len(p.names), [(p.constraint, start + np.arange(size), 1.0)], 1.0, keys=(np.arange(len(p.names)),),
                            labels=(p.names,)))  # fmt: skip
    return start


def margins(problem: RiskAllocation, quantile: Floats) -> Floats:
    """Margin ``s_i z_i`` of each chance row, from the quantile of each constraint."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(problem.deviation == 0.0, 0.0, problem.deviation * quantile[problem.constraint]))


def spared(problem: RiskAllocation) -> Floats:
    """Part of each limit that a restriction gives up, so that a solver's rounding breaks no chance constraint."""
    return np.asarray(np.where(problem.deviation > 0.0, ROUNDED * np.abs(problem.limits), 0.0))


def fixed_margins_program(problem: RiskAllocation, name: str, margin: Floats) -> Program:
    """``a_i x + margin_i <= b_i``, one margin a chance row; rows that are alternatives by binaries and large numbers."""
    blocks = Blocks(problem)
    limits, extra = problem.limits - margin, []
    if problem.disjunctive:
        choice, each = add_choices(blocks), np.arange(len(limits))
        slack = np.maximum(largest(problem) - limits, 0.0)
        slack[np.bincount(problem.constraint)[problem.constraint] == 1] = 0.0
        extra, limits = [(each, choice + each, slack)], limits + slack
    keys = (problem.constraint,) if not problem.disjunctive else (problem.constraint, np.arange(len(limits)))
    blocks.rows.append(dense_rows("chance", problem.chance, -math.inf, limits, extra, keys, (problem.names,)))
    return blocks.program(name)


def compiled(problem: RiskAllocation, name: str, quantile: Floats, risks: Floats) -> Compiled:
    """The program, a restriction, whose decisions have the given risks."""
    program, n = fixed_margins_program(problem, name, margins(problem, quantile) + spared(problem)), len(problem.lower)

    def decode(vector: Floats) -> Allocation:
        return Allocation(np.array(vector[:n]), risks if problem.risk.kind == "allocated" else None)

    return Compiled(program, problem, decode)


def uniform_risks(problem: RiskAllocation) -> Floats:
    """The same risk for all constraints that share a budget, or less where a constraint allows less; shape (constraints,)."""
    risks = problem.caps.copy()
    for budget in problem.budgets:
        risks[budget.constraints] = np.minimum(risks[budget.constraints], budget.risk / len(budget.constraints))
    return np.asarray(risks * (1.0 - 1e-15 * len(risks)))  # so that their sum keeps within the budget


def build_uniform(problem: RiskAllocation) -> Compiled:
    """The program of form ``uniform``; see the module's text."""
    risks = uniform_risks(problem)
    return compiled(problem, "uniform", -ndtri(risks), risks)


def radius(problem: RiskAllocation) -> float:
    """rho: deviations to which the ellipsoid of the noise reaches that it leaves with the total risk."""
    from scipy.stats import chi2

    assert problem.risk.total is not None
    values = np.linalg.eigvalsh(problem.covariance)
    rank = max(1, int((values > RANK * values[-1]).sum()))
    return math.sqrt(float(chi2.isf(problem.risk.total, rank)))


def ellipsoid_refuses(problem: RiskAllocation) -> frozenset[str]:
    """Budgets of parts, and risks that add up to more than the total."""
    lacking = set(refuses(problem))
    if problem.risk.total is None or len(problem.budgets) > 1 or (problem.risk.each < problem.risk.total).any():
        return frozenset(lacking | {"budgets other than the total"})
    if problem.risk.kind == "allocated" and float(ndtr(-radius(problem))) * len(problem.names) > problem.risk.total:
        lacking.add("risks that add up to more than the total in an ellipsoid of few dimensions (risk=joint has no such limit)")
    return frozenset(lacking)


def build_ellipsoid(problem: RiskAllocation) -> Compiled:
    """The program of form ``ellipsoid``; see the module's text."""
    rho, many = radius(problem), len(problem.names)
    return compiled(problem, "ellipsoid", np.full(many, rho), np.full(many, float(ndtr(-rho))))


for _name, _build, _refuses, _order in (
    ("uniform", build_uniform, refuses, 2),
    ("ellipsoid", build_ellipsoid, ellipsoid_refuses, 3),
):
    FORMS.enter(
        Form(
            _name, "risk-allocation", FEATURES, _build, Exactness.RESTRICTION, refuses=_refuses, makes=makes, order=_order, size=size_of,
        ),
    )  # fmt: skip
