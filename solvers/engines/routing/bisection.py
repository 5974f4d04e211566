"""Objectives with the largest of all routes, for engines that limit routes one by one: bisection over the limit.

An answer of value at most v is one of the same problem whose routes are limited by v: the makespan by ``max_duration``, the longest route
by ``max_distance``, the latest return by the end of the shift. Limits are tried between the least that is not known to be in vain and the
best value so far. Each answer is one of the problem, and its value moves the upper end. That an engine finds none proves nothing: the lower
end says where to look next, and is no bound.

Levels of the objective before the largest route, as in ``Reward().then(Makespan())``, are what is searched for under each limit; an answer
counts where it is no worse at them. Levels after it are searched for last, under the best limit.
"""

import math
import time
from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

from ....formulations.problem import Problem
from ....formulations.programs.exactness import Exactness, Link
from ....formulations.routing.objective import Composable, Objective, TotalCost, TotalDuration, Weighted
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.reachability import unreachable
from ....instances.errors import UnsupportedError
from ...backend import Control, Engine, Options, RawResult
from .best_routes import BestRoutes, PartControl
from .extents import largest_distance, largest_duration
from .routing_objective import MAXIMA, longest_stay, stops_between

NEAR = 1e-3
"""Part of the best value to which the ends are brought together; then any better value is asked for."""

LESS = 1e-6
"""Part of the best value by which another one has to be better."""

USUAL_FEATURES = frozenset(
    {
        "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "optional-sites", "limited-fleet",
        "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "energy:travel", "energy:elapsed",
        "energy:elapsed-fixed-start", "initial-energy", "shifts", "duration-cost", "vehicle-speeds", "vehicle-travel", "several-loads",
        "pickups", "shipments", "several-windows", "skills", "objective:total-cost", "objective:total-duration", "objective:vehicles",
        "objective:reward", "objective:penalties", "objective:makespan", "objective:longest-route", "objective:latest-return",
        "objective:weights", "objective:priorities",
    }
)  # fmt: skip
"""Features that every engine here takes."""


class Bisecting(Engine):
    """An engine that takes objectives with one of ``MAXIMA`` by limiting routes.

    With ``own_maxima`` it takes them by itself where it can, with ``mixed_maxima`` where they are one term among others, which no limit
    replaces; otherwise ``beyond`` and ``search`` are for problems without any. With
    ``iterations_end`` iterations end a search that finds nothing, too; an engine that counts answers ends by the clock. ``bytes_a_move``
    and ``seconds_a_move`` are what the library's own model of all moves between sites takes, measured at 2,000 sites.
    """

    family: ClassVar[str] = "routing"
    own_maxima: ClassVar[bool] = False
    mixed_maxima: ClassVar[bool] = False
    iterations_end: ClassVar[bool] = True
    bytes_a_move: ClassVar[float] = 0.0
    seconds_a_move: ClassVar[float] = 0.0

    @abstractmethod
    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        """Combinations of its features that the engine does not take."""

    @abstractmethod
    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        """``Engine.run`` for a problem under which ``beyond`` names nothing."""

    def memory(self, problem: Problem) -> float:
        return self.bytes_a_move * float(problem.size) ** 2

    def set_up_seconds(self, problem: Problem) -> float:
        return self.seconds_a_move * float(problem.size) ** 2

    def missing(self, problem: Problem) -> frozenset[str]:
        lacking = super().missing(problem)
        if lacking:
            return lacking
        bisection = self._bisection(problem)  # type: ignore[arg-type]
        if isinstance(bisection, Bisection):
            return frozenset()
        return self.beyond(problem) if bisection is None or self.own_maxima else bisection  # type: ignore[arg-type]

    def bisects(self, problem: RoutingProblem) -> bool:
        """Whether a problem is solved by bisection, as a sequence of others."""
        return isinstance(self._bisection(problem), Bisection)

    def _bisection(self, problem: RoutingProblem) -> "Bisection | frozenset[str] | None":
        if self.own_maxima and not self.beyond(problem):
            return None
        bisection = Bisection.of(self, problem)
        return None if isinstance(bisection, frozenset) and self.mixed_maxima else bisection

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        bisection = self._bisection(problem)  # type: ignore[arg-type]
        if not isinstance(bisection, Bisection):
            return self.search(problem, options, control)  # type: ignore[arg-type]
        return _Search(self, bisection, options, control).run()


