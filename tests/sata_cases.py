"""Small cases of simultaneous action and target assignment, with optima that were found by enumeration."""

import itertools
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import linprog

from waybound import MaxMinLP, Problem, Selection
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges

Robot = list[tuple[float, ...]]


@dataclass(frozen=True)
class Case:
    """One row of weights an action and robot; ``bottleneck`` and ``lp`` are best worst targets, ``winner`` the best total.

    ``strong`` and ``weak`` are the values of the linear relaxations of winner takes all. The choices are actions by robot, from 1, that
    are known to be best; ``shares`` is the only optimum of the LP, where there is only one.
    """

    robots: list[Robot]
    bottleneck: float
    lp: float
    winner: float
    strong: float
    weak: float
    bottleneck_choice: tuple[int, ...] = ()
    winner_choice: tuple[int, ...] = ()
    shares: tuple[float, ...] = ()

    def selection(self, choice: tuple[int, ...]) -> Selection:
        """The selection of one action a robot, counted from 1 within the robot."""
        starts = np.cumsum([0] + [len(robot) for robot in self.robots])
        return Selection.of(int(start) + k - 1 for start, k in zip(starts[:-1], choice, strict=True))

    @property
    def graph(self) -> SensingGraph:
        return graph_of_rows(*self.robots)


def graph_of_rows(*robots: Robot, names: tuple[str, ...] | None = None) -> SensingGraph:
    """A graph of robots with one row of weights an action."""
    rows = np.array([row for robot in robots for row in robot], dtype=float)
    action, target = np.nonzero(rows)
    owner = np.repeat(np.arange(len(robots)), [len(robot) for robot in robots])
    return graph_of_edges(owner, action, target, rows[action, target], robots=names or len(robots), targets=rows.shape[1])


SQRT_HALF = 0.5**0.5


def _by_distance(weight: Callable[[float], float]) -> list[Robot]:
    """Two robots that may stay or come 2 closer, three targets, and a sensing range of 2.5."""
    places = [[(0, 0), (2, 0)], [(6, 0), (4, 0)]]
    targets = [(1, 0), (5, 0), (3, 1)]
    return [[tuple(weight(d) if (d := math.dist(p, t)) <= 2.5 else 0.0 for t in targets) for p in robot] for robot in places]


CASES = {
    "S1": Case([[(1, 0, 0), (0, 1, 0)], [(0, 1, 1), (0, 0, 1)], [(0, 0, 1), (1, 0, 0)]], 1, 4 / 3, 3, 3, 3.5),
    "S1w": Case([[(5, 0, 0), (0, 3, 0)], [(0, 3, 3), (0, 0, 4)], [(0, 0, 2), (4, 0, 0)]], 3, 30 / 7, 11, 11, 12),
    "S2": Case([[(11, 0), (0, 10)], [(11, 0)]], 10, 10, 21, 21, 21),
    "S2b": Case([[(1, 0), (0, 1)], [(1, 0)]], 1, 1, 2, 2, 2),
    "S3": Case(
        [
            [(9, 0, 0, 3), (2, 2, 1, 0), (9, 7, 0, 8)],
            [(5, 0, 0, 0), (2, 2, 7, 8), (0, 7, 2, 9)],
            [(7, 5, 2, 6), (8, 3, 0, 1), (5, 4, 3, 1)],
        ],
        10, 10.5, 31, 31, 45.833333333333336, bottleneck_choice=(3, 2, 3), winner_choice=(3, 2, 1),
    ),
    "S4": Case([[(1, 0), (0, 0)], [(0, 0), (0, 1)]], 1, 1, 2, 2, 2),
    "S4a": Case([[(0.1, 0.1), (1, 0)], [(0, 1)]], 1, 1, 2, 2, 2),
    "S4b": Case([[(0, 1), (1, 0)], [(0, 1), (1, 0)], [(0, 0), (1, 0)], [(1, 0), (0, 0)]], 2, 2, 2, 2, 2),
    "S5": Case([[(1, 1, 0), (0, 0, 1)], [(1, 0, 0), (0, 1, 0)]], 0, 0.75, 2, 2.5, 2.5),
    "S6": Case(
        [[(0, 1, 1, 0), (0, 0, 0, 1)], [(0, 0, 0, 1), (1, 1, 0, 0)], [(0, 0, 0, 1), (1, 0, 1, 0)]],
        1, 6 / 5, 4, 4, 4, shares=(0.6, 0.4, 0.4, 0.6, 0.4, 0.6),
    ),
    "S7": Case(
        [[(0, 0, 2), (3, 0, 1)], [(3, 1, 0), (0, 2, 0)]],
        1, 12 / 7, 6, 6, 6, winner_choice=(2, 2), shares=(5 / 7, 2 / 7, 2 / 7, 5 / 7),
    ),
    "S8": Case([[(1, 1), (0, 1)]], 1, 1, 2, 2, 2),
    "S9": Case([[(1, 0, 0), (0, 1, 0), (0, 0, 1)]], 0, 1 / 3, 1, 1, 1),
    "S10": Case(
        [[(4, 2, 0), (0, 0, 5)], [(4, 0, 0), (0, 3, 0)], [(3, 0, 1), (0, 5, 0)]],
        4, 317 / 68, 14, 14, 14, bottleneck_choice=(2, 1, 2), winner_choice=(2, 1, 2),
    ),
    "S11": Case(_by_distance(lambda d: 1.0), 1, 1, 3, 3, 3),
    "S11d": Case(_by_distance(lambda d: 1.0 / d), 1, 1, 2 + SQRT_HALF, 2 + SQRT_HALF, 2 + SQRT_HALF),
}  # fmt: skip


