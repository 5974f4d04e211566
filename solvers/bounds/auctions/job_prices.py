"""Bound ``job-prices``: Lagrangean relaxation of generalised assignments, from the duals of the linear program on."""

import math

import numpy as np

from ....formulations.auctions.generalised_assignment import GeneralisedAssignment
from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ....formulations.verified_bounds import verified_bound
from ....instances.number_arrays import Floats, Integers
from ...linear_programs import LinearPrograms
from .. import bound_method, instead_of, of_family
from ..linear_relaxation import linear_relaxation_bound

FAMILY = GeneralisedAssignment.family

SOURCE = "Lagrangean relaxation, a knapsack an agent"

ROUNDS, HALVED_AFTER = 150, 10
"""Rounds of the subgradient method, and after how many without a better bound its steps are halved."""

MOST_STEPS = 2e7
"""Jobs times capacities, in steps, beyond which a round takes too long: a tenth of a second."""


@bound_method("job-prices", of_family(FAMILY), order=1, aims=True, replaces=instead_of("linear-relaxation", FAMILY))
def compute(problem: GeneralisedAssignment, stop: Stop, linear: LinearPrograms, target: float | None = None) -> Evidence | None:
    """Prices of the linear relaxation, made better by subgradients where consumption comes in few steps (Fisher 1981)."""
    reason = next(problem.infeasibility_reasons(), None)
    if reason is not None:
        return reason.evidence
    start = linear_relaxation_bound(problem, stop, linear)
    steps = _in_steps(problem)
    if steps is None:
        return start
    own = start is not None and start.kind == "job-prices"
    first = np.array(start.data["prices"]) if start is not None and own else _cheapest(problem)
    prices = _ascended(problem, *steps, first, stop, target)
    better = Evidence("job-prices", SOURCE, 0.0, {"prices": prices.tolist()})
    if start is None:
        return better
    sign = 1.0 if problem.objective == "cost" else -1.0
    return max(better, start, key=lambda one: sign * verified_bound(problem, one))


def _cheapest(problem: GeneralisedAssignment) -> Floats:
    """The best value of each job."""
    values = problem.instance.values
    best = np.where(problem.fitting, values, math.inf).min(axis=0) if problem.objective == "cost" else np.zeros(problem.num_jobs)
    return np.where(np.isfinite(best), best, 0.0)


def _in_steps(problem: GeneralisedAssignment) -> tuple[Integers, Integers] | None:
    """Consumption (agents, jobs) and capacities (agents,) in whole steps of each agent; None for too many steps.

    A step is the largest power of two that divides all consumption that fits; agents whose jobs all fit together count none.
    """
    instance = problem.instance
    used = np.where(problem.fitting, instance.consumption, 0.0)
    mantissa, exponent = np.frexp(used)
    digits = np.ldexp(mantissa, 53).astype(np.int64)
    lowest = exponent - 53 + np.log2(np.maximum(digits & -digits, 1)).astype(np.int64)
    unit = np.where(used > 0.0, lowest, 2000).min(axis=1, initial=2000)
    with np.errstate(over="ignore", under="ignore"):
        counts = np.ldexp(used, -unit[:, None])
        most = np.floor(np.ldexp(instance.capacity, -unit))
    ample = counts.sum(axis=1) <= most  # nothing is to be chosen
    counts[ample], most[ample] = 0.0, 0.0
    small = problem.num_jobs * math.fsum(most) <= MOST_STEPS
    return (counts.astype(np.int64), most.astype(np.int64)) if small else None


def _ascended(
    problem: GeneralisedAssignment, used: Integers, capacity: Integers, prices: Floats, stop: Stop, target: float | None
) -> Floats:
    """The best prices met: a job that several agents would do gets a smaller gain for them, one that none would do a larger one."""
    instance, costs = problem.instance, problem.objective == "cost"
    sign = 1.0 if costs else -1.0
    fits = problem.fitting
    signed = np.where(fits, sign * instance.values, 0.0)  # to be made small
    u = sign * prices
    if not costs:
        u = np.minimum(u, 0.0)
    best, kept, since, share = -math.inf, u, 0, 1.0
    for _ in range(ROUNDS):
        if stop.reached():
            break
        done = np.zeros(problem.num_jobs)
        bound = math.fsum(u)
        for i in range(problem.num_agents):
            jobs = np.nonzero(fits[i] & (u > signed[i]))[0]
            gain, chosen = _filled(u[jobs] - signed[i, jobs], used[i, jobs], int(capacity[i]))
            bound -= gain
            done[jobs[chosen]] += 1.0
        since = 0 if bound > best + 1e-12 * abs(bound) else since + 1
        if bound > best:
            best, kept = bound, u.copy()
        if since == HALVED_AFTER:
            share, since, u = share / 2.0, 0, kept.copy()
        step = 1.0 - done
        if not costs:
            step = np.where((u >= 0.0) & (step > 0.0), 0.0, step)
        length = float(step @ step)
        if length == 0.0:
            break
        aim = sign * target if target is not None and math.isfinite(target) else best + 0.05 * abs(best)
        u = u + share * max(aim - bound, 1e-9 * abs(bound)) / length * step
        if not costs:
            u = np.minimum(u, 0.0)
    return sign * kept


def _filled(gain: Floats, used: Integers, most: int) -> tuple[float, Integers]:
    """The most gain of jobs that fit together, and which jobs these are (Bellman 1957)."""
    if int(used.sum()) <= most:
        return float(gain.sum()), np.arange(len(gain))
    best = np.zeros(most + 1)
    taken = np.zeros((len(gain), most + 1), dtype=bool)
    for k, (each, part) in enumerate(zip(gain.tolist(), used.tolist(), strict=True)):
        with_it = best[: most + 1 - part] + each
        taken[k, part:] = with_it > best[part:]
        best[part:] = np.maximum(best[part:], with_it)
    chosen, room = [], most
    for k in range(len(gain) - 1, -1, -1):
        if taken[k, room]:
            chosen.append(k)
            room -= int(used[k])
    return float(best[most]), np.array(chosen, dtype=np.int64)
