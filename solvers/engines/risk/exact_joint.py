"""Engine ``exact-joint``: plans whose true probability that anything fails is the budget, by supporting planes of that probability.

Its gradient is the density of a constraint at its limit, times the probability that the others hold there: that over the cube of Genz
(1992), over a lattice rule with random shifts (Richtmyer's, Cranley and Patterson 1976).
"""

import math
from typing import Any, ClassVar

import numpy as np

from ....formulations.problem import Problem
from ....formulations.programs.rows import rows
from ....formulations.risk.allocations import Allocation, Floats
from ....formulations.risk.forms.fixed_risks import fixed_margins_program, margins
from ....formulations.risk.joint_normal import Probability, any_fails
from ....formulations.risk.normal import ndtr, ndtri
from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.stop import Stop, Stopped
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from .convex_allocation import beyond_boole, quantile, room
from .convex_allocation_steps.session import open_session
from .convex_allocation_steps.successive_tangents import SuccessiveTangents
from .convex_allocation_steps.units import Units

SHIFTS, POINTS = 12, 251
"""Random shifts of the lattice, and its points: a prime."""

SINGULAR = 1e-7
"""Part of a standard deviation below which a constraint depends on the constraints before it alone."""


MOST_ROWS = 60
"""Chance constraints whose joint probability is integrated for each plane, one integral a row."""

CLOSED = 1e-6
MOST_PLANES = 200
NEAR, FINE, MOST_LOOKS = 1e-8, 0.3, 30
"""Deviations from the boundary up to which a point counts as on it, or this part of the width of the limits; and most looks."""

HIGHER = (1e-2, 1e-3, 1e-5, 0.0)
"""Deviations above its budget's quantile, to which a plan is looked for that is allowed."""


@BACKENDS.register("exact-joint")
class ExactJoint(Engine):
    """Outer search over the multivariate normal probability that nothing fails, whose quantile is concave in the decision (Ehrhard 1983).

    A program with planes that support the quantile bounds the cost; from its decision the way to a plan that is known to be allowed crosses
    the boundary, where the next plane is laid (Veinott 1967). Where no allocation is allowed the planes alone lead to a plan (Kelley 1960).
    The integrals' errors count against the plan, and against the bound, which is claimed: its planes' slopes are as good as they are.
    """

    name = "exact-joint"
    package = "highspy"
    summary = "joint risk by its true probability, for up to 60 chance constraints"
    interrupts = "keeps the best plan"
    one_thread = True
    honours = frozenset({"gap", "iterations"})
    family = "risk-allocation"
    features = frozenset({"joint-risk", "quadratic-cost", "cones"})
    order: ClassVar[int] = 1

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if not lacking and len(problem.limits) > MOST_ROWS:  # type: ignore[attr-defined]
            return frozenset({f"more than {MOST_ROWS} chance constraints"})
        return lacking

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, RiskAllocation)
        return _Planes(problem, options, control, stop).run()


