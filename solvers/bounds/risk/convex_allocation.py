"""Bound ``convex-allocation``: prices of the convex program of decisions and risks, or of each constraint with all of its budgets."""

from dataclasses import replace

import numpy as np

from ....formulations.evidence import Evidence
from ....formulations.risk.risk_allocation import Ints, RiskAllocation
from ....formulations.stop import Stop
from ...engines.risk.convex_allocation_steps.successive_tangents import Interval, SuccessiveTangents
from ...linear_programs import LinearPrograms
from .. import bound_method, instead_of, of_family

FAMILY = RiskAllocation.family


@bound_method("convex-allocation", of_family(FAMILY), order=1, replaces=instead_of("linear-relaxation", FAMILY))
def compute(problem: RiskAllocation, stop: Stop, linear: LinearPrograms) -> Evidence | None:
    """Prices by successive tangents, for the part of the problem without alternatives, and without sums where risk is joint."""
    part, rows = problem.convex_part()
    return next(iter(part_evidence(problem, rows, SuccessiveTangents(part, linear.seed).run(stop))), None)


def part_evidence(problem: RiskAllocation, rows: Ints, interval: Interval) -> tuple[Evidence, ...]:
    """Evidence that an interval of ``problem.convex_part()``, which holds ``rows``, has for the problem."""
    if interval.prices is None:
        return ()
    chance, budgets = np.zeros(len(problem.limits)), np.zeros(len(problem.budgets))
    chance[rows] = interval.prices["chance"]
    if problem.risk.kind == "allocated":
        kept = np.unique(problem.constraint[rows])
        priced = [bool(np.isin(kept, b.constraints).any()) for b in problem.budgets]
        budgets[priced] = interval.prices["budgets"]
    return replace(interval, prices={**interval.prices, "chance": chance, "budgets": budgets}).evidence(problem.sign)
