"""Rooms explored, mapped and searched by robots that must be heard again and again: the most gain within so many steps."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...instances.auctions.exploration_map import GAINS, ExplorationMap
from ...instances.errors import InputError, UsageError
from ...instances.instance import digest
from ..evaluation import Checklist, Evaluation
from ..problem import PROBLEMS, Problem, refuse_settings

if TYPE_CHECKING:
    import pandas as pd

GO, MAP, SEARCH = range(3)
ACTIONS = ("go", "map", "search")
"""Go to a room or stay; observe the type of the room; look for a target in it."""

Deed = tuple[int, int]
"""The room in which a robot is after a step, and its action."""

Plans = tuple[tuple[Deed, ...], ...]
"""Each robot's steps."""


class RoomExploration(Problem):
    """The most gain of all robots together.

    At each step a robot goes through a door or stays, maps, or searches. Entering a room gains as a visit, whoever visits; the second visit
    of a room gains less. After each step robots that hear each other are in contact, and those that are so joined to the base have contact;
    nobody is without for more steps in a row than allowed, and all have contact after the last one.

    Parameters
    ----------
    instance : ExplorationMap
        Rooms, doors, who hears whom, and what actions gain.

    Raises
    ------
    UsageError
        For another instance.

    Notes
    -----
    Source: Zhang (2015), section 5.3, for given beliefs; docs/formulations/room-exploration.md#model.
    """

    family: ClassVar[str] = "room-exploration"
    senses = ("max",)

    def __init__(self, instance: ExplorationMap) -> None:
        if not isinstance(instance, ExplorationMap):
            raise UsageError(f"a room exploration is made of an ExplorationMap, not of {type(instance).__name__}", "malformed")
        self.instance = instance
        self.name, self.problem, self.notes = instance.name, "room-exploration", instance.notes

    def digest(self) -> str:
        return digest("room-exploration", self.instance.digest())

    def features(self) -> frozenset[str]:
        return frozenset({"contact"})

    @property
    def size(self) -> int:
        return self.instance.num_robots * self.instance.steps

    def facts(self) -> dict[str, Any]:
        return {"objective": "gains of visits and observations", "exploration": self.instance.facts()}

    def evaluate(self, answer: Any) -> Evaluation:
        """Add up the gains; test that each step leads through a door, that observers stay, and that contact is kept."""
        instance = self.instance
        self._check_shape(answer)
        checks = Checklist()
        adjacent = instance.adjacent
        counts = np.zeros((len(GAINS), instance.num_rooms), dtype=np.int64)
        for robot, deeds in enumerate(answer):
            here = int(instance.starts[robot])
            for step, (room, action) in enumerate(deeds, start=1):
                stays = room == here
                fine = stays or (action == GO and adjacent[here, room])
                what = f"from room {instance.room_name(here)} to {instance.room_name(room)}"
                message = f"robot {robot + 1} cannot {'go' if action == GO else ACTIONS[action]} {what} in step {step}"
                checks.test("doors", float(not fine), message, vehicle=str(robot + 1), site=instance.room_name(room))
                if action != GO or not stays:
                    counts[action, room] += 1
                here = room
        for robot, silent in enumerate(self.silences(answer)):
            message = f"robot {robot + 1} is without contact for {silent} steps in a row, {instance.silence} allowed"
            checks.test("contact", float(silent - instance.silence), message, vehicle=str(robot + 1))
        last = self.contacts(answer)[-1]
        for robot in range(instance.num_robots):
            checks.test("end", float(not last[robot]), f"robot {robot + 1} has no contact after the last step", vehicle=str(robot + 1))
        terms = [
            getattr(instance, key)[room, :count].tolist() for key, row in zip(GAINS, counts, strict=True) for room, count in enumerate(row)
        ]
        n = instance.num_rooms
        quantities = {key: math.fsum(v for own in terms[k * n : (k + 1) * n] for v in own) for k, key in enumerate(GAINS)}
        value = math.fsum(v for own in terms for v in own)
        return Evaluation((value,), checks.checks(("doors", "contact", "end")), tuple(checks.violations), quantities)

    def _check_shape(self, answer: Any) -> None:
        instance = self.instance
        if not isinstance(answer, tuple) or len(answer) != instance.num_robots:
            raise InputError(f"an answer is a tuple of steps for each of {instance.num_robots} robots", found=str(answer)[:80])
        for deeds in answer:
            if not isinstance(deeds, tuple) or len(deeds) != instance.steps:
                raise InputError(f"each robot makes {instance.steps} steps", "wrong-shape", found=str(deeds)[:80])
            for deed in deeds:
                pair = isinstance(deed, tuple) and len(deed) == 2 and all(type(k) is int for k in deed)
                if not pair or not (0 <= deed[0] < instance.num_rooms and 0 <= deed[1] < len(ACTIONS)):
                    raise InputError(f"a step is a room from 0 to {instance.num_rooms - 1} and an action from 0 to 2", found=str(deed)[:80])

    def contacts(self, answer: Plans) -> NDArray[np.bool_]:
        """Whether each robot has contact with the base after each step; shape (steps, robots)."""
        instance, linked = self.instance, self.instance.linked
        contacts = np.zeros((instance.steps, instance.num_robots), dtype=bool)
        for step in range(instance.steps):
            rooms = np.array([deeds[step][0] for deeds in answer])
            joined = linked[instance.base, rooms]
            while True:
                more = joined | (linked[np.ix_(rooms, rooms)] & joined[None, :]).any(axis=1)
                if (more == joined).all():
                    break
                joined = more
            contacts[step] = joined
        return contacts

    def silences(self, answer: Plans) -> list[int]:
        """The most steps in a row for which each robot has no contact."""
        longest = []
        for heard in self.contacts(answer).T:
            now = most = 0
            for flag in heard.tolist():
                now = 0 if flag else now + 1
                most = max(most, now)
            longest.append(most)
        return longest

    def answer_at_hand(self) -> Plans:
        """Everybody stays: an answer where all start in contact."""
        return tuple(((int(start), GO),) * self.instance.steps for start in self.instance.starts)

    def answer_to_json(self, answer: Plans) -> dict[str, Any]:
        name = self.instance.room_name
        robots = [[{"room": name(room), "action": ACTIONS[action]} for room, action in deeds] for deeds in answer]
        return {"kind": "explorations", "robots": robots}

    def answer_from_json(self, data: Any) -> Plans:
        robots = data.get("robots") if isinstance(data, Mapping) and data.get("kind") == "explorations" else None
        if not isinstance(robots, list) or not all(isinstance(deeds, list) for deeds in robots):
            raise InputError("not an answer to a room exploration", expected='an object {"kind": "explorations", "robots": [[...], ...]}')
        rooms = {self.instance.room_name(k): k for k in range(self.instance.num_rooms)}

        def deed(entry: Any) -> Deed:
            if not isinstance(entry, Mapping) or str(entry.get("room")) not in rooms or entry.get("action") not in ACTIONS:
                raise InputError("a step names a room and an action", expected='{"room": ..., "action": ...}', found=str(entry)[:80])
            return rooms[str(entry["room"])], ACTIONS.index(entry["action"])

        plans = tuple(tuple(map(deed, deeds)) for deeds in robots)
        self._check_shape(plans)
        return plans

    def answer_to_frame(self, answer: Plans) -> "pd.DataFrame":
        """One row per robot and step: robot, step, room, action, contact."""
        import pandas as pd

        contacts = self.contacts(answer)
        rows = [
            (robot + 1, step + 1, self.instance.room_name(room), ACTIONS[action], bool(contacts[step, robot]))
            for robot, deeds in enumerate(answer)
            for step, (room, action) in enumerate(deeds)
        ]
        return pd.DataFrame(rows, columns=["robot", "step", "room", "action", "contact"])

    def to_instance(self) -> ExplorationMap:
        return self.instance

    def __repr__(self) -> str:
        instance = self.instance
        return f"<RoomExploration {self.name}: {instance.num_rooms} rooms, {instance.num_robots} robots, {instance.steps} steps>"


@PROBLEMS.register("room-exploration")
def make(instance: Any, name: str, settings: dict[str, Any]) -> RoomExploration:
    """The problem of an instance; no settings."""
    if not isinstance(instance, ExplorationMap):
        raise UsageError(f"{instance.name} holds no rooms to explore, so it cannot be read as {name}", "foreign")
    refuse_settings(name, settings)
    return RoomExploration(instance)
