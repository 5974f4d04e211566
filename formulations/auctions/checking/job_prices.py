"""Evidence ``job-prices`` and ``capacity-need`` of generalised assignments.

With a price u_j a job, an agent gains u_j - c_ij (of costs) or v_ij - u_j (of profits) by doing it, and altogether no more than K_i, the
largest gain of jobs that fit its capacity. Whoever does the jobs,

    cost  >=  sum_j u_j - sum_i K_i             profit  <=  sum_j u_j + sum_i K_i     (u >= 0)

K_i is exact where consumption is a whole number of moderately many steps of some power of two (Bellman 1957); elsewhere jobs may be done in
part (Dantzig 1957).

With a weight y_i >= 0 an agent, not all jobs can be done if sum_j min_i y_i a_ij > sum_i y_i b_i.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats, Integers
from ...checking.granularity import grain, lift
from ...evidence import checker
from ...tolerance import room

MOST_STEPS = 2e8
"""Jobs x capacity of all agents up to which knapsacks are solved exactly: a second."""

_EPS = float(np.finfo(np.float64).eps)
LARGEST, _TINY, _WHOLE = 1e300, 1e-290, 2.0**53


@checker("job-prices", "generalised-assignment", "prices of jobs are")
def check_job_prices(problem: Any, data: Mapping[str, Any]) -> float:
    """Bound on the cost (rounded downwards) or profit (upwards) that any prices prove; ``data`` holds ``prices``, one number per job.

    Source: Lagrangean duality, Fisher, Jaikumar and Van Wassenhove (1986); docs/formulations/generalised-assignment.md#evidence.
    """
    instance, prices = problem.instance, finite_numbers(data, "prices", problem.num_jobs)
    costs = problem.objective == "cost"
    if not costs:
        prices = np.maximum(prices, 0.0)
    rooms = [room(row, b) for row, b in zip(instance.consumption, instance.capacity.tolist(), strict=True)]
    gains, steps = [], MOST_STEPS
    for values, used, most in zip(instance.values, instance.consumption, rooms, strict=True):
        fits = np.nonzero(np.isfinite(values) & (used <= most))[0]
        gain = prices[fits] - values[fits] if costs else values[fits] - prices[fits]
        kept = gain > 0.0
        gain, part = np.nextafter(gain[kept], math.inf), used[fits][kept]  # no less than the exact difference
        whole, size = _whole(part, most)
        steps -= len(part) * size
        gains.append(_in_part(gain, part, most) if whole is None or steps < 0.0 else _knapsack(gain, whole, int(size)))
    with np.errstate(over="ignore"):
        gains = [gain * (1.0 + (2 * instance.num_jobs + 16) * _EPS) for gain in gains]
    values = instance.values[np.isfinite(instance.values)]
    sign = 1.0 if costs else -1.0
    try:
        total = math.fsum([*(sign * prices).tolist(), *(-gain for gain in gains)])
    except (OverflowError, ValueError):
        total = -math.inf
    bound = sign * math.nextafter(total, -math.inf) if total else 0.0  # a sum of doubles that is 0 is so exactly
    return lift(bound, problem.sense, grain(values)) if math.isfinite(bound) else -sign * math.inf


def _whole(used: Floats, most: float) -> tuple[Integers | None, float]:
    """Consumption and useful capacity, counted in the largest power of two that divides all consumption; None for too many steps."""
    mantissa, exponent = np.frexp(used[used > 0.0])
    digits = np.ldexp(mantissa, 53).astype(np.int64)
    unit = int((exponent - 53 + np.log2(digits & -digits).astype(np.int64)).min(initial=2000))
    with np.errstate(over="ignore", under="ignore"):
        counts = np.ldexp(used, -unit)
        size = float(np.floor(min(np.ldexp(most, -unit), counts.sum())))
    return (counts.astype(np.int64), size) if size * max(len(used), 10) <= MOST_STEPS and counts.sum() < _WHOLE else (None, 0.0)


def _knapsack(gain: Floats, used: Integers, most: int) -> float:
    """The most gain of jobs that together take at most ``most``, in whole numbers."""
    best = np.zeros(most + 1)
    for each, part in zip(gain.tolist(), used.tolist(), strict=True):
        if part == 0:
            best += each
        elif part < len(best):
            best[part:] = np.maximum(best[part:], best[:-part] + each)
    return float(best.max(initial=0.0))


def _in_part(gain: Floats, used: Floats, most: float) -> float:
    """An upper bound on the most gain: at any rate q >= 0, q most and what jobs gain beyond q times their part; best where the capacity
    ends."""
    with np.errstate(over="ignore", under="ignore", divide="ignore", invalid="ignore"):
        unit = -math.frexp(most)[1] if most > 0.0 else 0
        used, most = np.ldexp(used, unit), math.ldexp(most, unit)
        used = np.where(used < _TINY, 0.0, used)  # what rounding could raise
        rate = np.where(used > 0.0, gain / used, math.inf)
        order = np.argsort(-rate, kind="stable")
        at = int(np.searchsorted(np.cumsum(used[order]), most, side="right"))
        q = float(rate[order][at]) if at < len(rate) else 0.0
        if not math.isfinite(q):
            q = 0.0
        beyond = np.maximum(gain - q * used * (1.0 - 2.0 * _EPS), 0.0)
    return float(beyond.sum()) + q * most


@checker("capacity-need", "generalised-assignment", "weights of agents are")
def check_capacity_need(problem: Any, data: Mapping[str, Any]) -> float:
    """Infinity where weights of agents prove that not all jobs can be done, else minus infinity; ``data`` holds ``weights``, one number an
    agent."""
    instance, weights = problem.instance, np.maximum(finite_numbers(data, "weights", problem.num_agents), 0.0)
    if problem.objective != "cost":
        return math.inf  # nothing has to be done
    rooms = np.array([room(row, b) for row, b in zip(instance.consumption, instance.capacity.tolist(), strict=True)])
    with np.errstate(over="ignore", invalid="ignore"):
        fits = np.isfinite(instance.values) & (instance.consumption <= rooms[:, None])
        need = np.where(fits, weights[:, None] * instance.consumption, math.inf).min(axis=0) * (1.0 - 2.0 * _EPS)
        need = np.where(need < _TINY, 0.0, need)
        there = weights * rooms * (1.0 + 2.0 * _EPS) + _TINY
    if np.isinf(need).any():
        return math.inf if not fits.any(axis=0).all() else -math.inf
    terms = [*need.tolist(), *(-there).tolist()]
    try:
        return math.inf if math.fsum(terms) > 0.0 else -math.inf
    except (OverflowError, ValueError):
        return -math.inf


def finite_numbers(data: Mapping[str, Any], key: str, count: int, what: str = "") -> Floats:
    """A list of finite numbers from evidence; ``what`` names it in the error."""
    listed = data.get(key)
    if not isinstance(listed, list) or len(listed) != count or not all(map(is_finite, listed)):
        raise InputError(f"evidence needs a list of {what or key}", expected=f"{count} finite numbers")
    return np.array(listed, dtype=np.float64)


def is_finite(value: object) -> bool:
    """Whether a value is a number of moderate size."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LARGEST
