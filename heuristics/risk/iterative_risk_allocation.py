"""Iterative risk allocation: constraints that leave risk unused give it to those that are active, and the plan is made again."""

import math
from typing import Any

import numpy as np

from ...formulations.risk.allocations import Allocation
from ...formulations.risk.forms.fixed_risks import fixed_margins_program, margins, uniform_risks
from ...formulations.risk.normal import ndtr, ndtri
from ...formulations.risk.risk_allocation import RiskAllocation
from ...instances.errors import UsageError
from ...solvers.engines.risk.convex_allocation_steps.session import open_session
from ...solvers.engines.risk.convex_allocation_steps.units import Units
from ..heuristic import Context, Outcome, heuristic

ACTIVE = 1e-7
"""Deviations by which the argument of an active constraint's tail may lie above that of its allowed risk."""


def _refuses(problem: RiskAllocation) -> frozenset[str]:
    return frozenset() if len(problem.budgets) == 1 and problem.risk.total is not None else frozenset({"budgets other than the total"})


@heuristic(
    "iterative", "risk-allocation", {"allocated-risk", "joint-risk", "quadratic-cost", "cones"},
    "iterative risk allocation: unused risk goes to the active constraints, plan after plan",
    "no guarantee (never worse than equal risks; stalls where all constraints are active)", refuses=_refuses,
)  # fmt: skip
def iterative(
    problem: RiskAllocation, context: Context, *, alpha: float = 0.7, decay: float = 1.0, epsilon: float = 2e-7, rounds: int = 200
) -> Outcome:
    """Iterative risk allocation (Ono and Williams 2008), from equal risks, where every constraint is in one budget.

    Each round plans for fixed risks. Constraints that are not active keep ``alpha``, in (0, 1), of the risk that they do not use; what they
    give is shared evenly among the active ones. The plan of a round stays allowed in the next, so that the cost never grows, and the risks
    always keep the budgets. ``decay``, in (0, 1], is the factor of ``alpha`` from round to round; it ends when a round gains less than the
    share ``epsilon`` of the cost, or after ``rounds``. No guarantee.

    ``statistics["end"]`` is ``small gain``; ``all active`` (it stalls: no constraint has risk to give, however unequal its worth, so that
    the allocation may be far from the best); ``none active``; ``rounds``; or ``infeasible`` where equal risks allow no plan.

    Source: Ono and Williams (2008), "Iterative risk allocation: a new approach to robust model predictive control with a joint chance
    constraint"; docs/formulations/risk-allocation.md#iterative.
    """
    if not (0.0 < alpha < 1.0 and 0.0 < decay <= 1.0 and epsilon >= 0.0 and rounds >= 1):
        raise UsageError(
            "iterative: alpha must lie between 0 and 1, decay above 0 up to 1, epsilon at 0 or more, rounds at 1 or more", "out-of-range"
        )
    stop, units = context.begin(), Units.of(problem)
    p = units.problem
    risks, budget = uniform_risks(p), _shared(p)
    program = fixed_margins_program(p, "fixed-risks", margins(p, -ndtri(risks)))
    session, first = open_session(program, context.linear.seed), sum(block.size for block in program.rows[:-1])
    noisy = p.deviation > 0.0
    answer: Allocation | None = None
    values: list[float] = []
    end, keep = "rounds", alpha
    while len(values) < rounds:
        if stop.reached():
            end = "stopped"
            break
        if values:
            session.change_upper(first, p.limits - margins(p, -ndtri(risks)))
        solved = session.solve(stop)
        if solved.status != "optimal":
            end = "stopped" if stop.reached() else solved.status if answer is None else "solver"
            break
        decision = np.clip(solved.x[: p.size], p.lower, p.upper)
        value = p.sign * solved.value
        if values and value > values[-1]:  # by the solver's rounding
            end = "small gain"
            break
        values.append(value)
        answer = Allocation(np.clip(decision * units.columns, problem.lower, problem.upper), risks.copy())
        context.publish(answer)
        if len(values) > 1 and values[-2] - value < epsilon * abs(value):
            end = "small gain"
            break
        slack = p.limits - p.chance @ decision
        z = np.where(noisy, slack / np.where(noisy, p.deviation, 1.0), math.inf)
        used, active = ndtr(-z), z + ndtri(risks) <= ACTIVE
        if not active.any() or active.all():
            end = "all active" if active.any() else "none active"
            break
        risks = np.where(active, risks, keep * risks + (1.0 - keep) * np.minimum(used, risks))
        risks[active] += max(0.0, budget - math.fsum(risks.tolist())) / np.count_nonzero(active)
        risks = np.minimum(risks, p.risk.each)
        keep *= decay
    statistics: dict[str, Any] = {"rounds": len(values), "end": end, "values": [p.sign * v / units.cost for v in values[:10]]}
    return Outcome(answer, statistics=statistics, message=_said(end), limit=stop.reached() or "none")


def _shared(problem: RiskAllocation) -> float:
    """The one budget, a little less for rounding."""
    return problem.budgets[0].risk * (1.0 - 1e-15 * len(problem.names))


def _said(end: str) -> str:
    if end == "all active":
        return "it stalled: all constraints are active, so that none has risk to give; convex-allocation decides what each is worth"
    if end == "infeasible":
        return "there is no plan with equal risks, from which it starts; convex-allocation finds one with others, or that there is none"
    return ""
