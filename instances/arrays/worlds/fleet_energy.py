"""Robots with small batteries that keep jobs going: they fly for minutes and charge for the better part of an hour."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError
from ...generators import Draw, Flags, Floats, Integers
from ...worlds import WORLDS, Setting, World, WorldKind, check_robot

DISPATCH = -1
"""Number of the agent whose action is the set of jobs that the team has taken on."""

HOME = "home"
"""Action of a robot that is to fly to its pad."""

NEVER = 2**40
"""End of a job that lasts for ever."""

Watch = tuple[int, int]
"""A job's number, and one of its places."""


@dataclass(frozen=True, eq=False)
class Job:
    """Places, shape (places, 2), each to be watched by one robot in the steps ``[start, end)``; ``start`` is when it is asked for."""

    places: Floats
    start: int
    end: int


@dataclass(frozen=True, eq=False)
class FleetObservation:
    """Knowledge of the team: of batteries only which robots fell below the low voltage, or took off before they were full.

    ``watches`` is for each robot the place to which it flies or which it watches, None for those on their way home or on a pad; ``since``
    the step at which it took off or landed, ``arrival`` when it is or was at its place. ``low`` maps robots that crossed the low voltage in
    the last step to their time in the air, ``hasty`` are those that took off in it before they were full.
    """

    time: int
    pads: Floats
    jobs: Mapping[int, Job]
    watches: tuple[Watch | None, ...]
    aloft: Flags
    since: Integers
    arrival: Integers
    low: Mapping[int, int]
    hasty: tuple[int, ...]
    reach: float

    def ways(self, places: Floats) -> Integers:
        """Steps from each pad to each place, shape (robots, places)."""
        return ways(self.pads, places, self.reach)


def ways(pads: Floats, places: Floats, reach: float) -> Integers:
    """Whole steps from pads to places, one at least; ``reach`` is the distance flown in a step."""
    apart = np.hypot(*(pads[:, None, :] - np.asarray(places).reshape(-1, 2)[None, :, :]).transpose(2, 0, 1))
    steps: Integers = np.maximum(1, np.ceil(apart / reach - 1e-9)).astype(np.int64)
    return steps


class FleetWorld(World):
    """In a step each robot on its pad charges, or takes off for a place; each in the air goes on, or turns home.

    ``pads`` has the shape (robots, 2), metres. ``endurance`` and ``recharge``, shape (robots,), steps: from a full battery to the low
    voltage, and from an empty one to a full one. ``reach``, metres: flown in a step. ``reserve``, steps: from the low voltage to an empty
    battery. A robot whose battery is empty in the air is lost there, and carried to its pad.

    Source: Mitchell (2020), appendix A; docs/missions/fleet-energy.md.
    """

    def __init__(
        self, pads: Floats, endurance: Integers, recharge: Integers, jobs: Sequence[Job], reach: float, reserve: int
    ) -> None:  # fmt: skip
        if not len(pads):
            raise InputError("there is no robot", "missing")
        if (endurance < 1).any() or (recharge < 1).any() or reserve < 0 or not reach > 0:
            raise InputError("batteries, the reserve and the speed must be positive", "out-of-range")
        nearest = [int(ways(pads, job.places, reach).min(axis=0).max()) for job in jobs if len(job.places)]
        if nearest and 2 * min(nearest) >= int(endurance.max()):
            raise InputError("no robot reaches the places of any job and returns with one charge", "out-of-range")
        self.pads, self.endurance, self.recharge, self.jobs, self.reach, self.reserve = pads, endurance, recharge, jobs, reach, reserve
        robots = len(pads)
        self.capacity = (endurance + reserve).astype(np.float64)
        self.battery = self.capacity.copy()
        self.time, self.takeoffs, self.lost, self.covered, self.demanded = 0, 0, 0, 0, 0
        self.aloft, self.since, self.arrival = np.zeros(robots, dtype=bool), np.full(robots, -NEVER), np.zeros(robots, dtype=np.int64)
        self.watches: list[Watch | None] = [None] * robots
        self.committed: frozenset[int] = frozenset()
        self.low: dict[int, int] = {}
        self.hasty: tuple[int, ...] = ()

    def observe(self) -> FleetObservation:
        asked = {number: job for number, job in enumerate(self.jobs) if job.start <= self.time < job.end}
        return FleetObservation(
            self.time, self.pads, asked, tuple(self.watches), self.aloft.copy(), self.since.copy(), self.arrival.copy(), dict(self.low),
            self.hasty, self.reach,
        )  # fmt: skip

    def step(self, actions: Mapping[int, Any]) -> None:
        for agent, deed in actions.items():
            self._refuse(agent, deed)
        self.committed = frozenset(actions.get(DISPATCH, self.committed))
        self.hasty = tuple(k for k, deed in actions.items() if k != DISPATCH and deed != HOME and self.battery[k] < self.capacity[k] - 1e-9)
        for robot, deed in actions.items():
            if robot == DISPATCH:
                continue
            watch: Any = self.watches[robot] if deed == HOME else deed
            way = int(ways(self.pads[[robot]], self.jobs[watch[0]].places[[watch[1]]], self.reach)[0, 0])
            if deed == HOME:
                self.watches[robot], self.arrival[robot] = None, self.time + min(way, self.time - int(self.since[robot]))
            else:
                self.watches[robot], self.aloft[robot] = watch, True
                self.since[robot], self.arrival[robot] = self.time, self.time + way
                self.takeoffs += 1
        wanted = self.wanted()
        there = self.watched()
        self.demanded += len(wanted)
        self.covered += len(wanted & there)
        before = self.battery.copy()
        full = np.minimum(self.capacity, self.battery + self.capacity / self.recharge)
        self.battery = np.where(self.aloft, self.battery - 1.0, full)
        self.time += 1
        crossed = self.aloft & (self.battery <= self.reserve) & (before > self.reserve)
        self.low = {int(k): self.time - int(self.since[k]) for k in np.flatnonzero(crossed)}
        home = self.aloft & np.array([watch is None for watch in self.watches]) & (self.arrival <= self.time)
        empty = self.aloft & ~home & (self.battery <= 0.0)
        self.lost += int(empty.sum())
        for robot in np.flatnonzero(home | empty).tolist():
            self.watches[robot], self.aloft[robot], self.since[robot] = None, False, self.time
        self.battery = np.maximum(self.battery, 0.0)

    def wanted(self) -> set[Watch]:
        """Places of the jobs taken on that are to be watched now."""
        active = [number for number in self.committed if self.jobs[number].start <= self.time < self.jobs[number].end]
        return {(number, place) for number in active for place in range(len(self.jobs[number].places))}

    def watched(self) -> set[Watch]:
        """Places at which a robot is now."""
        return {watch for watch, arrival in zip(self.watches, self.arrival, strict=True) if watch is not None and arrival <= self.time}

    def metrics(self) -> dict[str, float]:
        """``covered``: percent of what was to be watched so far, 100 where nothing was; ``jobs``: taken on and not over; ``airborne`` now;
        ``takeoffs`` so far; ``lost``: batteries that were empty in the air."""
        return {
            "covered": 100.0 * self.covered / self.demanded if self.demanded else 100.0,
            "jobs": float(len({number for number, _ in self.wanted()})), "airborne": float(self.aloft.sum()),
            "takeoffs": float(self.takeoffs), "lost": float(self.lost),
        }  # fmt: skip

    def _refuse(self, agent: Any, deed: Any) -> None:
        if agent == DISPATCH:
            if not all(isinstance(k, int) and 0 <= k < len(self.jobs) for k in deed):
                raise InputError("a job that is taken on does not exist", "unknown-name", found=str(sorted(deed))[:40])
            return
        check_robot(agent, len(self.pads))
        if deed == HOME:
            if self.watches[agent] is None:
                raise InputError(f"robot {agent} is on its way home, or there", "contradiction")
            return
        known = isinstance(deed, tuple) and len(deed) == 2 and deed[0] in range(len(self.jobs))
        if not known or deed[1] not in range(len(self.jobs[deed[0]].places)):
            raise InputError(f"robot {agent} is told no place of a job", "unknown-name", found=str(deed)[:40])
        if self.aloft[agent]:
            raise InputError(f"robot {agent} is in the air", "contradiction", expected="home")


