"""Form ``time-indexed``: at which step each standing bin's trip begins, and how many robots are away at each step."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program, Variables
from ...programs.rows import rows
from ...programs.size import ProgramSize
from ..orchard_day import OrchardDay, Trips, in_order

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

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
    """When a robot in the field would be home with each bin as its first; shape (robots, bins)."""
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
    jobs, last = problem.jobs, latest_end(problem)
    n, length = jobs.num_bins, jobs.out + jobs.home
    begin = np.maximum(full_at(problem) - jobs.out, 0)
    count = np.maximum(last - length - begin + 1, 0)
    b = np.repeat(np.arange(n), count)
    t = np.concatenate([np.arange(s, s + k) for s, k in zip(begin.tolist(), count.tolist(), strict=True)] or [np.zeros(0, np.int64)])
    out = np.nonzero(jobs.away)[0]
    r, first = (index.ravel() for index in np.divmod(np.arange(len(out) * n), n))
    ends = _first_ends(problem)[out][r, first] if len(out) else np.zeros(0, np.int64)
    goes = (jobs.robot_free + jobs.grid.empty_times[jobs.robot_cells, jobs.grid.home])[out]
    x, y, g = np.arange(len(b)), len(b) + np.arange(len(r)), len(b) + len(r) + np.arange(len(out))
    final, makespan = len(b) + len(r) + len(out), problem.objective == "makespan"
    names = [str(k + 1) for k in range(n)], [str(k + 1) for k in range(jobs.num_robots)]
    zeros, ones, counted = np.zeros, np.ones, 0.0 if makespan else 1.0
    variables = [
        Variables("x", (b, t), (names[0], None), zeros(len(b)), ones(len(b)), counted * (t + length[b]).astype(np.float64), integer=True),
        Variables("y", (out[r], first), (names[1], names[0]), zeros(len(r)), ones(len(r)), counted * ends.astype(np.float64), integer=True),
        Variables("g", (out,), (names[1],), zeros(len(out)), ones(len(out)), zeros(len(out)), integer=True),
    ]
    steps = np.arange(max(last, int(ends.max(initial=0)), int(goes.max(initial=0))))
    parts = [
        _spans(x, t, t + length[b]), _spans(y, np.zeros(len(r), np.int64), ends), _spans(g, np.zeros(len(out), np.int64), goes)
    ]  # fmt: skip
    home = jobs.robot_free[~jobs.away]
    there = jobs.num_robots - (home[:, None] > steps).sum(axis=0)
    blocks = [
        rows("fetched", n, [(b, x, 1.0), (first, y, 1.0)], 1.0, 1.0, (np.arange(n),), (names[0],)),
        rows("first", len(out), [(r, y, 1.0), (np.arange(len(out)), g, 1.0)], 1.0, 1.0, (out,), (names[1],)),
        rows("away", len(steps), parts, upper=there, keys=(steps,)),
    ]
    if makespan:
        variables.append(Variables("C", (), (), np.zeros(1), np.full(1, float(steps.size)), np.ones(1)))
        every = [(b, x, t + length[b]), (first, y, ends), (np.arange(n), np.full(n, final), -1.0)]
        blocks.append(rows("last", n, every, upper=0.0, keys=(np.arange(n),), labels=(names[0],)))

    def decode(vector: Floats) -> Trips:
        own: list[list[tuple[int, int]]] = [[] for _ in range(jobs.num_robots)]
        free = (jobs.robot_free + jobs.grid.empty_times[jobs.robot_cells, jobs.grid.home]).tolist()
        for at in np.nonzero(vector[y] > 0.5)[0].tolist() if len(y) else ():
            robot = int(out[r[at]])
            own[robot].append((-1, int(first[at])))
            free[robot] = int(ends[at])
        for at in sorted(np.nonzero(vector[x] > 0.5)[0].tolist(), key=lambda at: (t[at], b[at])):
            robot = min((k for k in range(jobs.num_robots) if free[k] <= t[at]), key=lambda k: (free[k], k), default=-1)
            if robot < 0:
                raise InputError(f"at step {t[at]} more robots are away than there are")
            own[robot].append((-1, int(b[at])))
            free[robot] = int(t[at] + length[b[at]])
        return tuple(tuple(trips) for trips in own)

    def encode(answer: Any) -> Floats:
        times = problem.timetable(answer)
        vector = np.zeros(final + makespan)
        for k, robot in enumerate(out.tolist()):
            mine = [fetch for _, fetch in answer[robot]]
            early = bool(mine) and int(times[mine[0]]) == int(_first_ends(problem)[robot, mine[0]])
            vector[y[k * n + mine[0]] if early else g[k]] = 1.0
        taken = {int(first[at]) for at in np.nonzero(vector[y] > 0.5)[0]} if len(y) else set()
        start = np.concatenate([[0], np.cumsum(count)])
        for k in range(n):
            if k not in taken:
                at = int(times[k] - length[k] - begin[k])
                if not 0 <= at < count[k]:
                    raise InputError(f"bin {k + 1} is not fetched within the steps of the program")
                vector[start[k] + at] = 1.0
        if makespan:
            vector[final] = times.max()
        return vector

    return Compiled(Program("time-indexed", "min", tuple(variables), tuple(blocks)), problem, decode, encode)


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


FORMS.add(
    "time-indexed",
    Form("time-indexed", "orchard-day", frozenset({"objective:makespan", "objective:completion"}), build, refuses=_refuses, size=_size),
)
