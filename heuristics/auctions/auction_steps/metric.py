"""Whether distances keep the triangle inequality: what guarantees of auctions assume."""

from __future__ import annotations

import numpy as np

from ....formulations.stop import Stop
from ....formulations.tolerance import LIMIT
from ....instances.auctions.robot_tasks import RobotTasks


def keeps_triangles(instance: RobotTasks, stop: Stop) -> tuple[str, ...] | None:
    """What was found to hold, None where it does not, or ``stop`` came before all was looked at.

    Distances of a rule of the plane need no look. In a matrix no direct way may be longer than one through a third place, but for
    the rounding of sums, a part of both ways: where a bound of a ratio adds up m of them, it holds but for m times that part.
    """
    if instance.metric != "matrix":
        return (f"distances are {instance.metric} ones of the plane",)
    every, between = instance.distances, instance.between
    if (between != between.T).any():
        return None
    for row in every:
        if stop.reached():
            return None
        with np.errstate(over="ignore"):
            through = row[:, None] + between
            around = row[:, None] + row
        if (row > through.min(axis=0) * (1.0 + LIMIT)).any() or (between > around * (1.0 + LIMIT)).any():
            return None
    return ("distances between tasks are symmetric", "the triangle inequality holds")