@dataclass(frozen=True)
class Bisection:
    """A problem with a level of the objective that is one of ``MAXIMA`` alone, ``term`` times ``weight``, and the problems with limits in
    its place.

    ``objective`` is what is searched for under a limit: the other levels, and where none follow what makes routes short.
    """

    problem: RoutingProblem
    term: str
    level: int
    weight: float
    objective: Objective

    @classmethod
    def of(cls, engine: Bisecting, problem: RoutingProblem) -> "Bisection | frozenset[str] | None":
        """None where the objective has none of ``MAXIMA``; the features in the way where one cannot be replaced by a limit."""
        levels = problem.objective.levels()
        held = {term.name for level in levels for _, term in level.terms} & set(MAXIMA)
        if not held:
            return None
        at = next(k for k, level in enumerate(levels) if any(term.name in MAXIMA for _, term in level.terms))
        weight, term = levels[at].terms[0]
        others = (*levels[:at], *levels[at + 1 :])
        further = {t.name for level in others for _, t in level.terms} & set(MAXIMA)
        hangs = term.name == "makespan" and problem.features() & {"route-risk", "team-risk"}  # on the longest duration that is allowed
        if further or hangs or len(levels[at].terms) > 1 or weight < 0:
            return frozenset(f"objective:{name}" for name in further or held)
        short: tuple[Composable, ...] = (TotalDuration(), TotalCost()) if term.name != "longest-route" else (TotalCost(),)
        tried: list[tuple[Weighted, ...]] = [others] if at + 1 < len(levels) else [(*others, *s.levels()) for s in short]
        if others:
            tried.append(others)
        lacking = []
        for one in (cls(problem, term.name, at, weight, Objective(each)) for each in tried):
            probe = one.limited(one.most)
            lacking.append((probe.features() - engine.features) | engine.beyond(probe))
            if not lacking[-1]:
                return one
        return min(lacking, key=len)

    @property
    def most(self) -> float:
        """A limit that some best answer keeps."""
        travels = [self.problem.travel_of(k) for k in range(len(self.problem.fleet))]
        moves = 4 * len(self.problem.sites) * (1 + stops_between(self.problem))
        if self.term == "longest-route":
            return 1.0 + moves * max(largest_distance(t) for t in travels)
        return 1.0 + abs(self.least) + longest_stay(self.problem) + moves * max(largest_duration(t) for t in travels)

    @property
    def least(self) -> float:
        """A value that no answer is below."""
        if self.term != "latest-return":
            return 0.0
        return min(max(float(self.problem.sites.ready[v.start]), v.shift[0]) for v in self.problem.fleet)

    def limited(self, most: float) -> RoutingProblem:
        """The problem with routes limited by ``most`` in place of the term; infinity is no limit."""
        if self.term == "makespan":
            fleet = [replace(v, max_duration=min(v.max_duration, most)) for v in self.problem.fleet]
        elif self.term == "longest-route":
            fleet = [replace(v, max_distance=min(v.max_distance, most)) for v in self.problem.fleet]
        else:
            fleet = [replace(v, shift=(v.shift[0], max(v.shift[0], min(v.shift[1], most)))) for v in self.problem.fleet]
        return replace(self.problem, fleet=tuple(fleet), objective=self.objective)


