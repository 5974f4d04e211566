"""Engine ``convex-allocation``: decisions and risks in one convex program, closed by successive tangents to a certified interval."""

import copy
import math
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.programs.exactness import Exactness
from ....formulations.risk.allocations import Allocation, Floats
from ....formulations.risk.normal import ndtri
from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.stop import Stop
from ....formulations.verified_bounds import verified_bound
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from .convex_allocation_steps.successive_tangents import Interval, SuccessiveTangents

PROVED = 1e-6
"""Part of the sum of a cost's terms by which the proof of an optimum may be behind it at most."""

LEANING = "the answer gains from limits that it breaks by what solvers round, so that no optimum is claimed"

BEYOND = "no allocation keeps the budgets in sum; this one keeps the joint risk"

BOX = 2.0
"""Half the width of a box about 0 that has a decision in it, in times of its largest number."""

COARSE, HALVINGS = 1e-3, 8
"""Gap of the allocations that are tried with multiples of the budgets, and how often their factor is halved."""


@BACKENDS.register("convex-allocation")
class ConvexAllocation(Engine):
    """Blackmore and Ono's (2009) joint program of decisions and risks: HiGHS for linear costs, Clarabel for cones and squares.

    Where risk is joint it finds the best allocation, which is an answer (Boole), or one of more risk in sum that keeps the joint risk, and
    bounds nothing.
    """

    name = "convex-allocation"
    package = "highspy"
    summary = "risk allocation as one convex program, by successive tangents, with a proved bound"
    interrupts = "keeps the best answer and the best bound"
    one_thread = bounds_itself = True
    honours = frozenset({"gap"})
    family = "risk-allocation"
    features = frozenset({"allocated-risk", "joint-risk", "quadratic-cost", "cones"})
    order: ClassVar[int] = 2

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, RiskAllocation)

        def publish(interval: Interval) -> None:
            if interval.answer is not None:
                control.publish(interval.answer, problem.sign * interval.value)

        joint = problem.risk.kind == "joint"
        part = problem.by_allocation() if joint else problem
        interval = SuccessiveTangents(part, options.seed, publish).run(stop, options.gap)
        unproved = _unproved(part, interval, options.gap)
        result = _result(problem, interval, stop, options)
        if unproved:
            result = replace(result, message=unproved)
        if not joint:
            return result
        decision = beyond_boole(problem, options.seed, stop) if result.answer is None else result.answer.decision
        if result.answer is None and decision is not None:
            objective = problem.value(decision)[0]
            result = replace(result, status="feasible", objective=objective, bound=None, message=BEYOND)
        answer = None if decision is None else Allocation(decision)
        return replace(result, answer=answer, holds=Exactness.RESTRICTION, evidence=())


def leans(problem: RiskAllocation, answer: Allocation, value: float, proved: float) -> bool:
    """True if an answer has a value below the lower bound ``proved``, as limits broken within tolerance allow."""
    return proved - value > PROVED * problem.value(answer.decision)[1]


def _unproved(problem: RiskAllocation, interval: Interval, gap: float) -> str:
    """Reason why a closed interval proves no optimum; empty where it does. It is opened then, its bound that of its prices.

    The bound of an open interval is that of its prices, too: interior points that stop early may be on the wrong side. Where prices prove
    nothing because of a decision without bounds, they are asked of a box that has the answer in it: as the problem is convex, what is best
    there is best.
    """

    def proved_of(problem: RiskAllocation) -> float:
        return max((problem.sign * verified_bound(problem, e) for e in interval.evidence(problem.sign)), default=-math.inf)

    if interval.status in ("feasible", "unknown"):
        interval.bound = proved_of(problem)
    if interval.status != "optimal" or interval.answer is None:
        return ""
    proved, x = proved_of(problem), interval.answer.decision
    if leans(problem, interval.answer, interval.value, proved):
        interval.status, interval.bound = "feasible", interval.value
        return LEANING
    if proved == -math.inf:
        boxed, reach = copy.copy(problem), BOX * (float(np.abs(x).max(initial=0.0)) or 1.0)
        boxed.lower, boxed.upper = np.maximum(problem.lower, -reach), np.minimum(problem.upper, reach)
        if interval.value - proved_of(boxed) <= max(gap, PROVED) * problem.value(x)[1]:
            return ""
    if interval.value - proved <= max(gap, PROVED) * problem.value(x)[1]:
        return ""
    interval.status, interval.bound = "feasible", proved
    return "the duals of its solver prove less than its interval says"


def _result(problem: RiskAllocation, interval: Interval, stop: Stop, options: Options) -> RawResult:
    statistics: dict[str, Any] = {"rounds": interval.rounds, "interval": interval.gap if math.isfinite(interval.gap) else None}
    limit = stop.reached() or ("gap" if interval.status == "optimal" and options.gap > 0.0 else "none")
    objective = problem.sign * interval.value if interval.answer is not None else None
    bound = problem.sign * interval.bound if math.isfinite(interval.bound) else None
    status = "feasible" if interval.status == "optimal" and limit == "gap" else interval.status
    if options.start is not None:
        statistics["start"] = "ignored"
    evidence = interval.evidence(problem.sign)
    none = interval.status == "infeasible" and evidence
    message = problem.why_none(evidence[0].kind, evidence[0].data) if none else ""
    return RawResult(status, limit, interval.answer, objective, bound, statistics=statistics, message=message, evidence=evidence)


def quantile(risk: Floats) -> Floats:
    """Deviations that a normal number exceeds with these probabilities."""
    return np.asarray(-ndtri(np.clip(risk, 1e-300, 1.0 - 1e-16)))


def room(problem: RiskAllocation, x: Floats, seed: int) -> float:
    """Least number of deviations by which the upper limits of the joint risks are below their budgets.

    The judge draws samples of its own, which may say a little more: to half the limits' width above these.
    """
    risks = problem.joint_risk(x, seed)
    most = [min(risk.most, 2.0 * risk.high - risk.value) for risk in (risks[b.name] for b in problem.budgets)]
    return float(np.min(quantile(np.array(most)) - quantile(np.array([b.risk for b in problem.budgets]))))


def beyond_boole(problem: RiskAllocation, seed: int, stop: Stop) -> Floats | None:
    """A plan of risks that add up to a multiple of the budgets, about the least that allows one, where it keeps the joint risks.

    The problem has joint risk, one row per constraint, and no plan whose risks add up to the budgets. None where no plan keeps them.
    """
    low = high = 1.0
    x: Floats | None = None
    while x is None and high < len(problem.names) and not stop.reached():
        low, high = high, min(2.0 * high, float(len(problem.names)))
        x = _multiplied(problem, high, seed, stop)
    for _ in range(HALVINGS):
        if x is None or stop.reached() or room(problem, x, seed) >= 0.0:
            break
        middle = math.sqrt(low * high)
        plan = _multiplied(problem, middle, seed, stop)
        low, high, x = (middle, high, x) if plan is None else (low, middle, plan)
    return x if x is not None and not stop.reached() and room(problem, x, seed) >= 0.0 else None


def _multiplied(problem: RiskAllocation, factor: float, seed: int, stop: Stop) -> Floats | None:
    """The best plan of allocated risk with ``factor`` times the budgets, each constraint no more than its own."""
    part = copy.copy(problem.by_allocation())
    part.budgets = tuple(replace(b, risk=b.risk * factor) for b in part.budgets)
    answer = SuccessiveTangents(part, seed).run(stop, COARSE).answer
    return None if answer is None else answer.decision
