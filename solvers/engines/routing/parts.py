"""Ruin and recreate of large problems, a part at a time: routes near to each other are a problem of their own.

In each round the routes are divided into parts, anew and across other borders each time (``ruin_recreate_steps.dividing``), and every part
is annealed from the routes that it has, at the temperature of the whole. Parts share no route, so that several threads anneal some at the
same time, and a round takes no more memory than its parts do: there is no matrix of all distances. Vehicles that nobody uses are handed out
to the parts, and sites that are on no route belong to the part that they lie in.

Source: Taillard and Voss (2002), POPMUSIC, in Essays and Surveys in Metaheuristics; that parts are best made by the barycentres of routes:
Santini, Schneider, Vidal and Vigo (2023), Decomposition strategies for vehicle routing heuristics, INFORMS Journal on Computing 35(3).
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.routing.routes import Route, Routes
from ....formulations.stop import Stop, now
from ....instances.memory import fits
from ...backend import Control, Options, RawResult
from .integer_scales import Floats, Integers
from .pace import Pace
from .routing_integers import IntegerRouting, searched_integers
from .ruin_recreate_steps.dividing import divided, positions

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem
    from .ruin_recreate_steps.arrays import Arrays
    from .ruin_recreate_steps.part_data import Part

SIZE = 500
"""Customers of a part, or more where that makes fewer than ``ROUTES`` routes."""

ROUTES = 8
"""Routes of a part at least: what one of them loses must find room on others."""

LARGEST = 3_000
"""Customers of a part at most, for it holds all moves between its sites; a longer route is left as it is."""

WHOLE = 1_500
"""Customers up to which all routes are annealed at once, or shared out among threads for moments."""

ALONE = 5_000
"""Customers from which no other engine comes to a search of its own within minutes."""

LAPS = 25, 80
"""Ruins for each customer in a round at least and at most: what is shared out more often mixes better, and takes longer to set up."""

MIXED = 8
"""Rounds that there shall be, if they are long enough."""

PROBED = 1_000
"""Ruins in a part that tell its speed."""

LEGS = 4
"""Temperatures of a part in a round, one after the other."""

INNER = 2.0
"""A move counts as long as so many of those between customers at most, when the first and the last temperature are told."""

RESERVED = 1.5
"""How many times as long as handing out the first answer takes is kept for the last one."""

LANDMARKS = 6
"""Sites from which distances tell where the others lie, if nothing else does."""

SPARE = 4
"""Vehicles that a part is given beyond those it uses and those that its sites on no route could need, if there are enough."""

BYTES = 4_000.0
"""Memory for each site."""

SET_UP = 2e-5
"""Seconds of setting up for each site."""

NEXT = 8
"""Customers that lie next to each other in memory: as many numbers as a line of the processor's cache holds."""

WHOLE_BYTES = 50.0
"""Memory for each two sites of a search that is not in parts."""

DIVISIBLE = frozenset(
    {
        "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "optional-sites", "limited-fleet",
        "heterogeneous-fleet", "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "energy:travel", "energy:elapsed",
        "energy:elapsed-fixed-start", "initial-energy", "shifts", "duration-cost", "vehicle-speeds", "vehicle-travel", "several-loads",
        "pickups", "skills", "forbidden-moves", "objective:total-cost", "objective:total-duration", "objective:vehicles",
        "objective:reward", "objective:penalties", "objective:weights", "objective:priorities",
    }
)  # fmt: skip
"""Features that couple routes through nothing but the fleet."""


def divisible(problem: RoutingProblem) -> bool:
    """Whether routes are coupled through nothing but the fleet."""
    charged = (k for k, v in enumerate(problem.fleet) if v.energy is not None and v.energy.charge == "travel")
    # Else no limit on distance stands for that on time on the move.
    return not problem.features() - DIVISIBLE and not any(problem.travel_of(k).own_durations for k in charged)


