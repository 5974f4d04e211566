"""Heuristic ``local-ratio``: one agent after the other fills its capacity with the jobs that gain most by coming to it."""

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...formulations.evidence import Guarantee
from ...formulations.stop import NEVER, Stop
from ...formulations.tolerance import room
from ...instances.errors import UsageError
from ...instances.number_arrays import Floats
from ..heuristic import Context, Outcome, heuristic

SOURCE = "Cohen, Katzir and Raz (2006), An efficient approximation for the generalized assignment problem, theorem 1"


@heuristic(
    "local-ratio",
    "generalised-assignment",
    {"objective:profit"},
    "one agent after the other fills its capacity with what gains most there",
    "2 for profits; 3 where knapsacks are too large to solve",
)
def local_ratio(problem: GeneralisedAssignment, context: Context, *, order: tuple[int, ...] | None = None) -> Outcome:
    """Each agent in turn takes the jobs of a best knapsack, where a job counts by how much more profit it brings here than where it is.

    Afterwards jobs that nobody has go where they fit, the most profitable first. ``order`` lists the agents as numbers from 0, by default
    as they are numbered.
    """
    stop = context.begin()
    instance, m, n = problem.instance, problem.num_agents, problem.num_jobs
    turns = list(range(m)) if order is None else list(order)
    if sorted(turns) != list(range(m)):
        raise UsageError(f"local-ratio: order must name each of {m} agents once", "malformed")
    agent, worth = np.full(n, -1), np.zeros(n)  # profit of each job where it is
    exact, whole = True, True
    rooms = [room(row, b) for row, b in zip(instance.consumption, instance.capacity.tolist(), strict=True)]
    for i in turns:
        if stop.reached():
            whole = False
            break
        beyond = np.where(problem.fitting[i], np.where(np.isfinite(instance.values[i]), instance.values[i], 0.0) - worth, 0.0)
        taken, best = knapsack(np.maximum(beyond, 0.0), instance.consumption[i], rooms[i], stop)
        agent[taken], worth[taken] = i, instance.values[i, taken]
        exact = exact and best
    load = np.array([instance.consumption[i, agent == i].sum() for i in range(m)])
    values = np.where(problem.fitting, instance.values, 0.0)
    free = np.nonzero(agent < 0)[0]
    for j in free[np.argsort(-values[:, free].max(axis=0), kind="stable")].tolist():
        if stop.reached():
            break
        gains = np.where((values[:, j] > 0.0) & (load + instance.consumption[:, j] <= instance.capacity), values[:, j], 0.0)
        i = int(np.argmax(gains))
        if gains[i] > 0.0:
            agent[j] = i
            load[i] += instance.consumption[i, j]
    guarantee = None
    if whole:
        knapsacks = "each agent's knapsack is solved exactly" if exact else "each agent's knapsack is at least half of the best"
        guarantee = Guarantee(2.0 if exact else 3.0, f"profit >= optimum / {2 if exact else 3}", (knapsacks,), SOURCE)
    return Outcome(tuple(agent.tolist()), guarantee, limit=stop.reached() or "none")


LONGEST = 1 << 15
"""Undominated sets that are kept; for whole weights these are all of them if the capacity is no more."""

MOST_KEPT = 1 << 25
"""Undominated sets that are kept for all things together: 5 bytes each."""


def knapsack(worth: Floats, weights: Floats, most: float, stop: Stop = NEVER) -> tuple[NDArray[np.int64], bool]:
    """Things that weigh no more than ``most`` together, and whether they are worth the most possible, or else at least half of it.

    ``worth`` and ``weights`` are at least 0. Where ``stop`` or a limit ends the search, the greedy set is taken.

    Source: Nemhauser and Ullmann (1969), Discrete dynamic programming and capital allocation; else the better of the greedy set and the
    first thing that does not fit (Dantzig 1957).
    """
    there = np.nonzero((worth > 0.0) & (weights <= most))[0]
    order = there[np.argsort(-_rates(worth[there], weights[there]), kind="stable")]
    total, weight = np.zeros(1), np.zeros(1)
    stages: list[tuple[NDArray[np.int32], NDArray[np.bool_]]] = []
    kept = 0
    for k in order.tolist():
        both = np.concatenate([total, total + worth[k]]), np.concatenate([weight, weight + weights[k]])
        came = np.tile(np.arange(len(total), dtype=np.int32), 2)
        took = np.arange(2 * len(total)) >= len(total)
        by = np.lexsort((-both[0], both[1]))
        by = by[both[1][by] <= most]
        ahead = np.concatenate([[-1.0], np.maximum.accumulate(both[0][by])[:-1]])
        by = by[both[0][by] > ahead]  # what weighs no less is worth more
        kept += len(by)
        if len(by) > LONGEST or kept > MOST_KEPT or stop.reached():
            return _greedy(worth, weights, most, order), False
        total, weight = both[0][by], both[1][by]
        stages.append((came[by], took[by]))
    chosen, at = [], len(total) - 1
    for k, (came, took) in zip(order[::-1].tolist(), stages[::-1], strict=True):
        if took[at]:
            chosen.append(k)
        at = int(came[at])
    return np.array(sorted(chosen), dtype=np.int64), True


def _rates(worth: Floats, weights: Floats) -> Floats:
    with np.errstate(divide="ignore", over="ignore"):
        return np.where(weights > 0.0, worth / weights, np.inf)


def _greedy(worth: Floats, weights: Floats, most: float, order: NDArray[np.int64]) -> NDArray[np.int64]:
    fits = np.cumsum(weights[order]) <= most
    if fits.all():
        return np.sort(order)
    first = int(np.argmin(fits))
    prefix = order[:first]
    return np.sort(prefix) if worth[prefix].sum() >= worth[order[first]] else order[first : first + 1]
