"""Random sensing graphs of some hundred robots, and their optima by a solver that the package does not use."""

import numpy as np
import scipy.sparse as sp
from scipy.optimize import linprog

from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges


def random_graph(seed: int, robots: int = 30, targets: int = 20, most_actions: int = 3, sees: int = 3, spread: float = 0.5) -> SensingGraph:
    """Robots of 1 to ``most_actions`` actions with ``sees`` random targets each, weights exp(normal(0, spread)); every target is seen."""
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(robots), rng.integers(1, most_actions + 1, robots))
    action = np.repeat(np.arange(len(owner)), sees)
    target = rng.integers(0, targets, len(action))
    unseen = np.setdiff1d(np.arange(targets), target)
    action = np.concatenate([action, rng.integers(0, len(owner), len(unseen))])
    target = np.concatenate([target, unseen])
    weight = np.exp(rng.normal(0.0, spread, len(action)))
    return graph_of_edges(owner, action, target, weight, robots=robots, targets=targets, duplicates="sum")


def chain_graph(seed: int, robots: int) -> SensingGraph:
    """Robots in a circle, each between two targets, one action for either: what one does matters far away."""
    rng = np.random.default_rng(seed)
    action = np.arange(2 * robots)
    return graph_of_edges(action // 2, action, (action // 2 + action % 2) % robots, rng.uniform(0.7, 1.3, 2 * robots), robots=robots)


def even_graph(seed: int, robots: int) -> SensingGraph:
    """Two actions a robot, two targets an action, four actions a target, joined at random: no target is far from any other."""
    rng = np.random.default_rng(seed)
    stub = np.arange(4 * robots)
    weight = rng.uniform(0.5, 1.5, len(stub))
    return graph_of_edges(np.arange(2 * robots) // 2, stub // 2, rng.permutation(len(stub)) // 4, weight, robots=robots, duplicates="sum")


def optimum(graph: SensingGraph) -> float:
    """Optimum of the max-min linear program, by scipy."""
    n, m = graph.num_actions, graph.num_targets
    seen = sp.csr_matrix((graph.weights, graph.indices, graph.indptr), shape=(n, m)).T
    owned = sp.csr_matrix((np.ones(n), (graph.robot_of_action, np.arange(n))), shape=(graph.num_robots, n))
    rows = sp.vstack([sp.hstack([-seen, np.ones((m, 1))]), sp.hstack([owned, np.zeros((graph.num_robots, 1))])])
    right = np.concatenate([np.zeros(m), np.ones(graph.num_robots)])
    finest = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10, "presolve": False}  # or 1e-5 may be lost
    found = linprog(np.append(np.zeros(n), -1.0), A_ub=rows, b_ub=right, bounds=(0, None), method="highs", options=finest)
    assert found.status == 0, found.message
    return float(-found.fun)
