"""Local ratios for generalised assignments of profits, whose optimum is enumerated or known by construction."""

import itertools
import math
from functools import partial
from typing import Any

import numpy as np

from ....formulations.auctions.generalised_assignment import GeneralisedAssignment
from ...ratios.families import Family, listed
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Case, Configuration
from ...ratios.optimum import Optimum, attained

Rng = np.random.Generator

MOST = 729
"""Assignments of a random instance that are compared."""


def best_assignment(problem: GeneralisedAssignment) -> Optimum:
    """The best of all ways to give each job to an agent or none that keep within the capacities."""
    m, n, instance = problem.num_agents, problem.num_jobs, problem.instance
    ways = np.array(list(itertools.product(range(-1, m), repeat=n)))
    fits = np.ones(len(ways), dtype=bool)
    value = np.zeros(len(ways))
    for i in range(m):
        does = ways == i
        fits &= (does * instance.consumption[i]).sum(axis=1) <= instance.capacity[i] * (1.0 + 1e-12)
        fits &= ~(does & ~instance.listed[i]).any(axis=1)
        value += (does * np.where(instance.listed[i], instance.values[i], 0.0)).sum(axis=1)
    best = int(np.argmax(np.where(fits, value, -math.inf)))
    return attained(problem, tuple(ways[best].tolist()), "enumeration")


def _random(k: int, rng: Rng) -> Case:
    """Whole numbers or not, profits that follow consumption or not, capacities tight or not, some pairs forbidden."""
    m = int(rng.integers(1, 4))
    n = int(rng.integers(1, int(math.log(MOST) / math.log(m + 1) + 1e-9) + 1))
    used = rng.integers(1, 10, (m, n)).astype(float) if k % 2 else rng.random((m, n))
    profit = rng.random((m, n)) if k % 3 else used + rng.integers(0, 3, (m, n))
    if k % 5 == 0:
        profit[rng.random((m, n)) < 0.2] = -math.inf
    capacity = used.max(axis=1) * rng.uniform(0.5, 3.0, m)
    capacity = np.floor(capacity) if k % 2 else capacity
    problem = GeneralisedAssignment.from_arrays(profit, used, capacity, "profit", name=f"knapsacks-{k}")
    return Case(problem, best_assignment(problem))


def stolen(pairs: int, short: float = 1e-9) -> Case:
    """Pairs of agents with room for one job each: the first takes the job that the second could do alike, and its own stays undone.

    The optimum is 2 - short a pair, what local ratios find 1.
    """
    profit = np.full((2 * pairs, 2 * pairs), -math.inf)
    for k in range(0, 2 * pairs, 2):
        profit[k, k], profit[k, k + 1], profit[k + 1, k + 1] = 1.0 - short, 1.0, 1.0
    problem = GeneralisedAssignment.from_arrays(profit, np.ones(profit.shape), np.ones(2 * pairs), "profit", name=f"stolen-{pairs}")
    return Case(problem, attained(problem, tuple(range(2 * pairs)), "construction"))


RANDOM_PROFITS = Family("random profits", "agents with capacities, jobs with profits", _random)
STOLEN_JOBS = listed("stolen jobs", "2 is attained to 9 digits", [partial(stolen, k) for k in range(1, 9)])


def _in_random_order(problem: Any, rng: np.random.Generator) -> dict[str, Any]:
    return {"order": tuple(rng.permutation(problem.num_agents).tolist())}


guarantee_study(
    "local-ratio", "agents fill their capacities in turn, stated 2 for profits", 2000,
    [
        Configuration("in order", "local-ratio", lambda problem: 2.0),
        Configuration("random order", "local-ratio", lambda problem: 2.0, _in_random_order),
    ],
    [RANDOM_PROFITS, STOLEN_JOBS],
)  # fmt: skip
