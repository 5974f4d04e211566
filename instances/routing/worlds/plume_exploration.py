"""A plume of grid cells that drifts over a plane, and robots that find out where it is by flying over it."""

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from ...errors import InputError
from ...generators import Draw
from ...text import read_text
from ...worlds import WORLDS, Setting, World, WorldKind, check_robot

Cell = tuple[int, int]

COMPASS: dict[str, Cell] = {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}
"""Directions in the order in which neighbours are looked at."""

TOGETHER = 1e-9
"""Arrivals nearer to each other than this share of the time so far are one event: sums of equal flights in another order differ by less."""


def flight_time(origin: Cell, target: Cell, speed: float, drift: tuple[float, float]) -> float:
    """Time of a straight flight between cell centres of the plume, which drifts meanwhile: the plume is at rest in these coordinates.

    ``speed`` is the robot's, in cells a unit of time, ``drift`` the plume's velocity. Source: Sung (2019), section 4.4.2, where edges
    are bounded; the exact time is that of docs/missions/plume-exploration.md#time-of-a-flight.
    """
    dx, dy = target[0] - origin[0], target[1] - origin[1]
    along, rest = dx * drift[0] + dy * drift[1], speed**2 - drift[0] ** 2 - drift[1] ** 2
    return (along + math.sqrt(along**2 + rest * (dx**2 + dy**2))) / rest


@dataclass(frozen=True, eq=False)
class PlumeObservation:
    """Knowledge of the team, which shares all that it sees.

    ``known`` are the plume cells seen so far, in the order in which they were, each with whether a robot was there. ``robots`` is the cell
    of each robot, or that to which it flies and will come in ``remaining`` (0 at a cell). ``box`` is the smallest rectangle of cells
    around the whole plume (west, south, east, north), which only a lawn mower is told.
    """

    time: int
    home: Cell
    known: Mapping[Cell, bool]
    robots: tuple[Cell, ...]
    remaining: tuple[float, ...]
    speed: float
    drift: tuple[float, float]
    box: tuple[int, int, int, int]

    @property
    def unvisited(self) -> list[Cell]:
        """Cells that were seen, and not visited yet."""
        return [cell for cell, visited in self.known.items() if not visited]


