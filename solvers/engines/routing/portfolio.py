"""A portfolio: our own engine and the libraries in turn, each from the best routes of all before."""

from __future__ import annotations

import shutil
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from ....formulations.programs.exactness import Exactness
from ....formulations.stop import now
from ....instances.errors import UnsupportedError, UsageError, in_words
from ...backend import BACKENDS, Control, Engine, Needs, Options, RawResult
from ...children import child
from .abreast import accompanied
from .best_routes import BestRoutes, PartControl
from .branch_price_cut import BranchPriceCut
from .ortools import ORTools
from .parts import ALONE, divides
from .pyvrp import PyVRP
from .ruin_recreate import RuinRecreate
from .vroom import VROOM

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

ENGINES = (RuinRecreate, PyVRP, ORTools, VROOM)
"""In the order in which they are asked for their turns."""

RUINS = 100
"""Ruins for each iteration that is asked for: they take a local search of PyVRP about as long as one iteration does."""

WORK = ("iterations", "solutions", "scale")
"""Entries of the last engine's statistics that the portfolio's statistics repeat."""

ENOUGH = 40_000
"""Ruins for each customer that ruin and recreate is given time for, if the limit has it, before another engine goes on from its routes."""

ENOUGH_BEFORE_PROOF = 15_000
"""The same before the turn of branch, price and cut."""

FIRST_SHARE = 0.5
"""Least part of the time for ruin and recreate where another engine goes on from its routes."""

GROUPED_SHARE = 0.7
"""The same where sites stand in groups: several anneals take so long, and PyVRP finds alternatives that they missed."""

TOO_LATE = 0.05
"""Seconds of the time limit with which no engine is begun."""

COMPILING = 8.0
"""Seconds of the time limit below which nothing would be compiled in time."""

LAST_SHARE = 0.1
"""Part of the time below which no other engine is begun."""


FEW_CUSTOMERS, FEW_WITHOUT_WINDOWS, SHORT = 250, 150, 15.0
"""Problems of no more customers, with time windows and without, and answers of no more visits a route, whose routes branch, price and cut
can look through in time."""

FIRST_BOUND = 0.2
"""Part of its time in which branch, price and cut has to solve its first linear program, or another engine takes its place."""


class Opening(RuinRecreate):
    """Ruin and recreate that leaves time for another engine where its speed allows."""

    def seconds_at(self, speed: float, customers: int, routes: int, left: float) -> float:
        share = max(FIRST_SHARE, ENOUGH * customers / max(1.0, speed * left))
        return left * (share if share <= 1.0 - LAST_SHARE else 1.0)


@dataclass(frozen=True)
class Turn:
    """One engine's turn: its part of the time that is left then, what an iteration that is asked for is to it, and options of its own."""

    engine: type[Engine]
    share: float = 1.0
    work: int = 1
    options: Mapping[str, Any] = field(default_factory=dict)


class BeforeProof(Opening):
    """Ruin and recreate that takes half of the time at most where routes are short enough for branch, price and cut."""

    def seconds_at(self, speed: float, customers: int, routes: int, left: float) -> float:
        if customers > SHORT * routes:
            return super().seconds_at(speed, customers, routes, left)
        return min(FIRST_SHARE * left, ENOUGH_BEFORE_PROOF * customers / max(1.0, speed))


def proves(problem: RoutingProblem) -> bool:
    """Whether branch, price and cut takes a problem."""
    return BranchPriceCut.installed() and not BranchPriceCut().missing(problem)


