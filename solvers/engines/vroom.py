"""VROOM: many constructions, each improved by local search, until none of them gets better."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ...formulations.programs.exactness import Exactness
from ...formulations.routing.routes import Routes
from ...instances.errors import InputError, UsageError
from ..backend import BACKENDS, Control, Options, RawResult
from .bisection import Bisecting
from .routing_integers import IntegerRouting, integer_routing
from .routing_objective import awaited, claimed_objective, unscalable
from .routing_shipments import entangled
from .vroom_model import LARGEST, PRICED, STAYS, Model

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem

FINE = (1_000_000, 100_000, 10_000, 1_000, 100, 10)
"""Scales of data that three decimals cannot hold: the first that leaves room."""

FIRST, DEEPEST = 0, 5
"""Least and largest exploration level."""


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
    family = "routing"
    features = frozenset(
        {
            "capacity", "time-windows", "depot-windows", "service-times", "max-distance", "limited-fleet", "heterogeneous-fleet",
            "multiple-depots", "open-routes", "fixed-cost", "separate-durations", "energy:travel", "energy:elapsed",
            "energy:elapsed-fixed-start", "initial-energy", "max-duration", "shifts", "duration-cost", "vehicle-speeds", "vehicle-travel",
            "several-loads", "pickups", "shipments", "several-windows", "skills", "objective:total-cost", "objective:total-duration",
            "objective:vehicles", "objective:makespan", "objective:longest-route", "objective:latest-return", "objective:weights",
            "objective:priorities",
        }
    )  # fmt: skip

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        """See ``Bisecting.beyond``."""
        held = problem.features()
        lacking = unscalable(problem) | entangled(problem)
        if awaited(problem):
            lacking |= {f"{name} with waiting" for name in held & (STAYS | PRICED)}
        if held & STAYS and "energy:travel" in held and problem.sites.service[problem.customers].any():
            lacking |= {"energy:travel with limited durations"}
        return lacking

    def search(self, problem: RoutingProblem, options: Options, control: Control) -> RawResult:
        """See ``Bisecting.search``."""
        level = self.converted(options).extra.get("exploration_level", DEEPEST)
        if not FIRST <= level <= DEEPEST:
            raise UsageError(f"vroom: exploration_level is a number from {FIRST} to {DEEPEST}, not {level}")
        ends = time.perf_counter() + options.time_limit
        return _search(problem, vroom_integers(problem), level, options, control, ends)


def _search(problem: RoutingProblem, data: IntegerRouting, level: int, options: Options, control: Control, ends: float) -> RawResult:
    if not len(problem.customers):
        return RawResult("optimal", answer=Routes(()), objective=0.0, bound=0.0, message="there are no customers")
    last = RawResult("unknown", message="VROOM leaves required sites out")
    for most in _fleets(problem, data):
        model = Model(problem, data, most)
        if not model.types:
            return RawResult("infeasible", message="no vehicle can leave its depot and return in time")
        if options.start is not None:
            model.begin(options.start)
        statistics: dict[str, Any] = {"exploration_level": level, "vehicles": len(model.types), "scale": data.scales}
        holds = data.holds.then(Exactness.RESTRICTION if model.clipped else Exactness.EXACT)
        for explored in sorted({FIRST, level}):
            left = ends - time.perf_counter()
            if left <= 0 or control.stopped:
                return replace(last, limit="interrupt" if control.stopped else "time")
            cost, answer = model.solved(explored, left)
            if options.start is not None:
                statistics["start"] = "used" if model.routes else "refused"
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


def vroom_integers(problem: Any) -> IntegerRouting:
    """A routing problem in integers that leave VROOM room for its sums."""
    for fine in FINE[:-1]:
        with suppress(InputError):
            return integer_routing(problem, largest=LARGEST, total=LARGEST, fine=fine)
    return integer_routing(problem, largest=LARGEST, total=LARGEST, fine=FINE[-1])


def _fleets(problem: RoutingProblem, data: IntegerRouting) -> list[int]:
    """Vehicles of an unlimited type, in the order in which they are tried: each costs the library time, used or not."""
    customers = len(problem.customers)
    first = min(customers, max(25, 2 * data.fewest()))
    return [first, customers] if first < customers and any(v.count is None for v in problem.fleet) else [first]
