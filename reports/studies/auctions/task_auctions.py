"""Auctions of tasks against their guarantees, on instances whose best paths are enumerated."""

import itertools
import math
from functools import partial
from typing import Any

import numpy as np

from ....formulations.auctions.task_allocation import TaskAllocation
from ....instances.auctions.robot_tasks import RobotTasks
from ...ratios.families import Family, listed
from ...ratios.guarantees import guarantee_study
from ...ratios.judged_runs import Case, Configuration
from ...ratios.optimum import Optimum, attained

Rng = np.random.Generator

KINDS = ("plane", "clusters", "line", "grid", "graph")


def team(rng: Rng, kind: str, robots: int, tasks: int, name: str) -> RobotTasks:
    """Robots and tasks whose distances keep the triangle inequality."""
    every = robots + tasks
    if kind == "graph":
        distances = np.where(rng.random((every, every)) < 0.5, rng.integers(1, 10, (every, every)), 30).astype(float)
        distances = np.minimum(distances, distances.T)
        np.fill_diagonal(distances, 0.0)
        for k in range(every):
            distances = np.minimum(distances, distances[:, [k]] + distances[k])
        return RobotTasks.of_distances(distances[:robots, robots:], distances[robots:, robots:], name=name)
    if kind == "line":
        places = np.column_stack([rng.integers(0, 20, every), np.zeros(every)]).astype(float)
    elif kind == "grid":
        places = rng.integers(0, 5, (every, 2)).astype(float)
    elif kind == "clusters":
        places = rng.integers(0, 100, (3, 2))[rng.integers(0, 3, every)] + rng.normal(0, 2, (every, 2))
    else:
        places = rng.uniform(0, 100, (every, 2))
    return RobotTasks.of_positions(places[:robots], places[robots:], "manhattan" if kind == "grid" else "euclidean", name=name)


def best(problem: TaskAllocation) -> Optimum:
    """The shortest path of every robot through every set of tasks, and the best way to share the sets."""
    robots, tasks, d = problem.num_robots, problem.num_tasks, problem.instance.distances
    waiting, largest = problem.objective == "mini-ave", problem.objective == "mini-max"
    costs_of_robots: list[list[tuple[float, tuple[int, ...]]]] = []
    for robot in range(robots):
        own: list[tuple[float, tuple[int, ...]]] = [(math.inf, ())] * (1 << tasks)
        own[0] = (0.0, ())
        for count in range(1, tasks + 1):
            for order in itertools.permutations(range(tasks), count):
                legs = [d[robot if k == 0 else robots + order[k - 1], task] for k, task in enumerate(order)]
                cost = sum(leg * (count - k) for k, leg in enumerate(legs)) if waiting else sum(legs)
                members = sum(1 << task for task in order)
                if cost < own[members][0]:
                    own[members] = (cost, order)
        costs_of_robots.append(own)
    shared: dict[int, tuple[float, tuple[tuple[int, ...], ...]]] = {0: (0.0, ())}
    for own in costs_of_robots:
        after: dict[int, tuple[float, tuple[tuple[int, ...], ...]]] = {}
        for (before, (value, paths)), members in itertools.product(shared.items(), range(1 << tasks)):
            if not before & members:
                worth = max(value, own[members][0]) if largest else value + own[members][0]
                if worth < after.get(before | members, (math.inf, ()))[0]:
                    after[before | members] = (worth, (*paths, own[members][1]))
        shared = after
    return attained(problem, shared[(1 << tasks) - 1][1], "enumeration")


def _random(k: int, rng: Rng, kind: str, robots: int | None) -> Case:
    count = int(rng.integers(1, 4)) if robots is None else robots
    instance = team(rng, kind, count, int(rng.integers(1, 5 if count > 2 else 6)), f"{kind}-{k}")
    problem = TaskAllocation(instance)
    return Case(problem, best(problem))


def random_families(robots: int | None = None) -> tuple[Family, ...]:
    """Random robots and tasks of every kind, the sum of all paths; ``robots`` of them, or one to three."""
    team_size = "one to three robots" if robots is None else f"{robots} robot{'s' if robots > 1 else ''}"
    return tuple(
        Family(f"tasks, {kind}, {team_size}", f"random {kind}, {team_size}", partial(_random, kind=kind, robots=robots)) for kind in KINDS
    )


def placed(starts: Any, tasks: Any, name: str, objective: str = "mini-sum") -> Case:
    """Robots and tasks at given places."""
    problem = TaskAllocation(RobotTasks.of_positions(starts, tasks, name=name), objective)
    return Case(problem, best(problem))


def greedy_line() -> Case:
    """Robots at 2 and 5, tasks at 0, 3 and 4: the first robot is drawn away from 0, and comes back."""
    return placed([2, 5], [0, 3, 4], "drawn-away")


def around_a_cluster(robots: int) -> Case:
    """Robots on a circle around tasks in its middle, each nearest to one of them: best done by one robot."""
    angle = 2.0 * math.pi * np.arange(robots) / robots
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    return placed(circle, 0.01 * circle, f"around-{robots}")


def zigzag(tasks: int) -> Case:
    """One robot at an end of a line, tasks at the other end and at this one in turn."""
    return placed([0], [10.0 * (k % 2 == 0) for k in range(tasks)], f"zigzag-{tasks}")


TRAPS = listed(
    "drawn away",
    "tasks whose nearest robots are led astray",
    [greedy_line, *(partial(around_a_cluster, n) for n in (2, 3, 4)), partial(placed, [0, 0], [1, -1.001, 2, -2.001], "between-two")],
)
ZIGZAGS = listed("zigzag", "tasks at both ends of a line in turn", [partial(zigzag, n) for n in (1, 2, 4, 5, 6)])


guarantee_study(
    "sequential-single-item", "sum of all paths under the triangle inequality, stated 2", 5000,
    [
        Configuration("by insertion", "sequential-single-item", lambda problem: 2.0),
        Configuration("by best paths", "sequential-single-item", lambda problem: 2.0, {"paths": "optimal"}),
    ],
    [*random_families(), TRAPS],
)  # fmt: skip
guarantee_study(
    "fixed-order-auction", "one robot, stated the number of tasks", 2000,
    [Configuration("as numbered", "fixed-order-auction", lambda problem: float(problem.num_tasks))],
    [*random_families(1), ZIGZAGS],
)  # fmt: skip
