"""Pictures of tasks of robots: paths and parts on a map, or as bars where places are not known."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.auctions.balanced_partition import BalancedPartition
from ....formulations.auctions.task_allocation import TaskAllocation
from ..drawing import COLOURS, INK, bare, bars, plot_of

NAMED = 40
"""Tasks up to which each is named."""


@plot_of("task-allocation")
def plot_task_allocation(ax: Any, problem: TaskAllocation, answer: Any) -> str:
    """The path of each robot from its start; where there are no places, the length of each path."""
    instance = problem.instance
    if instance.positions is None:
        lengths = np.array([float(problem.legs(robot, path).sum()) for robot, path in enumerate(answer)])
        bars(ax, lengths, [instance.robot_name(r) for r in range(instance.num_robots)], "robot")
        return "length of each path"
    for robot, path in enumerate(answer):
        stops = instance.positions[[robot, *(task + instance.num_robots for task in path)]]
        ax.plot(*stops.T, color=COLOURS[robot % len(COLOURS)], linewidth=1.6, zorder=2)
    _places(ax, problem, answer)
    return "squares are the robots, whose paths lead from task to task"


@plot_of("balanced-partition")
def plot_balanced_partition(ax: Any, problem: BalancedPartition, answer: Any) -> str:
    """The tasks in the colours of their parts, with the edges that count; where there are no places, the cost of each part."""
    instance = problem.instance
    if instance.positions is None:
        bars(ax, np.array(problem.costs(answer)), [instance.robot_name(r) for r in range(instance.num_robots)], "part")
        return "cost of each part"
    for robot, part in enumerate(answer):
        for a, b in _edges(problem, list(part)):
            ends = instance.positions[[a + instance.num_robots, b + instance.num_robots]]
            ax.plot(*ends.T, color=COLOURS[robot % len(COLOURS)], linewidth=1.0, alpha=0.7, zorder=2)
    _places(ax, problem, answer)
    return "squares are the robots, lines the distances that count"


def _edges(problem: BalancedPartition, part: list[int]) -> list[tuple[int, int]]:
    """Pairs of tasks whose distance counts."""
    if problem.edges == "none" or len(part) < 2:
        return []
    if problem.edges == "clique":
        return [(a, b) for k, a in enumerate(part) for b in part[:k]]
    between: NDArray[np.float64] = problem.instance.between[np.ix_(part, part)]
    near, joined, waiting = between[0].copy(), np.zeros(len(part), dtype=np.int64), np.arange(len(part)) > 0
    edges = []
    for _ in range(len(part) - 1):
        node = int(np.where(waiting, near, np.inf).argmin())
        edges.append((part[int(joined[node])], part[node]))
        waiting[node] = False
        joined, near = np.where(between[node] < near, node, joined), np.minimum(near, between[node])
    return edges


def _places(ax: Any, problem: TaskAllocation | BalancedPartition, answer: Any) -> None:
    instance = problem.instance
    assert instance.positions is not None
    starts, places = instance.positions[: instance.num_robots], instance.positions[instance.num_robots :]
    for robot, share in enumerate(answer):
        colour = COLOURS[robot % len(COLOURS)]
        ax.scatter(*places[list(share)].T, s=26, color=colour, edgecolors="white", linewidths=0.6, zorder=3)
        ax.scatter(*starts[[robot]].T, s=70, marker="s", color=colour, edgecolors="white", zorder=4)
    if instance.num_tasks <= NAMED:
        for task, place in enumerate(places):
            ax.annotate(instance.task_name(task), place, xytext=(4, 4), textcoords="offset points", fontsize=8, color=INK, zorder=5)
    bare(ax)
