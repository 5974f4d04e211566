"""Random robots and tasks in a square, on a grid, in clusters, or on a line.

Source: the settings of Zhang (2015), section 4.5 (a grid of eight neighbours, ten waypoints, two to five robots at corners) as ``grid``.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...generators import GENERATORS, Draw, Floats, Generator, Setting
from ..robot_tasks import PROBLEMS, RobotTasks

LAYOUTS = ("plane", "clusters", "grid", "line")

SETTINGS = {
    "robots": Setting(3, "number of robots", least=1, most=1000),
    "tasks": Setting(10, "number of tasks", least=1, most=5000),
    "layout": Setting("plane", "where they are: anywhere, tasks in clusters, on a grid of eight neighbours, or on a line", choices=LAYOUTS),
    "size": Setting(100.0, "side of the square, or length of the line; a whole number of cells on a grid", least=1.0, most=1e6),
    "weight": Setting(0.0, "largest weight of a task in its part, from 0 on", least=0.0, most=1e9),
    "problem": Setting(PROBLEMS[0], "what is meant to be asked", choices=PROBLEMS),
    "name": Setting(None, "name of the instance", type=str),
}

CORNERS = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5)])
"""Bases of the robots of a grid, the first two opposite as in the source; further ones are anywhere."""


def make(draw: Draw, settings: Mapping[str, Any]) -> RobotTasks:
    """The instance; weights are uniform."""
    robots, tasks, size, layout = settings["robots"], settings["tasks"], settings["size"], settings["layout"]
    places = _places(draw, robots, tasks, size, layout)
    weights = draw.uniform(0.0, settings["weight"], tasks) if settings["weight"] else None
    metric = "chebyshev" if layout == "grid" else "euclidean"
    name = settings["name"] or f"{layout}-r{robots}-t{tasks}-s{settings['seed']}"
    return RobotTasks(robots, tasks, metric, places, weights=weights, name=name, format="generated", problem=settings["problem"])


def _places(draw: Draw, robots: int, tasks: int, size: float, layout: str) -> Floats:
    every = robots + tasks
    if layout == "line":
        return np.column_stack([draw.uniform(0.0, size, every), np.zeros(every)])
    if layout == "grid":
        last = int(size) - 1
        anywhere = draw.integers(0, last, (every, 2)).astype(np.float64)
        fixed = min(robots, len(CORNERS))
        anywhere[:fixed] = np.floor(CORNERS[:fixed] * last)
        return anywhere
    places = draw.uniform(0.0, size, (every, 2))
    if layout == "clusters":
        centres = draw.uniform(0.0, size, (max(1, tasks // 5), 2))
        spread = np.column_stack([draw.normal(0.0, 0.03 * size, tasks) for _ in range(2)])
        places[robots:] = centres[draw.integers(0, len(centres) - 1, tasks)] + spread
    return places


GENERATORS.enter(Generator("robot-tasks", "robots and tasks in the plane (auctions, balanced partition)", SETTINGS, make))