class PlumeWorld(World):
    """Robots fly from cell to cell; at a cell a robot sees which of it and its four neighbours are plume. Cells outside may be flown over.

    A step is an event: robots that are told where to fly leave at once, and time passes until the next arrival. All positions are those
    in the frame of the plume, in which it is at rest.

    ``cells`` are the plume's by column and row, joined by sides; at ``start``, one of them, all ``robots`` begin and end. ``speed`` is
    theirs, in cells a unit of time, and more than that of the plume, whose velocity is ``drift``.

    Raises InputError if the plume is empty or in several parts, the start is outside, or the robots are no faster than the plume. Source:
    Sung (2019), sections 4.3 and 4.4; docs/missions/plume-exploration.md.
    """

    def __init__(self, cells: Sequence[Cell], start: Cell, robots: int, speed: float = 1.0, drift: tuple[float, float] = (0, 0)) -> None:
        self.cells = frozenset(cells)
        if not self.cells:
            raise InputError("the plume has no cell", "missing", expected="one cell at least")
        if start not in self.cells:
            raise InputError("the robots start outside the plume", "out-of-range", expected="a plume cell", found=str(start))
        apart = len(self.cells) - len(_joined(start, self.cells))
        if apart:
            raise InputError(f"{apart} plume cells are not joined to the start by sides: no robot would see them", "contradiction")
        if robots < 1:
            raise InputError("no robot explores the plume", "out-of-range", expected="1 at least", found=str(robots))
        if not speed > math.hypot(*drift) or not math.isfinite(speed):
            message = "robots that are no faster than the plume cannot fly against its drift"
            raise InputError(message, "out-of-range", expected=f"a finite speed above {math.hypot(*drift):g}", found=f"{speed:g}")
        self.start, self.speed, self.drift = start, speed, drift
        self.time, self.clock, self.flown = 0, 0.0, 0.0
        self.robots, self.origins, self.arrivals = [start] * robots, [start] * robots, [0.0] * robots
        columns, rows = zip(*self.cells, strict=True)
        self._box = (min(columns), min(rows), max(columns), max(rows))
        self._known: dict[Cell, bool] = {}
        self._look(start)

    def observe(self) -> PlumeObservation:
        return self._observation

    def step(self, actions: Mapping[int, Cell]) -> None:
        """Robots at a cell leave for the cells that ``actions`` gives; time passes until the next arrival of any."""
        for robot, cell in actions.items():
            self._refuse(robot, cell)
        for robot, cell in actions.items():
            takes = flight_time(self.robots[robot], cell, self.speed, self.drift)
            self.origins[robot], self.robots[robot], self.arrivals[robot] = self.robots[robot], cell, self.clock + takes
            self.flown += takes
        flying = [robot for robot, arrival in enumerate(self.arrivals) if arrival > self.clock]
        self.time += 1
        if flying:
            self.clock = min(self.arrivals[robot] for robot in flying)
            for robot in flying:
                if self.arrivals[robot] <= self.clock * (1.0 + TOGETHER):
                    self.arrivals[robot] = self.clock
                    self._look(self.robots[robot])
        self._observed()

    @property
    def over(self) -> bool:
        """True if all that was seen of the plume is visited, and all robots are back."""
        home = all(cell == self.start for cell in self.robots) and max(self.arrivals) <= self.clock
        return home and all(self._known.values())

    def metrics(self) -> dict[str, float]:
        """``clock``: time so far; ``visited``: plume cells where a robot was; ``flying``: robots under way; ``flown``: time of all flights
        begun so far; ``finished``: 1 once all is visited and all robots are back."""
        return {
            "clock": self.clock, "visited": float(sum(self._known.values())),
            "flying": float(sum(arrival > self.clock for arrival in self.arrivals)), "flown": self.flown, "finished": float(self.over),
        }  # fmt: skip

    def places(self) -> list[tuple[float, float]]:
        """Positions of all robots now, those between two cells included."""
        places_ahead = []
        for a, b, arrival in zip(self.origins, self.robots, self.arrivals, strict=True):
            left = (arrival - self.clock) / flight_time(a, b, self.speed, self.drift) if arrival > self.clock else 0.0
            places_ahead.append((b[0] + left * (a[0] - b[0]), b[1] + left * (a[1] - b[1])))
        return places_ahead

    def _look(self, cell: Cell) -> None:
        if cell in self.cells:
            self._known[cell] = True
        for near in neighbours(cell):
            if near in self.cells:
                self._known.setdefault(near, False)
        self._observed()

    def _observed(self) -> None:
        seconds = tuple(max(arrival - self.clock, 0.0) for arrival in self.arrivals)
        self._observation = PlumeObservation(
            self.time, self.start, MappingProxyType(dict(self._known)), tuple(self.robots), seconds, self.speed, self.drift, self._box
        )

    def _refuse(self, robot: Any, cell: Any) -> None:
        check_robot(robot, len(self.robots))
        if not (isinstance(cell, tuple) and len(cell) == 2 and all(isinstance(k, int | np.integer) for k in cell)):
            raise InputError(f"robot {robot} is told no cell", expected="a column and a row", found=str(cell)[:40])
        if self.arrivals[robot] > self.clock:
            raise InputError(f"robot {robot} is under way", "contradiction", found=f"told to fly to {cell}")


def neighbours(cell: Cell) -> list[Cell]:
    """The cells on its four sides, in the order of ``COMPASS``."""
    return [(cell[0] + dx, cell[1] + dy) for dx, dy in COMPASS.values()]


