"""Routes that keep limits on uncertain durations, made by an engine that knows certain ones alone.

A route of mean duration D and variance V keeps a limit B with probability 1 - risk if D + z sqrt(V) <= B. For any slope c > 0

    z sqrt(V) <= c V + z^2 / (4 c),     with equality at c = z / (2 sqrt(V)),

so that with c times its variance added to the duration of each move, and z^2 / (4 c) taken from B, whatever is feasible is so for the
problem asked. Slopes follow the routes that come closest to their limits. Of a risk of the team every route is first given an equal share,
then as large a one as all routes together bear. Of all routes that were met those are chosen that go together best, which splits the
team's risk anew; then each of them keeps its own part and slope, beside its own part of what is left of the risk, and the engine goes on
from there, as iterative risk allocation does (Ono and Williams 2008): answers become no worse.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ...formulations.evaluation import Checklist
from ...formulations.forms import FORMS
from ...formulations.programs.exactness import Exactness
from ...formulations.routing.forms.set_partitioning import over
from ...formulations.routing.judge import check_route
from ...formulations.routing.overrun import quantile, route_overrun
from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Route, Routes
from ...formulations.routing.schedule import schedule
from ...formulations.stop import Stop
from ...instances.errors import InputError, UnsupportedError, UsageError, WayboundError
from ...instances.routing.features import RISKS
from ...instances.routing.travel import Travel
from ...instances.routing.vehicle_type import VehicleType
from ...solvers.backend import Control, Engine, Options, solver_named
from ...solvers.backends.highs import Highs
from ...solvers.engines.routing.pyvrp import PyVRP
from ..heuristic import Context, Outcome, heuristic
from .tour_steps.cutting import ended

EXACT = 10
"""Customers up to which solvers find answers by themselves (docs/formulations/routing.md#risk)."""

NEAR = 1.05
"""Ratio of two shares, or slopes, that are no longer told apart."""

MOST_ROUTES = 4_000
"""Routes that are kept, the latest ones."""

NODES = 2_000
"""Nodes of a search for the best choice of routes."""

SECONDS = 5.0
"""Longest time of one such search."""


def _refuses(problem: Any) -> frozenset[str]:
    if not problem.features() & RISKS:
        return frozenset({"problems without a limit on risk"})
    return PyVRP().missing(certain(problem, 1.0, problem.team_risk))


def _opens(problem: Any) -> bool:
    if problem.family != "routing" or not problem.features() & RISKS:
        return False
    forms = problem.forms()
    if "set-partitioning" in forms:  # which solves what it takes in the time that a start would take
        return False
    return len(problem.customers) > EXACT or not any(FORMS[name].exactness is Exactness.EXACT for name in forms)


@heuristic(
    "safety-margins",
    "routing", (PyVRP.features | RISKS) - {"time-windows", "several-windows", "energy:travel"},
    "PyVRP, or another engine, with margins for uncertain durations, fitted to the risk of routes and team",
    refuses=_refuses, opens=_opens,
)  # fmt: skip
def safety_margins(
    problem: RoutingProblem, context: Context, *, rounds: int = 8, splits: int = 4, steps: int = 1000, engine: str = "pyvrp"
) -> Outcome:
    """Give durations a margin for what is uncertain of them, have an engine find routes, and fit the margin to these.

    Takes limits on the risk of routes or of the team where nobody waits for a window. Answers with the best routes that keep all limits;
    none where no round found any. A start that keeps all limits is the first answer. The mathematics:
    docs/formulations/routing.md#approximations.

    Parameters
    ----------
    rounds : int, >= 1
        Searches at most; the first one leaves the risk out, and is the last where its answer keeps it.
    splits : int, >= 0
        Searches after these, each with a vehicle per route, and with the risk split anew; they end where one gains nothing.
    steps : int, >= 1
        The engine's iterations in each, where it counts any.
    engine : str
        A solver of routing problems that takes the data without their risks.
    """
    for name, value, least in (("rounds", rounds, 1), ("splits", splits, 0), ("steps", steps, 1)):
        if not (isinstance(value, int) and value >= least):
            raise UsageError(f"{name} must be a whole number of at least {least}, not {value!r}", "out-of-range")
    solver = _engine(engine, problem)
    stop, search = context.begin(), _Search(problem, context)
    if context.start is not None:
        search.judge(context.start)
    seed, done, resplit = int(context.rng.integers(2**31)), 0, 0
    while done < rounds:
        done += 1
        answer = search.routes(solver, certain(problem, search.slope, search.share), steps, seed, stop)
        if search.settled(answer) or stop.reached():
            break
    if search.slope:  # otherwise the answer for the means keeps all limits
        search.recombine(stop, seed)
        while resplit < splits and not stop.reached() and search.best is not None:
            parts, before = split(problem, search.best), search.rank
            if parts is None or solver.missing(parts.problem):
                break
            resplit += 1
            answer = search.routes(solver, parts.problem, steps, seed + resplit, stop, parts.start)
            if answer is not None:
                search.judge(parts.back(answer))
            search.recombine(stop, seed)
            if search.rank == before:
                break
    cut = stop.reached()
    none = f"{engine} refuses durations with margins: {search.refused}" if search.refused else "no routes were found that keep the limits"
    statistics = {"rounds": done, "splits": resplit, "slope": search.slope, "routes": len(search.pool.routes)}
    return ended(search.best, cut, statistics, "" if cut or search.best is not None else none)


class _Search:
    """The best answer so far, and the slope and each route's share of the team's risk for the next search."""

    def __init__(self, problem: RoutingProblem, context: Context) -> None:
        self.problem, self.publish = problem, context.publish
        self.signs = [1.0 if sense == "min" else -1.0 for sense in problem.senses]
        self.best: Routes | None = None
        self.rank: tuple[float, ...] = ()
        self.slope, self.share = 0.0, problem.team_risk
        self._low = self._high = 0.0 if problem.team_risk is None else problem.team_risk
        self._vain = 0
        self.pool = Pool(problem)
        self.refused = ""

    def routes(
        self, engine: Engine, problem: RoutingProblem, steps: int, seed: int, stop: Stop, start: Routes | None = None
    ) -> Routes | None:
        """An answer of the engine; None, and the reason is kept, where it cannot count the numbers: that costs no answer from before."""
        control = Control()
        counted = steps if "iterations" in engine.honours else None
        options = Options(time_limit=min(stop.seconds_left, 1e9), iterations=counted, seed=seed, start=start)
        try:
            with stop.telling(control.stop):
                answer: Routes | None = engine.run(problem, options, control).answer
            return answer
        except InputError as fault:
            self.refused = str(fault)
            return None

    def judge(self, answer: Routes) -> bool:
        """Whether an answer keeps all limits; it is kept if it is the best of these."""
        self.pool.add(answer)
        judged = self.problem.evaluate(answer)
        rank = tuple(sign * value for sign, value in zip(self.signs, judged.values, strict=True))
        if judged.feasible and (self.best is None or rank < self.rank):
            self.best, self.rank = answer, rank
            self.publish(answer)
        return judged.feasible

    def recombine(self, stop: Stop, seed: int) -> None:
        """Judge the best choice among all routes so far."""
        answer = self.pool.best(stop, seed, self.best)
        if answer is not None:
            self.judge(answer)

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
        steepest = (0.0, 0.0)
        for route in answer:
            vehicle = self.problem.fleet[route.vehicle]
            risk, plan = allowed_risk(vehicle, self.share), schedule(self.problem, route)
            if risk is not None and plan.variance > 0.0:
                slope = quantile(risk) / (2.0 * vehicle.speed * math.sqrt(plan.variance))
                steepest = max(steepest, (route_overrun(vehicle, plan), slope))
        return steepest[1]


def _near(a: float, b: float) -> bool:
    return max(a, b) < NEAR * min(a, b)


def _engine(name: str, problem: RoutingProblem) -> Engine:
    """The engine of that name, if it takes the problem without its risks."""
    engine = solver_named(name)
    if not isinstance(engine, Engine) or engine.family != problem.family:
        raise UsageError(f"{name} is no engine for routing problems; pyvrp is one")
    lacking = engine.missing(certain(problem, 1.0, problem.team_risk))
    if lacking:
        raise UnsupportedError(f"engine {name}", lacking)
    return engine


def allowed_risk(vehicle: VehicleType, share: float | None) -> float | None:
    """The risk of a route where each has a ``share`` in that of the team."""
    risks = [risk for risk in (vehicle.risk, share) if risk is not None]
    return min(risks, default=None)


def certain(problem: RoutingProblem, slope: float, share: float | None) -> RoutingProblem:
    """The problem with certain durations, and with margins for a positive ``slope``, the duration added per variance of a move.

    For a slope of 0 durations are the means; otherwise answers keep the risk of each route, which is ``share`` in place of the team's.
    """
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
            capacity, initial = (
                None if held is None else max(0.0, held - energy.rate * margin) for held in (energy.capacity, energy.initial)
            )
            energy = replace(energy, capacity=capacity or 0.0, initial=initial)
        fleet.append(replace(vehicle, risk=None, travel=own, energy=energy, max_duration=max(0.0, vehicle.max_duration - margin)))
    return replace(problem, travel=_stretched(problem.travel, slope), fleet=tuple(fleet), team_risk=None)


def _stretched(travel: Travel, slope: float) -> Travel:
    if travel.variances is None:
        return travel
    longer = travel.durations + slope * travel.variances if slope else travel.duration_matrix
    return replace(travel, duration_matrix=longer, variances=None)


@dataclass(frozen=True, eq=False)
class Split:
    """A problem in which each route of an answer has a vehicle of its own, with its own risk and margin.

    ``problem`` has certain durations, and its answers keep the risk of each route, and that of the team; ``start`` is the answer as one of
    it; ``kinds`` are the vehicle types in the problem that was split.
    """

    problem: RoutingProblem
    start: Routes
    kinds: tuple[int, ...]

    def back(self, answer: Routes) -> Routes:
        """An answer to the problem that was split."""
        return Routes(tuple(Route(route.visits, self.kinds[route.vehicle]) for route in answer))


def split(problem: RoutingProblem, answer: Routes) -> Split | None:
    """One vehicle per route of ``answer``, which keeps all limits, and one more of each type that has any left.

    Of a risk of the team each route keeps what it has, and all vehicles get equal parts of the rest of ``-log(1 - team_risk)``. Margins are
    exact for routes of the variance that they are made for, so that the answer is feasible still, and no better one is lost to them that
    differs from it by little. None where vehicles drive without a site to serve.
    """
    if any(v.committed for v in problem.fleet):
        return None
    plans = [schedule(problem, route) for route in answer]
    used = [route.vehicle for route in answer]
    spare = [k for k, v in enumerate(problem.fleet) if v.count is None or used.count(k) < v.count]
    drivers = [*used, *spare]
    variances = [plan.variance for plan in plans]
    mean = math.fsum(variances) / max(1, len(variances))
    shares: Sequence[float | None] = [None] * len(drivers)
    if problem.team_risk is not None:
        spent = [-math.log1p(-route_overrun(problem.fleet[k], plan)) for k, plan in zip(used, plans, strict=True)]
        rest = max(0.0, -math.log1p(-problem.team_risk) - math.fsum(spent)) / len(drivers)
        weights = [s + rest for s in spent] + [rest] * len(spare)
        shares = [min(0.5, -math.expm1(-w)) or None for w in weights]
        if None in shares:
            return None
    fleet, start = [], []
    for number, (kind, share, variance) in enumerate(zip(drivers, shares, [*variances, *[mean] * len(spare)], strict=True)):
        vehicle = problem.fleet[kind]
        risk = allowed_risk(vehicle, share)
        slope = quantile(risk) / (2.0 * vehicle.speed * math.sqrt(variance)) if risk is not None and variance > 0.0 else 0.0
        alone = replace(problem, fleet=(replace(vehicle, count=1, travel=vehicle.travel or problem.travel, name=f"{number + 1}"),))
        fleet.append(certain(alone, slope, share).fleet[0])
        if number < len(used):
            start.append(Route(answer.routes[number].visits, number))
    plain = replace(problem.travel, variances=None)
    return Split(replace(problem, fleet=tuple(fleet), travel=plain, team_risk=None), Routes(tuple(start)), tuple(drivers))


class Pool:
    """Routes that keep all limits of single routes, and the best choice among them: set partitioning, with the team's risk as one row.

    How the risk is split is decided by the routes that are chosen, and so at least cost over the routes at hand.
    """

    def __init__(self, problem: RoutingProblem) -> None:
        self.problem = problem
        self.routes: dict[Route, None] = {}
        self._chosen = 0
        lacking = FORMS["set-partitioning"].missing(problem)
        self.able = all(name.startswith("more than") for name in lacking)
        if self.able:
            self.add(Routes(tuple(Route((site,), kind) for kind in range(len(problem.fleet)) for site in problem.customers.tolist())))

    def add(self, answer: Routes) -> None:
        """Keep the routes of an answer that are good by themselves."""
        if not self.able:
            return
        for route in answer:
            if route.visits and route not in self.routes and self._good(route):
                self.routes[route] = None
                if len(self.routes) > MOST_ROUTES:
                    self.routes.pop(next(iter(self.routes)))

    def _good(self, route: Route) -> bool:
        problem, judge = self.problem, Checklist()
        plan = check_route(problem, "route", route, judge)
        risk = problem.team_risk
        return not judge.violations and (risk is None or route_overrun(problem.fleet[route.vehicle], plan) <= risk)

    def best(self, stop: Stop, seed: int, start: Routes | None) -> Routes | None:
        """The best choice that was found; None where no routes came since the last time."""
        if not self.able or len(self.routes) == self._chosen or stop.reached():
            return None
        self._chosen = len(self.routes)
        control = Control()
        try:
            compiled = over(self.problem, self.routes)
            first = None if start is None or compiled.encode is None else compiled.encode(start)
        except WayboundError:  # a route that the form's own arithmetic finds to be beyond a limit
            return None
        options = Options(time_limit=min(SECONDS, stop.seconds_left), iterations=NODES, seed=seed, start=first)
        with stop.telling(control.stop):
            chosen = Highs().run(compiled.program, options, control).answer
        return None if chosen is None else compiled.decode(chosen)
