"""Form ``time-indexed``: at which step each standing bin's trip begins, and how many robots are away at each step."""

from typing import Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Floats, Integers
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Rows, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..orchard_day import OrchardDay, Trips, in_order

MOST_STARTS = 50_000
"""Variables, one a bin and step."""


def full_at(problem: OrchardDay) -> Integers:
    """Step at which each bin is full if all stand from the first step on."""
    full = np.zeros(problem.jobs.num_bins, np.int64)
    for k, before in enumerate(problem.jobs.after.tolist()):
        full[k] = problem.jobs.work[k] + (full[before] if before >= 0 else 0)
    return full


def latest_end(problem: OrchardDay) -> int:
    """A step by which some best plan is over: for the last step, that of the bins in turn; for the sum, when nobody waits any more."""
    jobs = problem.jobs
    known = int(problem.timetable(in_order(jobs, range(jobs.num_bins))).max())
    if problem.objective == "makespan":
        return known
    lengths = jobs.out + jobs.home
    free = jobs.robot_free + jobs.grid.empty_times[jobs.robot_cells, jobs.grid.home]
    ready = max(int(np.maximum(full_at(problem) - jobs.out, 0).max()), int(free.max()), int(_first_ends(problem).max(initial=0)))
    return ready + int(lengths.sum()) // jobs.num_robots + int(lengths.max())


def _first_ends(problem: OrchardDay) -> Integers:
    """Steps at which a robot in the field would be home with each bin as its first; shape (robots, bins)."""
    jobs = problem.jobs
    reached = jobs.robot_free[:, None] + jobs.grid.empty_times[np.ix_(jobs.robot_cells, jobs.bin_cells)]
    return np.asarray(np.maximum(reached, full_at(problem)) + jobs.home)


def build(problem: OrchardDay) -> Compiled:
    """Every bin stands. Bin b is fetched from the repository at step t (x_bt), so late that it is full on arrival, or first of all by
    robot r that is in the field (y_rb), which else goes home (g_r). With p_b = way out and home, e_rb the end of a first trip, h_r that of
    going home, and m_t robots but those at the repository that are not yet free::

        min  C  (makespan)     or     min  sum (t + p_b) x_bt + sum e_rb y_rb  (completion)
        fetched[b]   sum_t x_bt + sum_r y_rb = 1
        first[r]     sum_b y_rb + g_r = 1                                            robots in the field
        away[t]      sum_(b, t - p_b < s <= t) x_bs + sum_(rb, e_rb > t) y_rb + sum_(r, h_r > t) g_r <= m_t
        last[b]      sum_t (t + p_b) x_bt + sum_r e_rb y_rb <= C                      makespan alone

    Robots at the repository are alike, so that trips of which no more than there are robots overlap can be shared out. Source: Dyer and
    Wolsey (1990), Formulating the single machine sequencing problem with release dates as a mixed integer program.
    """
    starts = _Starts(problem)
    program = Program("time-indexed", "min", tuple(starts.variables()), tuple(starts.constraints()))
    return Compiled(program, problem, starts.decode, starts.encode)


