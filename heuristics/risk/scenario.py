"""Scenario approach: a plan that keeps every constraint in each of so many samples keeps the risk with a stated confidence."""

import math
from typing import Any

import numpy as np

from ...formulations.risk.allocations import Allocation, Floats
from ...formulations.risk.forms.fixed_risks import fixed_margins_program
from ...formulations.risk.risk_allocation import RiskAllocation
from ...instances.errors import UsageError
from ...solvers.engines.risk.convex_allocation_steps.session import open_session
from ...solvers.engines.risk.convex_allocation_steps.units import Units
from ..heuristic import Context, Outcome, heuristic

MOST_SAMPLES = 5_000_000
PORTION = 2_000_000
"""Numbers that are drawn at a time."""


def enough_samples(risk: float, confidence: float, support: int) -> int | None:
    """The least number of samples with which a plan of ``support`` decisions keeps ``risk`` with ``confidence``; None above
    ``MOST_SAMPLES``.

    It is the least M with ``sum over i < support of C(M, i) risk^i (1 - risk)^(M - i) <= 1 - confidence``. Source: Campi and Garatti
    (2008), "The exact feasibility of randomized solutions of uncertain convex programs", theorem 1.
    """
    from scipy.stats import binom

    low, high = support, support
    while binom.cdf(support - 1, high, risk) > 1.0 - confidence:
        if high >= MOST_SAMPLES:
            return None
        low, high = high, min(2 * high, MOST_SAMPLES)
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if binom.cdf(support - 1, middle, risk) <= 1.0 - confidence else (middle + 1, high)
    return high if high <= MOST_SAMPLES else None


def root(covariance: Floats) -> Floats:
    """A matrix whose product with its transpose is the covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def only_total(problem: RiskAllocation) -> frozenset[str]:
    """Features that methods of one joint probability lack."""
    alone = problem.risk.total is not None and len(problem.budgets) == 1 and bool((problem.caps >= problem.risk.total).all())
    return frozenset() if alone else frozenset({"budgets other than the total"})


@heuristic(
    "scenario", "risk-allocation", {"joint-risk", "quadratic-cost", "cones"},
    "the best plan that keeps every constraint in each of so many samples",
    "no guarantee of the cost; the joint risk is kept with the confidence asked for (Campi and Garatti 2008)", refuses=only_total,
)  # fmt: skip
def scenario(problem: RiskAllocation, context: Context, *, confidence: float = 0.999, samples: int = 0) -> Outcome:
    """The best plan that no sample of the noise breaks, of a problem with joint risk and a total alone.

    As the noise does not depend on the decision, each constraint is as tight as its worst sample. ``confidence``, in (0, 1), is that over
    the samples drawn that the plan's probability to fail is the total at most; ``samples`` is how many, 0 for as many as the confidence
    takes, for as many decisions as there are, or constraints if these are fewer. Raises UsageError for a parameter out of its range, or
    more samples than can be drawn. ``statistics`` hold ``samples``, ``confidence`` (NaN for fewer samples than it takes) and ``support``;
    the judge computes what is true of the plan.

    Source: Calafiore and Campi (2006), "The scenario approach to robust control design"; docs/formulations/risk-allocation.md#samples.
    """
    if not 0.0 < confidence < 1.0 or samples < 0:
        raise UsageError("scenario: confidence must lie between 0 and 1, and samples at 0 or more", "out-of-range")
    assert problem.risk.total is not None
    support = min(problem.size, len(problem.limits))
    needed = enough_samples(problem.risk.total, confidence, support)
    many = samples or needed
    if many is None or many > MOST_SAMPLES:
        demand = "more samples are" if many is None else f"{many} samples are"
        raise UsageError(
            f"scenario: {demand} needed, and at most {MOST_SAMPLES} are drawn: ask for less confidence or more risk", "too-large"
        )
    stop, noise, units = context.begin(), root(problem.covariance), Units.of(problem)
    worst = np.full(len(problem.limits), -math.inf)
    portion = max(1, PORTION // max(1, len(worst)))
    for begin in range(0, many, portion):
        if stop.reached():
            return Outcome(None, message="its samples were not drawn in time", limit=stop.reached())
        drawn = context.rng.standard_normal((min(portion, many - begin), len(worst))) @ noise.T
        worst = np.maximum(worst, drawn.max(axis=0))
    solved = open_session(fixed_margins_program(units.problem, "scenario", worst * units.chance), context.linear.seed).solve(stop)
    known = confidence if needed is not None and many >= needed else math.nan
    statistics: dict[str, Any] = {"samples": many, "confidence": known, "support": support}
    if solved.status != "optimal":
        message = f"the program of {many} samples is {solved.status}"
        return Outcome(None, statistics=statistics, message=message, limit=stop.reached() or "none")
    return Outcome(Allocation(np.clip(solved.x[: problem.size] * units.columns, problem.lower, problem.upper)), statistics=statistics)