def selections(graph: SensingGraph) -> Iterator[Selection]:
    """Every way to give each robot one of its actions or none."""
    starts, actions = graph.by_robot
    choices = [[None, *actions[starts[r] : starts[r + 1]].tolist()] for r in range(graph.num_robots)]
    for choice in itertools.product(*choices):
        yield Selection.of(a for a in choice if a is not None)


def random_graph(rng: np.random.Generator, robots: int = 3, actions: int = 5, targets: int = 4) -> SensingGraph:
    """A graph with uneven robots, idle ones and unseen targets among them."""
    dense = rng.random((actions, targets)).round(3) * (rng.random((actions, targets)) < 0.5)
    a, t = np.nonzero(dense)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return graph_of_edges(rng.integers(0, robots, actions), a, t, dense[a, t], robots=robots, targets=targets)


def dense_weights(graph: SensingGraph) -> np.ndarray:
    """Weights as a matrix of shape (actions, targets)."""
    dense = np.zeros((graph.num_actions, graph.num_targets))
    dense[graph.action_of_edge, graph.indices] = graph.weights
    return dense


def relabelled(graph: SensingGraph, rng: np.random.Generator) -> tuple[SensingGraph, np.ndarray]:
    """The same graph under other numbers, and the new number of each action."""
    robot, action, target = (rng.permutation(n) for n in (graph.num_robots, graph.num_actions, graph.num_targets))
    owner = np.empty(graph.num_actions, dtype=np.int64)
    owner[action] = robot[graph.robot_of_action]
    made = graph_of_edges(
        owner, action[graph.action_of_edge], target[graph.indices], graph.weights, robots=graph.num_robots, targets=graph.num_targets
    )
    return made, action


def matrices_of(graph: SensingGraph) -> tuple[np.ndarray, np.ndarray]:
    """The packing matrix of robots x actions and the covering matrix of targets x actions."""
    packing = np.zeros((graph.num_robots, graph.num_actions))
    packing[graph.robot_of_action, np.arange(graph.num_actions)] = 1.0
    return packing, dense_weights(graph).T


def best_value(problem: MaxMinLP) -> float:
    """Optimum of a max-min or min-max program by SciPy's LP solver, with the least or largest row as the last variable."""
    a, c = problem.packing.scipy.toarray(), problem.covering.scipy.toarray()
    n, sign = problem.num_variables, -1.0 if problem.sense == "max" else 1.0
    if problem.sense == "max":
        left = np.block([[a, np.zeros((len(a), 1))], [-c, np.ones((len(c), 1))]])
        right = np.repeat([1.0, 0.0], [len(a), len(c)])
    else:
        left = np.block([[a, -np.ones((len(a), 1))], [-c, np.zeros((len(c), 1))]])
        right = np.repeat([0.0, -1.0], [len(a), len(c)])
    result = linprog(np.append(np.zeros(n), sign), left, right, bounds=[(0, None)] * (n + 1), method="highs")
    assert result.status == 0
    return float(sign * result.fun)


def value(problem: Problem, answer: Any) -> float:
    """Value of an answer that must pass the problem's check."""
    judged = problem.evaluate(answer)
    assert judged.feasible, judged.violations
    return judged.values[0]
