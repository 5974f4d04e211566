"""Engine ``interval-scheduling``: days in the orchard as intervals of trips, of which no more overlap than there are robots."""

import time
from typing import Any, ClassVar

from ....formulations.auctions.orchard_day import OrchardDay, Trips, in_order
from ....formulations.problem import Problem
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from ...backends.cpsat import STATUS_MAP, search_until_stopped, set_limits

MOST_BINS = 200
"""Bins of a day: each pair of a bin to bring and one to fetch is a variable."""


@BACKENDS.register("interval-scheduling")
class IntervalScheduling(Engine):
    """OR-Tools CP-SAT with an interval for each trip, a cumulative row of robots, and the choice which bin is brought on which trip.

    A trip begins and ends at the repository, so that any intervals of which no more overlap than there are robots can be shared out; robots
    that begin elsewhere have their first interval from step 0 on. All numbers are whole, as in the data.
    """

    name = "interval-scheduling"
    package = "ortools"
    summary = "whole days in the orchard, by CP-SAT over intervals"
    interrupts = "keeps the best answer and the bound so far"
    honours = frozenset({"gap", "iterations"})
    order: ClassVar[int] = 10
    family = "orchard-day"
    features = frozenset({"objective:makespan", "objective:completion"})

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        lacking = super().missing(problem)
        if not lacking and problem.size > MOST_BINS:
            return frozenset({f"more than {MOST_BINS} bins"})
        return lacking

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from ortools.sat.python import cp_model

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        assert isinstance(problem, OrchardDay)
        self.converted(options)
        known = problem.answer_at_hand()
        value = problem.value(problem.timetable(known))
        control.publish(known, value)
        intervals = _Intervals(problem)
        solver, began = cp_model.CpSolver(), time.perf_counter()
        set_limits(solver.parameters, options)

        def hear(found: Any) -> None:
            control.publish(intervals.trips(found.value), float(found.objective_value))

        ended = search_until_stopped(solver, intervals.model, control, hear, lambda bound: control.publish(bound=float(bound)))
        status = STATUS_MAP[solver.status_name(ended)]
        limit = "none"
        if status in ("unknown", "feasible"):
            late = time.perf_counter() - began >= 0.98 * options.time_limit
            limit = "interrupt" if control.stopped else "time" if late else "iterations" if options.iterations is not None else "gap"
        answered = status in ("optimal", "feasible")
        if status == "optimal" and options.gap > 0.0 and solver.best_objective_bound < solver.objective_value:
            status, limit = "feasible", "gap"
        if status == "unknown":
            return RawResult(
                "feasible", limit, known, value, message="CP-SAT found no answer in time: bins are fetched as they are numbered"
            )
        return RawResult(
            status, limit, intervals.trips(solver.value) if answered else None, float(solver.objective_value) if answered else None,
            float(solver.best_objective_bound) if answered else None,
            statistics={"conflicts": int(solver.num_conflicts), **({} if options.start is None else {"start": "ignored"})},
        )  # fmt: skip


