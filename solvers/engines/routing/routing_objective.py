"""Objectives as one sum, for engines that minimise a single number."""

import math
from dataclasses import dataclass, fields

import numpy as np

from ....formulations.checking.granularity import grain
from ....formulations.routing.objective import Weighted
from ....formulations.routing.problem import RoutingProblem
from ....instances.errors import UnsupportedError
from .extents import largest_distance, largest_duration
from .integer_scales import Floats

MAXIMA = ("makespan", "longest-route", "latest-return")
"""Terms that are the largest value of a route."""

STEPPED = frozenset({"vehicles", "reward", "penalties"})
"""Terms that are counted in whole steps."""


@dataclass(frozen=True, eq=False)
class Scalar:
    """A sum to be minimised over routes.

    A route costs ``unit[type] * distance + fixed[type] + time[type] * duration``, and ``overtime[type]`` times what the duration exceeds
    the regular one by, minus ``prize`` of the visited sites; ``maxima`` times the largest of ``MAXIMA`` are added. All are at least 0.
    ``counted`` is the part of ``fixed`` that counts routes, which a vehicle that drives without a visit does not cost.
    """

    unit: Floats
    fixed: Floats
    counted: Floats
    time: Floats
    overtime: Floats
    prize: Floats
    maxima: Floats

    def __add__(self, other: "Scalar") -> "Scalar":
        return Scalar(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))

    def __mul__(self, weight: float) -> "Scalar":
        return Scalar(*(getattr(self, f.name) * weight for f in fields(self)))

    @property
    def timed(self) -> bool:
        """Whether durations of routes count."""
        return bool(self.time.any() or self.overtime.any() or self.maxima[0])


def unscalable(problem: RoutingProblem) -> frozenset[str]:
    """Features of the objective that one sum cannot express; empty if ``scalarised`` takes it."""
    lacking = set()
    levels = problem.objective.levels()
    for level in levels:
        for weight, term in level.terms:
            if weight * _sign(level) * (-1.0 if term.sense == "max" else 1.0) < 0:
                lacking.add(f"objective:{weight:g}*{term.name}")
    for level in levels[:-1]:
        # Only what is counted in whole steps can be put before something else by a large weight.
        if len(level.terms) > 1 or level.terms[0][1].name not in STEPPED:
            lacking.add(f"objective:{level} before others")
    return frozenset(lacking)


def scalarised(problem: RoutingProblem) -> Scalar:
    """One sum whose optima are those of the objective; UnsupportedError if there is none.

    A level is weighed so that its smallest step outweighs all later levels together, which is exact: a vehicle counts 1, and rewards and
    penalties count in steps of what they are all multiples of, or of a millionth of the largest where there is no such number.
    """
    lacking = unscalable(problem)
    if lacking:
        raise UnsupportedError("one sum of all terms", lacking)
    levels = problem.objective.levels()
    total = _level(problem, levels[-1])
    for level in reversed(levels[:-1]):
        first = _level(problem, level)
        step = abs(level.terms[0][0]) if level.terms[0][1].name == "vehicles" else _step(first.prize)
        spread = _range(problem, total)
        if not math.isfinite(spread / step):
            raise UnsupportedError("one sum of all levels", {f"objective:{level} so much smaller than what follows"})
        total = first * (2.0 ** (math.frexp(spread / step)[1] + 1) if spread > 0 else 1.0) + total
    return total


def _level(problem: RoutingProblem, level: Weighted) -> Scalar:
    fleet, sites = problem.fleet, problem.sites
    unit, fixed, counted, time, overtime = np.zeros((5, len(fleet)))
    prize, maxima = np.zeros(len(sites)), np.zeros(len(MAXIMA))
    for weight, term in level.terms:
        amount = abs(weight)
        if term.name == "total-cost":
            unit += amount * np.array([v.unit_cost for v in fleet])
            fixed += amount * np.array([v.fixed_cost for v in fleet])
            time += amount * np.array([v.unit_duration_cost for v in fleet])
            overtime += amount * np.array([v.unit_overtime_cost if v.regular_duration < math.inf else 0.0 for v in fleet])
        elif term.name == "vehicles":
            fixed += amount
            counted += amount
        elif term.name == "total-duration":
            time += amount
        elif term.name in MAXIMA:
            maxima[MAXIMA.index(term.name)] += amount
        else:
            prize += amount * np.where(sites.depot, 0.0, sites.reward if term.name == "reward" else sites.penalty)
    return Scalar(unit, fixed, counted, time, overtime, prize, maxima)