class _Search:
    """Tries limits, keeps the best answer, and divides time and iterations."""

    def __init__(self, engine: Bisecting, asked: Bisection, options: Options, control: Control) -> None:
        self.engine, self.asked, self.options, self.control = engine, asked, options, control
        self.problem = asked.problem
        self.ends = time.perf_counter() + options.time_limit
        self.iterations_left = options.iterations
        self.best = BestRoutes(asked.problem, control)
        self.tried = 0
        self.last = RawResult("unknown")

    def run(self) -> RawResult:
        asked, at = self.asked, self.asked.level
        began = self.options.start is not None and self.best.take(self.options.start)
        follows = at + 1 < len(self.problem.senses)
        for share in (0.3 if at else 0.1 if self.repeats else 1.0, 1.0):
            if self.best.answer is None or (at and not self.tried):
                self.probe(math.inf, share, enough=not at)
        if self.best.answer is None:
            return self.last
        low = asked.least
        while not self.spent:
            high, above = self.value, self.before
            near = high - low <= NEAR * abs(high)
            limit = high - LESS * abs(high) if near else (low + high) / 2.0
            if limit <= asked.least:
                break
            steps = 1.0 if near else math.log2((high - low) / (NEAR * abs(high))) + 2.0
            if self.probe(limit, (0.5 if follows else 1.0) / steps, enough=True):
                low = low if self.before == above else asked.least
            elif near:
                break
            else:
                low = limit
        if follows and not self.spent:
            self.probe(self.value, 1.0, enough=False)
        result = self.result()
        return replace(result, statistics={**result.statistics, "start": "used"}) if began else result

    @property
    def value(self) -> float:
        """Value of the largest route in the best answer."""
        assert self.best.values is not None
        return self.best.values[self.asked.level] / self.asked.weight

    @property
    def before(self) -> tuple[float, ...]:
        """Values of the best answer at the levels before."""
        assert self.best.values is not None
        return self.best.values[: self.asked.level]

    @property
    def spent(self) -> bool:
        return self.control.stopped or time.perf_counter() >= self.ends or (self.iterations_left is not None and self.iterations_left <= 0)

    @property
    def repeats(self) -> bool:
        """Whether the run shall repeat, so that no clock may end a probe."""
        return self.engine.iterations_end and (self.options.iterations is not None or self.options.no_improvement is not None)

    def probe(self, limit: float, share: float, *, enough: bool) -> bool:
        """Search under a limit with a share of the time left; whether that found a better answer, the first of which may be ``enough``."""
        problem = self.asked.limited(limit)
        self.tried += 1
        if math.isfinite(limit) and any(problem.sites.required[site] for site in unreachable(problem)):
            return False
        seconds = max(0.0, self.ends - time.perf_counter()) * (1.0 if self.repeats else share)
        most = None if self.iterations_left is None else max(1, int(self.iterations_left * share))
        start = self.best.answer or self.options.start
        control = _ProbeControl(self, enough and not self.repeats)
        known = self.best.answer
        self.last = self.engine.search(problem, replace(self.options, time_limit=seconds, iterations=most, start=start), control)
        if self.iterations_left is not None:
            statistics = self.last.statistics
            self.iterations_left -= max(1, int(statistics.get("iterations", statistics.get("solutions", most or 1))))
        if self.last.answer is not None:
            self.best.take(self.last.answer)
        return self.best.answer is not known

    def result(self) -> RawResult:
        limit = self.last.limit if self.last.limit != "interrupt" else "none"  # which is how the first better answer ends a probe
        if self.control.stopped:
            limit = "interrupt"
        elif self.iterations_left is not None and self.iterations_left <= 0:
            limit = "iterations"
        elif time.perf_counter() >= self.ends:
            limit = "time"
        statistics = {**self.last.statistics, "limits_tried": self.tried}
        if self.options.iterations is not None and self.iterations_left is not None:
            statistics["iterations"] = self.options.iterations - self.iterations_left
        detail = f"routes limited in place of {self.asked.term}, {self.tried} limit{'s' if self.tried != 1 else ''} tried"
        links = (*self.last.links, Link("bisection", Exactness.RESTRICTION, detail))
        return RawResult(
            "feasible", limit, self.best.answer, self.best.claim, statistics=statistics, holds=Exactness.RESTRICTION, links=links
        )


class _ProbeControl(PartControl):
    """The line to a probe, which its first better answer ends where that is enough."""

    def __init__(self, search: _Search, enough: bool) -> None:
        super().__init__(search.best, search.tried == 1)
        self._enough = enough

    def taken(self) -> None:
        if self._enough:
            self.stop()