class _Intervals:
    """The model and its variables."""

    def __init__(self, problem: OrchardDay) -> None:
        from ortools.sat.python import cp_model

        self.problem, self.jobs, self.model = problem, problem.jobs, cp_model.CpModel()
        jobs, model = self.jobs, self.model
        known = problem.timetable(in_order(jobs, range(jobs.num_bins)))
        self.horizon = int(known.max() if problem.objective == "makespan" else known.sum())
        self.brought = [k for k in range(jobs.num_bins) if not jobs.standing[k]]
        self.begin, self.pick, self.full = ([self._step(f"{what}{k}") for k in range(jobs.num_bins)] for what in ("begin", "pick", "full"))
        self.stand = {a: self._step(f"stand{a}") for a in self.brought}
        self.with_ = {(a, b): model.new_bool_var(f"{a} with {b}") for a in self.brought for b in range(jobs.num_bins)}
        self.alone = {a: model.new_bool_var(f"{a} alone") for a in self.brought}
        self.alone_begin = {a: self._step(f"alone{a}") for a in self.brought}
        self.away = [r for r in range(jobs.num_robots) if jobs.away[r]]
        self.first = {(r, b): model.new_bool_var(f"{b} first of {r}") for r in self.away for b in range(jobs.num_bins)}
        self.goes_home = {r: model.new_bool_var(f"{r} goes home") for r in self.away}
        self._fill()
        self._travel()
        self._share()
        ends = [self.pick[b] + int(jobs.home[b]) for b in range(jobs.num_bins)]
        if problem.objective == "makespan":
            last = self._step("last")
            model.add_max_equality(last, ends)
            model.minimize(last)
        else:
            model.minimize(sum(ends))

    def _step(self, name: str) -> Any:
        return self.model.new_int_var(0, self.horizon, name)

    def _fill(self) -> None:
        """Steps from which bins can be full."""
        for k, before in enumerate(self.jobs.after.tolist()):
            work = int(self.jobs.work[k])
            self.model.add(self.full[k] >= self.stand.get(k, 0) + work)
            if before >= 0:
                self.model.add(self.full[k] >= self.full[before] + work)
            self.model.add(self.pick[k] >= self.full[k])

    def _travel(self) -> None:
        """The legs of a trip, one after the other."""
        jobs, model, times = self.jobs, self.model, self.jobs.grid.empty_times
        for b in range(jobs.num_bins):
            with_b = [self.with_[a, b] for a in self.brought]
            first_b = [self.first[r, b] for r in self.away]
            model.add_at_most_one([*with_b, *first_b])
            model.add(self.pick[b] >= self.begin[b] + int(jobs.out[b])).only_enforce_if([~v for v in first_b])
            for r in self.away:
                model.add(self.begin[b] == 0).only_enforce_if(self.first[r, b])
                reached = int(jobs.robot_free[r] + times[jobs.robot_cells[r], jobs.bin_cells[b]])
                model.add(self.pick[b] >= reached).only_enforce_if(self.first[r, b])
            for a in self.brought:
                model.add(self.stand[a] >= self.begin[b] + int(jobs.out[a])).only_enforce_if(self.with_[a, b])
                between = int(times[jobs.bin_cells[a], jobs.bin_cells[b]])
                model.add(self.pick[b] >= self.stand[a] + between).only_enforce_if(self.with_[a, b])
        for a in self.brought:
            model.add_exactly_one([self.alone[a], *(self.with_[a, b] for b in range(jobs.num_bins))])
            model.add(self.stand[a] >= self.alone_begin[a] + int(jobs.out[a])).only_enforce_if(self.alone[a])
        for r in self.away:
            model.add_exactly_one([self.goes_home[r], *(self.first[r, b] for b in range(jobs.num_bins))])

    def _share(self) -> None:
        """No more trips at once than robots."""
        jobs, model = self.jobs, self.model
        taken, longest = [], self.horizon + int(jobs.grid.empty_times.max())
        for b in range(jobs.num_bins):
            end = self.pick[b] + int(jobs.home[b])
            length = model.new_int_var(0, longest, f"length{b}")
            taken.append(model.new_interval_var(self.begin[b], length, end, f"trip{b}"))
        for a in self.brought:
            length = model.new_int_var(0, longest, f"alone length{a}")
            back = self.stand[a] + int(jobs.grid.empty_times[jobs.bin_cells[a], jobs.grid.home])
            taken.append(model.new_optional_interval_var(self.alone_begin[a], length, back, self.alone[a], f"alone trip{a}"))
        for r in range(jobs.num_robots):
            until = int(jobs.robot_free[r] + jobs.grid.empty_times[jobs.robot_cells[r], jobs.grid.home])
            if r in self.goes_home:
                taken.append(model.new_optional_fixed_size_interval_var(0, until, self.goes_home[r], f"home{r}"))
            elif until:
                taken.append(model.new_fixed_size_interval_var(0, until, f"busy{r}"))
        model.add_cumulative(taken, [1] * len(taken), jobs.num_robots)

    def trips(self, value: Any) -> Trips:
        """The answer: trips in the order of their beginning, each to a robot that is free then."""
        jobs = self.jobs
        own: list[list[tuple[int, int]]] = [[] for _ in range(jobs.num_robots)]
        free = (jobs.robot_free + jobs.grid.empty_times[jobs.robot_cells, jobs.grid.home]).tolist()
        spans = []
        for b in range(jobs.num_bins):
            bring = next((a for a in self.brought if value(self.with_[a, b])), -1)
            robot = next((r for r in self.away if value(self.first[r, b])), None)
            end = value(self.pick[b]) + int(jobs.home[b])
            if robot is None:
                spans.append((value(self.begin[b]), end, (bring, b)))
            else:
                own[robot].append((-1, b))
                free[robot] = end
        for a in self.brought:
            if value(self.alone[a]):
                back = value(self.stand[a]) + int(jobs.grid.empty_times[jobs.bin_cells[a], jobs.grid.home])
                spans.append((value(self.alone_begin[a]), back, (a, -1)))
        for begin, end, trip in sorted(spans):
            robot = min((r for r in range(jobs.num_robots) if free[r] <= begin), key=lambda r: (free[r], r))
            own[robot].append(trip)
            free[robot] = end
        return tuple(tuple(trips) for trips in own)
