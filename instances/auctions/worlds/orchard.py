"""Robots that bring empty bins to groups of pickers and full ones home."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError
from ...generators import Draw, Flags, Floats, Integers
from ...worlds import WORLDS, World, WorldKind
from ..orchard_rules import NONE, ORCHARD, OrchardRules, OrchardStart, Trip, checked_start, draw_start, orchard_rules

IDLE, DELIVERING, FETCHING, WAITING, HAULING, RETURNING = range(6)
"""States of a robot: idle; on its way with a new bin; to its bin; at its bin, which is not full; home with it; home without one."""


@dataclass(frozen=True, eq=False)
class OrchardObservation:
    """State of robots, bins and groups at one time, known to all: communication is complete.

    ``robots`` are the numbers of the idle robots, ascending, and ``cells`` where they are. ``bins`` are the numbers, ascending, of the bins
    in the orchard that no robot fetches, ``bin_cells`` where they stand, and ``remaining`` the steps until each is full if nobody waits for
    anything. ``wanting``, a flag for each cell of the grid, is true where a new bin may be brought: a group stands there, fruit remains
    beyond the bin that it fills, and no empty bin stands there or is on its way. ``requests`` are the cells of the groups without a bin to
    which none is on its way, the earliest request first. ``homecoming`` is the step at which each robot would be back at the repository
    from its present trip, at the earliest.
    """

    time: int
    rules: OrchardRules
    robots: Integers
    cells: Integers
    bins: Integers
    bin_cells: Integers
    remaining: Integers
    wanting: Flags
    requests: Integers
    homecoming: Integers


class OrchardWorld(World):
    """A day: groups fill bins, robots bring new ones and fetch full ones. The start is drawn unless it is given.

    ``stood``, ``full``, ``returned``, shape (bins,): steps at which each bin was put up in the orchard, was full and came home; -1 before.
    ``idle_steps``: steps for which groups have waited for bins, all groups together.

    In a step robots whose legs end arrive, idle ones decide, and groups work until the next one. Bins are numbered as they leave the
    repository; those that stand there at the start by groups. Source: Zhang (2015), chapter 3; what it leaves open:
    docs/missions.md#orchard.
    """

    def __init__(self, rules: OrchardRules, rng: np.random.Generator, *, start: OrchardStart | None = None) -> None:
        self.rules, self.time = rules, 0
        grid, drawn = rules.grid, draw_start(rules, Draw(rng))
        self.start = drawn if start is None else checked_start(rules, start)
        self.fruit = np.zeros(grid.size, np.int64)
        self.fruit[grid.harvested] = rules.bins_per_cell
        self.group_cells, self.group_bins = self.start.cells.copy(), np.arange(rules.groups)
        self.progress, self.since = np.zeros(rules.groups, np.int64), np.zeros(rules.groups, np.int64)
        self.idle_steps, self.made = 0, rules.groups
        self.on_way = np.zeros(grid.size, bool)  # cells to which a new bin is brought
        self.spare = np.full(grid.size, NONE)  # a new bin in reserve beside the one that is filled
        self.bin_cells, self.stood, self.full, self.returned, self.taker = (np.full(rules.bins, NONE) for _ in range(5))
        self.bin_cells[: rules.groups], self.stood[: rules.groups] = self.start.cells, 0
        self.states, self.carried = np.full(rules.robots, IDLE), np.full(rules.robots, NONE)
        self.fetched = np.full(rules.robots, NONE)
        self.origins, self.goals = np.full(rules.robots, grid.home), np.full(rules.robots, grid.home)
        self.left, self.until = np.zeros(rules.robots, np.int64), np.zeros(rules.robots, np.int64)
        self._observation = self._look()

    def observe(self) -> OrchardObservation:
        return self._observation

    def step(self, actions: Mapping[int, Trip]) -> None:
        """Send each robot on the trip that ``actions`` gives for its number; an idle robot not named stays."""
        self._check(actions)
        for robot in sorted(actions):
            self._send(robot, Trip(*actions[robot]))
        self._arrive()  # legs of no length: a full bin at hand
        self._work()
        self.time += 1
        self._arrive()
        self._observation = self._look()

    def metrics(self) -> dict[str, float]:
        """``returned``: bins at the repository; ``standing``: in the orchard; ``waiting_groups``: without a bin, fruit before them;
        ``idle_worker_steps``: steps for which pickers have waited so far, all together; ``finished``: the step at which the last bin came
        home, NaN before."""
        home = int((self.returned >= 0).sum())
        return {
            "returned": float(home), "standing": float(((self.stood >= 0) & (self.returned < 0)).sum() - (self.states == HAULING).sum()),
            "waiting_groups": float(((self.group_cells >= 0) & (self.group_bins < 0)).sum()),
            "idle_worker_steps": float(self.idle_steps * self.rules.pickers),
            "finished": float(self.returned.max()) if self.over else np.nan,
        }  # fmt: skip

    @property
    def over(self) -> bool:
        """True if all bins are home."""
        return bool((self.returned >= 0).all())

    def positions(self) -> Floats:
        """Row and column of each robot now, shape (robots, 2)."""
        grid = self.rules.grid
        places = []
        for start, end, left, until in zip(self.origins, self.goals, self.left, self.until, strict=True):
            share = 1.0 if until <= left else min(1.0, (self.time - left) / (until - left))
            places.append(grid.along(start, end, share * grid.distances[start, end]))
        return np.array(places)

    # -- robots ----------------------------------------------------------------------------------------------------------

    def _check(self, actions: Mapping[int, Trip]) -> None:
        cells: set[int] = set()
        bins: set[int] = set()
        o = self._observation
        for robot, trip in actions.items():
            if not 0 <= robot < self.rules.robots:
                raise InputError(f"there is no robot number {robot}", "unknown-name", expected=f"0 to {self.rules.robots - 1}")
            if self.states[robot] != IDLE:
                raise InputError(f"robot number {robot} has not finished its trip", "contradiction")
            try:
                deliver, fetch = (int(part) for part in trip)
            except (TypeError, ValueError):
                raise InputError(f"robot number {robot} must be told a trip", expected="(cell, bin)", found=str(trip)[:80]) from None
            if deliver != NONE:
                if self.goals[robot] != self.rules.grid.home:
                    raise InputError(f"robot number {robot} is not at the repository, where new bins are", "contradiction")
                if not 0 <= deliver < self.rules.grid.size or not o.wanting[deliver] or deliver in cells:
                    raise InputError(f"no new bin may be brought to cell number {deliver} by robot number {robot}", "contradiction")
                cells.add(deliver)
            if fetch != NONE:
                if fetch not in o.bins or fetch in bins:
                    raise InputError(
                        f"robot number {robot} cannot fetch bin number {fetch}: it does not stand free in the orchard", "contradiction"
                    )
                bins.add(fetch)

    def _send(self, robot: int, trip: Trip) -> None:
        self.fetched[robot] = trip.fetch
        if trip.fetch != NONE:
            self.taker[trip.fetch] = robot
        if trip.deliver != NONE:
            self.on_way[trip.deliver] = True
            self.carried[robot], self.bin_cells[self.made] = self.made, trip.deliver
            self.made += 1
            self._leave(robot, DELIVERING, trip.deliver)
        elif trip.fetch != NONE:
            self._leave(robot, FETCHING, int(self.bin_cells[trip.fetch]))
        elif self.goals[robot] != self.rules.grid.home:
            self._leave(robot, RETURNING, self.rules.grid.home)

    def _leave(self, robot: int, state: int, cell: int) -> None:
        here = self.goals[robot]
        times = self.rules.grid.full_times if state == HAULING else self.rules.grid.empty_times
        self.states[robot], self.origins[robot], self.goals[robot] = state, here, cell
        self.left[robot], self.until[robot] = self.time, self.time + times[here, cell]

    def _arrive(self) -> None:
        for robot in range(self.rules.robots):
            while self.states[robot] != IDLE and self.until[robot] <= self.time and self._go_on(robot):
                pass

    def _go_on(self, robot: int) -> bool:
        """Begin the next leg of a robot at the end of its leg; False if it has to wait."""
        state, target = self.states[robot], int(self.fetched[robot])
        if state == DELIVERING:
            self._put_up(int(self.carried[robot]))
            self.carried[robot] = NONE
            if target == NONE:
                self.states[robot] = IDLE
            else:
                self._leave(robot, FETCHING, int(self.bin_cells[target]))
        elif state == FETCHING:
            self.states[robot] = WAITING
        elif state == WAITING:
            if self.full[target] < 0:
                return False
            self._leave(robot, HAULING, self.rules.grid.home)
        else:
            if state == HAULING:
                self.returned[target] = self.time
            self.states[robot] = IDLE
        return True

    # -- groups ----------------------------------------------------------------------------------------------------------

    def _put_up(self, new: int) -> None:
        cell = int(self.bin_cells[new])
        self.stood[new], self.on_way[cell] = self.time, False
        group = int(np.nonzero(self.group_cells == cell)[0][0])
        if self.group_bins[group] < 0:
            self.group_bins[group] = new
        else:
            self.spare[cell] = new

    def _work(self) -> None:
        for group in range(self.rules.groups):
            cell, filled = int(self.group_cells[group]), int(self.group_bins[group])
            if cell < 0:
                continue
            if filled < 0:
                self.idle_steps += 1
                continue
            self.progress[group] += 1
            if self.progress[group] < self.rules.fill:
                continue
            self.full[filled], self.progress[group] = self.time + 1, 0
            self.fruit[cell] -= 1
            self.since[group], self.group_bins[group], self.spare[cell] = self.time + 1, self.spare[cell], NONE
            if self.fruit[cell] == 0:
                self.group_cells[group] = self._next_cell(group)

    def _next_cell(self, group: int) -> int:
        here, orders = self.group_cells[group], self.start.orders
        if orders.shape[1]:
            candidates = orders[group][orders[group] >= 0]
        else:
            candidates = np.argsort(self.rules.grid.distances[here], kind="stable")
        free = (self.fruit[candidates] > 0) & ~np.isin(candidates, self.group_cells)
        return int(candidates[np.argmax(free)]) if free.any() else NONE

    def _look(self) -> OrchardObservation:
        grid = self.rules.grid
        idle = np.nonzero(self.states == IDLE)[0]
        bins = np.nonzero((self.stood >= 0) & (self.taker < 0))[0]
        at_work = np.nonzero((self.group_cells >= 0) & (self.group_bins >= 0))[0]
        remaining = np.zeros(self.rules.bins, np.int64)
        remaining[self.group_bins[at_work]] = self.rules.fill - self.progress[at_work]
        reserve = self.spare[self.group_cells[at_work]]
        remaining[reserve[reserve >= 0]] = (2 * self.rules.fill - self.progress[at_work])[reserve >= 0]
        wanting = np.zeros(grid.size, bool)
        there = self.group_cells[self.group_cells >= 0]
        wanting[there] = True
        wanting[self.group_cells[at_work]] = self.fruit[self.group_cells[at_work]] > 1
        wanting &= ~self.on_way & (self.spare < 0)
        asking = np.nonzero((self.group_cells >= 0) & (self.group_bins < 0))[0]
        asking = asking[wanting[self.group_cells[asking]]]
        requests = self.group_cells[asking[np.argsort(self.since[asking], kind="stable")]]
        return OrchardObservation(
            self.time, self.rules, idle, self.goals[idle], bins, self.bin_cells[bins], remaining[bins], wanting, requests,
            self._homecoming(remaining),
        )  # fmt: skip

    def _homecoming(self, remaining: Integers) -> Integers:
        grid = self.rules.grid
        times = np.zeros(self.rules.robots, np.int64)
        for robot in range(self.rules.robots):
            state, at, target = self.states[robot], int(self.until[robot]), int(self.fetched[robot])
            if state == IDLE:
                times[robot] = self.time + grid.empty_times[self.goals[robot], grid.home]
            elif state in (HAULING, RETURNING):
                times[robot] = at
            elif target == NONE:
                times[robot] = at + grid.empty_times[self.goals[robot], grid.home]
            else:
                cell = int(self.bin_cells[target])
                reached = at + (grid.empty_times[self.goals[robot], cell] if state == DELIVERING else 0)
                times[robot] = max(reached, self.time + remaining[target]) + grid.full_times[cell, grid.home]
        return times


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> OrchardWorld:
    return OrchardWorld(orchard_rules(values), rng)


WORLDS.enter(WorldKind("orchard", "pickers fill bins in an orchard, and robots bring new ones and fetch full ones", ORCHARD, _make))
