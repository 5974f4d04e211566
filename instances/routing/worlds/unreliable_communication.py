"""Unknown floors, and robots with small batteries that explore them and hear each other only when they are near."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...generators import Draw, Flags
from ...worlds import WORLDS, Setting, World, WorldKind, check_robot
from ._floors import blocks, read_floor, rooms

OUTSIDE = 1
"""Rows and columns of wall around each map, so that every cell has eight neighbours."""


@dataclass(frozen=True, eq=False)
class CommunicationObservation:
    """Knowledge of the robots. All arrays are read-only, and cells are numbered row by row, ``width`` a row.

    ``seen``, one row per robot, are the cells that its map holds; ``open`` the free cells that it knows of: those, and their free
    neighbours. ``robots`` are the cells where they are, ``battery`` the steps that each can still fly, and ``groups`` the robots that
    are in contact now, over others too.
    """

    time: int
    base: int
    width: int
    robots: tuple[int, ...]
    battery: tuple[int, ...]
    seen: Flags
    open: Flags
    groups: tuple[tuple[int, ...], ...]


class CommunicationWorld(World):
    """In a step each robot flies to a neighbouring cell, hovers, or rests on the ground, which costs no energy; then it looks around.

    Robots in contact merge their maps; one at the base leaves its map there. A link holds within ``reach`` cells where no wall lies
    between (unless ``through`` walls), and fails in a step with probability ``loss``.

    ``free`` are the cells of the floor, ``base`` one of them, where all robots begin; those that cannot be reached from it count as walls.
    ``patience`` is the number of steps without any flight after which it is over.

    Raises InputError if the base is no free cell, or a number is out of range.

    Source: Skeele (2016), sections 4.2 and 4.4; docs/missions/unreliable-communication.md.
    """

    def __init__(
        self, free: Flags, base: tuple[int, int], robots: int, battery: int, sight: float = 5.0, reach: float = 10.0, loss: float = 0.0,
        through: bool = False, rng: np.random.Generator | None = None,
    ) -> None:  # fmt: skip
        from scipy.ndimage import label

        floor = np.pad(np.asarray(free, dtype=bool), OUTSIDE)
        if not floor.any():
            raise InputError("the map has no free cell", "missing", expected="one cell at least")
        if not (0 <= base[0] < free.shape[0] and 0 <= base[1] < free.shape[1] and free[base]):
            raise InputError("the base is no free cell of the map", "out-of-range", expected="row and column of one", found=str(base))
        if robots < 1 or battery < 2:
            message = "no robot can leave the base and return"
            raise InputError(message, "out-of-range", expected="1 robot and 2 steps at least", found=f"{robots} and {battery}")
        if not (0 <= sight < math.inf and reach >= 0 and 0 <= loss <= 1):
            message, found = "robots cannot see or hear like this", f"sight {sight:g}, reach {reach:g}, loss {loss:g}"
            raise InputError(message, "out-of-range", expected="no negative range, and a loss from 0 to 1", found=found)
        self.shape, at = floor.shape, (base[0] + OUTSIDE, base[1] + OUTSIDE)
        parts = label(floor)[0]
        self.free: Flags = (parts == parts[at]).ravel()
        self.base, self.width, self.time, self.patience, self.rested = int(np.ravel_multi_index(at, floor.shape)), floor.shape[1], 0, 0, 0
        self.robots, self.battery = [self.base] * robots, [battery] * robots
        self.sight, self.reach, self.loss, self.through = sight, reach, loss, through
        self._rng = rng or np.random.default_rng(0)
        self._disc = _lines(sight, self.width)
        self._views: dict[int, NDArray[np.int64]] = {}
        self._seen = np.zeros((robots, self.free.size), dtype=bool)
        self.returned: Flags = np.zeros(self.free.size, dtype=bool)
        self._look()

    def observe(self) -> CommunicationObservation:
        return self._observation

    def step(self, actions: Mapping[int, int]) -> None:
        """Robots fly to the cells that ``actions`` gives, their own to hover; the others rest on the ground."""
        for robot, cell in actions.items():
            self._refuse(robot, cell)
        for robot, cell in actions.items():
            self.robots[robot] = int(cell)
            self.battery[robot] -= 1
        self.rested = 0 if actions else self.rested + 1
        self.time += 1
        self._look()

    @property
    def over(self) -> bool:
        """True if nobody has flown for longer than ``patience`` allows."""
        return self.rested > self.patience

    def metrics(self) -> dict[str, float]:
        """``returned``: percent of the floor whose map is at the base; ``explored``: percent that any robot has seen; ``energy``: steps
        that all batteries still hold; ``groups``: parts of the team without contact to each other; ``flying``: robots with energy."""
        share = 100.0 / float(self.free.sum())
        return {
            "returned": share * float(self.returned.sum()), "explored": share * float(self._seen.any(axis=0).sum()),
            "energy": float(sum(self.battery)), "groups": float(len(self._observation.groups)),
            "flying": float(sum(left > 0 for left in self.battery)),
        }  # fmt: skip

    def visible(self, cell: int) -> NDArray[np.int64]:
        """Cells that a robot at ``cell`` sees."""
        if cell not in self._views:
            lines, ends = self._disc
            clear = self.free.take(cell + lines, mode="wrap").all(axis=1)
            self._views[cell] = np.concatenate([[cell], cell + ends[clear]])
        return self._views[cell]

    def linked(self, a: int, b: int) -> bool:
        """Whether robots at these cells hear each other, but for losses."""
        (y, x), (v, u) = divmod(min(a, b), self.width), divmod(max(a, b), self.width)
        if math.hypot(u - x, v - y) > self.reach:
            return False
        return self.through or bool(self.free[_line(u - x, v - y, self.width) + min(a, b)].all())

    def _look(self) -> None:
        for robot, cell in enumerate(self.robots):
            self._seen[robot, self.visible(cell)] = True
        count = len(self.robots)
        lost = self._rng.random((count, count)) < self.loss if self.loss else np.zeros((count, count), dtype=bool)
        group = list(range(count))
        for a in range(count):
            for b in range(a + 1, count):
                if group[a] != group[b] and not lost[a, b] and self.linked(self.robots[a], self.robots[b]):
                    group = [group[a] if one == group[b] else one for one in group]
        groups = tuple(tuple(k for k in range(count) if group[k] == one) for one in dict.fromkeys(group))
        for members in groups:
            if len(members) > 1:
                self._seen[list(members)] = self._seen[list(members)].any(axis=0)
            if any(self.robots[k] == self.base for k in members):
                at = [k for k in members if self.robots[k] == self.base]
                self.returned |= self._seen[at[0]]
        seen = self._seen.copy()
        near = seen.copy()
        for step in (1, -1, self.width, -self.width):
            near |= np.roll(seen, step, axis=1)
        known = near & self.free
        for array in (seen, known):
            array.flags.writeable = False
        self._observation = CommunicationObservation(
            self.time, self.base, self.width, tuple(self.robots), tuple(self.battery), seen, known, groups
        )

    def _refuse(self, robot: Any, cell: Any) -> None:
        check_robot(robot, len(self.robots))
        if not isinstance(cell, int | np.integer) or abs(int(cell) - self.robots[robot]) not in (0, 1, self.width) or not self.free[cell]:
            message = f"robot {robot} cannot fly there"
            raise InputError(message, "contradiction", expected="its own cell or a free one beside it", found=str(cell)[:40])
        if not self.battery[robot]:
            raise InputError(f"the battery of robot {robot} is empty", "contradiction", found=f"told to fly to {cell}")


def _line(dx: int, dy: int, width: int) -> NDArray[np.int64]:
    """Offsets of the cells on the straight line to an offset, both ends included."""
    count = max(abs(dx), abs(dy), 1)
    k = np.arange(count + 1)
    return (k * dy * 2 + count) // (2 * count) * width + (k * dx * 2 + count) // (2 * count)


def _lines(radius: float, width: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Lines to all offsets within ``radius``, filled up with their starts to equal lengths, and the offsets."""
    most = int(radius)
    ends = [(x, y) for y in range(-most, most + 1) for x in range(-most, most + 1) if (x or y) and math.hypot(x, y) <= radius]
    lines = np.zeros((len(ends), most + 1), dtype=np.int64)
    for row, (x, y) in zip(lines, ends, strict=True):
        line = _line(x, y, width)
        row[: len(line)] = line
    return lines, np.array([y * width + x for x, y in ends], dtype=np.int64)


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> CommunicationWorld:
    from scipy.ndimage import label

    height, width = values["height"], values["width"]
    if values["file"] is not None:
        free, base = read_floor(values["file"])
    elif values["map"] == "corridor":
        free, base = np.ones((1, width), dtype=bool), (0, 0)
    else:
        free = rooms(rng, height, width, values["doors"], values["room"]) if values["map"] == "rooms" else blocks(rng, height, width)
        if not free.any():
            raise InputError("the map has no free cell", "missing", expected="a larger one")
        parts = label(free)[0]
        cells = np.argwhere(parts == np.bincount(parts[free]).argmax())
        base = tuple(cells[Draw(rng).integer(0, len(cells) - 1)].tolist())
    return CommunicationWorld(
        free, base, values["robots"], values["battery"], values["sight"], values["reach"], values["loss"], values["through"], rng
    )


WORLDS.enter(
    WorldKind(
        "unreliable-communication", "robots explore an unknown floor, and hear each other only when they are near",
        {
            "robots": Setting(4, "robots", int, 1, 100),
            "battery": Setting(150, "steps that each can fly", int, 2, 1_000_000),
            "map": Setting("rooms", "what the floor is like", choices=("rooms", "blocks", "corridor")),
            "width": Setting(120, "cells in a row", int, 1, 1000),
            "height": Setting(40, "rows; a corridor has one", int, 1, 1000),
            "room": Setting(10, "cells from one wall of a room to the next; 2 makes a maze", int, 2, 1000),
            "doors": Setting(0.3, "probability of a door between two rooms that are joined without it", float, 0.0, 1.0),
            "file": Setting(None, "a map: lines of # (wall), . (free) and one B (the base)", str),
            "sight": Setting(5.0, "cells that a robot sees around it, up to walls; 0: the one where it is", float, 0.0, 100.0),
            "reach": Setting(10.0, "cells over which robots hear each other", float, 0.0, 10_000.0),
            "through": Setting(False, "whether they do through walls", bool),
            "loss": Setting(0.0, "probability that a link fails in a step", float, 0.0, 1.0),
        },
        _make,
    ),
)  # fmt: skip