def _joined(start: Cell, cells: Set[Cell]) -> set[Cell]:
    """The cells that can be reached from ``start`` from side to side, it included."""
    joined, ends = {start}, [start]
    while ends:
        new = (cells & set(neighbours(ends.pop()))) - joined
        joined |= new
        ends += new
    return joined


def serpentine(width: int) -> list[Cell]:
    """``width`` full rows of ``width`` cells on every second row of the grid, joined at their ends in turn; it begins at (0, 0)."""
    rows = [[(x, 2 * row) for x in range(width)][:: -1 if row % 2 else 1] for row in range(width)]
    joints = [(0 if row % 2 else width - 1, 2 * row + 1) for row in range(width - 1)]
    return [cell for row in range(width) for cell in (*rows[row], *joints[row : row + 1])]


def grown(rng: np.random.Generator, count: int) -> list[Cell]:
    """``count`` cells, each drawn evenly from those beside the ones before."""
    cells: dict[Cell, None] = {(0, 0): None}
    border = dict.fromkeys(neighbours((0, 0)))
    while len(cells) < count:
        new = list(border)[Draw(rng).integer(0, len(border) - 1)]
        del border[new]
        cells[new] = None
        border.update((near, None) for near in neighbours(new) if near not in cells)
    return list(cells)


def read_plume(path: str) -> tuple[list[Cell], Cell]:
    """Cells and start of a map: lines of ``#`` (plume), ``.`` (free) and one ``S`` (the start, plume too). Raises InputError."""
    lines = read_text(path).split("\n")
    cells, starts = [], []
    for k, line in enumerate(lines):
        for column, sign in enumerate(line.rstrip()):
            if sign not in "#S. ":
                raise InputError("an unknown sign of a map", "malformed", file=path, line=k + 1, expected="#, . or S", found=repr(sign))
            cells += [(column, -k)] * (sign in "#S")
            starts += [(column, -k)] * (sign == "S")
    if len(starts) != 1:
        raise InputError("the map has no single start", "missing", file=path, expected="one S", found=str(len(starts)))
    return cells, starts[0]


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> PlumeWorld:
    count, pick = values["cells"], int(Draw(rng).integer(0, 3))
    way = COMPASS[values["direction"] if values["direction"] != "random" else list(COMPASS)[pick]]
    side = max(1, round(math.sqrt(count)))
    if values["file"] is not None:
        cells, start = read_plume(values["file"])
    elif values["shape"] == "grown":
        cells = grown(rng, count)
        start = cells[Draw(rng).integer(0, count - 1)]
    else:
        width = max(1, int((math.sqrt(4 * count + 5) - 1) / 2))  # width^2 + width - 1 cells
        square = [(x, y) for y in range(side) for x in range(side)]
        cells = {"square": square, "line": [(x, 0) for x in range(count)], "serpentine": serpentine(width)}[values["shape"]]
        start = (0, 0)
    return PlumeWorld(cells, start, values["robots"], values["speed"], (values["wind"] * way[0], values["wind"] * way[1]))


WORLDS.enter(
    WorldKind(
        "plume-exploration", "a plume of unknown shape drifts, and robots find out where it is by flying over it",
        {
            "robots": Setting(20, "robots", int, 1, 1000),
            "cells": Setting(120, "plume cells: exactly of grown and line, about as many of square and serpentine", int, 1, 10_000),
            "shape": Setting("grown", "of the plume", choices=("grown", "square", "line", "serpentine")),
            "file": Setting(None, "a map of the plume: lines of # (plume), . (free) and one S (the start)", str),
            "speed": Setting(2.5, "of robots, in cells a unit of time", float, 1e-6, 1e6),
            "wind": Setting(1.0, "speed at which the plume drifts, in cells a unit of time; 0: it stays", float, 0.0, 1e6),
            "direction": Setting("random", "in which it drifts", choices=("random", *COMPASS)),
        },
        _make,
    ),
)  # fmt: skip