@BACKENDS.register("portfolio")
class Portfolio(Engine):
    """Ruin and recreate, then a library's engine from its routes, within one limit of time.

    Problems that only one of its engines takes are that engine's. ``iterations`` counts those of the library; a hundred ruins are one.
    """

    name = "portfolio"
    package = "waybound"
    modules = ("numba",)
    summary = "ruin and recreate, then branch, price and cut, PyVRP, OR-Tools or VROOM from its routes"
    family: ClassVar[str] = "routing"
    options = MappingProxyType({})
    order = 5
    honours = frozenset({"iterations", "no_improvement", "gap"})
    features = frozenset[str]().union(*(kind.features for kind in ENGINES))

    def unasked(self, problem: Problem) -> bool:
        return RuinRecreate().unasked(problem)

    def turns(self, problem: RoutingProblem) -> list[Turn]:
        """The turns at a problem, first to last; none where no installed engine takes it."""
        able = [kind for kind in ENGINES if kind.installed() and not kind().missing(problem)]
        if able[:1] == [RuinRecreate] and len(problem.customers) >= ALONE and divides(problem, Options()):
            able = able[:1]
        if able[:2] == [RuinRecreate, PyVRP]:
            if {term.name for level in problem.objective.levels() for _, term in level.terms} == {"reward"}:
                rich = Turn(RuinRecreate, 0.5, RUINS, {"worth": 4.0})
                return [Turn(RuinRecreate, 0.4, RUINS), rich, Turn(PyVRP)]  # how much rewards are best taken for differs from file to file
            if RuinRecreate().bisects(problem):  # which asks ruin and recreate again and again, each time for a part of its time
                return [Turn(RuinRecreate, FIRST_SHARE, RUINS), Turn(PyVRP)]
            if problem.sites.groups:
                return [Turn(RuinRecreate, GROUPED_SHARE, RUINS), Turn(PyVRP)]
            few = FEW_CUSTOMERS if "time-windows" in problem.features() else FEW_WITHOUT_WINDOWS
            if len(problem.customers) <= few and proves(problem):
                return [Turn(BeforeProof, work=RUINS), Turn(BranchPriceCut), Turn(PyVRP)]
            return [Turn(Opening, work=RUINS), Turn(PyVRP)]
        return [Turn(kind, work=RUINS if kind is RuinRecreate else 1) for kind in able[:1]]

    def needs(self, problem: Problem) -> Needs:
        lacking = super().missing(problem)
        turns = [] if lacking else self.turns(problem)  # type: ignore[arg-type]
        if not turns:
            return Needs(lacking or min((kind().missing(problem) for kind in ENGINES if kind.installed()), key=len))
        each = [turn.engine().needs(problem) for turn in turns]
        return Needs(frozenset(), max(one.memory for one in each), each[0].set_up_seconds, any(one.apart for one in each))

    def missing(self, problem: Problem) -> frozenset[str]:
        return self.needs(problem).missing

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        self.converted(options)
        repeats = options.iterations is not None or options.no_improvement is not None
        turns = [turn for turn in self.turns(problem) if not (repeats and turn.engine is BranchPriceCut)]  # type: ignore[arg-type]
        for turn in turns:
            ignored = [name for name in options.asked() if name not in turn.engine.honours]
            if ignored:
                raise UsageError(
                    f"{turn.engine.name}, which alone takes this problem, does not keep to {', '.join(ignored)}", "unsupported"
                )
        return _Search(problem, options, control).run(turns)  # type: ignore[arg-type]


