"""Routes that keep limits on uncertain durations, made by an engine that knows certain ones alone.

A route of mean duration D and variance V keeps a limit B with probability 1 - risk if D + z sqrt(V) <= B. For any slope c > 0

    z sqrt(V) <= c V + z^2 / (4 c),     with equality at c = z / (2 sqrt(V)),

so that with c times its variance added to the duration of each move, and z^2 / (4 c) taken from B, whatever is feasible is so for the
problem asked. Slopes follow the routes that come closest to their limits. Of a risk of the team every route is first given an equal share,
then as large a one as all routes together bear.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...formulations.routing.overrun import quantile, route_overrun
from ...formulations.routing.schedule import schedule
from ...instances.errors import UsageError
from ...instances.routing.features import RISKS
from ...solvers.backend import Control, Options
from ...solvers.engines.pyvrp import PyVRP
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome
from ..selection.greedy_steps.ending import CUT_SHORT

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem
    from ...formulations.routing.routes import Routes
    from ...formulations.stop import Stop
    from ...instances.routing.travel import Travel
    from ...instances.routing.vehicle_type import VehicleType

NEAR = 1.05
"""Ratio of two shares, or slopes, that are no longer told apart."""


def safety_margins(problem: RoutingProblem, context: Context, *, rounds: int = 8, steps: int = 1000) -> Outcome:
    """Give durations a margin for what is uncertain of them, have PyVRP find routes, and fit the margin to these.

    Parameters
    ----------
    problem : RoutingProblem
        With a risk of routes or of the team; nobody waits for a window.
    context : Context
        Its ``start`` is the first answer where it keeps all limits.
    rounds : int, >= 1
        Searches at most; the first one leaves the risk out, and is the last where its answer keeps it.
    steps : int, >= 1
        PyVRP's iterations in each.

    Returns
    -------
    Outcome
        The best answer that keeps all limits; none where no round found one.

    Raises
    ------
    UsageError
        For options out of range.

    Notes
    -----
    The mathematics: docs/formulations/routing.md#approximations.
    """
    for name, value in (("rounds", rounds), ("steps", steps)):
        if not (isinstance(value, int) and value >= 1):
            raise UsageError(f"{name} must be a whole number of at least 1, not {value!r}")
    stop, search = context.begin(), _Search(problem, context)
    if context.start is not None:
        search.judge(context.start)
    seed, done = int(context.rng.integers(2**31)), 0
    while done < rounds:
        done += 1
        answer = _found(certain(problem, search.slope, search.share), steps, seed, stop)
        if search.settled(answer) or stop.reached():
            break
    cut = stop.reached()
    message = CUT_SHORT if cut else "" if search.best is not None else "no routes were found that keep the limits"
    return Outcome(search.best, statistics={"rounds": done, "slope": search.slope}, message=message, limit=cut or "none")


class _Search:
    """The best answer so far, and the slope and the share of each route in the team's risk under which the next one is looked for."""

    def __init__(self, problem: RoutingProblem, context: Context) -> None:
        self.problem, self.publish = problem, context.publish
        self.signs = [1.0 if sense == "min" else -1.0 for sense in problem.senses]
        self.best: Routes | None = None
        self.rank: tuple[float, ...] = ()
        self.slope, self.share = 0.0, problem.team_risk
        self._low = self._high = 0.0 if problem.team_risk is None else problem.team_risk
        self._vain = 0

    def judge(self, answer: Routes) -> bool:
        """Whether it keeps all limits; it is kept if it is the best of these."""
        judged = self.problem.evaluate(answer)
        rank = tuple(sign * value for sign, value in zip(self.signs, judged.values, strict=True))
        if judged.feasible and (self.best is None or rank < self.rank):
            self.best, self.rank = answer, rank
            self.publish(answer)
        return judged.feasible

    def settled(self, answer: Routes | None) -> bool:
        """Whether another round would find nothing else; otherwise slope and share are those of the next one."""
        if answer is None:
            return self._loosened()
        good, slope, share = self.judge(answer), self.slope, self.share
        if good and not slope:
            return True
        self._vain = 0
        if share is not None:
            self.share = self._shared(answer, share, good, first=not slope)
        self.slope = self._steepest(answer) or slope or 1.0
        return good and _near(slope, self.slope) and (share is None or self.share is None or _near(share, self.share))

    def _loosened(self) -> bool:
        if not self.slope:  # the means alone break the limits
            return True
        if self.share is not None and not _near(self.share, self._high):
            self._low = max(self._low, self.share)
            before, self.share = quantile(self.share), math.sqrt(self._low * self._high)
            self.slope *= quantile(self.share) / before
        else:  # twice as steep, half as steep, four times, a quarter, ...
            self._vain += 1
            self.slope *= 2.0 ** (self._vain if self._vain % 2 else -self._vain)
        return False

    def _shared(self, answer: Routes, share: float, good: bool, *, first: bool) -> float:
        """The next share: between one that all routes together bear and one that they do not."""
        if first:
            self._low = -math.expm1(math.log1p(-share) / max(1, len(answer)))
            return self._low
        if good:
            self._low = max(self._low, share)
        else:
            self._high = share
            self._low = self._low if self._low < share else 0.5 * share
        return self._low if _near(self._low, self._high) else math.sqrt(self._low * self._high)

    def _steepest(self, answer: Routes) -> float:
        """The slope that is right for the route likeliest to overrun a limit; 0 where none may."""
        found = (0.0, 0.0)
        for route in answer:
            vehicle = self.problem.fleet[route.vehicle]
            risk, plan = allowed_risk(vehicle, self.share), schedule(self.problem, route)
            if risk is not None and plan.variance > 0.0:
                slope = quantile(risk) / (2.0 * vehicle.speed * math.sqrt(plan.variance))
                found = max(found, (route_overrun(vehicle, plan), slope))
        return found[1]