class _Starts:
    """The columns by what they stand for, the rows about them, and how trips and points of the program become each other.

    Of each column of ``x`` there is the ``bin`` and the ``step``; of each of ``y`` the ``robot``, counted among those ``out`` in the
    field, the ``first`` bin and the step it ``ends``; of each of ``g`` the step the robot ``goes`` home by.
    """

    def __init__(self, problem: OrchardDay) -> None:
        self.problem, self.jobs, self.makespan = problem, problem.jobs, problem.objective == "makespan"
        jobs, self.last = problem.jobs, latest_end(problem)
        self.length = jobs.out + jobs.home
        self.begin = np.maximum(full_at(problem) - jobs.out, 0)
        self.count = np.maximum(self.last - self.length - self.begin + 1, 0)
        self.bin, self.offset = np.repeat(np.arange(jobs.num_bins), self.count), np.cumsum(self.count) - self.count
        self.step = np.arange(len(self.bin)) + np.repeat(self.begin - self.offset, self.count)
        self.out = np.nonzero(jobs.away)[0]
        self.robot, self.first = (index.ravel() for index in np.indices((len(self.out), jobs.num_bins)))
        self.ends = _first_ends(problem)[self.out].ravel()
        self.free = jobs.robot_free + jobs.grid.empty_times[jobs.robot_cells, jobs.grid.home]
        self.goes = self.free[self.out]
        self.x = np.arange(len(self.bin))
        self.y = len(self.x) + np.arange(len(self.robot))
        self.g = len(self.x) + len(self.y) + np.arange(len(self.out))
        self.size = len(self.x) + len(self.y) + len(self.g)
        self.steps = np.arange(max(self.last, int(self.ends.max(initial=0)), int(self.goes.max(initial=0))))
        self.bin_names, self.robot_names = ([str(k + 1) for k in range(count)] for count in (jobs.num_bins, jobs.num_robots))

    def variables(self) -> list[Variables]:
        def block(name: str, keys: tuple[Integers, ...], labels: tuple[list[str] | None, ...], ends: Integers) -> Variables:
            cost = np.zeros(len(ends)) if self.makespan else ends.astype(np.float64)
            return Variables(name, keys, labels, np.zeros(len(ends)), np.ones(len(ends)), cost, integer=True)

        blocks = [
            block("x", (self.bin, self.step), (self.bin_names, None), self.step + self.length[self.bin]),
            block("y", (self.out[self.robot], self.first), (self.robot_names, self.bin_names), self.ends),
            block("g", (self.out,), (self.robot_names,), np.zeros(len(self.out), np.int64)),
        ]
        if self.makespan:
            blocks.append(Variables("C", (), (), np.zeros(1), np.full(1, float(self.steps.size)), np.ones(1)))
        return blocks

    def constraints(self) -> list[Rows]:
        n, x, y, g = self.jobs.num_bins, self.x, self.y, self.g
        every, home = np.arange(n), self.jobs.robot_free[~self.jobs.away]
        over = self.step + self.length[self.bin]
        there = self.jobs.num_robots - (home[:, None] > self.steps).sum(axis=0)
        away = [_spans(x, self.step, over), _spans(y, np.zeros_like(self.ends), self.ends), _spans(g, np.zeros_like(self.goes), self.goes)]
        in_field = [(self.robot, y, 1.0), (np.arange(len(self.out)), g, 1.0)]
        blocks = [
            rows("fetched", n, [(self.bin, x, 1.0), (self.first, y, 1.0)], 1.0, 1.0, (every,), (self.bin_names,)),
            rows("first", len(self.out), in_field, 1.0, 1.0, (self.out,), (self.robot_names,)),
            rows("away", len(self.steps), away, upper=there, keys=(self.steps,)),
        ]
        if self.makespan:
            ends = [(self.bin, x, over), (self.first, y, self.ends), (every, np.full(n, self.size), -1.0)]
            blocks.append(rows("last", n, ends, upper=0.0, keys=(every,), labels=(self.bin_names,)))
        return blocks

    def decode(self, vector: Floats) -> Trips:
        trips: list[list[tuple[int, int]]] = [[] for _ in range(self.jobs.num_robots)]
        free = self.free.tolist()
        for at in np.nonzero(vector[self.y] > 0.5)[0].tolist():
            robot = int(self.out[self.robot[at]])
            trips[robot].append((-1, int(self.first[at])))
            free[robot] = int(self.ends[at])
        for at in sorted(np.nonzero(vector[self.x] > 0.5)[0].tolist(), key=lambda at: (self.step[at], self.bin[at])):
            step, fetched = int(self.step[at]), int(self.bin[at])
            robot = min((k for k in range(len(free)) if free[k] <= step), key=lambda k: (free[k], k), default=-1)
            if robot < 0:
                raise InputError(f"at step {step} more robots are away than there are", "contradiction")
            trips[robot].append((-1, fetched))
            free[robot] = step + int(self.length[fetched])
        return tuple(tuple(own) for own in trips)

    def encode(self, answer: Any) -> Floats:
        times = self.problem.timetable(answer)
        vector = np.zeros(self.size + self.makespan)
        for k, robot in enumerate(self.out.tolist()):
            fetched = [fetch for _, fetch in answer[robot]]
            early = bool(fetched) and int(times[fetched[0]]) == int(self.ends[k * self.jobs.num_bins + fetched[0]])
            vector[self.y[k * self.jobs.num_bins + fetched[0]] if early else self.g[k]] = 1.0
        taken = set(self.first[vector[self.y] > 0.5].tolist())
        for k in range(self.jobs.num_bins):
            if k not in taken:
                at = int(times[k] - self.length[k] - self.begin[k])
                if not 0 <= at < self.count[k]:
                    raise InputError(f"bin {k + 1} is not fetched within the steps of the program", "unsupported")
                vector[self.offset[k] + at] = 1.0
        if self.makespan:
            vector[self.size] = times.max()
        return vector


def _spans(column: Integers, begin: Integers, end: Integers) -> tuple[Integers, Integers, float]:
    """Row and column of each step from ``begin`` to before ``end``."""
    size = np.maximum(end - begin, 0)
    offset = np.arange(int(size.sum())) - np.repeat(np.cumsum(size) - size, size)
    return np.repeat(begin, size) + offset, np.repeat(column, size), 1.0


def _refuses(problem: Any) -> frozenset[str]:
    if not problem.jobs.standing.all():
        return frozenset({"bins to be brought"})
    starts = problem.jobs.num_bins * (latest_end(problem) + 1)
    return frozenset({f"more than {MOST_STARTS:,} pairs of bin and step"}) if starts > MOST_STARTS else frozenset()


def _size(problem: OrchardDay) -> ProgramSize:
    jobs, last = problem.jobs, float(latest_end(problem))
    length = (jobs.out + jobs.home).astype(np.float64)
    starts = np.maximum(last - length - np.maximum(full_at(problem) - jobs.out, 0) + 1.0, 0.0)
    first, away = float(jobs.away.sum()) * jobs.num_bins, float(jobs.away.sum())
    return ProgramSize(
        float(starts.sum()) + first + away + 1.0, 2.0 * jobs.num_bins + away + last,
        float((starts * (length + 2.0)).sum()) + (first + away) * (last / 2.0 + 3.0),
    )  # fmt: skip


FORMS.enter(
    Form("time-indexed", "orchard-day", frozenset({"objective:makespan", "objective:completion"}), build, refuses=_refuses, size=_size),
)
