"""Large random sensing graphs for measuring algorithms on max-min LPs: near-regular, on a ring, and in the plane.

With a seed equal to the number of robots, ``sensing-regular`` gives the graphs of published measurements: the optimum of the LP is
1.7818 for 10^3 robots, 1.4834 for 10^4. Targets that no action would see are left out, because they make every value 0.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...generators import GENERATORS, Draw, Generator, Setting
from ..sensing_graph import SensingGraph, graph_of_edges

SPREAD = 48.0
"""Stubs of the near-regular graph are shuffled as if each had been moved by up to this many places."""

NEIGHBOURS = 8
"""On the ring, an action sees targets up to this far from the one of its robot, on either side."""

RANGE = 0.8
"""In the plane, a target is seen within this distance of an action, which lies at distance 1 of its robot."""

Make = Callable[[Draw, int], dict[str, Any]]


def regular(draw: Draw, robots: int) -> dict[str, Any]:
    """Two actions a robot, two stubs an action, four stubs a target: stub i gets the key i + uniform(0, 48), and the j-th in the order
    of keys sees target floor(j / 4). Weights are uniform in [0.5, 1.5]; a pair that is drawn twice has their sum."""
    stubs = np.arange(4 * robots)
    key = stubs + draw.uniform(0.0, SPREAD, len(stubs))
    target = np.empty(len(stubs), dtype=np.int64)
    target[np.argsort(key, kind="stable")] = stubs // 4
    weight = draw.uniform(0.5, 1.5, len(stubs))
    return {"robot_of_action": np.arange(2 * robots) // 2, "action": stubs // 2, "target": target, "weight": weight, "duplicates": "sum"}


def ring(draw: Draw, robots: int) -> dict[str, Any]:
    """A circle of as many targets as robots. Two actions a robot, each with two targets drawn from the 17 around the robot's own, weight 1;
    a target drawn twice is seen once."""
    owner = np.arange(2 * robots) // 2
    target = (owner[:, None] + draw.integers(-NEIGHBOURS, NEIGHBOURS, (len(owner), 2))) % robots
    action, seen = np.divmod(np.unique(np.arange(len(owner))[:, None] * robots + target), robots)
    return {"robot_of_action": owner, "action": action, "target": np.unique(seen, return_inverse=True)[1], "weight": 1.0}


def geometric(draw: Draw, robots: int) -> dict[str, Any]:
    """Robots and as many targets in a square of side sqrt(robots). Four actions a robot, at distance 1 in random directions, each of
    which sees the targets within 0.8; weight 1."""
    from scipy.spatial import cKDTree

    side = math.sqrt(robots)
    centre = draw.uniform(0.0, side, (robots, 2))
    angle = draw.uniform(0.0, 2.0 * math.pi, (robots, 4))
    target = draw.uniform(0.0, side, (robots, 2))
    place = (centre[:, None] + np.stack([np.cos(angle), np.sin(angle)], axis=-1)).reshape(-1, 2)
    pairs = cKDTree(place).sparse_distance_matrix(cKDTree(target), RANGE, output_type="ndarray")
    seen, renumbered = np.unique(pairs["j"], return_inverse=True)
    return {
        "robot_of_action": np.repeat(np.arange(robots), 4), "action": pairs["i"], "target": renumbered, "weight": 1.0,
        "action_positions": place, "target_positions": target[seen],
    }  # fmt: skip


def _generator(name: str, summary: str, make: Make) -> Generator:
    settings = {
        "robots": Setting(1000, "number of robots", least=1, most=10_000_000),
        "name": Setting(None, "name of the instance", type=str),
    }

    def instance(draw: Draw, given: Mapping[str, Any]) -> SensingGraph:
        robots = given["robots"]
        data = make(draw, robots)
        return graph_of_edges(
            **data, robots=robots, name=given["name"] or f"{name}-r{robots}-s{given['seed']}", format="generated", problem="bottleneck-lp"
        )

    return Generator(name, summary, settings, instance)


for _name, _summary, _make in (
    ("sensing-regular", "near-regular sensing graphs: two actions a robot, two targets an action, four actions a target", regular),
    ("sensing-ring", "sensing graphs on a ring: two actions a robot, each with two targets nearby", ring),
    ("sensing-geometric", "sensing graphs in the plane: four actions a robot, each sees what is near", geometric),
):
    GENERATORS.enter(_generator(_name, _summary, _make))
