"""Engine ``convex-allocation``: decisions and risks in one convex program, closed by successive tangents to a certified interval."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ....formulations.certificate import verified_bound
from ....formulations.problem import Problem
from ....formulations.programs.exactness import Exactness
from ....formulations.risk.allocations import Allocation
from ....formulations.risk.normal import ndtri
from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.stop import Stop
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from .convex_allocation_steps.successive_tangents import SuccessiveTangents

if TYPE_CHECKING:
    from .convex_allocation_steps.successive_tangents import Interval


PROVED = 1e-6
"""Part of what a cost sums up by which the proof of an optimum may be behind it at most."""

LEANING = "the answer gains from limits that it breaks by what solvers round, so that no optimum is claimed"

BEYOND = "no allocation keeps the budgets in sum; this one keeps the joint risk"

BOX = 2.0
"""Times the largest number of a decision."""


@BACKENDS.register("convex-allocation")
class ConvexAllocation(Engine):
    """Blackmore and Ono's (2009) joint program of decisions and risks: HiGHS for linear costs, Clarabel for cones and squares.

    Where risk is joint it finds the best allocation, which is an answer (Boole), or one of more risk in sum that keeps the joint risk, and
    bounds nothing.
    """

    name = "convex-allocation"
    package = "highspy"
    modules = ("highspy",)
    summary = "risk allocation as one convex program, by successive tangents, with a proved bound"
    interrupts = "keeps the best answer and the best bound"
    one_thread = bounds_itself = True
    honours = frozenset({"gap"})
    family = "risk-allocation"
    features = frozenset({"allocated-risk", "joint-risk", "quadratic-cost", "cones"})
    order: ClassVar[int] = 2

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from .convex_allocation_steps.successive_tangents import SuccessiveTangents

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        assert isinstance(problem, RiskAllocation)
        self.converted(options)
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)

        def publish(found: Interval) -> None:
            if found.answer is not None:
                control.publish(found.answer, problem.sign * found.value)

        joint = problem.risk.kind == "joint"
        part = problem.by_allocation() if joint else problem
        found = SuccessiveTangents(part, options.seed, publish).run(stop, options.gap)
        unproved = _unproved(part, found, options.gap)
        result = _result(problem, found, stop, options)
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
    """Whether an answer has a better value, of a minimisation, than is ``proved`` to be possible: by limits broken within tolerance."""
    return proved - value > PROVED * problem.value(answer.decision)[1]


def _unproved(problem: RiskAllocation, found: Interval, gap: float) -> str:
    """Why a closed interval proves no optimum, or nothing: its bound is what its prices prove then, and it is closed no longer.

    One that is open bounds what its prices prove, too: interior points that stop early may be on the wrong side. Where they prove nothing
    because of a decision without bounds, they are asked of a box that has the answer in it: as the problem is convex, what is best there
    is best.
    """

    def by(problem: RiskAllocation) -> float:
        return max((problem.sign * verified_bound(problem, e) for e in found.evidence(problem.sign)), default=-math.inf)

    if found.status in ("feasible", "unknown"):
        found.bound = by(problem)
    if found.status != "optimal" or found.answer is None:
        return ""
    proved, x = by(problem), found.answer.decision
    if leans(problem, found.answer, found.value, proved):
        found.status, found.bound = "feasible", found.value
        return LEANING
    if proved == -math.inf:
        boxed, reach = copy.copy(problem), BOX * (float(np.abs(x).max(initial=0.0)) or 1.0)
        boxed.lower, boxed.upper = np.maximum(problem.lower, -reach), np.minimum(problem.upper, reach)
        if found.value - by(boxed) <= max(gap, PROVED) * problem.value(x)[1]:
            return ""
    if found.value - proved <= max(gap, PROVED) * problem.value(x)[1]:
        return ""
    found.status, found.bound = "feasible", proved
    return "the duals of its solver prove less than its interval says"


def _result(problem: RiskAllocation, found: Interval, stop: Stop, options: Options) -> RawResult:
    statistics: dict[str, Any] = {"rounds": found.rounds, "interval": found.gap if math.isfinite(found.gap) else None}
    limit = stop.reached() or ("gap" if found.status == "optimal" and options.gap > 0.0 else "none")
    objective = problem.sign * found.value if found.answer is not None else None
    bound = problem.sign * found.bound if math.isfinite(found.bound) else None
    status = "feasible" if found.status == "optimal" and limit == "gap" else found.status
    if options.start is not None:
        statistics["start"] = "ignored"
    evidence = found.evidence(problem.sign)
    none = found.status == "infeasible" and evidence
    message = problem.why_none(evidence[0].kind, evidence[0].data) if none else ""
    return RawResult(status, limit, found.answer, objective, bound, statistics=statistics, message=message, evidence=evidence)


Floats = NDArray[np.float64]

COARSE = 1e-3
"""Gap of the allocations that are tried."""

HALVINGS = 8


def quantile(risk: Floats) -> Floats:
    """Deviations that a normal number exceeds with these probabilities."""
    return np.asarray(-ndtri(np.clip(risk, 1e-300, 1.0 - 1e-16)))


def room(problem: RiskAllocation, x: Floats, seed: int) -> float:
    """By how many deviations the upper limits of the joint risks are below their budgets at least.

    The judge draws samples of its own, which may say a little more: to half the limits' width above these.
    """
    found = problem.joint_risk(x, seed)
    most = [min(f.most, 2.0 * f.high - f.value) for f in (found[b.name] for b in problem.budgets)]
    return float(np.min(quantile(np.array(most)) - quantile(np.array([b.risk for b in problem.budgets]))))


def beyond_boole(problem: RiskAllocation, seed: int, stop: Stop) -> Floats | None:
    """A plan of risks that add up to a multiple of the budgets, about the least that allows one, where it keeps the joint risks.

    Parameters
    ----------
    problem : RiskAllocation
        With joint risk, one row a constraint, and no plan whose risks add up to the budgets.
    seed : int
    stop : Stop

    Returns
    -------
    array of shape (decisions,) or None
        None where no plan was found that keeps them.
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
        found = _multiplied(problem, middle, seed, stop)
        low, high, x = (middle, high, x) if found is None else (low, middle, found)
    return x if x is not None and not stop.reached() and room(problem, x, seed) >= 0.0 else None


def _multiplied(problem: RiskAllocation, factor: float, seed: int, stop: Stop) -> Floats | None:
    """The best plan of allocated risk with so many times the budgets, each constraint no more than its own."""
    made = copy.copy(problem.by_allocation())
    made.budgets = tuple(replace(b, risk=b.risk * factor) for b in made.budgets)
    answer = SuccessiveTangents(made, seed).run(stop, COARSE).answer
    return None if answer is None else answer.decision
