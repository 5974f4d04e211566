"""The rest of a day in the orchard, planned as a whole: which robot brings and fetches which bins, in which order."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ...instances.auctions.orchard_jobs import OrchardJobs
from ...instances.errors import InputError, UsageError
from ...instances.generators.settings import Setting
from ...instances.instance import digest, with_settings
from ...instances.number_arrays import Integers
from ..evaluation import Checklist, Evaluation
from ..problem import PROBLEMS, Problem, refuse_settings
from ..stop import NEVER, Stop

if TYPE_CHECKING:
    import pandas as pd


Trip = tuple[int, int]
"""The bin brought, and the bin then fetched; -1 for none."""

Trips = tuple[tuple[Trip, ...], ...]
"""Each robot's trips, in their order."""

_EACH = 500
"""Bins between two looks at the clock."""

OBJECTIVE = Setting(
    "makespan",
    "what is minimised: the step at which the last bin is home, or the sum of all bins' steps",
    choices=("makespan", "completion"),
)


class OrchardDay(Problem):
    """Bring every bin that does not stand in the orchard, and fetch every bin when it is full.

    A trip leads from where the robot is to the repository if it brings a bin and is not there, to the cell of the bin that it brings, to
    the cell of the bin that it fetches, where it waits until that is full, and to the repository. An answer gives each robot a tuple of
    trips (bin brought, bin fetched); robots go as early as they can.

    Parameters
    ----------
    jobs : OrchardJobs
        The grid, robots, and the bins with their work.
    objective : str
        ``makespan``, or ``completion``: the sum of the steps at which bins come home.

    Raises
    ------
    UsageError
        For another objective.

    Notes
    -----
    Source: Zhang (2015), chapter 3, planned as a whole; docs/formulations/orchard-day.md#model.
    """

    family: ClassVar[str] = "orchard-day"
    senses = ("min",)

    def __init__(self, jobs: OrchardJobs, objective: str = OBJECTIVE.default) -> None:
        if not isinstance(jobs, OrchardJobs):
            raise UsageError(f"a day in the orchard is made of OrchardJobs, not of {type(jobs).__name__}", "malformed")
        self.jobs, self.objective = jobs, str(OBJECTIVE.value("objective", objective))
        self.name, self.problem, self.notes = jobs.name, "orchard-day", jobs.notes

    def digest(self) -> str:
        return digest("orchard-day", self.objective, self.jobs.digest())

    def features(self) -> frozenset[str]:
        return frozenset({f"objective:{self.objective}"})

    @property
    def size(self) -> int:
        return self.jobs.num_bins

    def facts(self) -> dict[str, Any]:
        return {
            "objective": "the last bin's step" if self.objective == "makespan" else "sum of all bins' steps",
            "orchard": self.jobs.facts(),
        }

    def value(self, times: Integers) -> float:
        """The objective, from the steps at which bins come home."""
        return float(times.max() if self.objective == "makespan" else times.sum())

    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute when bins come home; test that each is brought and fetched as often as it must be, and that no robot waits for ever."""
        jobs = self.jobs
        self._check_shape(answer)
        checks = Checklist()
        brought, fetched = np.zeros(jobs.num_bins, int), np.zeros(jobs.num_bins, int)
        for trips in answer:
            for bring, fetch in trips:
                for counts, k in ((brought, bring), (fetched, fetch)):
                    if k >= 0:
                        counts[k] += 1
        for k in range(jobs.num_bins):
            due = 0 if jobs.standing[k] else 1
            for check, count, wanted in (("brought", int(brought[k]), due), ("fetched", int(fetched[k]), 1)):
                fault = f"bin {k + 1} is {check} {_times(count)}, not {_times(wanted)}"
                checks.test(check, abs(float(count - wanted)), fault, site=str(k + 1))
        home, stuck = _timetable(jobs, answer)
        for robot in range(jobs.num_robots):
            late = robot in stuck
            checks.test("waits", float(late), f"robot {robot + 1} waits for a bin that is never full", vehicle=str(robot + 1))
        reached = home[home >= 0]
        quantities = {
            "makespan": float(reached.max(initial=0)), "completion": float(reached.sum()), "returned": float(len(reached)),
            "trips": float(sum(len(trips) for trips in answer)),
        }  # fmt: skip
        value = quantities["makespan" if self.objective == "makespan" else "completion"]
        return Evaluation((value,), checks.checks(("brought", "fetched", "waits")), tuple(checks.violations), quantities)

    def _check_shape(self, answer: Any) -> None:
        jobs = self.jobs
        if not isinstance(answer, tuple) or len(answer) != jobs.num_robots:
            raise InputError(f"an answer is a tuple of trips for each of {jobs.num_robots} robots", found=str(answer)[:80])
        for trips in answer:
            if not isinstance(trips, tuple) or not all(isinstance(trip, tuple) and len(trip) == 2 for trip in trips):
                raise InputError("a robot's trips are a tuple of pairs (bin brought, bin fetched)", found=str(trips)[:80])
            for trip in trips:
                if not all(type(k) is int and -1 <= k < jobs.num_bins for k in trip) or trip == (-1, -1):
                    raise InputError(
                        f"a trip names bins 0 to {jobs.num_bins - 1}, or -1 for one of the two", "out-of-range", found=str(trip)[:80]
                    )

    def timetable(self, answer: Trips) -> Integers:
        """Step at which each bin comes home, -1 for never."""
        self._check_shape(answer)
        return _timetable(self.jobs, answer)[0]

    def answer_at_hand(self) -> Trips:
        """Bin after bin, each by the robot that has it home the soonest; those that are to be brought, on the way to the one before."""
        return in_order(self.jobs, range(self.jobs.num_bins))

    def answer_to_json(self, answer: Trips) -> dict[str, Any]:
        def part(k: int) -> int | None:
            return None if k < 0 else k + 1

        return {"kind": "trips", "robots": [[{"bring": part(a), "fetch": part(b)} for a, b in trips] for trips in answer]}

    def answer_from_json(self, data: Any) -> Trips:
        robots = data.get("robots") if isinstance(data, Mapping) and data.get("kind") == "trips" else None
        if not isinstance(robots, list):
            raise InputError("not an answer to an orchard-day problem", expected='an object {"kind": "trips", "robots": [[...], ...]}')

        def part(trip: Any, key: str) -> int:
            value = trip.get(key) if isinstance(trip, Mapping) else None
            if not isinstance(trip, Mapping) or (value is not None and (type(value) is not int or value < 1)):
                raise InputError("a trip names bins from 1, or null", expected='{"bring": ..., "fetch": ...}', found=str(trip)[:80])
            return -1 if value is None else value - 1

        if not all(isinstance(trips, list) for trips in robots):
            raise InputError("each robot has a list of trips", found=str(robots)[:80])
        answer = tuple(tuple((part(trip, "bring"), part(trip, "fetch")) for trip in trips) for trips in robots)
        self._check_shape(answer)
        return answer

    def answer_to_frame(self, answer: Trips) -> "pd.DataFrame":
        """One row per trip: robot, trip, bin brought, bin fetched (from 1), and the step at which it comes home."""
        import pandas as pd

        home = self.timetable(answer)
        rows = [
            {"robot": r + 1, "trip": k + 1, "bring": a + 1 or None, "fetch": b + 1 or None, "home": int(home[b]) if b >= 0 else None}
            for r, trips in enumerate(answer)
            for k, (a, b) in enumerate(trips)
        ]
        frame = pd.DataFrame(rows, columns=["robot", "trip", "bring", "fetch", "home"])
        return frame.astype("Int64")  # nothing where there is no such bin

    def to_instance(self) -> OrchardJobs:
        return with_settings(replace(self.jobs), {"objective": self.objective})  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return f"<OrchardDay {self.name}: {self.jobs.num_robots} robots, {self.jobs.num_bins} bins, {self.objective}>"


def _times(count: Any) -> str:
    return {0: "never", 1: "once"}.get(int(count), f"{int(count)} times")


def _timetable(jobs: OrchardJobs, answer: Trips) -> tuple[Integers, set[int]]:
    """Step at which each bin comes home (-1 for never), and the robots that wait for ever. If a bin is brought or fetched twice, the first
    counts."""
    grid, after, work = jobs.grid, jobs.after.tolist(), jobs.work.tolist()
    following = {before: k for k, before in enumerate(after) if before >= 0}
    stood = [0 if there else -1 for there in jobs.standing]
    full, home = [-1] * jobs.num_bins, [-1] * jobs.num_bins
    here, clock, done = jobs.robot_cells.tolist(), jobs.robot_free.tolist(), [0] * jobs.num_robots
    waiting: dict[int, list[int]] = {}  # robots at bins that are not full
    going = list(range(jobs.num_robots))

    def stands(k: int) -> None:
        """Fill a bin that stands now, and then those that waited for it alone."""
        while k >= 0 and stood[k] >= 0 and (after[k] < 0 or full[after[k]] >= 0):
            full[k] = max(stood[k], full[after[k]] if after[k] >= 0 else 0) + work[k]
            going.extend(waiting.pop(k, ()))
            k = following.get(k, -1)

    for k in np.nonzero(jobs.standing)[0].tolist():
        if full[k] < 0:
            stands(k)
    arrived = [False] * jobs.num_robots  # at the bin of the trip that it makes
    while going:
        robot = going.pop()
        while done[robot] < len(answer[robot]):
            bring, fetch = answer[robot][done[robot]]
            if bring >= 0 and not arrived[robot]:
                clock[robot] += int(grid.empty_times[here[robot], grid.home])
                here[robot] = int(jobs.bin_cells[bring])
                clock[robot] += int(grid.empty_times[grid.home, here[robot]])
                if stood[bring] < 0:
                    stood[bring] = clock[robot]
                    stands(bring)
            if fetch >= 0:
                if not arrived[robot]:
                    clock[robot] += int(grid.empty_times[here[robot], jobs.bin_cells[fetch]])
                    here[robot], arrived[robot] = int(jobs.bin_cells[fetch]), True
                if full[fetch] < 0:
                    waiting.setdefault(fetch, []).append(robot)
                    break
                clock[robot] = max(clock[robot], full[fetch]) + int(grid.full_times[here[robot], grid.home])
                here[robot] = grid.home
                if home[fetch] < 0:
                    home[fetch] = clock[robot]
            arrived[robot] = False
            done[robot] += 1
    return np.array(home), {robot for robot, trips in enumerate(answer) if done[robot] < len(trips)}


def in_order(jobs: OrchardJobs, order: Iterable[int], stop: Stop = NEVER) -> Trips:
    """Bins fetched in the given order, each by the robot that has it home the soonest, which brings it first where it does not stand yet.

    A bin must come after those that its group fills before it. Raises Stopped.
    """
    grid = jobs.grid
    here, clock = jobs.robot_cells.copy(), jobs.robot_free.copy()
    full = np.zeros(jobs.num_bins, np.int64)
    trips: list[list[Trip]] = [[] for _ in range(jobs.num_robots)]
    for number, k in enumerate(order):
        if number % _EACH == 0:
            stop.check()
        cell, before = jobs.bin_cells[k], jobs.after[k]
        if jobs.standing[k]:
            reached, stood = clock + grid.empty_times[here, cell], np.zeros(jobs.num_robots, np.int64)
        else:
            reached = stood = clock + grid.empty_times[here, grid.home] + grid.empty_times[grid.home, cell]
        ready = np.maximum(stood, full[before] if before >= 0 else 0) + jobs.work[k]
        back = np.maximum(reached, ready) + grid.full_times[cell, grid.home]
        robot = int(np.argmin(back))
        clock[robot], here[robot], full[k] = back[robot], grid.home, ready[robot]
        trips[robot].append((-1 if jobs.standing[k] else int(k), int(k)))
    return tuple(tuple(own) for own in trips)


@PROBLEMS.register("orchard-day")
def make(instance: Any, name: str, settings: dict[str, Any]) -> OrchardDay:
    """The problem of an instance; setting ``objective``."""
    if not isinstance(instance, OrchardJobs):
        raise UsageError(f"{instance.name} holds no bins of an orchard, so it cannot be read as {name}", "foreign")
    refuse_settings(name, settings, ("objective",))
    return OrchardDay(instance, settings.get("objective", OBJECTIVE.default))
