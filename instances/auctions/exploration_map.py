"""Rooms that robots explore, map and search, and from where they are heard."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import number_arrays as arrays
from ..errors import InputError
from ..instance import digest
from ..text import label
from .assignment import LARGEST

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

PROBLEMS = ("room-exploration",)
"""What may be asked of such data."""

GAINS = ("exploring", "mapping", "searching")
"""What is gained by entering a room, by observing its type, and by looking for a target in it."""

SHOWN = 5
"""Rooms that a message lists."""

MOST_STEPS = 1000


@dataclass(frozen=True, eq=False)
class ExplorationMap:
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

    kind: ClassVar[str] = "exploration-map"
    doors: Integers
    exploring: Floats
    mapping: Floats
    searching: Floats
    starts: Integers
    base: int
    heard: Integers
    silence: int
    steps: int
    room_names: tuple[str, ...] | None = None
    positions: Floats | None = None
    name: str = "exploration-map"
    format: str = "arrays"
    problem: str = PROBLEMS[0]
    problems: tuple[str, ...] = PROBLEMS
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "name", label(self.name))
        gains = [_gains(key, getattr(self, key)) for key in GAINS]
        rooms = len(gains[0])
        if not rooms:
            raise InputError("there are no rooms", expected="one at least")
        for key, made in zip(GAINS, gains, strict=True):
            if len(made) != rooms:
                raise InputError(f"{key} must have one row a room", expected=str(rooms), found=str(len(made)))
            put(self, key, arrays.frozen(made))
        for key in ("doors", "heard"):
            put(self, key, arrays.frozen(_pairs(key, getattr(self, key), rooms)))
        starts = arrays.whole_numbers("starts", self.starts)
        if not len(starts):
            raise InputError("there are no robots", expected="one at least")
        arrays.refuse_outside("the start of robot {}", starts, rooms, "room")
        put(self, "starts", arrays.frozen(starts))
        for key, least, most in (("base", 0, rooms - 1), ("silence", 0, MOST_STEPS), ("steps", 1, MOST_STEPS)):
            value = getattr(self, key)
            if isinstance(value, bool) or not isinstance(value, int | np.integer) or not least <= value <= most:
                raise InputError(f"{key} must be a whole number from {least} to {most}", found=str(value)[:40])
            put(self, key, int(value))
        put(self, "room_names", arrays.names("room", self.room_names, rooms))
        put(self, "positions", arrays.positions("room", self.positions, rooms, self.room_names))
        self._refuse_walls()

    def _refuse_walls(self) -> None:
        """Raise InputError where no robot can enter a room, or one can never be heard."""
        doors = self.adjacent
        alone = np.nonzero(~_reached(doors, self.starts))[0].tolist()
        if alone:
            told = ", ".join(map(self.room_name, alone[:SHOWN])) + ", ..." * (len(alone) > SHOWN)
            raise InputError(
                f"no doors lead from a robot to {len(alone)} of the {self.num_rooms} rooms: {told}", expected="doors to every room"
            )
        heard = np.nonzero(_reached(self.linked, np.array([self.base])))[0]
        lost = np.nonzero(~_reached(doors, heard)[self.starts])[0]
        if len(lost):
            raise InputError(f"robot {lost[0] + 1} can enter no room from which links lead to the base", expected="doors or links to it")

    # -- lookups -----------------------------------------------------------------------------------------------------

    @property
    def num_rooms(self) -> int:
        return len(self.exploring)

    @property
    def num_robots(self) -> int:
        return len(self.starts)

    @property
    def adjacent(self) -> Flags:
        """Whether one step leads from a room to another; shape (rooms, rooms)."""
        return _table(self.doors, self.num_rooms)

    @property
    def linked(self) -> Flags:
        """Whether two rooms hear each other, themselves included; shape (rooms, rooms)."""
        return np.asarray(_table(self.heard, self.num_rooms) | np.eye(self.num_rooms, dtype=bool))

    def room_name(self, room: int) -> str:
        return str(room + 1) if self.room_names is None else self.room_names[room]

    def digest(self) -> str:
        """Hash of everything that values depend on; names and positions are not part of it."""
        return digest(
            "exploration-map", self.adjacent, self.exploring, self.mapping, self.searching, self.starts, self.base, self.linked,
            self.silence, self.steps,
        )  # fmt: skip

    def facts(self) -> dict[str, Any]:
        """Sizes, as plain JSON values."""
        return {
            "rooms": self.num_rooms, "doors": len(self.doors), "robots": self.num_robots, "steps": self.steps, "silence": self.silence,
            "heard_at_base": int(self.linked[self.base].sum()),
            **{key: float(getattr(self, key)[:, :1].sum()) for key in GAINS},
        }  # fmt: skip

    def __repr__(self) -> str:
        return f"<ExplorationMap {self.name}: {self.num_rooms} rooms, {self.num_robots} robots, {self.steps} steps>"


def _gains(key: str, given: ArrayLike) -> Floats:
    try:
        made = np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{key} must be a matrix of numbers, all rows of one length") from None
    if made.ndim != 2:
        raise InputError(f"{key} must be a matrix, one row a room", found=f"shape {made.shape}")
    rising = np.diff(made, axis=1, prepend=LARGEST) > 0
    wrong = ~((made >= 0) & (made <= LARGEST)) | rising
    if wrong.any():
        room, time = np.argwhere(wrong)[0].tolist()
        raise InputError(
            f"{key} of room {room + 1}, time {time + 1} must be at least 0, and no more than the time before", found=str(made[room, time])
        )
    return made


def _pairs(key: str, given: ArrayLike, rooms: int) -> Integers:
    made = arrays.whole_numbers(key, np.asarray(given).ravel()).reshape(-1, 2) if np.size(given) else np.zeros((0, 2), np.int64)
    arrays.refuse_outside(f"a room of {key}, entry {{}}", made.ravel(), rooms, "room")
    if (made[:, 0] == made[:, 1]).any():
        raise InputError(f"{key} must join two different rooms", found=f"room {made[made[:, 0] == made[:, 1]][0, 0]} twice")
    return made


def _reached(table: Flags, begin: Integers) -> Flags:
    """Rooms that pairs of a table lead to from some rooms."""
    found = np.zeros(len(table), dtype=bool)
    front = np.unique(begin)
    while len(front):
        found[front] = True
        front = np.nonzero(table[front].any(axis=0) & ~found)[0]
    return found


def _table(pairs: Integers, rooms: int) -> Flags:
    made = np.zeros((rooms, rooms), dtype=bool)
    made[pairs[:, 0], pairs[:, 1]] = made[pairs[:, 1], pairs[:, 0]] = True
    return made
