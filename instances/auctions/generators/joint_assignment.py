"""Idle robots, bins and requests of an orchard at one moment."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...generators import GENERATORS, Draw, Generator, Setting
from ..joint_assignment import JointAssignmentInstance
from .assignment import orchard_distance

SETTINGS = {
    "robots": Setting(6, "number of idle robots", least=1, most=1000),
    "home": Setting(4, "how many of them are at the repository, where new bins are", least=0, most=1000),
    "bins": Setting(8, "number of bins to fetch", least=1, most=1000),
    "requests": Setting(3, "number of groups that wait for a new bin", least=0, most=1000),
    "rows": Setting(10, "lanes of the orchard", least=1, most=1000),
    "columns": Setting(10, "cells of a lane, two of them headland", least=3, most=1000),
    "fill": Setting(4, "steps in which a bin is filled, some of which have passed", least=0, most=1000),
    "name": Setting(None, "name of the instance", type=str),
}


def make(draw: Draw, settings: Mapping[str, Any]) -> JointAssignmentInstance:
    """Steps of robots without a full bin, two cells each; a robot that is not at the repository brings no bin."""
    n, m, q, lanes, columns = (settings[key] for key in ("robots", "bins", "requests", "rows", "columns"))
    cells = [np.column_stack([draw.integers(0, lanes - 1, k), draw.integers(1, columns - 2, k)]) for k in (n, m, q)]
    robots, bins, requests = cells
    at_home = np.arange(n) < settings["home"]
    robots[at_home] = 0

    def steps(a: Any, b: Any) -> Any:
        return np.ceil(orchard_distance(a, b, columns) / 2.0)

    to_request = np.where(at_home[:, None], steps(robots, requests), np.inf)
    return JointAssignmentInstance(
        steps(robots, bins), to_request, steps(requests, bins), draw.integers(0, settings["fill"], m).astype(np.float64),
        name=settings["name"] or f"joint-assignment-{n}x{m}x{q}-s{settings['seed']}", format="generated",
    )  # fmt: skip


GENERATORS.enter(Generator("joint-assignment", "robots, bins and requests of an orchard at one moment (joint assignment)", SETTINGS, make))
