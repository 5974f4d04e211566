"""VROOM: many constructions, each improved by local search, until none of them gets better.

Rewards become its priorities: it assigns as much priority as it can, then as many sites, and then looks at costs.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import timedelta
from types import MappingProxyType
from typing import Any

import numpy as np

from ....formulations.checking.granularity import grain
from ....formulations.programs.exactness import Exactness
from ....formulations.routing.objective import Objective, TotalCost
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Route, Routes
from ....instances.errors import UsageError
from ...backend import BACKENDS, Control, Options, RawResult
from .bisection import USUAL_FEATURES, Bisecting
from .integer_scales import UNLIMITED, Floats, Integers
from .routing_integers import IntegerRouting, entangled, fitting_integers
from .routing_objective import awaited, claimed_objective, unscalable

FINE = (1_000_000, 100_000, 10_000, 1_000, 100, 10)
"""Scales of data that three decimals cannot hold: the first that leaves room."""

FIRST, DEEPEST = 0, 5
"""Least and largest exploration level."""

LARGEST = 2**32 - 1
"""VROOM reads costs, distances and times as 32 bits without a sign, and refuses costs whose sum along an answer could be larger."""

SEARCHES = 32
"""The most searches that VROOM makes at once. With fewer threads they wait at a semaphore of libstdc++, which may miss that it is free, and
then waits for ever (GCC#98033)."""

STAYS = frozenset({"max-duration", "energy:elapsed"})
"""Limits on a route's duration. VROOM has one on time on the move: where nobody waits, services can be added to the moves."""

TIMED = STAYS | {"time-windows", "several-windows", "depot-windows", "shifts", "energy:travel", "energy:elapsed-fixed-start"}
"""Features for which VROOM has to know how long moves take."""

PRICED = frozenset({"duration-cost", "objective:total-duration"})
"""Costs of a route's duration. VROOM knows costs of moves: where nobody waits, those of time and service can be added to them."""

HIGHEST = 100
"""The highest of VROOM's priorities, which are whole numbers from 0 on."""

PRIZES = frozenset({"reward", "penalties"})
"""Terms that count sites."""


@BACKENDS.register("vroom")
class VROOM(Bisecting):
    """VROOM (Coupey, Nicod & Varnier): constructions of several kinds, each improved by local search.

    ``exploration_level``, from 0 to 5, is how many it makes and how far each is taken; it ends by itself, often long before a time limit.
    The answer of level 0 is published first, so that a limit or Ctrl-C leaves one.

    The library cannot be stopped from outside, and limits its time only between two steps: it gets a process of its own.
    """

    name = "vroom"
    package = "pyvroom"
    modules = ("vroom",)
    summary = "VROOM: constructions and local search, very fast"
    options = MappingProxyType({"exploration_level": DEEPEST})
    order = 30
    interrupts = "is ended; the answer of the lowest exploration level counts"
    needs_process = True
    honours = frozenset()
    bytes_a_move, seconds_a_move = 40.0, 7e-7
    features = USUAL_FEATURES

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        lacking = unscalable(problem) | entangled(problem)
        asked = priorities(problem)
        if isinstance(asked, frozenset):
            return lacking | asked
        problem = asked.problem
        held = problem.features()
        if awaited(problem):
            lacking |= {f"{name} with waiting" for name in held & (STAYS | PRICED)}
        if held & STAYS and "energy:travel" in held and problem.sites.service[problem.customers].any():
            lacking |= {"energy:travel with limited durations"}
        return lacking

    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        level = self.converted(options).extra.get("exploration_level", DEEPEST)
        if not FIRST <= level <= DEEPEST:
            raise UsageError(f"vroom: exploration_level is a number from {FIRST} to {DEEPEST}, not {level}", "out-of-range")
        control.begin_set_up()
        ends = time.perf_counter() + options.time_limit
        asked = priorities(problem)
        assert not isinstance(asked, frozenset)
        return _search(problem, asked, vroom_integers(asked.problem), level, options, control, ends)


def _search(
    problem: RoutingProblem, asked: Priorities, data: IntegerRouting, level: int, options: Options, control: Control, ends: float
) -> RawResult:
    if not len(problem.customers):
        return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
    if not asked.of:
        return RawResult("feasible", answer=Routes(()), message="no site has to be visited, or earns anything")
    last = RawResult("unknown", message="VROOM leaves required sites out")
    for wanted, most in _attempts(asked, data):
        model = Model(wanted, data, most)
        if not model.types:
            return RawResult("infeasible", message="no vehicle can leave its depot and return in time")
        if options.start is not None:
            model.begin(options.start)
        statistics: dict[str, Any] = {"exploration_level": level, "vehicles": len(model.types), "scale": data.scales}
        holds = data.holds.then(Exactness.RESTRICTION if model.clipped else Exactness.EXACT)
        for explored in sorted({FIRST, level}):
            seconds = ends - time.perf_counter()
            if seconds <= 0 or control.stopped:
                return replace(last, limit="interrupt" if control.stopped else "time")
            control.end_set_up(options.time_limit - seconds)
            cost, answer = model.solved(explored, seconds)
            if options.start is not None:
                statistics["start"] = "used" if model.routes else "refused"
            if answer is None:
                continue
            # Costs tell nothing of rewards, and what 32 bits make of fractions is too coarse a claim.
            plain = data.scales["exact"] and asked.problem is problem
            claim = claimed_objective(problem, cost / data.cost_factor) if plain else problem.evaluate(answer).values[0]
            control.publish(answer, claim)
            limit = "time" if time.perf_counter() >= ends else "none"
            last = RawResult("feasible", limit, answer, claim, statistics=statistics, holds=holds, links=(data.link,))
        if last.answer is not None:
            break
    return last


def vroom_integers(problem: Any) -> IntegerRouting:
    """A routing problem in integers that leave VROOM room for its sums."""
    return fitting_integers(problem, largest=LARGEST, total=LARGEST, scales=FINE)


def _attempts(asked: Priorities, data: IntegerRouting) -> list[tuple[Priorities, int]]:
    """Priorities and vehicles of an unlimited type, in the order in which they are tried until no required site is left out.

    Each vehicle costs the library time, used or not. Priorities of many sites can outweigh that of a required one.
    """
    sites = len(asked.of)
    first = min(sites, max(25, 2 * data.fewest()))
    many = [first, sites] if first < sites and any(v.count is None for v in asked.problem.fleet) else [first]
    attempts = [(asked, most) for most in many]
    return [*attempts, (asked.without_choice(), many[-1])] if asked.required and asked.choosing else attempts


@dataclass(frozen=True)
class Priorities:
    """The sites to be visited, and what is minimised then.

    The objective of ``problem`` is what comes after the rewards; ``of`` has the priority of each site that is worth a visit, the highest
    for required ones where others are optional; without the ``required`` sites there is no answer.
    """

    problem: RoutingProblem
    of: Mapping[int, int]
    required: frozenset[int]

    @property
    def choosing(self) -> bool:
        """Whether any site may be left out."""
        return len(self.required) < len(self.of)

    def without_choice(self) -> Priorities:
        """The same for the required sites alone."""
        return replace(self, of={site: self.of[site] for site in self.required})


def priorities(problem: RoutingProblem) -> Priorities | frozenset[str]:
    """The priorities for VROOM, or the features in their way.

    Rewards, or penalties, have to be the first level of the objective, and become priorities where they are multiples, up to the 100th, of
    one number, or of the form p b + 1 for priorities p and a b that is larger than the number of sites: which is what an instance in
    VROOM's own JSON has. Sites that earn nothing are left out.
    """
    sites = problem.sites
    first, *later = problem.objective.levels()
    required = frozenset(site for site in problem.customers.tolist() if sites.required[site])
    prized = {term.name for _, term in first.terms} & PRIZES
    behind = {term.name for level in later for _, term in level.terms} & PRIZES
    if behind or (prized and len(first.terms) > 1):
        return frozenset(f"objective:{name} beside or after others" for name in behind | prized)
    if not prized:
        return Priorities(problem, dict.fromkeys(sorted(required), 0), required)
    after = replace(problem, objective=Objective(tuple(later) or TotalCost().levels()))
    earned = np.where(sites.depot, 0.0, sites.reward if prized == {"reward"} else sites.penalty)
    for shipment in sites.shipments:  # VROOM counts both ends
        earned[[shipment.pickup, shipment.delivery]] = (earned[shipment.pickup] + earned[shipment.delivery]) / 2.0
    choices = [site for site in problem.customers.tolist() if site not in required and earned[site] > 0.0]
    steps = _steps(earned[choices])
    if steps is None:
        return frozenset({f"objective:{next(iter(prized))} in more than {HIGHEST} steps"})
    of = dict.fromkeys(required, HIGHEST if choices else 0) | dict(zip(choices, steps, strict=True))
    return Priorities(after, dict(sorted(of.items())), required)


def _steps(earned: Floats) -> list[int] | None:
    """Priorities whose sums are in the same order as those of the rewards; None where there are none."""
    unit = grain(earned)
    if unit is None:
        return None if len(earned) else []
    counts = np.rint(earned / unit.size)
    if counts.max() > HIGHEST:
        whole = np.rint(earned)
        if (whole != earned).any() or whole.max() >= 2.0**53:
            return None
        base = int(np.gcd.reduce((whole - 1.0).astype(np.int64)))
        counts = (whole - 1.0) / max(base, 1)
        if base <= len(earned) or counts.max() > HIGHEST:
            return None
    return [int(count) for count in counts]


class Model:
    """A routing problem as VROOM's input.

    ``data`` are the integers of what is asked after the priorities, ``most`` the vehicles of each unlimited type. ``types`` is the fleet's
    type of each vehicle, without those that no route can use; ``clipped`` says whether an answer may be too late for VROOM's clock.
    """

    def __init__(self, asked: Priorities, data: IntegerRouting, most: int) -> None:
        self.asked, self.problem, self.data = asked, asked.problem, data
        problem = asked.problem
        held = problem.features()
        self.timed = bool(TIMED & held)
        self.types = [
            k for k, v in enumerate(problem.fleet) if data.closes[k] >= data.opens[k]
            for _ in range(most if v.count is None else min(v.count, len(asked.of)))
        ]  # fmt: skip
        # Without waiting, a route's duration is what its moves take if each begins with the service of where it starts.
        self.within = bool(STAYS & held)
        longest = max(int((m.duration + data.service[:, None]).max(axis=1).sum()) for m in data.moves)
        horizon = int(max(opens for listed in data.windows for opens, _ in listed)) + longest
        self.clipped = self.timed and min(max(horizon, int(data.opens.max()) + longest), int(data.closes.max())) > LARGEST
        self.words = {word: k for k, word in enumerate(sorted({w for s in problem.sites.skills for w in s}))}
        self.carried = [int(sum(values[:, k].sum() for values in (data.demand, data.pickup, data.shipped))) for k in data.limited]
        self.routes: dict[int, tuple[int, ...]] = {}

    def begin(self, answer: Routes) -> None:
        """Start from an answer, if it has no site or route too many and breaks no rule, which VROOM would refuse."""
        if not {site for route in answer for site in route.visits} <= self.asked.of.keys():
            return
        free: dict[int, list[int]] = {}
        for vehicle, kind in enumerate(self.types):
            free.setdefault(kind, []).append(vehicle)
        if any(len(free.get(kind, ())) < len([r for r in answer if r.vehicle == kind]) for kind in {r.vehicle for r in answer}):
            return
        if self.problem.evaluate(answer).feasible:
            self.routes = {free[route.vehicle].pop(0): route.visits for route in answer}

    def solved(self, level: int, seconds: float) -> tuple[int, Routes | None]:
        """Cost and routes; no routes where a required site is left out."""
        asked = {"exploration_level": level, "nb_threads": SEARCHES, "timeout": timedelta(seconds=seconds)}
        try:
            solution = self._input().solve(**asked)
        except Exception as fault:
            if not self.routes or type(fault).__name__ != "VroomInputException":
                raise
            # It holds a site that is too far for a round trip of its own out of reach, whatever ways there are through others.
            self.routes = {}
            solution = self._input().solve(**asked)
        visits: dict[int, list[int]] = {}
        frame = solution.routes
        for vehicle, kind, site in zip(frame["vehicle_id"], frame["type"], frame["location_index"], strict=True):
            if kind in ("job", "pickup", "delivery"):
                visits.setdefault(int(vehicle), []).append(int(site))
        if not self.asked.required <= {site for sites in visits.values() for site in sites}:
            return 0, None
        return int(solution.summary.cost), Routes.of(Route(tuple(sites), self.types[v]) for v, sites in sorted(visits.items()))

    def _input(self) -> Any:
        import vroom

        model, data = vroom.Input(), self.data
        measured = any(data.max_distance[k] != UNLIMITED for k in self.types)  # all profiles have distances, or none has
        for k in sorted(set(self.types)):
            moves = data.moves_of(k)
            taken = moves.duration + data.service[:, None]
            durations = taken if self.within else moves.duration
            model.set_costs_matrix(str(k), _unsigned(moves.distance * data.unit[k] + taken * data.time[k]))
            model.set_durations_matrix(str(k), _unsigned(durations if self.timed else np.zeros_like(durations)))
            if measured:
                model.set_distances_matrix(str(k), _unsigned(moves.distance_up))
        shipments = self.problem.sites.shipments
        ends = {site for s in shipments for site in (s.pickup, s.delivery)}
        model.add_job([self._job(vroom, site) for site in self.asked.of if site not in ends])
        for k, shipment in enumerate(shipments):
            first, last = shipment.pickup, shipment.delivery
            if first not in self.asked.of:
                continue
            model.add_shipment(
                self._step(vroom, first), self._step(vroom, last), vroom.Amount(data.shipped[k, data.limited].tolist()),
                self._skills(first) | self._skills(last), self.asked.of[first],
            )  # fmt: skip
        model.add_vehicle([self._vehicle(vroom, number, k) for number, k in enumerate(self.types)])
        return model

    def _skills(self, site: int) -> set[int]:
        return {self.words[word] for word in self.problem.sites.skills[site]} if self.words else set()

    def _time(self, vroom: Any, site: int) -> dict[str, Any]:
        if not self.timed:
            return {}
        served = 0 if self.within else int(self.data.service[site])
        return {"default_service": served, "time_windows": [_window(vroom, *w) for w in self.data.windows[site] if w[0] <= LARGEST]}

    def _step(self, vroom: Any, site: int) -> Any:
        return vroom.ShipmentStep(site, site, **self._time(vroom, site))

    def _job(self, vroom: Any, site: int) -> Any:
        delivery, pickup = (values[site, self.data.limited].tolist() for values in (self.data.demand, self.data.pickup))
        return vroom.Job(
            site, site, delivery=delivery, pickup=pickup, skills=self._skills(site), priority=self.asked.of[site], **self._time(vroom, site)
        )  # fmt: skip

    def _vehicle(self, vroom: Any, number: int, k: int) -> Any:
        data, vehicle, limits = self.data, self.problem.fleet[k], {}
        longest = int(min(data.travel_limit[k], data.max_duration[k]))
        if longest != UNLIMITED:
            limits["max_travel_time"] = min(longest, LARGEST)
        if data.max_distance[k] != UNLIMITED:
            limits["max_distance"] = int(min(data.max_distance[k], LARGEST))
        return vroom.Vehicle(
            number, start=vehicle.start, end=vehicle.end, profile=str(k), costs=vroom.VehicleCosts(fixed=int(data.fixed[k])),
            capacity=[min(int(data.capacity[k, dimension]), most) for dimension, most in zip(data.limited, self.carried, strict=True)],
            time_window=_window(vroom, data.opens[k], data.closes[k]) if self.timed else None,
            skills={number for word, number in self.words.items() if word in vehicle.skills},
            steps=self._steps(vroom, self.routes.get(number, ())), **limits,
        )  # fmt: skip

    def _steps(self, vroom: Any, visits: tuple[int, ...]) -> list[Any]:
        kinds: dict[int, Any] = {}
        for shipment in self.problem.sites.shipments:
            kinds |= {shipment.pickup: vroom.VehicleStepPickup, shipment.delivery: vroom.VehicleStepDelivery}
        return [kinds.get(site, vroom.VehicleStepSingle)(site) for site in visits]


def _unsigned(values: Integers) -> Any:
    return values.astype(np.uint32)


def _window(vroom: Any, opens: int, closes: int) -> Any:
    return vroom.TimeWindow(int(min(opens, LARGEST)), int(min(closes, LARGEST)))