def _sign(level: Weighted) -> float:
    return 1.0 if level.sense == "min" else -1.0


def _range(problem: RoutingProblem, goal: Scalar) -> float:
    """Largest difference of two answers in ``goal``: routes are as many and as long as their limits allow, and their moves no longer than
    the longest one, two a customer."""
    n = len(problem.customers)
    moves, stay = 2 * n * (1 + stops_between(problem)), longest_stay(problem)
    counts = np.array([n if v.count is None else min(v.count, n) for v in problem.fleet])
    travels = [problem.travel_of(k) for k in range(len(problem.fleet))]
    farthest = moves * np.array([largest_distance(t) for t in travels])
    slowest = stay + moves * np.array([largest_duration(t) for t in travels])
    opens, closes = problem.sites.ready, problem.sites.due
    hours = [min(v.max_duration, max(0.0, min(v.shift[1], closes[v.end]) - max(v.shift[0], opens[v.start]))) for v in problem.fleet]
    duration = np.minimum(slowest, hours)
    distance = np.minimum(farthest, [v.max_distance for v in problem.fleet])
    distance = np.where([t.own_durations for t in travels], distance, np.minimum(distance, hours))
    priced = np.minimum(goal.unit * distance @ counts, goal.unit.max() * farthest.max())
    dear = goal.time + goal.overtime
    timed = np.minimum(dear * duration @ counts, n * dear.max() * duration.max())
    return float(priced + n * goal.fixed.max() + timed + goal.prize.sum() + goal.maxima @ [duration.max(), distance.max(), duration.max()])


def stops_between(problem: RoutingProblem) -> int:
    """Largest number of depots at which a vehicle can have reason to stop between two sites."""
    return max(len({*v.reloads, *v.stations}) for v in problem.fleet)


def longest_stay(problem: RoutingProblem) -> float:
    """The longest time that a route can wait and serve, all in all."""
    sites = problem.sites
    opens = [w[-1][0] for w in sites.windows if w]
    first = min(float(sites.ready.min()), *(max(float(sites.ready[v.start]), v.shift[0]) for v in problem.fleet))
    pauses = sorted({site for v in problem.fleet for site in (*v.reloads, *v.stations)})
    gaps = len(problem.customers) + 1
    served = float(sites.service[problem.customers].sum()) + gaps * float(sites.service[pauses].sum())
    return max(float(sites.ready.max()), *opens, first) - first + served


def _step(prize: Floats) -> float:
    unit = grain(prize)
    return unit.size if unit is not None else 1e-6 * float(prize.max(initial=0.0)) or 1.0


def awaited(problem: RoutingProblem) -> bool:
    """Whether a vehicle that departs as late as it may could have to wait for a site to open."""
    sites = problem.sites
    if sites.windows:
        return True
    opens = min(max(float(sites.ready[v.start]), v.shift[0]) for v in problem.fleet)
    return bool((sites.ready[problem.customers] > opens).any())


def claimed_objective(problem: RoutingProblem, value: float) -> float | None:
    """Value of the objective for an engine's minimised sum; None for objectives in order of priority."""
    levels = problem.objective.levels()
    if len(levels) > 1:
        return None
    penalties = math.fsum(weight for weight, term in levels[0].terms if term.name == "penalties")
    all_left_out = penalties * float(problem.sites.penalty[problem.customers].sum())
    return _sign(levels[0]) * value + problem.constant + all_left_out
