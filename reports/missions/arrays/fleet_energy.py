"""Fleet energy: which jobs a fleet can keep going, and which robot relieves which one when."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from ....formulations.arrays.exchange_schedule import Aloft, ExchangeCase, Sortie, uncovered
from ....formulations.arrays.problem import ArrayProblem
from ....formulations.problem import Problem
from ....heuristics.arrays._exchanges import exchange_program, feasible, one_by_one, robots_for_ever, scheduled
from ....instances.arrays.worlds.fleet_energy import DISPATCH, HOME, NEVER, FleetObservation, FleetWorld, Watch
from ....instances.errors import UsageError
from ....instances.worlds import WORLDS, Setting, World, make_world, setting_values
from ..mission import MISSIONS, Actions, Decision, Mission, Scene


class FleetEnergy(Mission):
    """Take on the jobs that the fleet can sustain, and watch all their places without a gap, with few takeoffs.

    Source: Mitchell (2020), appendix A; readings and errata: docs/missions/fleet-energy.md.
    """

    name: ClassVar[str] = "fleet-energy"
    summary: ClassVar[str] = "robots with small batteries take turns so that jobs never stop"
    headline: ClassVar[str] = "covered"
    lasting: ClassVar[int] = 360
    settings: ClassVar[Mapping[str, Setting]] = {
        **WORLDS["fleet-energy"].settings,
        "believed-flight": Setting(None, "first estimate of the flight time, in seconds; without it the true mean", float, 1.0, 1e6),
        "believed-charge": Setting(None, "first estimate of the charging time, in seconds; without it the true mean", float, 1.0, 1e7),
        "adapt": Setting(True, "whether the estimates follow what is observed"),
        "count-ways": Setting(False, "whether jobs are taken on by the time at their places, without the ways"),
        "charge-step": Setting(20.0, "added to the charging time for each takeoff before a battery was full, in seconds", float, 0.0, 1e6),
        "least-flight": Setting(0.9, "the estimate of the flight time stays above this share of the first one", float, 0.0, 1.0),
        "horizon": Setting(480.0, "for which watches are planned, in seconds", float, 1.0, 1e6),
    }

    def world(self, seed: int, **settings: Any) -> FleetWorld:
        self.values = v = setting_values(self.name, self.settings, settings)
        world = make_world(self.name, seed, **{key: v[key] for key in WORLDS[self.name].settings})
        assert isinstance(world, FleetWorld)
        believed = [v[f"believed-{key}"] or v[key] for key in ("flight", "charge")]
        self.flight, self.charge = (max(1, round(seconds / v["step"])) for seconds in believed)
        self._least, self._horizon = max(3, round(v["least-flight"] * self.flight)), max(2, round(v["horizon"] / v["step"]))
        if self.flight <= 2:
            raise UsageError(f"the flight time is {self.flight} steps: a way there, one back and a step there take 3", "out-of-range")
        self._way = int(np.median(np.concatenate([world.observe().ways(job.places) for job in world.jobs], axis=1))) if world.jobs else 0
        self.taken: set[int] = set()
        self._asked: set[int] = set()
        self._prepared, self._planned, self._changed = -1, -NEVER, True
        self._plan: list[tuple[int, Watch, int, int]] = []
        return world

    @property
    def robots_for_ever(self) -> int:
        """How many robots one job for ever takes, by the present estimates."""
        return robots_for_ever(*self._counted())

    def _counted(self) -> tuple[int, int]:
        """Charging and flight time by which jobs are taken on; with ways, the time between two watches, and that of a watch."""
        way = self._way if self.values["count-ways"] else 0
        return self.charge + 2 * way, max(1, self.flight - 2 * way)

    def problem(self, observation: FleetObservation) -> Problem | None:
        """The fewest takeoffs up to the horizon; None where the plan still holds, or nothing is to be watched."""
        case = self._case(observation)
        if case is None:
            return None
        program, self._columns = exchange_program(case)
        return ArrayProblem(program, f"watches at step {observation.time}")

    def actions(self, observation: FleetObservation, problem: Problem | None, answer: Any) -> Actions:
        if problem is not None and answer is not None:
            self._accept(scheduled(self._cased, self._columns, np.asarray(answer)))
        return self._deeds(observation)

    def policies(self) -> Mapping[str, Callable[[Any], Actions]]:
        """``one-by-one``: exchanges in the order in which batteries run out, matched by distance."""
        return {"one-by-one": self._one_by_one}

    def _one_by_one(self, observation: FleetObservation) -> Actions:
        case = self._case(observation)
        if case is not None:
            self._accept(one_by_one(case))
        return self._deeds(observation)

    def measures(self, decisions: Sequence[Decision], world: World) -> dict[str, float]:
        """``flight`` and ``charge``: estimates, in seconds; ``for_ever``: robots that one job for ever takes by them; ``planned_alone``:
        steps that the last plan leaves places alone."""
        unit = self.values["step"]
        return {
            "flight": self.flight * unit, "charge": self.charge * unit, "for_ever": float(self.robots_for_ever),
            "planned_alone": float(self._alone) if self._plan else 0.0,
        }  # fmt: skip

    def scene(self, world: World) -> Scene:
        """Pads, places of all jobs, those watched now marked, and robots on straight ways between."""
        assert isinstance(world, FleetWorld)
        points = np.concatenate([job.places for job in world.jobs] or [np.zeros((0, 2))])
        keys = [(number, place) for number, job in enumerate(world.jobs) for place in range(len(job.places))]
        there, at = world.watched(), dict(zip(keys, points, strict=True))
        agents = world.pads.copy()
        for robot, watch in enumerate(world.watches):
            if watch is not None:
                total = max(int(world.arrival[robot] - world.since[robot]), 1)
                share = min(1.0, (world.time - int(world.since[robot])) / total)
                agents[robot] += share * (at[watch] - agents[robot])
        side = self.values["area"]
        marked = np.array([key in there for key in keys], dtype=bool)
        return Scene((0.0, 0.0, side, side), agents, 0.0, points, marked, ("robots", "places watched", "places not watched"))

    # ------------------------------------------------------------------------------------------------------------------

    def _case(self, o: FleetObservation) -> ExchangeCase | None:
        """Learn from what was observed, take jobs on; then what is to be planned, or None where the plan holds."""
        if o.time != self._prepared:
            self._prepared = o.time
            self._learn(o)
            self._take_on(o)
        if not self._changed and o.time < self._planned + self._horizon // 2:
            return None
        self._watches = [(number, place) for number in sorted(self.taken) for place in range(len(o.jobs[number].places))]
        self._changed, self._planned, self._plan = False, o.time, []
        if not self._watches:
            return None
        travel = o.ways(np.concatenate([o.jobs[number].places for number in sorted(self.taken)]))
        if 2 * int(travel.min()) >= self.flight:
            return None
        index = {watch: k for k, watch in enumerate(self._watches)}
        aloft = {
            robot: Aloft(index[watch], int(o.since[robot]) - o.time, int(o.arrival[robot]) - o.time)
            for robot, watch in enumerate(o.watches) if watch in index and o.since[robot] < o.time and self._may_stay(o, robot)
        }  # fmt: skip
        ready = np.where(o.aloft, o.arrival + self.charge - o.time, o.since + self.charge - o.time).clip(0)
        end = np.array([min(o.jobs[number].end - o.time, self._horizon) for number, _ in self._watches], dtype=np.int64)
        self._cased = ExchangeCase(travel, self.flight, self.charge, ready, np.zeros(len(end), dtype=np.int64), end, aloft)
        return self._cased

    def _may_stay(self, o: FleetObservation, robot: int) -> bool:
        """Whether its battery lasts for a step more and the way home, by the estimate."""
        watch = o.watches[robot]
        assert watch is not None
        way = int(o.ways(o.jobs[watch[0]].places)[robot, watch[1]])
        return bool(max(o.time, int(o.arrival[robot])) - int(o.since[robot]) + way < self.flight)

    def _accept(self, schedule: Sequence[Sortie]) -> None:
        case, start = self._cased, self._planned
        self._alone = uncovered(case, schedule)
        self._plan = [
            (s.robot, self._watches[s.place], start + s.arrive - int(case.travel[s.robot, s.place]), start + s.leave) for s in schedule
        ]

    def _deeds(self, o: FleetObservation) -> Actions:
        """Jobs taken on, takeoffs that are due, and flights home: of those relieved, low, or out of what the plan gives them."""
        deeds: dict[int, Any] = {DISPATCH: frozenset(self.taken)}
        leaves = {(robot, watch): leave for robot, watch, _, leave in self._plan}
        for robot, watch in enumerate(o.watches):
            if watch is not None and (watch[0] not in self.taken or o.time >= leaves.get((robot, watch), o.time) or robot in o.low):
                deeds[robot] = HOME
        for robot, watch, takeoff, leave in self._plan:
            if takeoff == o.time < leave and not o.aloft[robot]:
                deeds[robot] = watch
        return deeds

    def _learn(self, o: FleetObservation) -> None:
        """Update the estimates by the last crossing of the low voltage and by takeoffs before batteries were full."""
        if o.low:
            self._changed = True
        if not self.values["adapt"]:
            return
        if o.low:
            self.flight = max(self._least, list(o.low.values())[-1])
        self.charge += round(len(o.hasty) * self.values["charge-step"] / self.values["step"])
        self._changed |= bool(o.hasty)

    def _take_on(self, o: FleetObservation) -> None:
        over = self.taken - set(o.jobs)
        self.taken -= over
        self._changed |= bool(over)
        for_ever = sorted(number for number in self.taken if o.jobs[number].end == NEVER)
        surplus = for_ever[len(o.watches) // self.robots_for_ever :]
        self.taken.difference_update(surplus)
        self._changed |= bool(surplus)
        ready = np.where(o.aloft, 0, (o.since + self.charge - o.time).clip(0))
        for number in sorted(set(o.jobs) - self._asked):
            self._asked.add(number)
            own = [o.jobs[k] for k in (*sorted(self.taken), number)]
            jobs = [(len(job.places), np.inf if job.end == NEVER else float(job.end - o.time)) for job in own]
            charge, flight = self._counted()
            if feasible(ready, jobs, flight, charge):
                self.taken.add(number)
                self._changed = True


MISSIONS.add("fleet-energy", FleetEnergy)
