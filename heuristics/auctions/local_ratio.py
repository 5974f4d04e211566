"""Heuristic ``local-ratio``: one agent after the other fills its capacity with what is worth more there than where it is."""

from __future__ import annotations

import numpy as np

from ...formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...formulations.evidence import Guarantee
from ...formulations.tolerance import room
from ...instances.errors import UsageError
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome
from ._knapsack import knapsack

SOURCE = "Cohen, Katzir and Raz (2006), An efficient approximation for the generalized assignment problem, theorem 1"


def local_ratio(problem: GeneralisedAssignment, context: Context, *, order: tuple[int, ...] | None = None) -> Outcome:
    """Each agent in turn takes the jobs of a best knapsack, a job counting what it is worth beyond its profit with who has it so far.

    Afterwards jobs that nobody has go where they fit, the most profitable first.

    Parameters
    ----------
    problem : GeneralisedAssignment
        Of profits.
    context : Context
    order : tuple of int, optional
        Of the agents, as numbers from 0; that of their numbers by default.
    """
    stop = context.begin()
    instance, m, n = problem.instance, problem.num_agents, problem.num_jobs
    turns = list(range(m)) if order is None else list(order)
    if sorted(turns) != list(range(m)):
        raise UsageError(f"local-ratio: order must name each of {m} agents once")
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
        left = np.where((values[:, j] > 0.0) & (load + instance.consumption[:, j] <= instance.capacity), values[:, j], 0.0)
        i = int(np.argmax(left))
        if left[i] > 0.0:
            agent[j] = i
            load[i] += instance.consumption[i, j]
    guarantee = None
    if whole:
        knapsacks = "each agent's knapsack is solved exactly" if exact else "each agent's knapsack is at least half of the best"
        guarantee = Guarantee(2.0 if exact else 3.0, f"profit >= optimum / {2 if exact else 3}", (knapsacks,), SOURCE)
    return Outcome(tuple(agent.tolist()), guarantee, limit=stop.reached() or "none")


HEURISTICS.add(
    "local-ratio",
    Heuristic(
        "local-ratio", ("generalised-assignment",), frozenset({"objective:profit"}), local_ratio,
        "one agent after the other fills its capacity with what gains most there",
        "2 for profits; 3 where knapsacks are too large to solve",
    ),
)  # fmt: skip
