"""Successive tangents: a risk allocation between a relaxation and a restriction that close in on each other.

The normal tail is replaced by its tangents at some points. The optimum of that program bounds the cost from below, and its duals do so more
tightly than it says, since they price the tail itself and not its tangents. Its decision takes a little more risk than allowed; the same
program with budgets smaller by about that has a decision that keeps them, and its duals bound the cost, too. The last point between the two
decisions that keeps the budgets bounds the cost from above. Tangents at both are added. Each round divides what is missing by four and more
(Kelley 1960, on a separable convex function).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from .....formulations.evidence import Evidence
from .....formulations.risk.allocations import Allocation, Floats
from .....formulations.risk.forms._blocks import evidence_of, prices
from .....formulations.risk.forms.piecewise import mean_risk, piecewise_program, points
from .....formulations.risk.normal import ndtr, ndtri
from .....formulations.risk.risk_allocation import RiskAllocation
from .....formulations.stop import Stop
from .envelope import Envelope
from .session import Solved, open_session
from .units import Units

FIRST_POINTS, FIRST_LEAST = 6, 0.2
"""Tangents of each constraint at the start, from its largest risk to this part of a mean one."""

CLOSED = 1e-9
"""Gap at which nothing more can be asked of double precision."""

MOST_ROUNDS = 100

MARGIN = 0.5
"""Part of the excess of risk by which the budgets are solved smaller."""

NEAR = 0.03
"""Excess of risk from which on decisions that keep the budgets are looked for: before, they would not last."""

LEAST = 1e-10
"""Least part by which budgets are solved smaller."""

TOUCHED = 1e-4
"""Part of the largest distance between tail and tangents from which on a constraint gets a further tangent."""

CHORDS = 3
"""Chords laid to find the last allowed point between two decisions."""

CHORD_POINTS = 60
"""Points of each constraint, for a decision where the rounds found none."""

STALLED = 8
"""Rounds without progress after which it ends."""

HIGHEST = 1.0 / math.sqrt(2.0 * math.pi)
"""The normal density at 0."""

MOST_NAMED = 60
"""Most chance rows of a contradiction that are left out one by one, to find those that it needs."""


@dataclass
class Interval:
    """Interval that holds the optimum of a risk allocation, its answer, and the prices that prove its bound.

    ``status`` is ``optimal`` (closed to what was asked), ``feasible``, ``infeasible``, ``unbounded`` or ``unknown``. ``bound`` and
    ``value`` are at most and at least the optimum, in the sense of minimisation, and infinite where nothing is known.
    """

    status: str = "unknown"
    bound: float = -math.inf
    value: float = math.inf
    answer: Allocation | None = None
    rounds: int = 0
    prices: dict[str, Floats] | None = None

    @property
    def gap(self) -> float:
        """Width in parts of the value."""
        if not (math.isfinite(self.bound) and math.isfinite(self.value)):
            return math.inf
        return max(0.0, self.value - self.bound) / max(abs(self.value), 1e-300)

    def evidence(self, sign: float) -> tuple[Evidence, ...]:
        """Evidence of its bound, or that there is no answer; ``sign`` is the problem's."""
        if self.prices is None:
            return ()
        if self.status == "infeasible":
            return (evidence_of(self.prices, sign * math.inf, "prices that no decision can pay", infeasible=True),)
        return (evidence_of(self.prices, sign * self.bound, "duals of successive tangents"),)


