"""Ruin and recreate: strings of visits are removed from routes that are near to each other, and inserted again where they cost least."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.routes import Route, Routes
from ....formulations.stop import Stop, now
from ....instances.errors import UsageError
from ....instances.memory import fits
from ....instances.number_arrays import Integers
from ...backend import BACKENDS, Control, Options, RawResult
from .abreast import abreast
from .bisection import Bisecting
from .pace import Pace
from .parts import SET_UP, WHOLE_BYTES, Search, arranged, divides, memory, places, result_of
from .routing_integers import entangled, searched_integers
from .routing_objective import unscalable
from .side_by_side import SideBySide, collect, following

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

LEAST = {"removals": 1.0, "string": 1.0, "neighbours": 1, "hot": 0.0, "cold": 0.0, "worth": 0.0}
"""Smallest values of its options."""

PIECE = 0.02
"""Seconds of searching between two looks at the clock."""

MEASURED = 0.1
"""Seconds of searching after which its speed is told."""

FEW = 300
"""Ruins for each customer below which there is no time to cool down from far above a start: it is bettered from where it is."""

WARMER_WITH_WINDOWS = (3.0, 2.0)
"""Factors of the first and of the last temperature for problems with time windows: there a search that begins at the usual temperature
seldom gets rid of a route."""

WARMER = 2.0, 2.0
"""The same for others in which all sites are required."""

WARMER_WITH_REWARDS = 3.0, 1.0
"""The same for others in which rewards are all that counts: which part of the plane is visited is settled early."""

ANNEALS, AMPLE, FROM_NOTHING = 4, 12_000, 0.6
"""How many anneals there are from nothing where there is time for so many ruins for each customer, and their share of the time; with less,
one long anneal is better."""

COOLEST, LARGE = 0.25, 300
"""With less time the one anneal begins cooler, in proportion down to this share, from this number of customers on: few customers need the
warmth to get from one fleet to another."""

RECOMBINED = 200
"""Ruins for each customer of an anneal that begins with an answer made of two."""

COOLER, REWARMED = 0.2, 0.2
"""First temperatures of all anneals but the first, and of those that begin with an answer made of two, as shares of the first one's: short
ones end better when they begin cool, while only a warm one gets rid of a route too many."""

COMBINED, COMBINING = 0.9, 0.07
"""Share of the time after which the best answer that routes of all answers make up is looked for, and share of the time for that."""

COMBINED_AGAIN = 100
"""Ruins for each customer for which one part of the best answer may be looked at then, if no clock ends it."""

PLACING = 0.2
"""Share of the time for places of required sites that are left out, and for fewer vehicles where a vehicle outweighs all else."""

WARMTH, PRICE, GROWTH = 0.3, 5.0, 0.01
"""Temperature of the search for places, the price of a visit left out at first, and by what it grows a step: all in mean moves."""

PATIENCE = 1000
"""Steps of it between two looks at the clock."""


@BACKENDS.register("ruin-recreate")
class RuinRecreate(Bisecting):
    """Ruin and recreate with string removal, greedy insertion with blinks and annealing (Christiaens & Vanden Berghe 2020).

    ``iterations`` counts ruins. Options: ``removals``, how many visits are removed on the mean; ``string``, the longest string of them;
    ``neighbours``, next to how many customers a visit is inserted, twice as many where sites outside groups may be left out; ``hot`` and
    ``cold``, the temperatures at the beginning and the end, in lengths of a mean move (three times and twice that where windows bind, three
    times and once where rewards are all that counts, twice both where all sites are required); ``worth``, where rewards are all that
    counts, for how many times the cost of the routes all rewards on them are taken in the search, 0 for what they are in the objective.
    """

    name = "ruin-recreate"
    package = "waybound"
    modules = ("numba",)
    summary = "ruin and recreate of routes, by annealing"
    options = MappingProxyType({"removals": 10.0, "string": 10.0, "neighbours": 60, "hot": 1.0, "cold": 0.01, "worth": 2.0})
    order = 25
    honours = frozenset({"iterations", "no_improvement", "gap"})
    mixed_maxima = True
    bytes_a_move, seconds_a_move = 50.0, 4e-7
    features = frozenset(
        {
            "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "optional-sites", "groups",
            "reloads", "overtime", "committed-vehicles", "min-vehicles", "limited-fleet", "heterogeneous-fleet", "multiple-depots",
            "open-routes", "fixed-cost", "separate-durations", "energy:travel", "energy:elapsed", "energy:elapsed-fixed-start",
            "initial-energy", "shifts", "duration-cost", "vehicle-speeds", "vehicle-travel", "several-loads", "pickups", "shipments",
            "several-windows", "skills", "forbidden-moves", "closing-moves", "energy:windows", "recharging", "objective:total-cost",
            "objective:total-duration", "objective:vehicles", "objective:reward", "objective:penalties", "objective:makespan",
            "objective:longest-route", "objective:latest-return", "objective:weights", "objective:priorities", "route-risk", "team-risk",
        }
    )  # fmt: skip

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        features = problem.features()
        # What a move is charged by windows depends on the moment when a depot opens, which is another one on the way.
        paused = {f"energy:windows with {name}" for name in ("reloads", "recharging") if features >= {"energy:windows", name}}
        recharged = {f"recharging with {name}" for name in ("reloads", "shipments") if features >= {"recharging", name}}
        return unscalable(problem) | paused | recharged | entangled(problem)

    def unasked(self, problem: Problem) -> bool:
        """Not for risks of few customers: the program that chooses among all their routes is solved at once."""
        return not (problem.features() & {"route-risk", "team-risk"} and "set-partitioning" in problem.forms())

    def memory(self, problem: Problem) -> float:
        return memory(problem) if divides(problem, Options()) else super().memory(problem)  # type: ignore[arg-type]

    def set_up_seconds(self, problem: Problem) -> float:
        return SET_UP * problem.size if divides(problem, Options()) else super().set_up_seconds(problem)  # type: ignore[arg-type]

    def seconds_at(self, speed: float, customers: int, routes: int, left: float) -> float:
        """For how many of the seconds that are left it goes on, told its speed in ruins a second on all of its threads and how many routes
        the best answer has: for who has other plans for the rest."""
        return left

    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        asked = {**self.options, **self.converted(options).extra}
        for name, least in LEAST.items():
            if not least <= asked[name] < math.inf:
                raise UsageError(f"ruin-recreate: {name} must be at least {least:g}, not {asked[name]!r}", "out-of-range")
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        if not len(problem.customers):
            return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
        control.begin_set_up()
        began = time.perf_counter()
        if divides(problem, options):
            warmer = WARMER_WITH_WINDOWS
            parts = Search(problem, options, asked, control, stop, few=FEW, warmer=warmer)
            control.end_set_up(time.perf_counter() - began)
            return parts.run()
        search = _Search(problem, options, asked, control, stop, self.seconds_at)
        control.end_set_up(time.perf_counter() - began)
        found = search.run()
        if found is not None:
            return found
        team, lock = [search], threading.Lock()

        def member(problem: RoutingProblem, own: Options, line: Control) -> RawResult:
            stop = Stop(own.time_limit)
            line.on_stop(stop.ask)
            with lock:
                one = _Search(problem, own, asked, line, stop, self.seconds_at, team, search.abreast)
                team.append(one)
            found = one.run()
            assert found is not None
            return found

        return abreast(member, problem, replace(options, time_limit=stop.seconds_left), control, search.abreast)


@dataclass
class Course:
    """Temperatures of a run: one anneal, or several from nothing for a share of the time, and then short ones of answers made of two."""

    hot: float
    cold: float
    anneals: int = 1
    stage: int = 0
    begun: float = 0.0
    steps: int = 0

    def over(self, share: float, done: int) -> bool:
        """Whether an anneal is over, told the share of the run that is."""
        return self.anneals > 1 and self.done(share, done) >= 1.0

    def done(self, share: float, done: int) -> float:
        """How much of the anneal at hand is over."""
        if self.stage >= self.anneals:
            return (done - self.begun) / self.steps
        return share if self.anneals == 1 else (share - self.begun) * self.anneals / FROM_NOTHING

    def next(self, share: float, done: int, steps: int) -> bool:
        """Go on to the next anneal; whether it begins from nothing, or lasts so many steps."""
        self.stage += 1
        fresh = self.stage < self.anneals
        self.begun, self.steps = (share, 0) if fresh else (done, steps)
        return fresh

    def warmth(self, share: float, done: int) -> float:
        """The temperature."""
        hot = self.hot * (1.0 if self.stage == 0 else COOLER if self.stage < self.anneals else REWARMED)
        return float(self.cold * (max(hot, self.cold) / self.cold) ** (1.0 - min(1.0, self.done(share, done))))


class _Search:
    """One run: cools down, publishes its incumbents, and translates its answers."""

    def __init__(
        self,
        problem: RoutingProblem,
        options: Options,
        asked: dict[str, Any],
        control: Control,
        stop: Stop,
        seconds_at: Callable[[float, int, int, float], float],
        team: Sequence[_Search] = (),
        many: int = 1,
    ) -> None:
        from .ruin_recreate_steps import columns, search_kernels
        from .ruin_recreate_steps.arrays import arrays
        from .ruin_recreate_steps.elites import Elites
        from .ruin_recreate_steps.partition import Pool

        self.problem, self.options, self.asked, self.control, self.stop = problem, options, asked, control, stop
        self.seconds_at = seconds_at
        self.kernels, self.columns = search_kernels, columns
        self.data, self.sloped = searched_integers(problem)
        settled = problem.sites.required.copy()
        settled[[site for group in problem.sites.groups for site in group.sites]] = True
        optional = not settled[problem.customers].all()
        part = arranged(problem, self.data)
        self.site_of = part.sites.tolist() if part else list(range(len(problem.sites)))
        inner, data = (part.problem, part.data) if part else (problem, self.data)
        self.held = arrays(inner, data, int(asked["neighbours"]) * (2 if optional else 1), options.seed % 2**64)
        self.best, self.own = np.zeros((2, 1 + len(self.held.node)), dtype=np.int64)  # of all, and of the anneal at hand
        self.team, self.abreast, self.bytes = team, many, WHOLE_BYTES * problem.size**2
        self.elites: Elites = copy(team[0].elites) if team else Elites(self.held, options.seed)
        coupled = (
            self.held.flags & (columns.COUNTED | columns.SHARED | columns.TOPPED)
            or len(self.held.depots)
            or self.held.types[:, columns.HOME].any()
        )
        self.pool: Pool | None = None if coupled else copy(team[0].pool) if team else Pool(self.held, options.seed)
        if self.pool:
            self.pool.held, self.pool.looked = self.held, 0
        self.lock: threading.Lock = team[0].lock if team else threading.Lock()
        self.sizes = np.array([asked["string"], asked["removals"], 0.0, 0.0])
        shared = part and options.threads > 1
        at = places(problem)[self.site_of] if shared else None
        self.beside = None if at is None else SideBySide(self.held, at, self.sizes, self.pool, self.lock, stop, options.seed)
        self.answer: Routes | None = None
        self.value: float | None = None
        self.told, self.pace = int(np.iinfo(np.int64).max), Pace()

    def run(self) -> RawResult | None:
        """Search to the end; None where several searches beside each other, ``abreast`` of them, make more of the threads."""
        k, sums = self.columns, self.held.sums
        if not self.held.types[:, k.SLOTS].any():
            message = "no vehicle can leave its depot and return in time"
            return RawResult("infeasible" if self.problem.sites.required.any() else "unknown", message=message)
        self.kernels.anneal.make()
        most, idle = self.options.iterations or math.inf, self.options.no_improvement or math.inf
        start = self.options.start is not None and self.begin(self.options.start)
        self.take_at_hand()
        self.own[:] = self.best
        self.publish()
        began, pieces, whole = now(), 64, max(1e-9, self.options.time_limit)
        self.advance(int(min(self.held.most_visits, most)), 0.0)
        self.sizes[3] = self.load_price()
        self.find_places(most, idle)
        rewarded = self.data.prize.any() and self.sloped and self.asked["worth"] and not self.data.maxima.any()
        if rewarded:
            self.held.reward(self.asked["worth"])
        move = self.mean_move()
        optional = (self.held.site[self.held.customers, k.REQUIRED] == 0).any()
        others = WARMER_WITH_REWARDS if rewarded else (1.0, 1.0) if optional else WARMER
        warmer = WARMER_WITH_WINDOWS if self.held.flags & k.TIMED else others
        hot, cold = (self.asked[name] * move * more for name, more in zip(("hot", "cold"), warmer, strict=True))
        course = Course(max(hot, 1e-9), max(cold, 1e-9))
        at, share, limit, measured, combined = 0, 0.0, "time", not self.by_clock, 0
        if math.isfinite(most):
            self.plan(course, most)
        if self.goes_abreast(course):
            return None
        while not self.stop.reached() and now() - began < whole:
            done = int(sums[k.STEPS])
            if not measured and now() - began >= MEASURED:
                measured = True
                spent = now() - began
                routes = len(self.held.routes(self.best[1:]))
                speed = done / spent * self.abreast
                whole = spent + self.seconds_at(speed, self.held.most_visits, routes, self.stop.seconds_left)
                self.plan(course, done / spent * whole)
                if self.goes_abreast(course):
                    return None
                if start and done / spent * whole < FEW * self.held.most_visits:
                    course.hot = min(course.hot, 3.0 * course.cold)
            if done >= most or done - at >= idle:
                limit = "iterations"
                break
            if math.isfinite(most):
                share = done / most
            else:  # a run that no clock may steer cools down by how long nothing was gained
                share = (now() - began) / whole if self.by_clock else max(share, (done - at) / idle)
            if course.over(share, done):
                self.go_on(course, share, done)
            if share >= (COMBINED if combined or course.anneals == 1 else FROM_NOTHING) and combined < min(2, course.anneals):
                combined += 1
                self.combine(COMBINING * whole)
            started, value, piece = now(), self.best[0], int(min(pieces, most - done, idle - (done - at)))
            many = self.advance(piece, course.warmth(share, done))
            at = int(sums[k.STEPS]) if self.best[0] < value else at
            if self.by_clock:
                took = (now() - started) * many * piece / max(1, sums[k.STEPS] - done)
                pieces = max(16, int(pieces * min(4.0, PIECE / max(1e-6, took))))
            self.publish()
        self.publish(last=True)
        missing = sorted(self.site_of[c] for c in self.held.unserved(self.best[1 : 1 + len(self.held.site)] >= 0).tolist())
        statistics = {"iterations": int(sums[k.STEPS]), "better": int(sums[k.BETTER])}
        limit = "interrupt" if self.control.stopped else limit
        return result_of(self.problem, self.data, self.options, self.answer, self.value, limit, statistics, start, missing)

    def begin(self, answer: Routes) -> bool:
        """Take the routes of an answer; whether it is one of these customers."""
        place = {site: c for c, site in enumerate(self.site_of)}
        if not all(c in place for one in answer for c in one.visits):
            return False
        return self.held.begin(Routes.of(Route(tuple(place[c] for c in one.visits), one.vehicle) for one in answer))

    def find_places(self, most: float, idle: float) -> None:
        """Find places for required sites that are left out, and, where a vehicle outweighs all else that routes cost, dissolve one route
        after the other as long as its sites find places on the others.

        Meanwhile a site left out counts for more with each step that leaves it out, until others make room for it: the sums of absences of
        Christiaens and Vanden Berghe (2020), as prices.
        """
        k, held = self.columns, self.held
        types, slots, used = held.types, held.types[:, k.SLOTS].copy(), held.types[:, k.USED] > 0
        fixed = self.price_of_use()
        required = held.customers[held.site[held.customers, k.REQUIRED] > 0]
        running = int(held.route[:, k.COST].sum() - (fixed * types[:, k.USED]).sum())
        outweighed = used.any() and fixed[used].min() >= max(1, running)
        if not len(required) or not (outweighed or self.lacking):
            return
        ends, move = now() + PLACING * self.stop.seconds_left, self.mean_move()
        steps_end = held.sums[k.STEPS] + (math.inf if self.by_clock else PLACING * most if math.isfinite(most) else idle)
        fewest = max(1, 0 if held.flags & k.GROUPED else self.data.fewest(), self.problem.min_vehicles)  # loads of groups are alternatives
        prices, nothing = held.site[:, k.MISSED].copy(), np.full_like(self.best, -k.NONE)
        types[:, k.FIXED] -= fixed
        held.alone[:] -= np.where(held.alone < k.NONE, fixed[:, None], 0)
        held.site[required, k.MISSED], self.sizes[2] = max(1, round(PRICE * move)), max(1.0, GROWTH * move)
        held.put(held.routes(self.best[1:]))
        while True:
            if not self.lacking:
                self.take_at_hand()
                self.best[0] += (fixed * types[:, k.USED]).sum()
                self.publish()
                if not outweighed or types[:, k.USED].sum() <= fewest:
                    break
                routes = held.routes(self.best[1:])
                lightest = min(routes, key=lambda one: held.site[list(one.visits), k.MISSED].sum())
                types[:, k.SLOTS] = types[:, k.USED]
                types[lightest.vehicle, k.SLOTS] -= 1
                held.put(Routes.of(one for one in routes if one is not lightest))
            steps = min(PATIENCE, steps_end - held.sums[k.STEPS])
            if steps < 1 or self.stop.reached() or (self.by_clock and now() > ends):
                break
            self.kernels.anneal(self.stop.flag, *held.parts, nothing, self.sizes, int(steps), WARMTH * move, held.flags)
        types[:, k.FIXED] += fixed
        held.alone[:] += np.where(held.alone < k.NONE, fixed[:, None], 0)
        types[:, k.SLOTS] = slots
        held.site[:, k.MISSED], self.sizes[2] = prices, 0.0
        held.put(held.routes(self.best[1:]))
        self.best[0] = held.sums[k.OBJECTIVE]
        self.own[:] = self.best

    def take_at_hand(self) -> None:
        """Take the routes at hand for the best answer."""
        with self.lock:
            self.best[:] = following(self.held)

    @property
    def lacking(self) -> bool:
        """Whether the routes at hand leave required sites out."""
        return len(self.held.unserved(self.held.node[: len(self.held.site), self.columns.ROUTE] >= 0)) > 0

    @property
    def by_clock(self) -> bool:
        """Whether a clock ends the search, and no work limit."""
        return self.options.iterations is None and self.options.no_improvement is None

    @property
    def threads(self) -> int:
        """Among how many threads the routes at hand can be shared out."""
        return self.beside.most(self.options.threads) if self.beside and self.by_clock else 1

    def advance(self, steps: int, warmth: float) -> int:
        """So many ruins, or some moments of such pieces on each of several threads; returns on how many."""
        many = self.threads
        if self.beside and many > 1:
            found = self.beside.anneal(many, steps, warmth)
            if found[0] < self.own[0]:
                self.own[:] = found
        else:
            self.kernels.anneal(self.stop.flag, *self.held.parts, self.own, self.sizes, steps, warmth, self.held.flags)
            collect(self.pool, self.lock)
        if self.own[0] < self.best[0]:
            with self.lock:
                self.best[:] = self.own
        return many

    def combine(self, seconds: float) -> None:
        """Go on from the best answer that routes of all answers make up, where it is better than any of them."""
        from .ruin_recreate_steps.partition import VISITS

        if self.pool is None:
            return
        k, held, ends, control = self.columns, self.held, now() + seconds, Control()
        self.control.on_stop(control.stop)
        with self.lock:
            self.best[:] = min((one.best for one in (self, *self.team)), key=lambda best: int(best[0]))
        held.put(held.routes(self.best[1:]))
        parts = held.sums[k.STEPS] // (COMBINED_AGAIN * held.most_visits)
        while not self.stop.reached() and (now() < ends if self.by_clock else parts > 0):
            parts -= 1
            left, many = ends - now() if self.by_clock else self.stop.seconds_left, self.threads
            several = many > 1 and len(held.customers) > many * VISITS
            if self.beside and several:
                self.beside.combine(many, left, control)
            else:
                known = self.pool.routes
                self.pool.routes = dict(known) if self.team else known  # which other threads change meanwhile
                better = self.pool.better(left, control)
                self.pool.routes = known
                if better is not None:
                    held.put(better)
            if held.sums[k.OBJECTIVE] < self.best[0]:
                self.take_at_hand()
                self.publish()
            elif self.pool.whole and not several:
                break
        held.put(held.routes(self.best[1:]))
        self.own[:] = self.best

    def goes_abreast(self, course: Course) -> bool:
        """Whether several searches shall go on in place of this one: their anneals side by side, or because routes are few."""
        threads = self.options.threads if self.by_clock and self.abreast == 1 else 1
        each = 1 if course.anneals > 1 else self.threads
        if threads // each < 2 or not fits(threads // each * self.bytes):
            return False
        self.abreast = threads // each
        return True

    def plan(self, course: Course, ruins: float) -> None:
        """Choose how many anneals there are, and how warm the first one begins, told for how many ruins there is time."""
        k, ample = self.columns, AMPLE * self.held.most_visits
        coupled = self.held.flags & (k.RELOADING | k.RECHARGING)  # routes of two answers do not go together then
        course.anneals = 1 if coupled or ruins * self.abreast < ample else max(2, ANNEALS // self.abreast)
        if self.held.most_visits >= LARGE:
            course.hot *= min(1.0, max(COOLEST, ruins / ample))

    def go_on(self, course: Course, share: float, done: int) -> None:
        """Keep the answer of an anneal, and begin the next one: from nothing, or from an answer made of two."""
        self.elites.add(int(self.own[0]), self.held.routes(self.own[1:]))
        fresh = course.next(share, done, RECOMBINED * self.held.most_visits)
        if not self.held.put(Routes(()) if fresh else self.elites.make()):
            self.held.put(self.held.routes(self.best[1:]))
        self.own[0] = np.iinfo(np.int64).max

    def mean_move(self) -> float:
        """Cost of a move on the mean, without that of the vehicles, no less than to the next customer; where nobody is visited, of those
        to one site and back. Routes alone do not tell where only who is near pays so far."""
        k, route, types = self.columns, self.held.route, self.held.types
        if not route[:, k.VISITS].any():
            costs = (self.held.alone - self.price_of_use()[:, None])[:, self.held.customers]
            known = costs[self.held.alone[:, self.held.customers] < k.NONE]
            return float(np.abs(known).mean()) / 2.0 if len(known) else 0.0
        moves = int(route[:, k.VISITS].sum() + (route[:, k.VISITS] > 0).sum())
        least = self.held.next_move() * int(types[:, k.UNIT].min())
        return max(least, float(route[:, k.COST].sum() - (types[:, k.FIXED] * types[:, k.USED]).sum()) / max(1, moves))

    def price_of_use(self) -> Integers:
        """Cost of using one more vehicle of each type, without its travel. A committed vehicle has its fixed cost in any case, so that only
        the weight of the number of routes in the objective is left."""
        k, types = self.columns, self.held.types
        return np.where(types[:, k.COMMITTED] > 0, self.data.counted, types[:, k.FIXED])

    def load_price(self) -> float:
        """Cost of the routes at hand divided by the load they deliver, in the first load dimension; 0 where no load is limited."""
        k, held = self.columns, self.held
        if held.route.shape[1] == k.ROOM:
            return 0.0
        load = held.site[held.customers[held.node[held.customers, k.ROUTE] >= 0], k.DEMAND].sum()
        return float(held.route[:, k.COST].sum() / max(1, load))

    def publish(self, last: bool = False) -> None:
        """Hand out the best answer, if it is a new one and leaves no required customer out."""
        if self.best[0] >= self.told or not (last or self.pace.due):
            return
        following = self.best[1:]
        if len(self.held.unserved(following[: len(self.held.site)] >= 0)):
            return
        answer = Routes.of(Route(tuple(self.site_of[c] for c in one.visits), one.vehicle) for one in self.held.routes(following))
        if len(answer) < self.problem.min_vehicles:
            return
        self.told = int(self.best[0])
        with self.pace.handing_out():
            self.answer = answer
            self.value = self.problem.evaluate(self.answer).values[0] if len(self.problem.senses) == 1 else None
            self.control.publish(self.answer, self.value)