class _Planes:
    """Planes that are laid until plan and bound meet."""

    def __init__(self, problem: RiskAllocation, options: Options, control: Control, stop: Stop) -> None:
        self.problem, self.options, self.control, self.stop, self.units = problem, options, control, stop, Units.of(problem)
        inner = self.units.problem
        program = fixed_margins_program(inner, "planes", margins(inner, quantile(problem.caps)))
        self.session = open_session(program, options.seed)
        self.bound, self.value, self.planes, self.higher, self.none = -math.inf, math.inf, 0, 0.0, False
        self.first = sum(block.size for block in program.rows)
        self.sides: list[tuple[float, float]] = []
        self.answer: Allocation | None = None

    def run(self) -> RawResult:
        """Planes until plan and bound meet."""
        p, stop = self.problem, self.stop
        try:
            inside = self._start()
        except Stopped:
            inside = None
        if inside is None:
            return self._without_plan()
        aim, most, limit = max(self.options.gap, CLOSED), min(self.options.iterations or MOST_PLANES, MOST_PLANES), "none"
        self._take(inside)
        while True:
            solved = self.session.solve(stop)
            if solved.status != "optimal":
                limit = stop.reached() or "none"
                break
            outside = solved.x[: p.size] * self.units.columns
            self.bound = max(self.bound, min(p.sign * solved.value, p.sign * solved.bound) / self.units.cost)
            if self.value - self.bound <= aim * max(abs(self.value), 1e-300):
                break
            if self.planes >= most:
                limit = "iterations"
                break
            try:
                edge = self._edge(inside, outside)
                self._take(edge)
                if not any([self._support(edge, outside), self._support(outside, outside)]):
                    break
            except Stopped:
                limit = stop.reached()
                break
            self.planes += 1
        closed = self.value - self.bound <= aim * max(abs(self.value), 1e-300)
        limit = "gap" if closed and self.options.gap > 0.0 else limit
        bound = p.sign * self.bound if math.isfinite(self.bound) else None
        status = "optimal" if closed and limit != "gap" else "feasible"
        return RawResult(
            status, limit, self.answer, p.sign * self.value, bound, statistics=self._statistics(), message=self._said(closed, limit)
        )

    def _statistics(self) -> dict[str, Any]:
        statistics: dict[str, Any] = {"planes": self.planes}
        if self.answer is not None:
            statistics["joint_risk"] = next(iter(self.problem.joint_risk(self.answer.decision, self.options.seed).values())).value
        return statistics if self.options.start is None else {**statistics, "start": "ignored"}

    def _said(self, closed: bool, limit: str) -> str:
        return "" if closed or limit != "none" else "its samples of the joint risk tell no finer what is left between answer and bound"

    def _without_plan(self) -> RawResult:
        if self.none:
            message = "the planes of the joint risk leave no plan"
            return RawResult("infeasible", statistics=self._statistics(), message=message)
        message = "no plan was found that keeps the joint risk, and none is ruled out"
        return RawResult("unknown", self.stop.reached() or "none", statistics=self._statistics(), message=message)

    def _start(self) -> Floats | None:
        """The best plan of allocated risk, which keeps the joint risk by Boole's inequality; or one of more risk; or where planes lead."""
        answer = SuccessiveTangents(self.problem.by_allocation(), self.options.seed).run(self.stop, CLOSED).answer
        if answer is not None:
            return answer.decision
        beyond = beyond_boole(self.problem, self.options.seed, self.stop)
        return self._led() if beyond is None else beyond

    def _led(self) -> Floats | None:
        """The cheapest point beyond planes at a level a little higher than asked for, again and again, until it is allowed."""
        for higher in HIGHER:
            self._raise(higher)
            while self.planes < MOST_PLANES:
                solved = self.session.solve(self.stop)
                if solved.status != "optimal":
                    self.none = solved.status == "infeasible" and higher == 0.0
                    break
                x = np.clip(solved.x[: self.problem.size] * self.units.columns, self.problem.lower, self.problem.upper)
                if self._look(x)[0] >= 0.0:
                    self._raise(0.0)
                    return x
                if not self._support(x, x):
                    break
                self.planes += 1
        return None

    def _raise(self, higher: float) -> None:
        """Move all planes to ``higher`` deviations above the level asked for."""
        self.higher = higher
        for k, (side, unit) in enumerate(self.sides):
            self.session.change_upper(self.first + k, np.array([(side - higher) * unit]))

    def _risks(self, x: Floats) -> dict[str, Probability]:
        self.stop.check()  # one takes up to some tenths of a second
        return self.problem.joint_risk(x, self.options.seed)

    def _look(self, x: Floats) -> tuple[float, float]:
        """Deviations below the budgets, and those that the limits of the probabilities leave open."""
        risks = self._risks(x)
        limits = np.array([(f.low, f.high) for f in (risks[b.name] for b in self.problem.budgets)])
        return room(self.problem, x, self.options.seed), float(np.ptp(quantile(limits), axis=1).max(initial=0.0))

    def _take(self, x: Floats) -> None:
        p, decision = self.problem, np.clip(x, self.problem.lower, self.problem.upper)
        value = p.sign * p.value(decision)[0]
        if value < self.value:
            self.value, self.answer = value, Allocation(decision)
            self.control.publish(self.answer, p.sign * value)

    def _edge(self, inside: Floats, outside: Floats) -> Floats:
        """About the last allowed point on the way from ``inside`` to ``outside``: chords of a concave function stay inside."""
        way, part, (beyond, _), (distance, blur) = outside - inside, 0.0, self._look(outside), self._look(inside)
        if beyond >= 0.0:
            return outside
        for _ in range(MOST_LOOKS):
            near = max(NEAR, FINE * blur)
            if distance <= near:
                break
            tried = part + (1.0 - part) * (distance - 0.5 * near) / (distance - beyond)
            distance_there, blur = self._look(inside + tried * way)
            if distance_there < 0.0:  # by its samples' noise
                break
            part, distance = tried, distance_there
        return np.asarray(inside + part * way)

    def _support(self, edge: Floats, outside: Floats) -> bool:
        """Lay planes at the edge; whether one of them is in the way of ``outside``."""
        p, laid = self.problem, False
        slack, risks = p.limits - p.chance @ edge, self._risks(edge)
        for budget in p.budgets:
            self.stop.check()
            at = np.nonzero(np.isin(p.constraint, budget.constraints) & (p.deviation > 0.0))[0]
            risk = risks[budget.name]
            level, least, most = quantile(np.array([risk.value, risk.high, risk.low])).tolist()
            density = math.exp(-0.5 * level * level) / math.sqrt(2.0 * math.pi)
            normal = -gradient(slack[at], p.covariance[np.ix_(at, at)]) / density @ p.chance[at]  # of the quantile, by the decision
            # most - normal (x - edge) >= quantile of the budget
            side = most + float(normal @ edge) - float(quantile(np.array(budget.risk)))
            if float(normal @ outside) > side - self.higher + max(1e-10 * max(1.0, abs(side)), FINE * (most - least)):
                entries = np.nonzero(normal)[0]
                inner = normal[entries] * self.units.columns[entries]
                largest = float(np.abs(inner).max(initial=0.0))
                unit = 2.0 ** -math.floor(math.log2(largest)) if largest > 1e-300 else 1.0
                row = [(np.zeros(len(entries), dtype=np.int64), entries, inner * unit)]
                self.session.add(rows("plane", 1, row, -math.inf, (side - self.higher) * unit))
                self.sides.append((side, unit))
                laid = True
        return laid