class SuccessiveTangents:
    """Rounds of tangents for a problem with ``allocated`` risk and without alternatives; ``publish`` gets each better interval."""

    def __init__(self, problem: RiskAllocation, seed: int = 1, publish: Callable[[Interval], None] = lambda interval: None) -> None:
        self.original, self.units, self.publish = problem, Units.of(problem), publish
        self.problem = problem = self.units.problem
        self.tail, self.seed = Envelope(problem, FIRST_POINTS, FIRST_LEAST, seed), seed
        self.session, self.program = self.tail.session, self.tail.program
        self.budgets = np.array([b.risk for b in problem.budgets])
        self.floor = -ndtri(problem.caps)
        order = np.argsort(problem.constraint)  # one row a constraint
        noise = problem.deviation[order]
        certain = noise == 0.0
        scale = np.where(certain, 1.0, noise)
        self.slopes = np.where(certain, 0.0, 1.0)[:, None] * problem.chance[order] / scale[:, None]
        self.limits = np.where(certain, math.inf, problem.limits[order] / scale)
        self.deviation, self.order = noise, order
        self.members = np.zeros((len(self.budgets), len(problem.names)))
        for k, budget in enumerate(problem.budgets):
            self.members[k, budget.constraints] = 1.0
        self.shares = self.members / np.array([b.risk for b in problem.budgets])[:, None]
        self.inside: Floats | None = None
        self.best: Solved | None = None
        self.least = LEAST
        self.interval = Interval()

    def run(self, stop: Stop, gap: float = 0.0) -> Interval:
        """Rounds until the interval is as narrow as ``gap`` asks, nothing moves any more, or ``stop``."""
        interval, aim, still = self.interval, max(gap, CLOSED), 0
        while interval.rounds < MOST_ROUNDS and not stop.reached():
            before = interval.gap
            self.tail.use(0.0)
            below = self.session.solve(stop)
            if below.status != "optimal":
                self._ended(below, stop)
                break
            interval.rounds += 1
            excess = self._lower(below)
            added = self._touch(below)
            if interval.gap > aim and excess < NEAR:
                less = MARGIN * max(excess, self.least)
                self.tail.use(less)
                above = self.session.solve(stop)
                if above.status == "optimal":
                    self._bound(above, less)
                    if not self._upper(above.x, below.x):
                        self.least *= 10.0  # beyond what the solver and the judge round
                    added += self._touch(above) if interval.gap > aim else 0
            self.publish(interval)
            if interval.gap <= aim:
                interval.status = "optimal"
                break
            still = still + 1 if math.isfinite(before) and not interval.gap < 0.9 * before else 0
            if (not added and interval.answer is not None) or still > STALLED:
                break
        if interval.answer is None and interval.status == "unknown" and not stop.reached():
            self._restricted(stop)
        if self.best is not None and interval.status != "infeasible":
            interval.prices = self._prices(self.best, self.best.duals)
        if interval.answer is not None:
            interval.answer = self.original.allocated(interval.answer.decision)
        if interval.status == "unknown" and interval.answer is not None:
            interval.status = "feasible"
        return interval

    def _prices(self, solved: Solved, duals: Floats) -> dict[str, Floats]:
        p = self.problem
        inner = prices(p, self.program, solved.x, duals, solved.cone_duals)
        return self.units.prices({**inner, "budgets": self._spent(duals)})

    def _spent(self, duals: Floats) -> Floats:
        """Prices of the budgets."""
        start = self.tail.budget
        return np.asarray(np.maximum(-self.problem.sign * duals[start : start + len(self.budgets)] / self.tail.unit, 0.0))

    def _bound(self, solved: Solved, less: float = 0.0) -> None:
        """Take the bound that the duals prove, of budgets that were smaller by the part ``less``."""
        p, interval = self.problem, self.interval
        z, risk = self.tail.parts(solved)
        chance = solved.duals[self.tail.chance : self.tail.budget][self.order]
        slope = np.maximum(-p.sign * chance, 0.0) * self.deviation
        prices = self._spent(solved.duals)
        spent = prices @ self.members
        more = float((least_margin(slope, spent, self.floor) - slope * z - spent * risk * self.tail.unit).sum())
        more -= less * float(prices @ self.budgets)
        bound = (p.sign * solved.value + more) / self.units.cost
        if bound > interval.bound:
            interval.bound, self.best = bound, solved

    def _lower(self, solved: Solved) -> float:
        """Take the bound of a relaxation and try its decision; the largest part by which that exceeds a budget."""
        self._bound(solved)
        outside = solved.x[: self.problem.size]
        excess = self._excess(self._risks(outside))
        if excess <= 0.0:
            self._take(outside)
        elif self.inside is not None:
            self._between(self.inside, outside)
        return max(excess, 0.0)

    def _risks(self, x: Floats) -> Floats:
        """Risk of each constraint; rows without noise have none."""
        return np.asarray(ndtr(-(self.limits - self.slopes @ x)))

    def _excess(self, own: Floats) -> float:
        """Largest part by which the risks exceed a budget."""
        return float((self.shares @ own).max(initial=1.0 if len(self.shares) == 0 else 0.0)) - 1.0

    def _upper(self, inside: Floats, outside: Floats) -> bool:
        """Take a decision that keeps the budgets, or the last that does on the way to one that does not; whether any is known."""
        inside = inside[: self.problem.size]
        if self._excess(self._risks(inside)) > 0.0:
            return False
        self.inside = inside
        self._between(inside, outside[: self.problem.size])
        return self.interval.answer is not None or self._take(inside)

    def _between(self, inside: Floats, outside: Floats) -> None:
        """Take the last point that keeps the budgets on the way from a decision that does to one that does not: risks are convex."""
        start, way = self.limits - self.slopes @ inside, self.slopes @ (outside - inside)
        most, part, last = self._excess(ndtr(way - start)), 0.0, 0.0
        for _ in range(CHORDS):  # a chord of a convex function crosses 0 before the function does
            excess = self._excess(ndtr(part * way - start))
            if excess >= 0.0 or most <= 0.0:
                break
            last, part = part, part + (1.0 - part) * excess / (excess - most)
        if part > 0.0 and not self._take(inside + part * (outside - inside)):  # which rounding may have carried too far
            self._take(inside + last * (outside - inside))

    def _take(self, x: Floats) -> bool:
        """Keep a decision that is better than the best so far and keeps its risks in the judge's arithmetic; whether it does."""
        p = self.original
        decision = np.clip(x * self.units.columns, p.lower, p.upper)
        value = p.sign * p.value(decision)[0]
        if value >= self.interval.value:
            return False
        own = p.risks(decision)
        kept = self._excess(own) <= 0.0 and bool((own <= p.risk.each * (1.0 + 1e-7)).all())
        if kept:
            self.interval.value, self.interval.answer = value, Allocation(decision)
        return kept

    def _restricted(self, stop: Stop) -> None:
        """Take the decision of the program with chords, where deviations are so small that the tangents' solver rounds them away."""
        at = points(self.problem, mean_risk(self.problem), CHORD_POINTS)
        solved = open_session(piecewise_program(self.problem, "secants", at, above=True).program, self.seed).solve(stop)
        if solved.status == "optimal":
            self._take(solved.x[: self.problem.size])

    def _touch(self, solved: Solved) -> int:
        """Add tangents where constraints have more risk than the program counts; their number."""
        slack, risk = self.limits - self.slopes @ solved.x[: self.problem.size], self.tail.parts(solved)[1]
        short = ndtr(-slack) / self.tail.unit - risk
        at = np.nonzero(short > max(1e-11, TOUCHED * float(short.max(initial=0.0))))[0]
        if len(at):
            self.tail.add(at, slack[at])
        return len(at)

    def _ended(self, solved: Solved, stop: Stop) -> None:
        """Take the status of a relaxation without optimum, and the evidence where there is no answer."""
        interval = self.interval
        interval.status = solved.status if interval.answer is None or solved.status != "unknown" else "feasible"
        if solved.status == "infeasible":
            proofs = (self._proof(ray) for ray in (self._fewest(solved, stop), solved))
            interval.prices = next((prices for prices in proofs if prices is not None), None)

    def _fewest(self, solved: Solved, stop: Stop) -> Solved:
        """A contradiction that needs few chance rows: each is left out where the others contradict each other without it."""
        first = self.tail.chance
        priced = np.zeros(0) if solved.ray is None else np.abs(solved.ray[first : first + len(self.problem.limits)])
        rows = np.nonzero(priced)[0]
        if len(rows) > MOST_NAMED:
            return solved
        for row in rows[np.argsort(priced[rows], kind="stable")].tolist():
            self.session.change_upper(first + row, np.array([math.inf]))
            trial = self.session.solve(stop)
            if trial.status == "infeasible" and trial.ray is not None:
                solved = trial
            else:
                self.session.change_upper(first + row, self.problem.limits[[row]])
        return solved

    def _proof(self, solved: Solved) -> dict[str, Floats] | None:
        """Prices that prove that there is no answer, from the ray of a program that has none."""
        from .....formulations.verified_bounds import verified_bound

        sign = self.problem.sign
        if solved.ray is None:
            return None
        size = float(np.abs(solved.ray).max(initial=0.0)) or 1.0
        nowhere = Solved("infeasible", x=np.zeros(self.program.num_variables), cone_duals=solved.cone_duals / size)
        for turn in (1.0, -1.0):
            prices = self._prices(nowhere, turn * sign * solved.ray / size)
            claimed = Interval("infeasible", prices=prices).evidence(sign)[0]
            if verified_bound(self.original, claimed) == sign * math.inf:
                return prices
        return None


def least_margin(slope: Floats, price: Floats, floor: Floats) -> Floats:
    """The least of ``slope z + price tail(z)`` over z >= floor, entry by entry."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = slope / (price * HIGHEST)
        z = np.sqrt(np.maximum(-2.0 * np.log(ratio), 0.0))
    z = np.maximum(np.where(price > 0.0, np.where(slope > 0.0, z, 40.0), floor), floor)
    return np.asarray(np.where(slope > 0.0, slope * z + price * ndtr(-z), 0.0))
