"""A grid of cells that are free or occupied and change, and robots with small batteries that keep a map of it up to date."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...errors import InputError
from ...generators import Flags, Floats
from ...worlds import WORLDS, Setting, World, WorldKind, check_robot
from ..occupancy import SIDES, Beams, RangeSensor, divergence, entropy
from ..occupancy_maps import DecayMap, MarkovMap
from ..terrain import EDGE, Terrain, made_terrain, middle_of

Cell = tuple[int, int]

SURE = 0.001
"""Probability of occupied of the cells that are known to be free: section 6.1."""


@dataclass
class Robot:
    """A robot on its way: the cell that it left last, the cells before it, seconds since it left the former, and battery."""

    cell: Cell
    ahead: list[Cell] = field(default_factory=list)
    since: float = 0.0
    aloft: bool = False
    flown: float = 0.0
    ready: float = 0.0
    lost: bool = False


@dataclass(frozen=True)
class RobotState:
    """Knowledge about a robot: it can be told another way from ``cell``, which it reaches ``after`` seconds, having ``flown`` for so long
    then; ``ahead`` is the way that it has been told from there. ``free`` are robots at the base with a full battery."""

    cell: Cell
    after: float
    flown: float
    ahead: tuple[Cell, ...]
    aloft: bool
    free: bool


@dataclass(frozen=True, eq=False)
class MapObservation:
    """Knowledge of the team, which shares one map: ``map`` is it itself, to be read only; ``p`` are its probabilities on the grid."""

    time: int
    clock: float
    base: Cell
    p: Floats
    map: Any
    robots: tuple[RobotState, ...]


class PersistentWorld(World):
    """Robots fly from cell to cell, look with a beam sensor each second, and recharge at the base; a step takes ``tick`` seconds.

    A robot told a way takes off, follows it, and waits in the air at its end; where that is the base it lands. One in the air for longer
    than ``endurance`` is lost. Robots rise above cells that turn out to be occupied, which is counted. Readings of a step are taken
    together into the map, one a cell.

    Raises InputError for a map without free cells, a base outside of it or in an obstacle, and limits that reach nothing. Source: Mitchell
    (2020), sections 3.3, 4.3 and 6.1, in the plane; docs/missions/persistent-exploration.md.
    """

    def __init__(
        self, rng: np.random.Generator, terrain: Terrain, base: Cell, robots: int, beams: Beams, map_: Any, *, tick: float = 10.0,
        speed: float = 2.0, endurance: float = 300.0, charge: float = 0.0,
    ) -> None:  # fmt: skip
        shape = terrain.known.shape
        if not terrain.known.any() or not (terrain.known & ~terrain.occupied).any():
            raise InputError("the map has no cell that is known to be free", "missing", expected="one at least, for the base")
        if not (0 <= base[0] < shape[0] and 0 <= base[1] < shape[1]) or not terrain.known[base] or terrain.occupied[base]:
            raise InputError("the robots' base is outside the map, or in no free cell", "out-of-range", found=str(base))
        if robots < 1 or not endurance >= 2.0 * EDGE / speed:
            message, least = "robots reach no cell beside the base and return", f"1 robot, and {2 * EDGE / speed:g} s of flight"
            raise InputError(message, "out-of-range", expected=least, found=f"{robots}, {endurance:g} s")
        self.terrain, self.base, self.beams, self.map = terrain, base, beams, map_
        self.tick, self.seconds, self.endurance, self.charge = tick, EDGE / speed, endurance, charge
        self.time, self.clock, self.crossed, self.robots = 0, 0.0, 0.0, [Robot(base) for _ in range(robots)]
        self._rng, self._truth = rng, terrain.at(0.0)
        self._pending = np.full(shape, np.nan)
        self.ever = np.zeros(shape, dtype=bool)
        self._observe()

    def observe(self) -> MapObservation:
        return self._observation

    def step(self, actions: Mapping[int, Sequence[Cell]]) -> None:
        """Robots follow the ways that ``actions`` tells, each from the cell that ``RobotState`` names, or those told before."""
        for number, cells in actions.items():
            self._refuse(number, cells)
        for number, cells in actions.items():
            robot = self.robots[number]
            robot.ahead = [*robot.ahead[: robot.since > 0], *cells]
            robot.aloft = robot.aloft or bool(robot.ahead)
        draws = self._rng.random(self._truth.shape)
        seen = np.zeros(self._truth.shape, dtype=bool)
        left = self.tick
        while left > 1e-9:
            part = min(1.0, left)
            left -= part
            self.clock += part
            now = self.terrain.at(self.clock)
            self._pending[(now != self._truth) & np.isnan(self._pending)] = self.clock
            self._truth = now
            aloft = [robot for robot in self.robots if robot.aloft]
            for robot in aloft:
                self._fly(robot, part)
            if aloft:
                _, met, _ = self.beams.passed(now.astype(np.float64), np.array([robot.cell for robot in aloft]))
                seen.ravel()[met] = True
                self.crossed += part * sum(bool(now[robot.cell]) for robot in aloft)
        self.time += 1
        self._pending[seen] = np.nan
        self.ever |= seen
        taken = np.flatnonzero(seen & ~self.terrain.known)
        sensor = self.map.sensor
        self.map.update(taken, draws.ravel()[taken] < np.where(self._truth.ravel()[taken], sensor.hit, sensor.false_hit))
        self._observe()

    def _fly(self, robot: Robot, part: float) -> None:
        robot.flown += part
        robot.since += part if robot.ahead else 0.0
        while robot.ahead and robot.since >= self.seconds * (1.0 - 1e-9):
            robot.since -= self.seconds
            robot.cell = robot.ahead.pop(0)
        if not robot.ahead:
            robot.since = 0.0
            if robot.cell == self.base:
                robot.aloft, robot.flown, robot.ready = False, 0.0, self.clock + self.charge
        if robot.aloft and robot.flown > self.endurance * (1.0 + 1e-9) + 1e-9:
            robot.aloft, robot.lost, robot.ahead = False, True, []

    def metrics(self) -> dict[str, float]:
        """``clock``, s; ``entropy`` and ``divergence`` of the map, bits; ``late``: mean time since a change that nobody saw, percent of the
        period, over the cells that change; ``missed``: those for which it is over 50; ``unobserved``: cells never seen; ``aloft``;
        ``crossed``: seconds of flight above occupied cells; ``lost`` robots."""
        open_ = ~self.terrain.known
        p, truth = self._observation.p[open_], self._truth[open_]
        change = np.isfinite(self.terrain.period)
        waited = 100.0 * np.nan_to_num(self.clock - self._pending[change]) / self.terrain.period[change]
        return {
            "clock": self.clock, "entropy": float(entropy(p).sum()), "divergence": float(divergence(p, truth).sum()),
            "late": float(waited.mean()) if len(waited) else 0.0, "missed": float((waited > 50.0).sum()),
            "unobserved": float((open_ & ~self.ever).sum()), "aloft": float(sum(r.aloft for r in self.robots)),
            "crossed": self.crossed, "lost": float(sum(r.lost for r in self.robots)),
        }  # fmt: skip

    @property
    def truth(self) -> Flags:
        """Cells that are occupied now."""
        return self._truth

    def _observe(self) -> None:
        p = np.where(self.terrain.known, SURE, self.map.p.reshape(self._truth.shape))
        p.setflags(write=False)
        self._observation = MapObservation(self.time, self.clock, self.base, p, self.map, tuple(map(self._state, self.robots)))

    def _state(self, robot: Robot) -> RobotState:
        bound = bool(robot.ahead) and robot.since > 0
        after = self.seconds - robot.since if bound else 0.0
        cell = robot.ahead[0] if bound else robot.cell
        free = not robot.aloft and not robot.lost and robot.ready <= self.clock
        return RobotState(cell, after, robot.flown + after, tuple(robot.ahead[bound:]), robot.aloft, free)

    def _refuse(self, number: Any, cells: Any) -> None:
        check_robot(number, len(self.robots))
        state = self._observation.robots[number]
        if not (state.aloft or state.free):
            raise InputError(
                f"robot {number} is lost, or its battery is not full", "contradiction", found=f"told to fly to {str(cells)[:40]}"
            )
        at, shape = state.cell, self._truth.shape
        for cell in cells:
            near = (cell[0] - at[0], cell[1] - at[1]) in SIDES if isinstance(cell, tuple) and len(cell) == 2 else False
            if not near or not (0 <= cell[0] < shape[0] and 0 <= cell[1] < shape[1]):
                raise InputError(
                    f"robot {number} is told a way with a gap", expected=f"a cell of the map beside {at}", found=str(cell)[:40]
                )
            at = cell


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> PersistentWorld:
    if values["walls"] + values["dynamic"] > 1.0:
        raise InputError("walls and changing blocks are more than all", "out-of-range", expected="shares that sum to at most 1")
    if values["shortest"] > values["longest"]:
        raise InputError("the shortest period is longer than the longest", "contradiction")
    terrain = made_terrain(rng, values)
    sensor = RangeSensor(values["hit"], values["false-hit"])
    prior = np.where(terrain.known, SURE, 0.5).ravel()
    tick = values["tick"]
    if values["model"] == "markov":
        kept = {key: values[key] for key in ("rate", "forgetting", "window", "counted")}
        map_: Any = MarkovMap(prior, sensor, seconds=tick, **kept)
    else:
        kept = {"period": values["period"], "since": values["measured-from"], "surest": values["surest"], "occupied": values["occupied"]}
        map_ = DecayMap(prior, sensor, seconds=tick, free=1.0 - values["occupied"], learning=values["model"] == "decay", **kept)
    beams = Beams.of(values["reach"] / EDGE, values["field"], values["beams"])
    return PersistentWorld(
        rng, terrain, middle_of(values), values["robots"], beams, map_, tick=tick, speed=values["speed"],
        endurance=values["endurance"], charge=values["charge"],
    )  # fmt: skip


WORLDS.enter(
    WorldKind(
        "persistent-exploration", "cells of a map change, and robots with small batteries keep looking at them",
        {
            "rows": Setting(33, "of cells, 2 m wide", int, 3, 100),
            "columns": Setting(33, "of cells", int, 3, 100),
            "lanes": Setting(4, "every so many rows and columns are known to stay free; 0: none are", int, 0, 50),
            "safe": Setting(6.0, "radius around the base in which cells are known to stay free, m", float, 0.0, 1e3),
            "walls": Setting(0.2, "share of the blocks that are occupied", float, 0.0, 1.0),
            "dynamic": Setting(0.4, "share of the blocks that change", float, 0.0, 1.0),
            "shortest": Setting(300.0, "shortest period of a change to and fro, s", float, 1.0, 1e7),
            "longest": Setting(2000.0, "longest period, s", float, 1.0, 1e7),
            "phases": Setting("clustered", "cells of a block change together, or each by itself", choices=("clustered", "independent")),
            "robots": Setting(3, "robots", int, 1, 100),
            "speed": Setting(2.0, "of robots, m/s", float, 1e-3, 1e3),
            "endurance": Setting(300.0, "longest time in the air, s", float, 1e-3, 1e6),
            "charge": Setting(0.0, "time at the base before the next flight, s", float, 0.0, 1e6),
            "reach": Setting(12.0, "of the sensor, m", float, 2.0, 1e3),
            "field": Setting(360.0, "of view around east, degrees", float, 1.0, 360.0),
            "beams": Setting(36, "of the sensor, evenly over its field of view", int, 1, 1000),
            "hit": Setting(0.9, "probability of a hit on an occupied cell", float, 0.0, 1.0),
            "false-hit": Setting(0.05, "probability of a hit on a free cell", float, 0.0, 1.0),
            "tick": Setting(10.0, "time of a step, s", float, 1.0, 1e4),
            "model": Setting("markov", "of cells; static: confidence that does not decay", choices=("markov", "decay", "static")),
            "rate": Setting(0.02, "markov: probability of a change in a step, at the start", float, 0.0, 1.0),
            "forgetting": Setting(0.005, "markov: weight of a step in what is learnt", float, 0.0, 1.0),
            "window": Setting(3000.0, "markov: time in which transitions are counted, s", float, 1.0, 1e7),
            "counted": Setting("observed", "markov: transitions from reading to reading, or one a step", choices=("observed", "believed")),
            "surest": Setting(0.97, "decay: largest probability that a reading leaves", float, 0.5, 1.0),
            "occupied": Setting(0.7, "decay: probability from which a cell is told occupied; free below one less it", float, 0.5, 1.0),
            "period": Setting(300.0, "decay: period of a change at the start, s", float, 1e-3, 1e7),
            "measured-from": Setting("shift", "decay: periods count from the change before, or the reading", choices=("shift", "last")),
        },
        _make,
    ),
)  # fmt: skip
