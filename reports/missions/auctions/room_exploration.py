"""Room exploration: a team goes through a building in rounds, and learns the types of its rooms and where targets are."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, ClassVar

import numpy as np

from ....formulations.auctions.room_exploration import RoomExploration
from ....formulations.problem import Problem
from ....heuristics.auctions._exploration import Worth, explorers_and_relays
from ....instances.auctions.beliefs import TARGET, Floats, Integers, Rewards, Sensors, after_target, after_type, prior
from ....instances.auctions.exploration_map import ExplorationMap
from ....instances.auctions.generators.exploration_map import TIMES
from ....instances.auctions.worlds.room_exploration import GO, MAP, SEARCH, TARGETS, ExplorationObservation, ExplorationWorld
from ....instances.errors import UsageError
from ....instances.worlds import WORLDS, Setting, World, make_world, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene

WEIGHTS = ("explore", "map", "search")

BESIDE = 0.22
"""Distance in pictures of each robot from the middle of its room, as a share of a room's width."""


class RoomsExplored(Mission):
    """Gain much in rounds: at the start of each all robots have contact, share what they read, and plan its steps.

    Source: Zhang (2015), chapter 5. What of it is played, and what is not: docs/missions.md#room-exploration.
    """

    name: ClassVar[str] = "room-exploration"
    summary: ClassVar[str] = "robots explore, map and search rooms in rounds, and must be heard again and again"
    headline: ClassVar[str] = "entered"
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["room-exploration"].settings,
        "round": Setting(6, "steps that are planned at once, from contact to contact", int, 1, 100),
        "explore": Setting(0.3, "weight of entering rooms", float, 0.0, 1.0),
        "map": Setting(0.3, "weight of observing their types", float, 0.0, 1.0),
        "search": Setting(0.4, "weight of looking for targets", float, 0.0, 1.0),
        "decay": Setting(0.5, "what a room keeps of its gain at each visit", float, 0.0, 1.0),
    }

    def world(self, seed: int, **settings: Any) -> ExplorationWorld:
        self.values = setting_values(self.name, self.settings, settings)
        weights = [self.values[key] for key in WEIGHTS]
        if abs(sum(weights) - 1.0) > 1e-9:
            raise UsageError(f"explore, map and search must sum to 1, not to {sum(weights):g}")
        world = make_world(self.name, seed, **{key: self.values[key] for key in WORLDS[self.name].settings})
        assert isinstance(world, ExplorationWorld)
        self._rewards = Rewards((weights[0], weights[1], weights[2]), decay=self.values["decay"])
        self._sensors = Sensors(world.sensors[0], self.values["detection"], self.values["false-alarm"])
        types = len(TARGETS)
        self._beliefs = [prior(np.full(types, 1.0 / types), TARGETS) for _ in range(world.building.num_rooms)]
        self._heard = 0
        self._plan: Sequence[Sequence[tuple[int, int]]] | None = None
        self._teams: dict[int, tuple[int, ...]] = {}
        return world

    def problem(self, observation: ExplorationObservation) -> Problem | None:
        o, steps = observation, self.values["round"]
        if o.time % steps:
            return None
        self._learn(o.readings)
        tables = self._rewards.tables(np.array(self._beliefs), o.visits, self._sensors, TIMES)
        return round_problem(o.building, tables, o.robots, steps, f"rooms at step {o.time}")

    def actions(self, observation: ExplorationObservation, problem: Problem | None, answer: Any) -> Actions:
        if problem is not None:
            self._plan = answer
        if self._plan is None:
            return {robot: (room, GO) for robot, room in enumerate(observation.robots.tolist())}
        return {robot: deeds[observation.time % self.values["round"]] for robot, deeds in enumerate(self._plan)}

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``alone`` and ``relays`` decide anew in each step, by all readings so far: see ``explorers_and_relays``."""
        return {"alone": partial(self._by_rule, False), "relays": partial(self._by_rule, True)}

    def _by_rule(self, relays: bool, o: ExplorationObservation) -> Actions:
        self._learn(o.readings)
        worth = worth_now(self._rewards, np.array(self._beliefs), o.visits, self._sensors)
        building = o.building
        deeds, self._teams = explorers_and_relays(
            building.adjacent, building.linked, building.base, o.robots.tolist(), o.silent.tolist(), building.silence, worth, self._teams,
            relays=relays,
        )  # fmt: skip
        return deeds

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``types_known`` and ``targets_known``: the mean probability that all readings so far give to what is true of a room."""
        assert isinstance(world, ExplorationWorld)
        self._learn(world.readings)
        beliefs = np.array(self._beliefs)
        rooms = np.arange(len(beliefs))
        return {
            "types_known": float(beliefs.sum(axis=2)[rooms, world.types].mean()),
            "targets_known": float(beliefs.sum(axis=1)[rooms, np.where(world.targets, TARGET, 1 - TARGET)].mean()),
        }

    def scene(self, world: World) -> Scene | None:
        assert isinstance(world, ExplorationWorld)
        return rooms_scene(world)

    # ------------------------------------------------------------------------------------------------------------------

    def _learn(self, readings: Sequence[Any]) -> None:
        """Update the beliefs with the readings that they do not hold yet."""
        for _, room, action, value in readings[self._heard :]:
            old = self._beliefs[room]
            self._beliefs[room] = after_type(old, self._sensors, value) if action == MAP else after_target(old, self._sensors, value == 0)
        self._heard = len(readings)


def round_problem(building: ExplorationMap, tables: Sequence[Floats], robots: Integers, steps: int, name: str) -> RoomExploration:
    """The static problem of the next ``steps``, from the rooms of ``robots`` and tables of gains, one a kind, of shape (rooms, times)."""
    return RoomExploration(
        ExplorationMap(
            building.doors, tables[0], tables[1], tables[2], robots, building.base, building.heard, building.silence, steps,
            positions=building.positions, name=name,
        )
    )  # fmt: skip


def worth_now(rewards: Rewards, beliefs: Floats, visits: Integers, sensors: Sensors) -> Worth:
    """Worth of each robot's next action: a visit after those of others in the step, and a reading that no other takes."""
    read = {MAP: rewards.map(beliefs, sensors).tolist(), SEARCH: rewards.search(beliefs, sensors).tolist()}

    def worth(room: int, action: int, others: int) -> float:
        if action == GO:
            return float(rewards.explore(int(visits[room]) + others))
        return 0.0 if others else float(read[action][room])

    return worth


def rooms_scene(world: ExplorationWorld) -> Scene | None:
    """Rooms and doors; each robot on its own side of its room; links of communication are not drawn. None if rooms have no places."""
    if world.building.positions is None:
        return None
    places = np.asarray(world.building.positions, dtype=np.float64) * [1.0, -1.0]
    side = 2.0 * np.pi * (np.arange(len(world.robots)) / len(world.robots) + 0.125)
    robots = places[world.robots] + BESIDE * np.column_stack([np.cos(side), np.sin(side)])
    low, high = places.min(axis=0) - 0.6, places.max(axis=0) + 0.6
    area = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    doors = tuple((int(a), int(b)) for a, b in world.building.doors)
    return Scene(area, robots, 0.08, places, world.visits > 0, ("robots", "rooms entered", "rooms not entered"), ways=doors)


MISSIONS.add("room-exploration", RoomsExplored)
