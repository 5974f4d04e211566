"""Rooms of unknown types, some with targets, and robots that enter them, read their types and look for targets."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ...errors import InputError
from ...generators import Draw, Floats, Integers
from ...worlds import WORLDS, Setting, World, WorldKind, check_robot
from ..exploration_map import ExplorationMap
from ..generators import exploration_map as buildings

GO, MAP, SEARCH = range(3)

TARGETS = np.array([0.1, 0.8, 0.6])
"""Probability of a target in a corridor, an office and a laboratory: Zhang (2015), table 5.1."""

OWN = ("rooms", "robots", "silence", "detection", "false-alarm")


class Reading(NamedTuple):
    """A robot's reading in a room: ``action`` 1 with the type of the room as ``value``, or 2 with 0 for a target and 1 for none."""

    robot: int
    room: int
    action: int
    value: int


@dataclass(frozen=True, eq=False)
class ExplorationObservation:
    """Knowledge of the robots that have contact, at one time.

    ``building`` holds doors, rooms that hear each other and the base; its gains are those before anything is known. ``robots`` is the room
    of each robot, ``silent`` the steps in a row that each is without contact, and ``visits`` the number of times that each room was
    entered. ``sensors`` are two arrays, the probabilities of each reading of the type and of a target, one row a truth.
    """

    time: int
    building: ExplorationMap
    robots: Integers
    silent: Integers
    visits: Integers
    readings: tuple[Reading, ...]
    sensors: tuple[Floats, Floats]


class ExplorationWorld(World):
    """In a step each robot goes through a door or stays, reads the type of its room, or looks for a target in it.

    ``types`` are the true types of the rooms (corridor, office, laboratory), ``targets`` tells where there is a target in truth.
    """

    def __init__(self, building: ExplorationMap, sensors: tuple[Floats, Floats], rng: np.random.Generator) -> None:
        self.building, self.sensors, self._rng = building, sensors, rng
        self.types = rng.integers(0, len(TARGETS), building.num_rooms)
        self.targets = rng.random(building.num_rooms) < TARGETS[self.types]
        self.time = 0
        self.robots, self.silent = building.starts.copy(), np.zeros(building.num_robots, dtype=np.int64)
        self.visits = np.zeros(building.num_rooms, dtype=np.int64)
        self.visits[building.starts] = 1
        self.readings: list[Reading] = []
        self._adjacent, self._linked = building.adjacent, building.linked
        self.groups = self._groups()

    def observe(self) -> ExplorationObservation:
        return ExplorationObservation(
            self.time, self.building, self.robots.copy(), self.silent.copy(), self.visits.copy(), tuple(self.readings), self.sensors
        )

    def step(self, actions: Mapping[int, Any]) -> None:
        for robot, deed in actions.items():
            self._refuse(robot, deed)
        chances = self._rng.random(len(self.robots))  # one a robot and step, whatever they do
        for robot, (room, action) in sorted(actions.items()):
            if action == GO:
                self.visits[room] += room != self.robots[robot]
                self.robots[robot] = room
                continue
            truth = int(self.types[room]) if action == MAP else int(not self.targets[room])
            odds = np.cumsum(self.sensors[action - MAP][truth])
            value = min(int(np.searchsorted(odds, chances[robot], side="right")), len(odds) - 1)
            self.readings.append(Reading(robot, room, action, value))
        self.groups = self._groups()
        self.silent = np.where(self.groups[:-1] == self.groups[-1], 0, self.silent + 1)
        self.time += 1

    def metrics(self) -> dict[str, float]:
        """Rooms ``entered``, ``mapped`` and ``searched`` at least once; ``readings``; ``silent``: the longest that a robot is without
        contact now."""
        read = {action: {r.room for r in self.readings if r.action == action} for action in (MAP, SEARCH)}
        return {
            "entered": float((self.visits > 0).sum()), "mapped": float(len(read[MAP])), "searched": float(len(read[SEARCH])),
            "readings": float(len(self.readings)), "silent": float(self.silent.max()),
        }  # fmt: skip

    def _groups(self) -> Integers:
        """The group that each robot, and last the base, belongs to: all in a group can reach each other, directly or through others."""
        rooms = np.append(self.robots, self.building.base)
        heard = self._linked[np.ix_(rooms, rooms)]
        while not np.array_equal(heard, more := heard @ heard):
            heard = more
        return np.asarray(heard.argmax(axis=1), dtype=np.int64)

    def _refuse(self, robot: Any, deed: Any) -> None:
        check_robot(robot, len(self.robots))
        fine = isinstance(deed, tuple) and len(deed) == 2 and all(isinstance(k, int) for k in deed)
        if not fine or not (0 <= deed[0] < self.building.num_rooms and deed[1] in (GO, MAP, SEARCH)):
            raise InputError(f"robot {robot} is told a room and an action from 0 to 2", found=str(deed)[:40])
        here = int(self.robots[robot])
        if deed[0] != here and (deed[1] != GO or not self._adjacent[here, deed[0]]):
            raise InputError(f"robot {robot} cannot do that in room {deed[0]}: it is in room {here}", "contradiction", found=str(deed)[:40])


def make(rng: np.random.Generator, settings: Mapping[str, Any]) -> ExplorationWorld:
    """A building of the generator ``exploration-map``, types of equal chance, and targets by table 5.1."""
    values = {key: setting.default for key, setting in buildings.SETTINGS.items()} | {key: settings[key] for key in OWN}
    building = buildings.make(Draw(rng), {**values, "name": "rooms", "seed": 0})
    detected = np.array([settings["detection"], settings["false-alarm"]])
    return ExplorationWorld(building, (buildings.READINGS, np.column_stack([detected, 1.0 - detected])), rng)


WORLDS.enter(
    WorldKind(
        "room-exploration", "rooms of unknown types, some with targets, and robots that must be heard again and again",
        {key: Setting(s.default, s.help, s.type, s.least, s.most) for key, s in buildings.SETTINGS.items() if key in OWN}, make,
    ),
)  # fmt: skip
