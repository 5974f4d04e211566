"""Heuristic ``shmoys-tardos``: the linear relaxation of a generalised assignment of costs, rounded by a matching of jobs to slots."""

import math

import numpy as np

from ...formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...formulations.stop import NEVER, Stop
from ...formulations.tolerance import room
from ...instances.number_arrays import Floats, Integers
from ..heuristic import Context, Outcome, heuristic

SMALLEST = 1e-9
"""Parts of a job that count as none: linear programs are solved to about this."""


def rounded(problem: GeneralisedAssignment, parts: Floats) -> tuple[int, ...] | None:
    """Agent of each job, at no more cost than ``parts``, a point of the linear relaxation of shape (agents, jobs); None if parts are
    missing.

    An agent's jobs, those that consume the most first, are poured into slots of one job each, and the cheapest matching of jobs to slots is
    taken. It exceeds the load in parts of an agent by no more than its largest job.

    Source: Shmoys and Tardos (1993), An approximation algorithm for the generalized assignment problem, theorem 2.1.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    instance = problem.instance
    parts = np.where((parts > SMALLEST) & problem.fitting, parts, 0.0)
    whole = parts.sum(axis=0)
    if not (whole > 0.5).all():
        return None
    parts = parts / whole
    owner: list[int] = []
    pairs: list[tuple[Integers, int, Floats]] = []  # jobs of a slot, and their costs
    for i in range(problem.num_agents):
        jobs = np.nonzero(parts[i])[0]
        jobs = jobs[np.argsort(-instance.consumption[i, jobs], kind="stable")]
        end = np.cumsum(parts[i, jobs])
        begin = end - parts[i, jobs]
        slots = max(1, math.ceil(float(end[-1]) - SMALLEST)) if len(jobs) else 0
        first = np.searchsorted(end, np.arange(slots) + SMALLEST, side="right")
        last = np.searchsorted(begin, np.arange(1, slots + 1) - SMALLEST, side="left")
        for inside in map(slice, first.tolist(), last.tolist()):
            pairs.append((jobs[inside], len(owner), instance.values[i, jobs[inside]]))
            owner.append(i)
    job, cost = (np.concatenate([pair[k] for pair in pairs]) for k in (0, 2))
    slot = np.repeat(np.arange(len(owner)), [len(pair[0]) for pair in pairs])
    low, high = float(cost.min()), float(cost.max())
    weight = cost - low + (high - low or 1.0)  # the same for every job; a stored 0 would be no pair
    try:
        job, slot = min_weight_full_bipartite_matching(csr_array((weight, (job, slot)), shape=(problem.num_jobs, len(owner))))
    except ValueError:
        return None
    agent = np.full(problem.num_jobs, -1)
    agent[job] = np.array(owner)[slot]
    return tuple(agent.tolist()) if (agent >= 0).all() else None


def within_capacities(problem: GeneralisedAssignment, answer: tuple[int, ...], stop: Stop = NEVER) -> tuple[tuple[int, ...], int]:
    """Move or exchange jobs of overloaded agents, the cheapest way first, until capacities suffice or no way lowers the overload; and how
    often."""
    instance = problem.instance
    used, values = instance.consumption, np.where(problem.fitting, instance.values, math.inf)
    rooms = np.array([room(row, b) for row, b in zip(used, instance.capacity.tolist(), strict=True)])
    agent = np.array(answer)
    moves = 0
    while True:
        load = np.array(problem.loads(tuple(agent.tolist())))
        over = np.maximum(load - rooms, 0.0)
        if not over.any() or moves > 10 * problem.num_jobs:
            return tuple(agent.tolist()), moves
        i = int(np.argmax(over))
        back = np.nonzero((agent != i) & np.isfinite(values[i]))[0]  # what may come in exchange, or nothing
        to = np.concatenate([np.delete(np.arange(len(rooms)), i), agent[back]])
        back = np.concatenate([np.full(len(rooms) - 1, -1), back])
        comes = back >= 0
        taken, freed = np.where(comes, used[i, back], 0.0), np.where(comes, used[to, back], 0.0)
        gained = np.where(comes, values[i, back], 0.0) - np.where(comes, values[to, back], 0.0)
        best: tuple[float, int, int, int] | None = None  # cost for each unit of overload, job, agent, job that comes back
        for j in np.nonzero(agent == i)[0].tolist():
            if stop.reached():
                return tuple(agent.tolist()), moves
            here, there = load[i] - used[i, j] + taken, load[to] + used[to, j] - freed
            less = over[i] + over[to] - np.maximum(here - rooms[i], 0.0) - np.maximum(there - rooms[to], 0.0)
            fits = np.nonzero(np.isfinite(values[to, j]) & (less > 1e-12 * rooms[i]))[0]
            if len(fits):
                price, less = values[to[fits], j] - values[i, j] + gained[fits], less[fits]
                rate = np.where(price > 0, price / less, price * less)
                first = fits[np.lexsort((back[fits], to[fits], rate))[0]]
                best = min((float(rate.min()), j, int(to[first]), int(back[first])), best or (math.inf, 0, 0, 0))
        if best is None:
            return tuple(agent.tolist()), moves
        _, j, k, b = best
        agent[j] = k
        if b >= 0:
            agent[b] = i
        moves += 1


@heuristic(
    "shmoys-tardos",
    "generalised-assignment",
    {"objective:cost"},
    "the linear relaxation, rounded by a matching, and moved into the capacities",
    "no guarantee within capacities; as rounded no dearer than the relaxation, loads at most the capacity and the largest job",
)
def shmoys_tardos(problem: GeneralisedAssignment, context: Context) -> Outcome:
    """Round the linear relaxation, and move what exceeds a capacity. Where nothing does, the answer costs no more than the optimum."""
    stop = context.begin()
    raw = context.linear.solve(problem.compile("assignment-knapsacks", relax=True).program, stop)
    if raw.answer is None or raw.status != "optimal":
        return Outcome(None, limit=stop.reached() or "none", message=f"the linear relaxation is {raw.status}")
    parts = np.zeros((problem.num_agents, problem.num_jobs))
    parts[np.nonzero(problem.fitting)] = np.asarray(raw.answer)[: int(problem.fitting.sum())]
    answer = rounded(problem, parts)
    if answer is None:
        return Outcome(None, message="the linear relaxation does not make up all jobs")
    answer, moves = within_capacities(problem, answer, stop)
    statistics = {"moves": moves}
    if not problem.evaluate(answer).feasible:
        return Outcome(
            None, limit=stop.reached() or "none", statistics=statistics, message="no way was found to keep within all capacities"
        )
    return Outcome(answer, statistics=statistics, message=f"{moves} jobs were moved to keep within capacities" if moves else "")
