"""Bound ``task-forest``: prices of tasks and robots by projected subgradients, for the evidence of the same name."""

import numpy as np

from ....formulations.auctions.task_allocation import TaskAllocation
from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family

STEPS = 1500
"""Forests that are looked at: more bring no visible gain."""

PATIENCE = 25
"""Steps without a rise after which they become shorter."""

SHORTEST = 1e-4
"""The least part of the value that a step aims at."""

KERNELS = ("waybound.solvers.bounds.auctions.forest_kernels",)

MISSING = of_family("task-allocation", lambda problem: problem.features() & {"objective:mini-ave"})
"""A forest says little about the mean way."""


@bound_method("task-forest", MISSING, order=1, kernels=KERNELS)
def compute(problem: TaskAllocation, stop: Stop, linear: LinearPrograms) -> Evidence | None:
    """The best prices that an ascent finds; no prices where ``stop`` comes first."""
    from .forest_kernels import rooted_forest

    instance = problem.instance
    starts, robots = np.array(instance.starts), instance.num_robots
    edges = np.minimum(instance.between, instance.between.T)
    price = np.zeros(instance.num_tasks + robots)
    ends = np.concatenate([np.full(instance.num_tasks, 2.0), np.ones(robots)])
    best_price, best, aim, waited = price, -np.inf, 0.1, 0
    for _ in range(STEPS):
        weight, of_tasks, of_robots = rooted_forest(stop.flag, starts, edges, price[:-robots], price[-robots:])
        value = weight - float(ends @ price)
        if np.isnan(value):
            break
        waited += 1
        if value > best * (1.0 + 1e-6) or best < 0.0:
            waited = 0
        if value > best:
            best_price, best = price, value
        slope = np.concatenate([of_tasks, of_robots]) - ends
        slope[(price <= 0.0) & (slope < 0.0)] = 0.0
        length = float(slope @ slope)
        if length == 0.0 or best == 0.0:
            break
        if waited >= PATIENCE:
            aim, waited, price = aim / 2.0, 0, best_price
            if aim < SHORTEST:
                break
            continue
        price = np.maximum(0.0, price + (best * (1.0 + aim) - value) / length * slope)
    data = {"tasks": best_price[:-robots].tolist(), "robots": best_price[-robots:].tolist()}
    value = max(0.0, best) / (robots if problem.objective == "mini-max" else 1)
    return Evidence("task-forest", "forest of tasks rooted at the robots, with prices", value, data)