def gradient(slack: Floats, covariance: Floats, *, points: int = POINTS) -> Floats:
    """Derivative of the probability that any fails by each entry of ``slack``, all with noise; ``points`` are the lattice's."""
    deviation = np.sqrt(np.diag(covariance))
    z, correlation = slack / deviation, covariance / deviation[:, None] / deviation
    density = np.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
    slopes = np.zeros(len(z))
    for k in np.nonzero(density > 1e-12 * density.max(initial=0.0))[0].tolist():
        others = np.arange(len(z)) != k
        along = correlation[others, k]
        conditional = correlation[np.ix_(others, others)] - np.outer(along, along)
        own = np.diag(conditional).copy()
        own[own < SINGULAR**2] = 0.0
        conditional = conditional * np.outer(own > 0.0, own > 0.0)
        np.fill_diagonal(conditional, own)
        slopes[k] = -density[k] / deviation[k] * _all_hold(z[others] - along * z[k], conditional, points)
    return slopes


def _all_hold(slack: Floats, covariance: Floats, points: int) -> float:
    """Probability that none fails; constraints without noise hold at their limit, but for rounding."""
    deviation = np.sqrt(np.diag(covariance))
    noisy = deviation > 0.0
    if (slack[~noisy] < -SINGULAR).any():
        return 0.0
    if np.count_nonzero(noisy) <= 2:
        return 1.0 - any_fails(slack[noisy], covariance[np.ix_(noisy, noisy)]).value
    z = slack[noisy] / deviation[noisy]
    correlation = covariance[np.ix_(noisy, noisy)] / deviation[noisy][:, None] / deviation[noisy]
    order = np.argsort(z, kind="stable")
    factor, rng = _factor(correlation[np.ix_(order, order)]), np.random.default_rng(1)
    roots = np.sqrt(_primes(len(z)))
    base = np.arange(1, points + 1)[:, None] * (roots - np.floor(roots))
    shifted = (base + rng.random((SHIFTS, 1, len(z)))).reshape(-1, len(z)) % 1.0
    return float(np.mean(_hold_in_turn(z[order], factor, np.abs(2.0 * shifted - 1.0))))  # the tent makes it periodic


def _hold_in_turn(z: Floats, factor: Floats, points: Floats) -> Floats:
    """Probability to hold for each point of the cube, one constraint after the other."""
    many, size = points.shape
    normal, holds = np.zeros((many, size)), np.ones(many)
    for k in range(size):
        expected = normal[:, :k] @ factor[k, :k]
        own = factor[k, k]
        if own > SINGULAR:
            below = ndtr((z[k] - expected) / own)
            normal[:, k] = np.clip(ndtri(np.maximum(points[:, k], 1e-300) * below), -38.0, 38.0)
            holds *= below
        else:
            holds *= expected <= z[k] + 1e-9
    return holds


def _factor(correlation: Floats) -> Floats:
    """Lower triangle whose product with its transpose is the correlation, which may be singular."""
    size = len(correlation)
    factor = np.zeros((size, size))
    for k in range(size):
        rest = correlation[k, k] - factor[k, :k] @ factor[k, :k]
        if rest > SINGULAR**2:
            factor[k, k] = math.sqrt(rest)
            factor[k + 1 :, k] = (correlation[k + 1 :, k] - factor[k + 1 :, :k] @ factor[k, :k]) / factor[k, k]
    return factor


def _primes(count: int) -> Floats:
    """The first prime numbers."""
    limit = max(16, int(count * (math.log(count + 2) + math.log(math.log(count + 3)) + 2)))
    sieve = np.ones(limit, dtype=bool)
    sieve[:2] = False
    for p in range(2, math.isqrt(limit) + 1):
        if sieve[p]:
            sieve[p * p :: p] = False
    return np.nonzero(sieve)[0][:count].astype(np.float64)
