"""VROOM: many constructions, each improved by local search, until none of them gets better."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ....formulations.programs.exactness import Exactness
from ....formulations.routing.routes import Routes
from ....instances.errors import InputError, UsageError
from ...backend import BACKENDS, Control, Options, RawResult
from .bisection import USUAL_FEATURES, Bisecting
from .routing_integers import IntegerRouting, entangled, integer_routing
from .routing_objective import awaited, claimed_objective, unscalable
from .vroom_model import LARGEST, PRICED, STAYS, Model, Priorities, priorities

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

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
    bytes_a_move, seconds_a_move = 40.0, 7e-7
    family = "routing"
    features = USUAL_FEATURES

    def beyond(self, problem: RoutingProblem) -> frozenset[str]:
        """See ``Bisecting.beyond``."""
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
        """See ``Bisecting.search``."""
        level = self.converted(options).extra.get("exploration_level", DEEPEST)
        if not FIRST <= level <= DEEPEST:
            raise UsageError(f"vroom: exploration_level is a number from {FIRST} to {DEEPEST}, not {level}")
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
    for fine in FINE[:-1]:
        with suppress(InputError):
            return integer_routing(problem, largest=LARGEST, total=LARGEST, fine=fine)
    return integer_routing(problem, largest=LARGEST, total=LARGEST, fine=FINE[-1])


def _attempts(asked: Priorities, data: IntegerRouting) -> list[tuple[Priorities, int]]:
    """Priorities and vehicles of an unlimited type, in the order in which they are tried until no required site is left out.

    Each vehicle costs the library time, used or not. Priorities of many sites can outweigh that of a required one.
    """
    sites = len(asked.of)
    first = min(sites, max(25, 2 * data.fewest()))
    many = [first, sites] if first < sites and any(v.count is None for v in asked.problem.fleet) else [first]
    attempts = [(asked, most) for most in many]
    return [*attempts, (asked.without_choice(), many[-1])] if asked.required and asked.choosing else attempts
