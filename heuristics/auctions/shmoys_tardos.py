"""Heuristic ``shmoys-tardos``: the linear relaxation of a generalised assignment of costs, rounded by a matching of jobs to slots."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...formulations.tolerance import room
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome

Floats = NDArray[np.float64]

SMALLEST = 1e-9
"""Parts of a job that count as none: a linear program is solved to about as much."""


def rounded(problem: GeneralisedAssignment, parts: Floats) -> tuple[int, ...] | None:
    """Whole jobs instead of parts, at no more cost: each agent is loaded by its largest job beyond its load in parts at most.

    An agent's jobs, those that consume the most first, are poured into slots of one job each; the cheapest matching of jobs to slots costs
    no more than the parts, which are one in fractions.

    Parameters
    ----------
    problem : GeneralisedAssignment
    parts : array of shape (agents, jobs)
        A point of the linear relaxation.

    Returns
    -------
    tuple of int or None
        Agent of each job; None where the parts do not make up all jobs.

    Notes
    -----
    Source: Shmoys and Tardos (1993), An approximation algorithm for the generalized assignment problem, theorem 2.1.
    """
    from scipy.optimize import linear_sum_assignment

    instance = problem.instance
    parts = np.where((parts > SMALLEST) & problem.fitting, parts, 0.0)
    whole = parts.sum(axis=0)
    if not (whole > 0.5).all():
        return None
    parts = parts / whole
    owner: list[int] = []
    columns: list[Floats] = []
    for i in range(problem.num_agents):
        jobs = np.nonzero(parts[i])[0]
        jobs = jobs[np.argsort(-instance.consumption[i, jobs], kind="stable")]
        end = np.cumsum(parts[i, jobs])
        begin = end - parts[i, jobs]
        slots = max(1, math.ceil(float(end[-1]) - SMALLEST)) if len(jobs) else 0
        for k in range(slots):
            inside = (end > k + SMALLEST) & (begin < k + 1 - SMALLEST)
            column = np.full(problem.num_jobs, math.inf)
            column[jobs[inside]] = instance.values[i, jobs[inside]]
            owner.append(i)
            columns.append(column)
    try:
        job, slot = linear_sum_assignment(np.column_stack(columns))
    except ValueError:
        return None
    agent = np.full(problem.num_jobs, -1)
    agent[job] = np.array(owner)[slot]
    return tuple(agent.tolist()) if (agent >= 0).all() else None


def within_capacities(problem: GeneralisedAssignment, answer: tuple[int, ...]) -> tuple[tuple[int, ...], int]:
    """Jobs of overloaded agents moved or exchanged, the cheapest way first, until capacities suffice or no way lowers the overload; and how
    often."""
    instance = problem.instance
    used, values = instance.consumption, np.where(problem.fitting, instance.values, math.inf)
    rooms = np.array([room(row, b) for row, b in zip(used, instance.capacity.tolist(), strict=True)])
    agent, jobs = np.array(answer), np.arange(problem.num_jobs)
    moves = 0
    while True:
        load = np.array(problem.loads(tuple(agent.tolist())))
        over = np.maximum(load - rooms, 0.0)
        if not over.any() or moves > 10 * problem.num_jobs:
            return tuple(agent.tolist()), moves
        i = int(np.argmax(over))
        mine = jobs[agent == i]
        best: tuple[float, int, int, int] | None = None  # cost for each unit of overload, job, agent, job that comes back
        for j in mine.tolist():
            for k in np.nonzero(np.isfinite(values[:, j]) & (np.arange(len(rooms)) != i))[0].tolist():
                back = [-1, *jobs[(agent == k) & np.isfinite(values[i])].tolist()]
                for b in back:
                    here = load[i] - used[i, j] + (used[i, b] if b >= 0 else 0.0)
                    there = load[k] + used[k, j] - (used[k, b] if b >= 0 else 0.0)
                    less = over[i] + over[k] - max(here - rooms[i], 0.0) - max(there - rooms[k], 0.0)
                    if less > 1e-12 * rooms[i]:
                        price = values[k, j] - values[i, j] + (values[i, b] - values[k, b] if b >= 0 else 0.0)
                        best = min((price / less if price > 0 else price * less, j, k, b), best or (math.inf, 0, 0, 0))
        if best is None:
            return tuple(agent.tolist()), moves
        _, j, k, b = best
        agent[j] = k
        if b >= 0:
            agent[b] = i
        moves += 1


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
    answer, moves = within_capacities(problem, answer)
    statistics = {"moves": moves}
    if not problem.evaluate(answer).feasible:
        return Outcome(None, statistics=statistics, message="no way was found to keep within all capacities")
    return Outcome(answer, statistics=statistics, message=f"{moves} jobs were moved to keep within capacities" if moves else "")


HEURISTICS.add(
    "shmoys-tardos",
    Heuristic(
        "shmoys-tardos", ("generalised-assignment",), frozenset({"objective:cost"}), shmoys_tardos,
        "the linear relaxation, rounded by a matching, and moved into the capacities",
        "no guarantee within capacities; as rounded no dearer than the relaxation, loads at most the capacity and the largest job",
    ),
)  # fmt: skip