def _near(a: float, b: float) -> bool:
    return max(a, b) < NEAR * min(a, b)


def allowed_risk(vehicle: VehicleType, share: float | None) -> float | None:
    """The risk of a route where each has a ``share`` in that of the team."""
    risks = [risk for risk in (vehicle.risk, share) if risk is not None]
    return min(risks, default=None)


def certain(problem: RoutingProblem, slope: float, share: float | None) -> RoutingProblem:
    """A problem of certain durations: those of the means for a ``slope`` of 0, otherwise answers to it keep the risk of each route."""
    fleet = []
    for vehicle in problem.fleet:
        own, uncertain = vehicle.travel, (vehicle.travel or problem.travel).uncertain
        risk = allowed_risk(vehicle, share) if uncertain else None
        margin = quantile(risk) ** 2 / (4.0 * slope * vehicle.speed) if risk is not None and slope else 0.0
        if risk is not None:
            own = None if own is None else _stretched(own, slope)
        elif slope and uncertain:
            own = _stretched(own or problem.travel, 0.0)
        energy = vehicle.energy
        if energy is not None:
            left = [None if held is None else max(0.0, held - energy.rate * margin) for held in (energy.capacity, energy.initial)]
            energy = replace(energy, capacity=left[0] or 0.0, initial=left[1])
        fleet.append(replace(vehicle, risk=None, travel=own, energy=energy, max_duration=max(0.0, vehicle.max_duration - margin)))
    return replace(problem, travel=_stretched(problem.travel, slope), fleet=tuple(fleet), team_risk=None)


def _stretched(travel: Travel, slope: float) -> Travel:
    if travel.variances is None:
        return travel
    longer = travel.durations + slope * travel.variances if slope else travel.duration_matrix
    return replace(travel, duration_matrix=longer, variances=None)


def _found(problem: RoutingProblem, steps: int, seed: int, stop: Stop) -> Routes | None:
    control = Control()
    options = Options(time_limit=min(stop.seconds_left, 1e9), iterations=steps, seed=seed)
    with stop.telling(control.stop):
        answer: Routes | None = PyVRP().run(problem, options, control).answer
    return answer


def _refuses(problem: Any) -> frozenset[str]:
    if not problem.features() & RISKS:
        return frozenset({"certain durations"})
    return PyVRP().missing(certain(problem, 1.0, problem.team_risk))


HEURISTICS.add(
    "safety-margins",
    Heuristic(
        name="safety-margins",
        families=("routing",),
        features=(PyVRP.features | RISKS) - {"time-windows", "several-windows", "energy:travel"},
        run=safety_margins,
        summary="PyVRP with margins for uncertain durations, fitted to the risk of routes and team",
        refuses=_refuses,
    ),
)
