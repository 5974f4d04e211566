"""Random buildings: rooms on a grid, and what noisy sensors are expected to learn of them.

Source: Zhang (2015), section 5.3 and tables 5.1 and 5.2; rows of the latter are true types (docs/formulations/room-exploration.md#errata).
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...generators import GENERATORS, Draw, Generator, Setting
from ..beliefs import expected_gains
from ..exploration_map import ExplorationMap

READINGS = np.array([[0.5, 0.3, 0.2], [0.05, 0.9, 0.05], [0.1, 0.1, 0.8]])
"""Probability of each reading (corridor, office, laboratory), one row a true type."""

TIMES = 3
"""Visits and observations of a room that gain something."""

SETTINGS = {
    "rooms": Setting(22, "number of rooms", least=1, most=500),
    "robots": Setting(2, "number of robots, which start at the base", least=1, most=50),
    "steps": Setting(6, "steps of each robot", least=1, most=1000),
    "silence": Setting(1, "steps in a row that a robot may be out of contact", least=0, most=1000),
    "explore": Setting(0.3, "weight of entering rooms", least=0.0, most=1.0),
    "map": Setting(0.3, "weight of observing their types", least=0.0, most=1.0),
    "search": Setting(0.4, "weight of looking for targets", least=0.0, most=1.0),
    "decay": Setting(0.5, "what a room keeps of its gain at each visit", least=0.0, most=1.0),
    "detection": Setting(0.9, "probability that a target is reported", least=0.0, most=1.0),
    "false-alarm": Setting(0.05, "probability that one is reported where there is none", least=0.0, most=1.0),
    "name": Setting(None, "name of the instance", type=str),
}


def make(draw: Draw, settings: Mapping[str, Any]) -> ExplorationMap:
    """Rooms of a square grid; a random tree of doors, and a fifth of the others; the base in the corner.

    Rooms hear each other through a door.
    """
    rooms = settings["rooms"]
    columns = math.isqrt(rooms - 1) + 1
    places = np.column_stack(np.divmod(np.arange(rooms), columns))
    beside = [
        (a, b) for a in range(rooms) for b in (a + 1, a + columns) if b < rooms and np.abs(places[a] - places[b]).sum() == 1
    ]  # fmt: skip
    order = draw.permutation(len(beside)).tolist()
    extra = draw.uniform(0.0, 1.0, len(beside))
    part = list(range(rooms))

    def root(a: int) -> int:
        while part[a] != a:
            a = part[a]
        return a

    doors = []
    for k in order:
        a, b = beside[k]
        if root(a) != root(b):
            part[root(a)] = root(b)
            doors.append((a, b))
        elif extra[k] < 0.2:
            doors.append((a, b))
    weigh = settings["explore"], settings["map"], settings["search"]
    alarm = np.array([[settings["detection"], 1 - settings["detection"]], [settings["false-alarm"], 1 - settings["false-alarm"]]])
    decaying = settings["decay"] ** np.arange(TIMES)
    gains = [decaying, *(expected_gains(np.full(len(t), 1 / len(t)), t, TIMES) for t in (READINGS, alarm))]
    tables = [np.tile(weight * gain, (rooms, 1)) for weight, gain in zip(weigh, gains, strict=True)]
    tables[0][0] = np.append(tables[0][0][1:], 0.0)  # robots are in the base already
    return ExplorationMap(
        np.array(sorted(doors), dtype=np.int64).reshape(-1, 2), tables[0], tables[1], tables[2],
        np.zeros(settings["robots"], dtype=np.int64), 0,
        np.array(sorted(doors), dtype=np.int64).reshape(-1, 2), settings["silence"], settings["steps"],
        positions=places[:, ::-1].astype(np.float64), name=settings["name"] or f"exploration-{rooms}-s{settings['seed']}",
        format="generated",
    )  # fmt: skip


GENERATORS.enter(Generator("exploration-map", "rooms to explore, map and search (room exploration)", SETTINGS, make))
