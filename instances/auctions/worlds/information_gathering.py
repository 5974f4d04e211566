"""Sensors that fill up where they stand, and robots that empty them and bring what they take to their bases."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...errors import InputError, UsageError
from ...generators import Draw, Floats, Integers
from ...worlds import WORLDS, Setting, World, WorldKind

EXCESS = 1e-9
"""Relative rounding error by which an amount may exceed the amount that is there."""


class Move(NamedTuple):
    """The cell, row and column, where a robot is next (its own, or one of the eight around it), and the units that it takes there at
    most."""

    cell: tuple[int, int]
    amount: float = 0.0


@dataclass(frozen=True)
class GatheringRules:
    """Sizes, rates and limits, which do not change while sensors gather.

    Each sensor's rate, units a step, is drawn from 1 to ``rates``. A sensor with a full ``store`` gathers nothing, and one that has taken
    all units of its ``cell`` goes to another. ``load`` is the units that a robot can carry.
    """

    rows: int
    columns: int
    sensors: int
    robots: int
    rates: int = 5
    store: float = 100.0
    load: float = 100.0
    cell: float = 200.0

    def __post_init__(self) -> None:
        if self.sensors > self.rows * self.columns:
            raise UsageError(f"{self.sensors} sensors do not fit into {self.rows * self.columns} cells")

    @property
    def bases(self) -> Integers:
        """Row and column of each robot's base: the upper left, lower right, upper right and lower left corners and the centre, in turn."""
        low, right = self.rows - 1, self.columns - 1
        places = [(0, 0), (low, right), (0, right), (low, 0), (low // 2, right // 2)]
        return np.array([places[robot % len(places)] for robot in range(self.robots)])


@dataclass(frozen=True, eq=False)
class GatheringObservation:
    """State of robots and sensors at one time, known to all.

    ``robots`` and ``sensors`` hold row and column of each, shape (k, 2); ``loads`` of robots and ``stores`` of sensors are in units,
    ``rates`` in units a step, 0 for a sensor that found no cell with anything left.
    """

    time: int
    rules: GatheringRules
    robots: Integers
    loads: Floats
    sensors: Integers
    stores: Floats
    rates: Floats


class GatheringWorld(World):
    """In a step sensors gather; then robots move, unload at their bases, and take from the sensor of their cell.

    ``places``, shape (sensors, 2), and ``rates`` of the sensors are drawn unless they are given.

    ``brought``, shape (robots,), units: unloaded by each robot at its base. ``lost``, shape (sensors,), units: what each sensor would have
    gathered with room in its store. ``cut``, units: shortfall of the last steps in exhausted cells. ``due``, units: rates of all sensors
    that stood in a cell, over all steps: always what was brought, loads, stores, ``lost`` and ``cut`` together.

    The cells that a sensor goes to are an order drawn for it at the start: the first with anything left and no other sensor. Its store goes
    with it. Source: Zhang (2015), section 4.3; what it leaves open: docs/missions.md#information-gathering.
    """

    def __init__(
        self, rules: GatheringRules, rng: np.random.Generator, *, places: ArrayLike | None = None, rates: ArrayLike | None = None
    ) -> None:
        self.rules, self.time = rules, 0
        draw, cells = Draw(rng), rules.rows * rules.columns
        drawn = draw.permutation(cells)[: rules.sensors]
        self.rates = draw.integers(1, rules.rates, rules.sensors).astype(np.float64)
        self._orders = [draw.permutation(cells) for _ in range(rules.sensors)]
        self.places = np.column_stack(np.divmod(drawn, rules.columns))
        if places is not None:
            self.places = self._within(np.asarray(places, dtype=np.int64), rules.sensors)
        if rates is not None:
            self.rates = np.array(rates, dtype=np.float64)
            if self.rates.shape != (rules.sensors,) or not (np.isfinite(self.rates) & (self.rates > 0)).all():
                raise InputError("there must be one rate above 0 a sensor", found=str(self.rates.tolist())[:80])
        self.left = np.full((rules.rows, rules.columns), float(rules.cell))
        self.stores, self.lost = np.zeros(rules.sensors), np.zeros(rules.sensors)
        self.robots, self.loads, self.brought = rules.bases.copy(), np.zeros(rules.robots), np.zeros(rules.robots)
        self.cut = self.due = 0.0
        self.gathering = np.ones(rules.sensors, dtype=bool)
        self._observation = self._look()

    def _within(self, places: Integers, count: int) -> Integers:
        if places.shape != (count, 2) or (places < 0).any() or (places >= [self.rules.rows, self.rules.columns]).any():
            raise InputError(f"there must be {count} cells of the grid", found=str(places.tolist())[:80])
        if len(np.unique(places, axis=0)) < count:
            raise InputError("two sensors stand in one cell", "duplicate")
        return places.copy()

    def observe(self) -> GatheringObservation:
        return self._observation

    @property
    def gain(self) -> float:
        """Units at the bases."""
        return float(self.brought.sum())

    def step(self, actions: Mapping[int, Move]) -> None:
        """Let sensors gather, and each robot do what ``actions`` says for its number; the others stay where they are."""
        moves = self._checked(actions)
        self._gather()
        for robot, (cell, amount) in moves.items():
            self.robots[robot] = cell
            if (self.robots[robot] == self.rules.bases[robot]).all():
                self.brought[robot] += self.loads[robot]
                self.loads[robot] = 0.0
            here = np.nonzero((self.places == self.robots[robot]).all(axis=1))[0]
            for sensor in here.tolist():
                taken = min(amount, self.stores[sensor], self.rules.load - self.loads[robot])
                self.stores[sensor] -= taken
                self.loads[robot] += taken
                amount -= taken
        self.time += 1
        self._observation = self._look()

    def metrics(self) -> dict[str, float]:
        """``working``: sensors that are not full, and have something to gather; ``gain``: units at the bases; ``idle``: steps for which
        full sensors have gathered nothing, all together (tau); ``loss``: units that they would have gathered then (Gamma); ``carried`` by
        robots and ``stored`` by sensors now, units."""
        full = self.stores >= self.rules.store * (1 - EXCESS)
        return {
            "working": float((self.gathering & ~full).sum()),
            "gain": self.gain, "idle": float((self.lost / self.rates).sum()), "loss": float(self.lost.sum()),
            "carried": float(self.loads.sum()), "stored": float(self.stores.sum()),
        }  # fmt: skip

    def _checked(self, actions: Mapping[int, Move]) -> dict[int, tuple[tuple[int, int], float]]:
        moves = {}
        for robot in sorted(actions):
            if not 0 <= robot < self.rules.robots:
                raise InputError(f"there is no robot number {robot}", "unknown-name", expected=f"0 to {self.rules.robots - 1}")
            try:
                (row, column), amount = actions[robot]
                cell, much = (int(row), int(column)), float(amount)
            except (TypeError, ValueError):
                raise InputError(
                    f"robot number {robot} must be told a move", expected="((row, column), amount)", found=str(actions[robot])[:80]
                ) from None
            if not (0 <= cell[0] < self.rules.rows and 0 <= cell[1] < self.rules.columns):
                raise InputError(f"robot number {robot} must stay inside", "out-of-range", found=str(cell))
            if max(abs(cell[0] - self.robots[robot][0]), abs(cell[1] - self.robots[robot][1])) > 1:
                raise InputError(f"robot number {robot} moves to one of the eight cells around it at most", "out-of-range", found=str(cell))
            if not 0.0 <= much < np.inf:
                raise InputError(f"robot number {robot} takes a finite amount from 0 on", "out-of-range", found=str(amount)[:40])
            moves[robot] = (cell, much)
        return moves

    def _gather(self) -> None:
        for sensor in np.nonzero(self.gathering)[0].tolist():
            rate, cell = self.rates[sensor], tuple(self.places[sensor].tolist())
            room = self.rules.store - self.stores[sensor]
            taken = min(rate, room, self.left[cell])
            self.stores[sensor] += taken
            self.left[cell] -= taken
            self.due += rate
            if taken < rate:
                if room <= self.left[cell] + taken:
                    self.lost[sensor] += rate - taken
                else:
                    self.cut += rate - taken
            if self.left[cell] <= EXCESS * self.rules.cell:
                self._relocate(sensor)

    def _relocate(self, sensor: int) -> None:
        order = self._orders[sensor]
        taken = self.places[:, 0] * self.rules.columns + self.places[:, 1]
        free = (self.left.ravel()[order] > EXCESS * self.rules.cell) & ~np.isin(order, taken)
        if free.any():
            self.places[sensor] = divmod(int(order[np.argmax(free)]), self.rules.columns)
        else:
            self.gathering[sensor] = False

    def _look(self) -> GatheringObservation:
        return GatheringObservation(
            self.time, self.rules, self.robots.copy(), self.loads.copy(), self.places.copy(), self.stores.copy(),
            np.where(self.gathering, self.rates, 0.0),
        )  # fmt: skip


GATHERING: Mapping[str, Setting] = {
    "rows": Setting(20, "of the grid", int, 1, 200),
    "columns": Setting(20, "of the grid", int, 1, 200),
    "sensors": Setting(10, "waypoints that gather", int, 1, 1000),
    "robots": Setting(2, "number of robots, each with a base", int, 1, 100),
    "rates": Setting(5, "the largest rate of a sensor, units a step; the least is 1", int, 1, 1000),
    "store": Setting(100.0, "of a sensor, units", float, 1.0, 1e6),
    "load": Setting(100.0, "of a robot, units", float, 1.0, 1e6),
    "cell": Setting(200.0, "that a cell holds, units", float, 1.0, 1e6),
}


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> GatheringWorld:
    return GatheringWorld(GatheringRules(**values), rng)


WORLDS.enter(
    WorldKind("information-gathering", "robots empty sensors that fill up, and bring what they take to their bases", GATHERING, _make),
)