class _Search:
    """One run: gives each engine its turn, and keeps the best answer."""

    def __init__(self, problem: RoutingProblem, options: Options, control: Control) -> None:
        self.problem, self.options, self.control = problem, options, control
        self.ends = now() + options.time_limit
        self.best = BestRoutes(problem, control)
        self.turns: list[dict[str, Any]] = []

    def run(self, turns: list[Turn]) -> RawResult:
        started = self.options.start is not None and self.best.take(self.options.start)
        results = []
        with ExitStack() as stack:
            waits = self.has_to_compile(turns)
            if waits and self.ends - now() < COMPILING:
                turns = turns[-1:]
            elif waits:
                compiler = self.compiler(stack)
                results.append(self.turn(turns[-1], 1.0, compiler))
                turns = [] if compiler.poll() is None else turns if self.compiled() else turns[-1:]  # no folder may keep what is compiled
            alone = True
            for turn in turns:
                if turn.engine is BranchPriceCut and not self.short_routes:
                    continue
                if alone and self.has_company(turn):
                    alone = False
                    own = replace(self.options, time_limit=max(0.0, self.ends - now()), start=self.best.answer or self.options.start)
                    stack.enter_context(accompanied(RuinRecreate(), self.problem, own, self.best))
                results.append(self.turn(turn, turn.share))
                closed = results[-1].status in ("optimal", "infeasible") or results[-1].limit == "gap"
                if self.control.stopped or closed or self.ends - now() < TOO_LATE:
                    break
        last = results[-1]
        statistics = {name: value for name, value in last.statistics.items() if name in WORK} | {"turns": self.turns}
        if self.options.start is not None:
            statistics["start"] = "used" if started else "refused"
        limit = "interrupt" if self.control.stopped else last.limit
        failures = [result for result in results if result.status == "error"]
        if self.best.answer is None:
            return replace((failures or [last])[0], limit=limit, statistics=statistics)
        message = "; ".join(dict.fromkeys(result.message for result in [*failures, last] if result.message))
        found = RawResult("feasible", limit, self.best.answer, self.best.claim, statistics=statistics, message=message)
        proof = next((result for result in results if result.evidence), last)
        found = replace(found, evidence=proof.evidence, links=tuple(dict.fromkeys(link for result in results for link in result.links)))
        if proof.status == "optimal":
            return replace(found, status="optimal", limit="none", bound=proof.bound, holds=proof.holds)
        return replace(found, holds=next((r.holds for r in results if r.holds is not Exactness.EXACT), Exactness.EXACT))

    @property
    def short_routes(self) -> bool:
        """Whether the best answer has few visits a route."""
        return self.best.answer is not None and sum(len(one.visits) for one in self.best.answer) <= SHORT * len(self.best.answer)

    @property
    def repeats(self) -> bool:
        """Whether the run shall repeat, so that no clock may end a turn."""
        return self.options.iterations is not None or self.options.no_improvement is not None

    def has_company(self, turn: Turn) -> bool:
        """Whether ruin and recreate searches on further threads from this turn on."""
        further = self.options.threads > 1 and not self.repeats
        return further and not issubclass(turn.engine, RuinRecreate) and not RuinRecreate().missing(self.problem)

    def has_to_compile(self, turns: list[Turn]) -> bool:
        """Whether the loops of ruin and recreate have to be compiled, and a library can search meanwhile."""
        return issubclass(turns[0].engine, RuinRecreate) and len(turns) > 1 and not self.repeats and not self.compiled()

    @staticmethod
    def compiler(stack: ExitStack) -> subprocess.Popen[bytes]:
        """A process that compiles the loops of ruin and recreate."""
        nice = shutil.which("nice")  # who searches and who bounds come first
        command = [*([nice, "-n", "5"] if nice else []), sys.executable, "-m", "waybound", "warm", "--quiet", "ruin_recreate_steps"]
        return stack.enter_context(child(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    @staticmethod
    def compiled() -> bool:
        """Whether ruin and recreate takes no compiler."""
        from .ruin_recreate_steps import near_kernels, search_kernels

        return near_kernels.nearest.kept() and search_kernels.anneal.kept()

    def turn(self, turn: Turn, share: float, until: subprocess.Popen[bytes] | None = None) -> RawResult:
        """Run one engine from the best routes so far, for its share of the time that is left or until process ``until`` ends."""
        asked, left = self.options, max(0.0, self.ends - now())
        own = replace(
            asked,
            time_limit=left if self.repeats else left * share,
            iterations=asked.iterations and asked.iterations * turn.work,
            no_improvement=asked.no_improvement and asked.no_improvement * turn.work,
            start=self.best.answer or asked.start,
            extra=dict(turn.options),
        )
        control, before, began = _TurnControl(self, until), self.best.values, now()
        patience = threading.Timer(FIRST_BOUND * own.time_limit, control.end_unless_bounded)
        patience.daemon = True
        if turn.engine is BranchPriceCut:
            patience.start()
        try:
            result = turn.engine().run(self.problem, own, control)
        except Exception as fault:  # the next one goes on, and the message tells it
            result = RawResult("error", message=f"{turn.engine.name} failed: {in_words(fault)}")
        finally:
            patience.cancel()
        if result.answer is not None:
            self.best.take(result.answer)
        done = {name: value for name, value in result.statistics.items() if name in ("iterations", "solutions")}
        found = {"before": before and list(before), "after": self.best.values and list(self.best.values)}
        self.turns.append({"engine": turn.engine.name, "seconds": round(now() - began, 2), **done, **found})
        return result


class _TurnControl(PartControl):
    """The line to an engine in its turn, which ends when process ``until`` does."""

    def __init__(self, search: _Search, until: subprocess.Popen[bytes] | None) -> None:
        super().__init__(search.best, not search.turns)
        self._until, self._bounded = until, False

    def count(self, nodes: int, **further: int) -> None:
        super().count(nodes, **further)
        self._bounded = True

    def end_unless_bounded(self) -> None:
        """End a turn in which branch, price and cut solved no linear program yet."""
        if not self._bounded:
            self.stop()

    @property
    def stopped(self) -> bool:
        return super().stopped or (self._until is not None and self._until.poll() is not None)
