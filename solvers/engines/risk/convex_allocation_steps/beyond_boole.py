"""Plans that keep a joint risk though the risks of their constraints add up to more, as failures come together."""

from __future__ import annotations

import copy
import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .....formulations.risk.normal import ndtri
from .....formulations.risk.risk_allocation import RiskAllocation
from .....formulations.stop import Stop
from .successive_tangents import SuccessiveTangents

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