def _make(rng: np.random.Generator, values: Mapping[str, Any]) -> FleetWorld:
    draw, unit, side, robots = Draw(rng), values["step"], values["area"], values["robots"]
    stations = draw.uniform(0.0, side, (values["stations"], 2))
    pads = stations[np.arange(robots) % len(stations)]

    def drawn(seconds: float) -> Integers:
        scattered = draw.normal(1.0, values["scatter"], robots).clip(0.5, 1.5)
        steps: Integers = np.maximum(1, np.round(seconds * scattered / unit)).astype(np.int64)
        return steps

    endurance, recharge = drawn(values["flight"]), drawn(values["charge"])
    jobs = [Job(draw.uniform(0.0, side, (1, 2)), 0, NEVER) for _ in range(values["persistent"])]
    when = 0.0
    for _ in range(values["jobs"]):
        when += -values["between"] * math.log1p(-float(draw.uniform(0.0, 1.0, 1)[0]))
        lasting, count = float(draw.uniform(1.0, 15.0, 1)[0]) * values["flight"], draw.integer(1, 3)
        start = int(when / unit)
        jobs.append(Job(draw.uniform(0.0, side, (count, 2)), start, start + max(1, round(lasting / unit))))
    return FleetWorld(pads, endurance, recharge, jobs, values["speed"] * unit, round(values["reserve"] / unit))


WORLDS.enter(
    WorldKind(
        "fleet-energy", "robots with small batteries take turns so that jobs never stop",
        {
            "robots": Setting(26, "robots", int, 1, 10_000),
            "stations": Setting(4, "places where pads are, robot by robot in turn", int, 1, 10_000),
            "persistent": Setting(4, "jobs for one robot that are asked for at once and last for ever", int, 0, 1000),
            "jobs": Setting(8, "jobs for one to three robots that are asked for later, and last 1 to 15 flight times", int, 0, 10_000),
            "between": Setting(600.0, "mean time between these, in seconds", float, 0.0, 1e7),
            "flight": Setting(120.0, "true time from a full battery to the low voltage, in seconds", float, 1.0, 1e6),
            "charge": Setting(2400.0, "true time from an empty battery to a full one, in seconds", float, 1.0, 1e7),
            "scatter": Setting(0.05, "deviation of both among robots, as a share", float, 0.0, 0.2),
            "reserve": Setting(30.0, "from the low voltage to an empty battery, in seconds", float, 0.0, 1e6),
            "area": Setting(8.0, "side of the square in which all is, in metres", float, 0.0, 1e6),
            "speed": Setting(0.5, "of robots, in metres a second", float, 1e-6, 1e6),
            "step": Setting(10.0, "length of a step, in seconds", float, 1e-3, 1e6),
        },
        _make,
    ),
)  # fmt: skip
