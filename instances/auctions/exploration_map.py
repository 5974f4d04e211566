"""Rooms that robots explore, map and search, and from where they are heard."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from .. import number_arrays as arrays
from ..declared import CountOf, Declared, NameOf, Names
from ..document import array, wholes
from ..errors import InputError
from ..number_arrays import Flags, Floats, Integers
from ..parts import LARGEST, Axis, Numbers, Part, Whole, Wholes

GAINS = ("exploring", "mapping", "searching")
"""Gains: of entering a room, of observing its type, of looking for a target in it."""

SHOWN = 5
"""Rooms that a message lists."""

MOST_STEPS = 1000


class Gains(Numbers):
    """Arrays whose rows never increase."""

    def refuse(self, key: str, value: Floats, instance: Declared) -> None:
        rising = np.diff(value, axis=1, prepend=LARGEST) > 0
        wrong = ~((value >= 0) & (value <= LARGEST)) | rising
        if wrong.any():
            room, time = np.argwhere(wrong)[0].tolist()
            what = f"{key} of room {room + 1}, time {time + 1}"
            raise InputError(f"{what} must be at least 0, and no more than the time before", "out-of-range", found=str(value[room, time]))


class Links(Part):
    """Pairs of different rooms."""

    def converted(self, key: str, value: Any, counts: dict[str, int]) -> Integers:
        pairs = arrays.whole_numbers(key, np.asarray(value).ravel()).reshape(-1, 2) if np.size(value) else np.zeros((0, 2), np.int64)
        return arrays.frozen(pairs)

    def refuse(self, key: str, value: Integers, instance: Declared) -> None:
        arrays.refuse_outside(f"a room of {key}, entry {{}}", value.ravel(), instance.counts["room"], "room")
        if (value[:, 0] == value[:, 1]).any():
            raise InputError(
                f"{key} must join two different rooms", "duplicate", found=f"room {value[value[:, 0] == value[:, 1]][0, 0]} twice"
            )

    def read(self, data: Any, path: str, counts: Mapping[str, int]) -> Integers:
        pairs = [wholes(pair, f"{path}[{k}]", 2) for k, pair in enumerate(array(data, path))]
        return np.array(pairs, dtype=np.int64).reshape(-1, 2)

    def write(self, value: Integers) -> list[list[int]]:
        pairs: list[list[int]] = value.tolist()
        return pairs


@dataclass(frozen=True, eq=False, repr=False)
class ExplorationMap(Declared):
    """A graph of rooms, what each visit and observation of a room gains, and where robots hear each other.

    Parameters
    ----------
    doors : array of shape (doors, 2)
        Pairs of rooms, as numbers from 0, between which one step leads.
    exploring, mapping, searching : array of shape (rooms, times)
        What the first, second, ... time gains in each room, at least 0 and never more than the time before; nothing after the last.
        Weights of the three kinds are in them.
    starts : array of shape (robots,)
        Room of each robot.
    base : int
        The room that robots must be in contact with.
    heard : array of shape (pairs, 2)
        Pairs of different rooms that hear each other; a room hears itself.
    silence : int
        Steps in a row that a robot may be without contact; 0 asks for contact always.
    steps : int
        That each robot makes, at least 1.
    room_names : tuple of str, optional
        None stands for "1", "2", ...
    positions : array of shape (rooms, 2), optional
        For maps.
    name, format, problem, problems, notes
        See ``Instance``.

    Raises
    ------
    InputError
        If an array has the wrong shape or holds what it must not, if no robot can enter a room, or one can never be heard.

    Notes
    -----
    Source: Zhang (2015), section 5.3; docs/formulations/room-exploration.md#model.
    """

    kind = "exploration-map"
    problem_names = ("room-exploration",)
    content = "maps of rooms"
    axes = (Axis("room", positions="positions"), Axis("robot", table=False))
    hashed = ("adjacent", *GAINS, "starts", "base", "linked", "silence", "steps")
    doors: Annotated[Integers, Links()]
    exploring: Annotated[Floats, Gains("room", None, table="room")]
    mapping: Annotated[Floats, Gains("room", None, table="room")]
    searching: Annotated[Floats, Gains("room", None, table="room")]
    starts: Annotated[Integers, Wholes("robot", refers="room", what="the start of robot {}", key="robots", table="")]
    base: Annotated[int, Whole(0, "room")]
    heard: Annotated[Integers, Links()]
    silence: Annotated[int, Whole(0, MOST_STEPS)]
    steps: Annotated[int, Whole(1, MOST_STEPS)]
    room_names: Names = None
    positions: Floats | None = None
    num_rooms, num_robots = CountOf("room"), CountOf("robot")
    room_name = NameOf("room")

    def check_rest(self) -> None:
        """Raise InputError where no robot can enter a room, or one can never be heard."""
        doors = self.adjacent
        alone = np.nonzero(~_reached(doors, self.starts))[0].tolist()
        if alone:
            names = ", ".join(map(self.room_name, alone[:SHOWN])) + ", ..." * (len(alone) > SHOWN)
            raise InputError(
                f"no doors lead from a robot to {len(alone)} of the {self.num_rooms} rooms: {names}", "contradiction",
                expected="doors to every room",
            )  # fmt: skip
        reached = np.nonzero(_reached(self.linked, np.array([self.base])))[0]
        lost = np.nonzero(~_reached(doors, reached)[self.starts])[0]
        if len(lost):
            raise InputError(
                f"robot {lost[0] + 1} can enter no room from which links lead to the base", "contradiction", expected="doors or links to it"
            )

    @property
    def adjacent(self) -> Flags:
        """Mask of the moves of one step, shape (rooms, rooms)."""
        return _table(self.doors, self.num_rooms)

    @property
    def linked(self) -> Flags:
        """Mask of the rooms that hear each other, themselves included, shape (rooms, rooms)."""
        return np.asarray(_table(self.heard, self.num_rooms) | np.eye(self.num_rooms, dtype=bool))

    def facts(self) -> dict[str, Any]:
        """Sizes, as plain JSON values."""
        return {
            "rooms": self.num_rooms, "doors": len(self.doors), "robots": self.num_robots, "steps": self.steps, "silence": self.silence,
            "heard_at_base": int(self.linked[self.base].sum()),
            **{key: float(getattr(self, key)[:, :1].sum()) for key in GAINS},
        }  # fmt: skip

    def summary(self) -> Iterable[str]:
        return (*super().summary(), f"{self.steps} steps")


def _reached(table: Flags, begin: Integers) -> Flags:
    """Rooms that pairs of a table lead to from some rooms."""
    reached = np.zeros(len(table), dtype=bool)
    front = np.unique(begin)
    while len(front):
        reached[front] = True
        front = np.nonzero(table[front].any(axis=0) & ~reached)[0]
    return reached


def _table(pairs: Integers, rooms: int) -> Flags:
    table = np.zeros((rooms, rooms), dtype=bool)
    table[pairs[:, 0], pairs[:, 1]] = table[pairs[:, 1], pairs[:, 0]] = True
    return table
