"""Exact joint risk: plans whose true probability that anything fails is the budget, by supporting planes of that probability."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...formulations.problem import Problem
from ...formulations.programs.rows import rows
from ...formulations.risk.allocations import Allocation
from ...formulations.risk.forms._fixed_risks import fixed_margins_program, margins
from ...formulations.risk.joint_normal import gradient
from ...formulations.risk.risk_allocation import RiskAllocation
from ...formulations.stop import Stop, Stopped
from ...instances.errors import UnsupportedError
from ..backend import BACKENDS, Control, Engine, Options, RawResult

Floats = NDArray[np.float64]

MOST_ROWS = 60
"""Chance constraints whose joint probability is integrated for each plane, one integral a row."""

CLOSED = 1e-6
MOST_PLANES = 200
NEAR, MOST_LOOKS = 1e-5, 30
"""Part of the way to the boundary to which it is known, and looks at most."""


@BACKENDS.register("exact-joint")
class ExactJoint(Engine):
    """Outer search over the multivariate normal probability, which is logarithmically concave in the decision (Prekopa 1971).

    A program with planes that support ``log P(nothing fails)`` bounds the cost; from its decision the way to a plan that is known to be
    allowed crosses the boundary, where the next plane is laid (Veinott 1967). The integrals' errors count against the plan, whose bound is
    claimed: it is as good as they are.
    """

    name = "exact-joint"
    package = "highspy"
    modules = ("highspy",)
    summary = "joint risk by its true probability, for up to 60 chance constraints"
    interrupts = "keeps the best plan"
    one_thread = True
    honours = frozenset({"gap", "iterations"})
    family = "risk-allocation"
    features = frozenset({"joint-risk", "quadratic-cost", "cones"})
    order: ClassVar[int] = 1

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        lacking = super().missing(problem)
        if not lacking and len(problem.limits) > MOST_ROWS:  # type: ignore[attr-defined]
            return frozenset({f"more than {MOST_ROWS} chance constraints"})
        return lacking

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        assert isinstance(problem, RiskAllocation)
        self.converted(options)
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        return _Planes(problem, options, control, stop).run()


class _Planes:
    """The search."""

    def __init__(self, problem: RiskAllocation, options: Options, control: Control, stop: Stop) -> None:
        from scipy.special import ndtri

        from .convex_allocation_steps.session import open_session
        from .convex_allocation_steps.units import Units

        self.problem, self.options, self.control, self.stop, self.units = problem, options, control, stop, Units.of(problem)
        inner = self.units.problem
        program = fixed_margins_program(inner, "planes", margins(inner, -ndtri(problem.caps)))
        self.session = open_session(program, options.seed)
        self.bound, self.value, self.planes = -math.inf, math.inf, 0
        self.answer: Allocation | None = None

    def run(self) -> RawResult:
        """Planes until plan and bound meet."""
        p, stop, inside = self.problem, self.stop, self._start(self.stop)
        if inside is None:
            return RawResult("unknown", stop.reached() or "none", message="there is no plan with allocated risks, from which it starts")
        aim, most, limit = max(self.options.gap, CLOSED), min(self.options.iterations or MOST_PLANES, MOST_PLANES), "none"
        self._take(inside)
        while True:
            made = self.session.solve(stop)
            if made.status != "optimal":
                limit = stop.reached() or "none"
                break
            outside = made.x[: p.size] * self.units.columns
            self.bound = max(self.bound, min(p.sign * made.value, p.sign * made.bound) / self.units.cost)
            if self.value - self.bound <= aim * max(abs(self.value), 1e-300):
                break
            if self.planes >= most:
                limit = "iterations"
                break
            try:
                edge = self._edge(inside, outside)
                self._take(edge)
                if not self._support(edge, outside):
                    break
            except Stopped:
                limit = stop.reached()
                break
            self.planes += 1
        closed = self.value - self.bound <= aim * max(abs(self.value), 1e-300)
        statistics: dict[str, Any] = {"planes": self.planes, "joint_risk": next(iter(p.joint_risk(self.answer.decision).values())).value}  # type: ignore[union-attr]
        if self.options.start is not None:
            statistics["start"] = "ignored"
        limit = "gap" if closed and self.options.gap > 0.0 else limit
        bound = p.sign * self.bound if math.isfinite(self.bound) else None
        status = "optimal" if closed and limit != "gap" else "feasible"
        return RawResult(status, limit, self.answer, p.sign * self.value, bound, statistics=statistics)

    def _start(self, stop: Stop) -> Floats | None:
        """The best plan of allocated risk, which keeps the joint risk by Boole's inequality."""
        from .convex_allocation_steps.successive_tangents import SuccessiveTangents

        found = SuccessiveTangents(self.problem.by_allocation(), self.options.seed).run(stop, 1e-6).answer
        return None if found is None else found.decision

    def _excess(self, x: Floats) -> float:
        """By which part the upper limits of the probabilities exceed a budget at most."""
        self.stop.check()  # one takes up to some tenths of a second
        found = self.problem.joint_risk(x)
        return max(found[b.name].high / b.risk - 1.0 for b in self.problem.budgets)

    def _take(self, x: Floats) -> None:
        p, decision = self.problem, np.clip(x, self.problem.lower, self.problem.upper)
        value = p.sign * p.value(decision)[0]
        if value < self.value:
            self.value, self.answer = value, Allocation(decision)
            self.control.publish(self.answer, p.sign * value)

    def _edge(self, inside: Floats, outside: Floats) -> Floats:
        """About the last allowed point on the way from ``inside`` to ``outside``."""
        from scipy.optimize import brentq

        if self._excess(outside) <= 0.0:
            return outside
        if self._excess(inside) >= 0.0:
            return inside
        way = outside - inside
        part = brentq(lambda t: self._excess(inside + t * way), 0.0, 1.0, xtol=NEAR, maxiter=MOST_LOOKS, disp=False)
        while part > 0.0 and self._excess(inside + part * way) > 0.0:
            part -= NEAR
        return np.asarray(inside + max(part, 0.0) * way)

    def _support(self, edge: Floats, outside: Floats) -> bool:
        """Lay planes at the edge; whether one of them is in the way of ``outside``."""
        p, laid = self.problem, False
        slack = p.limits - p.chance @ edge
        for budget in p.budgets:
            self.stop.check()
            at = np.nonzero(np.isin(p.constraint, budget.constraints) & (p.deviation > 0.0))[0]
            found = p.joint_risk(edge)[budget.name]
            holds = 1.0 - found.value
            slope = -gradient(slack[at], p.covariance[np.ix_(at, at)]) / holds  # of log P(nothing fails), by slack
            normal = slope @ p.chance[at]
            # log holds - normal (x - edge) >= log(1 - budget)
            side = math.log(holds) + float(normal @ edge) - math.log1p(-budget.risk)
            if float(normal @ outside) > side + 1e-10 * max(1.0, abs(side)):
                entries = np.nonzero(normal)[0]
                inner = normal[entries] * self.units.columns[entries]
                largest = float(np.abs(inner).max(initial=0.0))
                own = 2.0 ** -math.floor(math.log2(largest)) if largest > 1e-300 else 1.0
                row = [(np.zeros(len(entries), dtype=np.int64), entries, inner * own)]
                self.session.add(rows("plane", 1, row, -math.inf, side * own))
                laid = True
        return laid
