"""Routes that keep limits on uncertain durations, made by an engine that knows certain ones alone.

A route of mean duration D and variance V keeps a limit B with probability 1 - risk if D + z sqrt(V) <= B. For any slope c > 0

    z sqrt(V) <= c V + z^2 / (4 c),     with equality at c = z / (2 sqrt(V)),

so that with c times its variance added to the duration of each move, and z^2 / (4 c) taken from B, whatever is feasible is so for the
problem asked. Slopes follow the routes that come closest to their limits. Of a risk of the team every route is first given an equal share,
then as large a one as all routes together bear. Of all routes that were met those are chosen that go together best, which splits the
team's risk anew; then each of them keeps its own part and slope, beside its own part of what is left of the risk, and the engine goes on
from there, as iterative risk allocation does (Ono and Williams 2008): answers become no worse.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ...formulations.forms import FORMS
from ...formulations.programs.exactness import Exactness
from ...formulations.routing.overrun import quantile, route_overrun
from ...formulations.routing.schedule import schedule
from ...instances.errors import InputError, UnsupportedError, UsageError
from ...instances.routing.features import RISKS
from ...solvers.backend import Control, Engine, Options, solver_named
from ...solvers.engines.routing.pyvrp import PyVRP
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .margin_steps.certain import allowed_risk, certain, split
from .margin_steps.recombination import Pool

if TYPE_CHECKING:
    from ...formulations.routing.problem import RoutingProblem
    from ...formulations.routing.routes import Routes
    from ...formulations.stop import Stop

EXACT = 10
"""Customers up to which solvers find answers by themselves (docs/formulations/routing.md#risk)."""

NEAR = 1.05
"""Ratio of two shares, or slopes, that are no longer told apart."""


def safety_margins(
    problem: RoutingProblem, context: Context, *, rounds: int = 8, splits: int = 4, steps: int = 1000, engine: str = "pyvrp"
) -> Outcome:
    """Give durations a margin for what is uncertain of them, have an engine find routes, and fit the margin to these.

    Parameters
    ----------
    problem : RoutingProblem
        With a risk of routes or of the team; nobody waits for a window.
    context : Context
        Its ``start`` is the first answer where it keeps all limits.
    rounds : int, >= 1
        Searches at most; the first one leaves the risk out, and is the last where its answer keeps it.
    splits : int, >= 0
        Searches after these, each with a vehicle a route, and with the risk split anew; they end where one gains nothing.
    steps : int, >= 1
        The engine's iterations in each, where it counts any.
    engine : str
        A solver of routing problems that takes the data without their risks.

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
    for name, value, least in (("rounds", rounds, 1), ("splits", splits, 0), ("steps", steps, 1)):
        if not (isinstance(value, int) and value >= least):
            raise UsageError(f"{name} must be a whole number of at least {least}, not {value!r}")
    made = _engine(engine, problem)
    stop, search = context.begin(), _Search(problem, context)
    if context.start is not None:
        search.judge(context.start)
    seed, done, resplit = int(context.rng.integers(2**31)), 0, 0
    while done < rounds:
        done += 1
        answer = search.found(made, certain(problem, search.slope, search.share), steps, seed, stop)
        if search.settled(answer) or stop.reached():
            break
    if search.slope:  # otherwise the answer for the means keeps all limits
        search.recombine(stop, seed)
        while resplit < splits and not stop.reached() and search.best is not None:
            parts, before = split(problem, search.best), search.rank
            if parts is None or made.missing(parts.problem):
                break
            resplit += 1
            answer = search.found(made, parts.problem, steps, seed + resplit, stop, parts.start)
            if answer is not None:
                search.judge(parts.back(answer))
            search.recombine(stop, seed)
            if search.rank == before:
                break
    cut = stop.reached()
    none = f"{engine} refuses durations with margins: {search.refused}" if search.refused else "no routes were found that keep the limits"
    message = CUT_SHORT if cut else "" if search.best is not None else none
    told = {"rounds": done, "splits": resplit, "slope": search.slope, "routes": len(search.pool.routes)}
    return Outcome(search.best, statistics=told, message=message, limit=cut or "none")


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
        self.pool = Pool(problem)
        self.refused = ""

    def found(
        self, engine: Engine, problem: RoutingProblem, steps: int, seed: int, stop: Stop, start: Routes | None = None
    ) -> Routes | None:
        """What the engine finds; nothing, and why, where it cannot count the numbers: that costs no answer from before."""
        try:
            return _found(engine, problem, steps, seed, stop, start)
        except InputError as fault:
            self.refused = str(fault)
            return None

    def judge(self, answer: Routes) -> bool:
        """Whether it keeps all limits; it is kept if it is the best of these."""
        self.pool.add(answer)
        judged = self.problem.evaluate(answer)
        rank = tuple(sign * value for sign, value in zip(self.signs, judged.values, strict=True))
        if judged.feasible and (self.best is None or rank < self.rank):
            self.best, self.rank = answer, rank
            self.publish(answer)
        return judged.feasible

    def recombine(self, stop: Stop, seed: int) -> None:
        """Choose among all routes so far."""
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


def _engine(name: str, problem: RoutingProblem) -> Engine:
    """The engine of that name, if it takes what is left of the problem without risks."""
    made = solver_named(name)
    if not isinstance(made, Engine) or made.family != problem.family:
        raise UsageError(f"{name} is no engine for routing problems; pyvrp is one")
    lacking = made.missing(certain(problem, 1.0, problem.team_risk))
    if lacking:
        raise UnsupportedError(f"engine {name}", lacking)
    return made


def _found(engine: Engine, problem: RoutingProblem, steps: int, seed: int, stop: Stop, start: Routes | None = None) -> Routes | None:
    control = Control()
    counted = steps if "iterations" in engine.honours else None
    options = Options(time_limit=min(stop.seconds_left, 1e9), iterations=counted, seed=seed, start=start)
    with stop.telling(control.stop):
        answer: Routes | None = engine.run(problem, options, control).answer
    return answer


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


HEURISTICS.add(
    "safety-margins",
    Heuristic(
        name="safety-margins",
        families=("routing",),
        features=(PyVRP.features | RISKS) - {"time-windows", "several-windows", "energy:travel"},
        run=safety_margins,
        summary="PyVRP, or another engine, with margins for uncertain durations, fitted to the risk of routes and team",
        refuses=_refuses,
        opens=_opens,
    ),
)