def divides(problem: RoutingProblem, options: Options) -> bool:
    """Whether the problem is searched in parts, however many threads there are."""
    customers = len(problem.customers)
    if customers < WHOLE or not divisible(problem):
        return False
    routes = problem.vehicle_limit
    if options.start is not None and fits(WHOLE_BYTES * customers**2):
        routes = len(options.start)
    return routes is None or routes >= 2 * ROUTES


def places(problem: RoutingProblem) -> Floats:
    """A point for each site."""
    coordinates = problem.travel.coordinates if problem.travel.coordinates is not None else problem.sites.coordinates
    if coordinates is not None:
        return positions(None, coordinates, problem.sites.geographic)
    every = np.arange(len(problem.sites))
    far = [problem.travel.distance(every, 0)]
    for _ in range(LANDMARKS):
        far.append(problem.travel.distance(every, int(np.argmax(np.min(far, axis=0)))))
    return positions(np.column_stack(far[1:]), None, False)


def arranged(problem: RoutingProblem, data: IntegerRouting) -> Part | None:
    """The whole problem as a part whose customers stand in the order in which they lie, so that what the search reads about near ones lies
    together in memory, too; None where it cannot be a part."""
    from .ruin_recreate_steps.part_data import Divisible

    customers = problem.customers
    counts = np.array([len(customers) if v.count is None else min(v.count, len(customers)) for v in problem.fleet])
    if not divisible(problem) or not (counts * (data.closes >= data.opens)).all():
        return None
    many = -(-len(customers) // NEXT)
    near = divided(places(problem)[customers], np.ones(len(customers), dtype=np.int64), many, np.random.default_rng(0))
    return Divisible(problem, data).part(customers[np.concatenate(near)], counts)


def memory(problem: RoutingProblem) -> float:
    """Bytes that a search in parts takes."""
    return BYTES * float(problem.size)


@dataclass(frozen=True, eq=False)
class State:
    """Routes, and the customers on none of them."""

    routes: list[Route]
    absent: list[int]


@dataclass(frozen=True, eq=False)
class Task:
    """The work on a part in one round: its routes and unvisited customers, its vehicles of each type, how many ruins, their temperatures,
    and the seed."""

    state: State
    counts: Integers
    steps: int
    warmths: tuple[float, ...]
    seed: int


@dataclass(frozen=True, eq=False)
class Done:
    """The result of a task: the routes at its end, the best ones on the way, and the values of start, best and end, in this order; ruins,
    and how many found a new best answer; seconds, and whether windows or hours limit the part.

    ``met`` are cost, without that of vehicles, and number of moves of the routes at the end, the rewards on them, their length, and length
    and number of their moves between customers.
    """

    last: State
    best: State
    values: tuple[int, int, int]
    met: Integers
    steps: int
    better: int
    seconds: float
    timed: bool


class Search:
    """One run: divides, has the parts annealed, and puts them together again.

    Parameters
    ----------
    problem, options, asked, control, stop
        What is searched, how, by which options of its own, who hears of it, and when it ends.
    few : int
        Ruins for each customer below which there is no time to cool down from far above a start.
    warmer : (float, float)
        Factors of the first and of the last temperature where anybody can come too late.
    """

    def __init__(
        self,
        problem: RoutingProblem,
        options: Options,
        asked: dict[str, Any],
        control: Control,
        stop: Stop,
        *,
        few: int,
        warmer: tuple[float, float],
    ) -> None:
        from .ruin_recreate_steps.arrays import dear
        from .ruin_recreate_steps.part_data import Divisible

        self.problem, self.options, self.asked, self.control, self.stop = problem, options, asked, control, stop
        self.few, self.warmer = few, warmer
        self.data, self.sloped = searched_integers(problem)
        self.whole = Divisible(problem, self.data)
        optional = not problem.sites.required[problem.customers].all()
        self.neighbours = int(asked["neighbours"]) * (2 if optional else 1)
        self.sizes = np.array([asked["string"], asked["removals"], 0.0, 0.0])
        self.lost = np.where(problem.sites.required, dear(problem, self.data), self.data.prize)
        self.places = places(problem)
        usable = self.data.closes >= self.data.opens
        self.counts = np.array([len(problem.customers) if v.count is None else min(v.count, len(problem.customers)) for v in problem.fleet])
        self.counts[~usable] = 0
        self.state = State([], problem.customers.tolist())
        self.best, self.value, self.best_value = self.state, 0, 0
        self.told: int | None = None
        self.met: Floats = np.zeros(6)
        self.worth: float | None = None
        self.steps = self.better = self.rounds = 0
        self.busy = 0.0
        self.timed = False
        self.answer: Routes | None = None
        self.claim: float | None = None
        self.pace, self.reserved = Pace(), False

    def run(self) -> RawResult:
        from .ruin_recreate_steps import search_kernels

        if not self.counts.any():
            message = "no vehicle can leave its depot and return in time"
            return RawResult("infeasible" if self.problem.sites.required.any() else "unknown", message=message)
        search_kernels.anneal.make()
        search_kernels.settle.make()
        start = self.options.start is not None and self.begin(self.options.start)
        limit = self.cool(start)
        self.publish(last=True)
        missing = [c for c in self.best.absent if self.problem.sites.required[c]]
        statistics = {"iterations": self.steps, "better": self.better, "rounds": self.rounds}
        limit = "interrupt" if self.control.stopped else limit
        return result_of(self.problem, self.data, self.options, self.answer, self.claim, limit, statistics, start, missing)

    def begin(self, answer: Routes) -> bool:
        """Take the routes of an answer, the longest ones where there are more than vehicles; whether it is one of these customers."""
        visited = [c for one in answer for c in one.visits]
        if len(set(visited)) < len(visited) or not set(visited) <= set(self.problem.customers.tolist()):
            return False
        left, kept = self.counts.copy(), []
        for one in sorted(answer, key=lambda one: -len(one.visits)):
            if 0 <= one.vehicle < len(left) and left[one.vehicle] and one.visits:
                left[one.vehicle] -= 1
                kept.append(Route(one.visits, one.vehicle))
        on_route = {c for one in kept for c in one.visits}
        self.state = self.best = State(kept, [c for c in self.problem.customers.tolist() if c not in on_route])
        return True

    def cool(self, start: bool) -> str:
        """All rounds; returns what ended them."""
        customers, threads = len(self.problem.customers), self.options.threads if self.by_clock else 1
        most, idle = self.options.iterations or math.inf, self.options.no_improvement or math.inf
        began, at = now(), 0
        with ThreadPoolExecutor(self.options.threads) as pool:
            if start and self.by_clock:
                self.round(pool, PROBED * threads, (0.0,), few=threads)
            else:
                self.round(pool, int(min(customers, most)), (0.0,))
            hot, cold = self.temperatures()
            lap = math.inf
            while not self.stop.reached():
                if self.steps >= most or self.steps - at >= idle:
                    return "iterations"
                left = most - self.steps
                if math.isinf(most):
                    left = self.steps / max(1e-9, self.busy) * self.stop.seconds_left * threads if self.by_clock else math.inf
                if math.isinf(lap):
                    lap = customers * min(LAPS[1], max(LAPS[0], left / customers / MIXED))
                    if start and left < self.few * customers:
                        hot = min(hot, 3.0 * cold)
                rounds = max(1, math.ceil(left / lap - 0.5)) if math.isfinite(left) else 1
                steps = int(max(1, min(left, idle, left / rounds if math.isfinite(left) else lap)))
                if self.by_clock:
                    share = (now() - began) / max(1e-9, now() - began + self.stop.seconds_left)
                    ahead = (1.0 - share) / rounds
                else:
                    share, ahead = (self.steps / most, steps / most) if math.isfinite(most) else (1.0, 0.0)
                shares = [share + ahead * leg / LEGS for leg in range(LEGS)]
                before, done = self.best_value, self.steps
                self.round(pool, steps, tuple(cold * (hot / cold) ** (1.0 - min(1.0, s)) for s in shares))
                at = self.steps if self.best_value < before else at
                if self.steps == done and not self.stop.reached():  # no part can do anything
                    return "none"
        return "time"

    @property
    def by_clock(self) -> bool:
        """Whether a clock ends the search, and no work limit."""
        return self.options.iterations is None and self.options.no_improvement is None

    def temperatures(self) -> tuple[float, float]:
        """The first and the last one, told by the routes that the first round ended with; from then on rewards are weighed."""
        cost, moves, collected, length, inner, inner_moves = self.met
        move = cost / max(1, moves)
        if length and inner:  # what the search does near to each other hangs little on how far away the depot is
            move *= min(1.0, INNER * inner / inner_moves * moves / length)
        if self.data.prize.any() and self.sloped and self.asked["worth"] and collected and cost:
            self.worth = self.asked["worth"] * cost / collected
        warmer = self.warmer if self.timed else (1.0, 1.0)
        hot, cold = (max(1e-9, self.asked[name] * move * more) for name, more in zip(("hot", "cold"), warmer, strict=True))
        return hot, cold

    # -- a round ---------------------------------------------------------------------------------------------------------

    def round(self, pool: ThreadPoolExecutor, steps: int, warmths: tuple[float, ...], few: int | None = None) -> None:
        """Anneal all parts, or a few."""
        random = np.random.default_rng([self.options.seed % 2**64, self.rounds])
        tasks, rest = self.tasks(random, steps, warmths, few)
        working = [pool.submit(self.anneal, task) for task in tasks]
        self.publish()
        done = [one.result() for one in working]
        self.rounds += 1
        best_value = self.value
        for one in done:
            self.value += one.values[2] - one.values[0]
            best_value += one.values[1] - one.values[0]
            self.steps += one.steps
            self.better += one.better
            self.busy += one.seconds
            self.timed = self.timed or one.timed
        self.state = _together([one.last for one in done] + rest)
        if best_value < self.best_value or self.rounds == 1:
            self.best_value, self.best = best_value, _together([one.best for one in done] + rest)
        self.met = np.sum([np.zeros(6), *(one.met for one in done)], axis=0)

    def tasks(self, random: np.random.Generator, steps: int, warmths: tuple[float, ...], few: int | None) -> tuple[list[Task], list[State]]:
        """The tasks of this round, and the states of the parts that have none."""
        routes, absent = self.state.routes, self.state.absent
        visits = np.array([len(one.visits) for one in routes], dtype=np.int64)
        flat = np.array([c for one in routes for c in one.visits], dtype=np.int64)
        middles = np.add.reduceat(self.places[flat], np.cumsum(visits) - visits) / visits[:, None] if routes else self.places[:0]
        points = np.concatenate([middles, self.places[absent]])
        weights = np.concatenate([visits, np.ones(len(absent), dtype=np.int64)])
        parts = divided(points, weights, self.many(len(routes) or self.problem.vehicle_limit), random)
        states, centres = [], []
        for part in parts:
            states.append(State([routes[k] for k in part if k < len(routes)], [absent[k - len(routes)] for k in part if k >= len(routes)]))
            centres.append(np.average(points[part], axis=0, weights=weights[part]))
        counts = self.shared(states, np.array(centres), random)
        size = np.array([int(weights[part].sum()) for part in parts])
        able = [
            k for k in range(len(parts)) if max((len(one.visits) for one in states[k].routes), default=0) <= LARGEST and counts[k].any()
        ]
        able = [able[k] for k in random.permutation(len(able))[:few]]
        able.sort(key=lambda k: -size[k] if few is None else k)
        share = np.floor(np.cumsum(size[able]) / max(1, size[able].sum()) * steps).astype(np.int64)
        seeds = random.integers(2**63, size=len(able))
        tasks = [
            Task(states[k], counts[k], int(many), warmths, int(seed))
            for k, many, seed in zip(able, np.diff(share, prepend=0), seeds, strict=True)
        ]
        working = set(able)
        return tasks, [state for k, state in enumerate(states) if k not in working]

    def many(self, routes: int | None) -> int:
        """How many parts there shall be, of so many routes."""
        customers, threads = len(self.problem.customers), self.options.threads
        if not self.rounds and not self.state.routes:
            return math.ceil(customers / (LARGEST if customers <= 4 * LARGEST else 2 * SIZE))
        many = math.ceil(customers / SIZE)
        if self.by_clock:  # no thread waits for others
            many = math.ceil(many / threads) * threads
        return max(many if routes is None else min(many, routes // ROUTES), math.ceil(customers / LARGEST))

    def shared(self, states: Sequence[State], centres: Floats, random: np.random.Generator) -> Integers:
        """Vehicles of each type for each part: those it uses, and a share of those that nobody does, the larger the more sites wait there
        and the nearer their depot is."""
        used = np.zeros((len(states), len(self.counts)), dtype=np.int64)
        for k, state in enumerate(states):
            for one in state.routes:
                used[k, one.vehicle] += 1
        waiting = np.array([len(state.absent) for state in states])
        wanted = waiting[:, None] + SPARE + used // 4
        granted = np.empty_like(used)
        for kind, vehicle in enumerate(self.problem.fleet):
            spare = int(self.counts[kind] - used[:, kind].sum())
            if spare >= wanted[:, kind].sum():
                granted[:, kind] = wanted[:, kind]
                continue
            far = np.linalg.norm(centres - self.places[vehicle.start], axis=1)
            weight = (1.0 + waiting) / (1e-9 + far / max(1e-9, float(far.mean()))) if len(self.whole.ends) > 1 else 1.0 + waiting
            upto = np.floor(np.cumsum(weight) / weight.sum() * spare + random.random())
            upto[-1] = spare
            granted[:, kind] = np.diff(np.minimum(upto, spare), prepend=0)
        return used + granted

    def anneal(self, task: Task) -> Done:
        """Anneal one part."""
        from .ruin_recreate_steps import columns as k
        from .ruin_recreate_steps.arrays import arrays
        from .ruin_recreate_steps.search_kernels import anneal

        began = time.perf_counter()
        if self.stop.reached():
            return Done(task.state, task.state, (0, 0, 0), np.zeros(6, dtype=np.int64), 0, 0, 0.0, self.timed)
        customers = np.sort(np.array([c for one in task.state.routes for c in one.visits] + task.state.absent, dtype=np.int64))
        part = self.whole.part(customers, task.counts)
        held = arrays(part.problem, part.data, self.neighbours, task.seed)
        place = dict(zip(part.sites.tolist(), range(len(part.sites)), strict=True))
        kinds = {kind: k for k, kind in enumerate(part.kinds.tolist())}
        held.begin(Routes(tuple(Route(tuple(place[c] for c in one.visits), kinds[one.vehicle]) for one in task.state.routes)))
        if self.worth is not None:
            held.weigh(self.worth)
        sums, best = held.sums, np.empty(1 + len(held.node), dtype=np.int64)
        best[0] = sums[k.OBJECTIVE]
        best[1:] = np.where(held.node[:, k.ROUTE] >= 0, held.node[:, k.FOLLOWING], -1)
        before = self.value_of(part, held, best)[1]
        legs = np.diff(np.linspace(0, task.steps, len(task.warmths) + 1).astype(np.int64))
        for steps, warmth in zip(legs.tolist(), task.warmths, strict=True):
            anneal(self.stop.flag, *held.parts, best, self.sizes, steps, warmth, held.flags)
        now_at = np.concatenate([[sums[k.OBJECTIVE]], np.where(held.node[:, k.ROUTE] >= 0, held.node[:, k.FOLLOWING], -1)])
        states, values = [], [before]
        for following in (best, now_at):
            left_out, value = self.value_of(part, held, following)
            routes = [
                Route(tuple(part.sites[list(one.visits)].tolist()), int(part.kinds[one.vehicle])) for one in held.routes(following[1:])
            ]
            states.append(State(routes, left_out.tolist()))
            values.append(value)
        return Done(
            states[1], states[0], (values[0], values[1], values[2]), self.met_by(held), int(sums[k.STEPS]), int(sums[k.BETTER]),
            time.perf_counter() - began, bool(held.flags & k.TIMED),
        )  # fmt: skip

    def met_by(self, held: Arrays) -> Integers:
        """``Done.met`` of the routes of a part."""
        from .ruin_recreate_steps import columns as k

        used = np.nonzero(held.route[:, k.VISITS])[0]
        heads = len(held.site) + 2 * used
        optional = held.customers[(held.node[held.customers, k.ROUTE] >= 0) & (held.site[held.customers, k.REQUIRED] == 0)]
        visits, length = int(held.route[used, k.VISITS].sum()), int(held.route[used, k.LENGTH].sum())
        ends = int(held.node[heads, k.AHEAD].sum() + held.node[held.node[heads + 1, k.PREVIOUS], k.AHEAD].sum())
        cost, collected = (
            int(held.route[used, k.COST].sum() - (held.types[:, k.FIXED] * held.types[:, k.USED]).sum()),
            int(held.site[optional, k.LOST].sum()),
        )
        return np.array([cost, visits + len(used), collected, length, length - ends, visits - len(used)])

    def value_of(self, part: Part, held: Arrays, following: Integers) -> tuple[Integers, int]:
        """Customers that are left out, and what the routes cost and what is left out counts, in the integers of the whole problem."""
        from .ruin_recreate_steps.columns import LOST

        absent = held.customers[following[1:][held.customers] < 0]
        left_out = part.sites[absent]
        return left_out, int(following[0] - held.site[absent, LOST].sum() + self.lost[left_out].sum())

    # -- answers ---------------------------------------------------------------------------------------------------------

    def publish(self, last: bool = False) -> None:
        """Hand out the best answer, if it is a new one and leaves no required customer out."""
        new = self.told is None or self.best_value < self.told
        if not self.rounds or not new or not (last or self.pace.due):
            return
        if self.problem.sites.required[self.best.absent].any():
            return
        self.told, began = self.best_value, now()
        with self.pace.handing_out():
            answer = Routes.of(self.best.routes)
            verdict = self.problem.evaluate(answer)
            if verdict.feasible:  # routes of a start that no part has looked at yet may break limits
                self.answer, self.claim = answer, verdict.values[0] if len(verdict.values) == 1 else None
                self.control.publish(self.answer, self.claim)
        if self.by_clock and not self.reserved:  # the last one shall be out when the time is up
            self.reserved, left = True, self.stop.seconds_left
            self.stop = self.stop.within(max(left / 2.0, left - RESERVED * (now() - began)))


def result_of(
    problem: RoutingProblem,
    data: IntegerRouting,
    options: Options,
    answer: Routes | None,
    claim: float | None,
    limit: str,
    statistics: dict[str, Any],
    started: bool,
    missing: Sequence[int],
) -> RawResult:
    """The result of a search: its answer, or a sentence that says what the best one lacks: required sites, or routes."""
    statistics = {**statistics, "scale": data.scales}
    if options.start is not None:
        statistics["start"] = "used" if started else "refused"
    if answer is not None:
        return RawResult("feasible", limit, answer, claim, statistics=statistics, holds=data.holds, links=(data.link,))
    names = ", ".join(problem.sites.ids[c] for c in missing[:5])
    message = f"no answer was found that visits every required site; the best one leaves out {len(missing)}: {names}"
    if not missing and problem.min_vehicles:
        message = f"no answer was found that has {problem.min_vehicles} routes"
    return RawResult("unknown", limit, statistics=statistics, message=message, links=(data.link,))


def _together(states: Sequence[State]) -> State:
    return State([one for state in states for one in state.routes], [c for state in states for c in state.absent])
