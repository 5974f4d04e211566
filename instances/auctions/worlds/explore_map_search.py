"""Rooms that robots with a budget explore, map and search, and what each of them has been told."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...errors import InputError, UsageError
from ...generators import Draw, Floats, Integers
from ...reading import read_instance
from ...worlds import WORLDS, Setting, WorldKind
from ..beliefs import TARGET, Rewards, Sensors, after_target, after_type, prior, sensors_from_text
from ..exploration_map import ExplorationMap
from ..generators import exploration_map as buildings
from .room_exploration import GO, MAP, TARGETS, ExplorationObservation, ExplorationWorld

OWN = ("rooms", "robots", "silence")

WEIGHTS = ("explore", "map", "search")

TOLERANCE = 1e-9
"""Share of the range by which a distance may be longer."""


@dataclass(frozen=True, eq=False)
class TeamObservation(ExplorationObservation):
    """Truth that the base and the robots know parts of.

    ``history`` has shape (time, robots, 3): the room in which each robot was after each step, its action, and what came of it (1 for a
    room entered, or the reading). Of it robot r, and the base in the last row, knows the first ``knows[r, q]`` steps of robot q.
    ``groups`` numbers who hears each other, the base at last. ``left`` are the steps that the budget allows still.
    """

    history: Integers
    knows: Integers
    groups: Integers
    left: int


class TeamWorld(ExplorationWorld):
    """In a step each robot goes through a door or stays, reads the type of its room, or looks for a target; each costs the same.

    After it all that hear each other, over others or not, tell each other what they know. ``gains`` are the sums, before they are weighted,
    of what visits, readings of types and searches gained, each valued by all that was read before it, by whomever.

    Source: Zhang (2015), sections 5.3 and 5.5; docs/missions/explore-map-search.md.
    """

    def __init__(self, building: ExplorationMap, sensors: Sensors, rewards: Rewards, steps: int, rng: np.random.Generator) -> None:
        super().__init__(building, (sensors.types, sensors.targets), rng)
        self.sensing, self.rewards, self.steps = sensors, rewards, steps
        robots, types = building.num_robots, len(TARGETS)
        self.prior = prior(np.full(types, 1.0 / types), TARGETS)
        self.beliefs = np.tile(self.prior, (building.num_rooms, 1, 1))
        self.knows = np.zeros((robots + 1, robots), dtype=np.int64)
        self.gains = np.zeros(len(WEIGHTS))
        self._history: list[Integers] = []

    def observe(self) -> TeamObservation:
        history = np.array(self._history, dtype=np.int64).reshape(-1, len(self.robots), 3)
        seen = super().observe()
        return TeamObservation(
            seen.time, seen.building, seen.robots, seen.silent, seen.visits, seen.readings, seen.sensors, history, self.knows.copy(),
            self.groups, self.steps - self.time,
        )  # fmt: skip

    def step(self, actions: Mapping[int, Any]) -> None:
        if self.over:
            raise InputError(f"the budget of {self.steps} actions is spent", "contradiction")
        before, visits, told = self.robots.copy(), self.visits.copy(), len(self.readings)
        super().step(actions)
        row = np.column_stack([self.robots, np.full_like(before, GO), self.robots != before])
        for reading in self.readings[told:]:
            row[reading.robot, 1:] = reading.action, reading.value
        for room, action, value in row.tolist():
            self._value(visits, room, action, value)
        self._history.append(row)
        self.knows[np.arange(len(before)), np.arange(len(before))] = self.time
        for group in np.unique(self.groups):
            self.knows[self.groups == group] = self.knows[self.groups == group].max(axis=0)

    def _value(self, visits: Integers, room: int, action: int, value: int) -> None:
        """Add what an action gained, and learn what it read."""
        belief, sensors = self.beliefs[room], self.sensing
        if action == GO:
            self.gains[GO] += self.rewards.visit(int(visits[room])) if value else 0.0
            visits[room] += value
        elif action == MAP:
            self.gains[MAP] += self.rewards.reading(belief.sum(axis=1), sensors.types)
            self.beliefs[room] = after_type(belief, sensors, value)
        else:
            self.gains[action] += self.rewards.reading(belief.sum(axis=0), sensors.targets)
            self.beliefs[room] = after_target(belief, sensors, value == 0)

    @property
    def over(self) -> bool:
        return self.time >= self.steps

    def metrics(self) -> dict[str, float]:
        """Metrics of room exploration; ``utility``: the weighted sum of ``exploring``, ``mapping`` and ``searching``, what actions gained;
        ``types_known`` and ``targets_known``: mean probability that all readings give to what is true; ``groups`` out of contact."""
        rooms = np.arange(len(self.beliefs))
        gains = dict(zip(("exploring", "mapping", "searching"), self.gains.tolist(), strict=True))
        return {
            **super().metrics(), "utility": float(np.dot(self.rewards.weights, self.gains)), **gains,
            "types_known": float(self.beliefs.sum(axis=2)[rooms, self.types].mean()),
            "targets_known": float(self.beliefs.sum(axis=1)[rooms, np.where(self.targets, TARGET, 1 - TARGET)].mean()),
            "groups": float(len(np.unique(self.groups)) - 1),
        }  # fmt: skip


def within(places: Floats, reach: float, strict: bool) -> Integers:
    """Pairs of places at most ``reach`` apart, or nearer than that; shape (pairs, 2)."""
    apart = np.sqrt(((places[:, None] - places[None]) ** 2).sum(axis=2))
    near = apart < reach * (1.0 - TOLERANCE) if strict else apart <= reach * (1.0 + TOLERANCE)
    return np.argwhere(np.triu(near, 1)).astype(np.int64)


def make(rng: np.random.Generator, settings: Mapping[str, Any]) -> TeamWorld:
    """A building of the generator ``exploration-map`` or a file, types of equal chance, and targets by table 5.1.

    Raises InputError or UsageError if a sensor's table is none of probabilities, a weight or the decay is out of range, or the budget
    reaches no action.
    """
    values = {key: setting.default for key, setting in buildings.SETTINGS.items()} | {key: settings[key] for key in OWN}
    sensors = sensors_from_text(settings["type-sensor"], settings["target-sensor"])
    explore, map_, search = (settings[key] for key in WEIGHTS)
    rewards = Rewards((explore, map_, search), settings["first"], settings["decay"], settings["gain"])
    steps = int(settings["budget"] / settings["cost"] * (1.0 + TOLERANCE))
    if steps < 1:
        raise UsageError(f"a budget of {settings['budget']:g} reaches no action, each costs {settings['cost']:g}", "out-of-range")
    if settings["file"] is None:
        drawn = buildings.make(Draw(rng), {**values, "name": "rooms", "seed": 0})
        assert drawn.positions is not None
        building = replace(drawn, heard=within(drawn.positions, settings["range"], settings["strict"]))
    else:
        read = read_instance(settings["file"])
        if not isinstance(read, ExplorationMap):
            raise UsageError(f"{settings['file']} holds no map of rooms to explore", "foreign")
        building = read
    world = TeamWorld(building, sensors, rewards, steps, rng)
    lost = np.nonzero(world.groups != world.groups[-1])[0]
    if len(lost):
        raise InputError(f"robot {lost[0] + 1} does not hear the base at the start", "contradiction", expected="contact of all")
    return world


WORLDS.enter(
    WorldKind(
        "explore-map-search", "robots with a budget explore rooms, map and search them, and tell each other what they know where they meet",
        {
            "rooms": Setting(22, "number of rooms", int, 1, 500),
            "robots": Setting(2, "robots, which start at the base", int, 1, 50),
            "silence": Setting(2, "steps in a row that a robot may be out of contact", int, 0, 1000),
            "file": Setting(None, "an exploration map with doors, starts, base, links and silence, in place of one that is drawn", str),
            "range": Setting(2.0, "distance up to which rooms hear each other; rooms side by side are 1 apart", float, 0.0, 1e6),
            "strict": Setting(False, "whether rooms just as far apart as the range do not", bool),
            "budget": Setting(100.0, "of each robot", float, 0.0, 1e6),
            "cost": Setting(1.0, "of each action, staying included", float, 1e-6, 1e6),
            "explore": Setting(0.3, "weight of entering rooms", float),
            "map": Setting(0.3, "weight of observing their types", float),
            "search": Setting(0.4, "weight of looking for targets", float),
            "first": Setting(1.0, "gain of the first visit of a room", float, 0.0, 1e6),
            "decay": Setting(0.5, "what a room keeps of it at each further visit", float),
            "gain": Setting("mutual-information", "of a reading: what it is expected to tell, or all that is unknown",
                            choices=("mutual-information", "entropy")),
            "type-sensor": Setting("0.5 0.3 0.2; 0.05 0.9 0.05; 0.1 0.1 0.8", "probability of reading each type, one row a true type", str),
            "target-sensor": Setting("0.9 0.1; 0.05 0.95", "of a report and of none; the first row with a target, the second without", str),
        },
        make,
    ),
)  # fmt: skip
