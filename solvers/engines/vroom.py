"""VROOM: many constructions, each improved by local search, until none of them gets better."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import replace
from datetime import timedelta
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from ...formulations.problem import Problem
from ...formulations.programs.exactness import Exactness
from ...formulations.routing.routes import Route, Routes
from ...instances.errors import InputError, UnsupportedError, UsageError
from ..backend import BACKENDS, Control, Engine, Options, RawResult
from .routing_integers import UNLIMITED, IntegerRouting, Integers, integer_routing
from .routing_objective import claimed_objective, unscalable

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem

LARGEST = 2**32 - 1
"""VROOM reads costs, distances and times as 32 bits without a sign, and refuses costs whose sum along an answer could be larger."""

FINE = (1_000_000, 100_000, 10_000, 1_000, 100, 10)
"""Scales of data that three decimals cannot hold: the first that leaves room."""

TIMED = frozenset({"time-windows", "depot-windows", "energy:travel", "energy:elapsed-fixed-start"})
"""Features for which VROOM has to know how long moves take."""

FIRST, DEEPEST = 0, 5
"""Least and largest exploration level."""


@BACKENDS.register("vroom")
class VROOM(Engine):
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
    family = "routing"
    features = frozenset(
        {
            "capacity", "time-windows", "depot-windows", "service-times", "max-distance", "limited-fleet", "heterogeneous-fleet",
            "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "energy:travel", "energy:elapsed-fixed-start",
            "objective:total-cost", "objective:vehicles", "objective:weights", "objective:priorities",
        }
    )  # fmt: skip

    def missing(self, problem: Problem) -> frozenset[str]:
        """See ``Engine.missing``."""
        return super().missing(problem) or unscalable(problem)  # type: ignore[arg-type]

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        level = self.converted(options).extra.get("exploration_level", DEEPEST)
        if not FIRST <= level <= DEEPEST:
            raise UsageError(f"vroom: exploration_level is a number from {FIRST} to {DEEPEST}, not {level}")
        ends = time.perf_counter() + options.time_limit
        return _search(problem, _integers(problem), level, options, control, ends)  # type: ignore[arg-type]


def _search(problem: RoutingProblem, data: IntegerRouting, level: int, options: Options, control: Control, ends: float) -> RawResult:
    if not len(problem.customers):
        return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
    last = RawResult("unknown", message="VROOM leaves required sites out")
    for most in _fleets(problem, data):
        model = Model(problem, data, most)
        if not model.types:
            return RawResult("infeasible", message="no vehicle can leave its depot and return in time")
        begun = options.start is not None and model.begin(options.start)
        statistics: dict[str, Any] = {"exploration_level": level, "vehicles": len(model.types), "scale": data.scales}
        if options.start is not None:
            statistics["start"] = "used" if begun else "refused"
        holds = data.holds.then(Exactness.RESTRICTION if model.clipped else Exactness.EXACT)
        for explored in sorted({FIRST, level}):
            left = ends - time.perf_counter()
            if left <= 0 or control.stopped:
                return replace(last, limit="interrupt" if control.stopped else "time")
            cost, answer = model.solved(explored, options.threads, left)
            if answer is None:
                continue
            # What 32 bits make of fractions is too coarse a claim.
            claim = claimed_objective(problem, cost / data.cost_factor) if data.scales["exact"] else problem.evaluate(answer).values[0]
            control.publish(answer, claim)
            limit = "time" if time.perf_counter() >= ends else "none"
            last = RawResult("feasible", limit, answer, claim, statistics=statistics, holds=holds, links=(data.link,))
        if last.answer is not None:
            break
    return last


def _integers(problem: Any) -> IntegerRouting:
    for fine in FINE[:-1]:
        with suppress(InputError):
            return integer_routing(problem, largest=LARGEST, total=LARGEST, fine=fine)
    return integer_routing(problem, largest=LARGEST, total=LARGEST, fine=FINE[-1])


def _fleets(problem: RoutingProblem, data: IntegerRouting) -> list[int]:
    """Vehicles of an unlimited type, in the order in which they are tried: each costs the library time, used or not."""
    customers = len(problem.customers)
    roomiest = int(data.capacity.max())
    loads = 0 if roomiest in (0, UNLIMITED) else -(-int(data.demand.sum()) // roomiest)
    first = min(customers, max(25, 2 * loads))
    return [first, customers] if first < customers and any(v.count is None for v in problem.fleet) else [first]


class Model:
    """A routing problem as VROOM's input.

    Parameters
    ----------
    problem : RoutingProblem
    data : IntegerRouting
    most : int
        Vehicles of each unlimited type.

    Attributes
    ----------
    types : list of int
        Fleet's type of each vehicle; those that no route can use are left out.
    clipped : bool
        Whether an answer of the problem may be too late for VROOM's clock.
    """

    def __init__(self, problem: RoutingProblem, data: IntegerRouting, most: int) -> None:
        self.problem, self.data = problem, data
        self.timed, self.loaded = bool(TIMED & problem.features()), "capacity" in problem.features()
        self.opens = data.ready[[v.start for v in problem.fleet]]
        self.closes = np.minimum(data.due[[v.end for v in problem.fleet]], data.latest_return)
        self.types = [
            k for k, v in enumerate(problem.fleet) if self.closes[k] >= self.opens[k]
            for _ in range(most if v.count is None else min(v.count, len(problem.customers)))
        ]  # fmt: skip
        horizon = int(data.ready.max(initial=0)) + int((data.duration + data.service[:, None]).max(axis=1).sum())
        self.clipped = self.timed and min(horizon, int(self.closes.max(initial=0))) > LARGEST
        self.routes: dict[int, tuple[int, ...]] = {}

    def begin(self, answer: Routes) -> bool:
        """Start from an answer, if it has no route too many and breaks no rule, which VROOM would refuse."""
        free: dict[int, list[int]] = {}
        for vehicle, kind in enumerate(self.types):
            free.setdefault(kind, []).append(vehicle)
        if any(len(free.get(kind, ())) < len([r for r in answer if r.vehicle == kind]) for kind in {r.vehicle for r in answer}):
            return False
        if not self.problem.evaluate(answer).feasible:
            return False
        self.routes = {free[route.vehicle].pop(0): route.visits for route in answer}
        return True

    def solved(self, level: int, threads: int, seconds: float) -> tuple[int, Routes | None]:
        """Cost and routes, or None where a required site is left out."""
        found = self._input().solve(exploration_level=level, nb_threads=threads, timeout=timedelta(seconds=seconds))
        if found.unassigned:
            return 0, None
        visits: dict[int, list[int]] = {}
        frame = found.routes
        for vehicle, kind, site in zip(frame["vehicle_id"], frame["type"], frame["location_index"], strict=True):
            if kind == "job":
                visits.setdefault(int(vehicle), []).append(int(site))
        return int(found.summary.cost), Routes.of(Route(tuple(sites), self.types[v]) for v, sites in sorted(visits.items()))

    def _input(self) -> Any:
        import vroom

        made = vroom.Input()
        for k in sorted(set(self.types)):
            made.set_costs_matrix(str(k), _unsigned(self.data.distance * self.data.unit[k]))
            made.set_durations_matrix(str(k), _unsigned(self.data.duration if self.timed else np.zeros_like(self.data.duration)))
            if self.data.max_distance[k] != UNLIMITED:
                made.set_distances_matrix(str(k), _unsigned(self.data.distance_up))
        made.add_job([self._job(vroom, site) for site in self.problem.customers.tolist()])
        made.add_vehicle([self._vehicle(vroom, number, k) for number, k in enumerate(self.types)])
        return made

    def _job(self, vroom: Any, site: int) -> Any:
        data = self.data
        return vroom.Job(
            site, site, default_service=int(data.service[site]) if self.timed else 0,
            delivery=[int(data.demand[site])] if self.loaded else [],
            time_windows=[_window(vroom, data.ready[site], data.due[site])] if self.timed else [],
        )  # fmt: skip

    def _vehicle(self, vroom: Any, number: int, k: int) -> Any:
        data, vehicle, limits = self.data, self.problem.fleet[k], {}
        if data.travel_limit[k] != UNLIMITED:
            limits["max_travel_time"] = int(min(data.travel_limit[k], LARGEST))
        if data.max_distance[k] != UNLIMITED:
            limits["max_distance"] = int(min(data.max_distance[k], LARGEST))
        begun = self.routes.get(number, ())
        return vroom.Vehicle(
            number, start=vehicle.start, end=vehicle.end, profile=str(k), costs=vroom.VehicleCosts(fixed=int(data.fixed[k])),
            capacity=[min(int(data.capacity[k]), int(data.demand.sum()))] if self.loaded else [],
            time_window=_window(vroom, self.opens[k], self.closes[k]) if self.timed else None,
            steps=[vroom.VehicleStepSingle(site) for site in begun], **limits,
        )  # fmt: skip


def _unsigned(values: Integers) -> Any:
    return values.astype(np.uint32)


def _window(vroom: Any, opens: int, closes: int) -> Any:
    return vroom.TimeWindow(int(min(opens, LARGEST)), int(min(closes, LARGEST)))
