"""Objectives of cost, vehicles and reward as one sum, for engines that minimise a single number."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...formulations.checking.granularity import grain
from ...instances.errors import UnsupportedError

if TYPE_CHECKING:
    from ...formulations.routing.objective import Weighted
    from ...formulations.routing.problem import RoutingProblem

Floats = NDArray[np.float64]

TERMS = frozenset({"total-cost", "vehicles", "reward"})


@dataclass(frozen=True, eq=False)
class Scalar:
    """Minimise, over routes, ``unit[type] * distance + fixed[type]``, minus ``prize`` of the visited sites.

    ``unit`` and ``fixed`` have one entry a vehicle type, ``prize`` one a site; all are at least 0.
    """

    unit: Floats
    fixed: Floats
    prize: Floats

    def __add__(self, other: Scalar) -> Scalar:
        return Scalar(self.unit + other.unit, self.fixed + other.fixed, self.prize + other.prize)

    def __mul__(self, weight: float) -> Scalar:
        return Scalar(self.unit * weight, self.fixed * weight, self.prize * weight)


def unscalable(problem: RoutingProblem) -> frozenset[str]:
    """Features of the objective that one sum cannot express; empty if ``scalarised`` takes it."""
    lacking = set()
    levels = problem.objective.levels()
    for level in levels:
        for weight, term in level.terms:
            if term.name not in TERMS:
                lacking.add(f"objective:{term.name}")
            elif weight * _sign(level) * (-1.0 if term.sense == "max" else 1.0) < 0:
                lacking.add(f"objective:{weight:g}*{term.name}")
    for level in levels[:-1]:
        # Only what is counted in whole steps can be put before something else by a large weight.
        if len(level.terms) > 1 or level.terms[0][1].name == "total-cost":
            lacking.add(f"objective:{level} before others")
    return frozenset(lacking)


def scalarised(problem: RoutingProblem) -> Scalar:
    """One sum whose optima are those of the objective.

    A level is weighed so that its smallest step outweighs all later levels together, which is exact: a vehicle counts 1,
    and rewards count in steps of what they are all multiples of, or of a millionth of the largest where there is no such number.

    Raises
    ------
    UnsupportedError
        If the objective cannot be expressed.
    """
    lacking = unscalable(problem)
    if lacking:
        raise UnsupportedError("the sum of cost, vehicles and reward", lacking)
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
    types, sites = len(problem.fleet), len(problem.sites)
    unit, fixed, prize = np.zeros(types), np.zeros(types), np.zeros(sites)
    for weight, term in level.terms:
        amount = abs(weight)
        if term.name == "total-cost":
            unit += amount * np.array([v.unit_cost for v in problem.fleet])
            fixed += amount * np.array([v.fixed_cost for v in problem.fleet])
        elif term.name == "vehicles":
            fixed += amount
        else:
            prize += amount * np.where(problem.sites.depot, 0.0, problem.sites.reward)
    return Scalar(unit, fixed, prize)


def _sign(level: Weighted) -> float:
    return 1.0 if level.sense == "min" else -1.0


def _range(problem: RoutingProblem, goal: Scalar) -> float:
    """No two answers differ by more in ``goal``: every customer on a route of its own costs at most this."""
    n = len(problem.customers)
    longest = float(problem.travel.distances.max(initial=0.0))
    return float(n * (2.0 * longest * goal.unit.max() + goal.fixed.max()) + goal.prize.sum())


def _step(prize: Floats) -> float:
    found = grain(prize)
    return found.size if found is not None else 1e-6 * float(prize.max(initial=0.0)) or 1.0


def claimed_objective(problem: RoutingProblem, value: float) -> float | None:
    """What an engine's minimised sum says about the objective; None for objectives in order of priority."""
    levels = problem.objective.levels()
    return _sign(levels[0]) * value + problem.constant if len(levels) == 1 else None
