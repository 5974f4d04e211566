"""Verified bounds of a problem: before a search, beside it, and after it by every method that applies, within a budget."""

import math
import os
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from ..formulations.certificate import Certificate, certify
from ..formulations.evidence import ENDLESS, Evidence
from ..formulations.problem import Problem
from ..formulations.stop import Stop, off_the_clock
from ..formulations.tolerance import gap, same
from ..formulations.verified_bounds import proved_bound
from ..instances.errors import UnsupportedError, in_words
from ..solvers.backend import Control, Options, RawResult
from ..solvers.bounds import BOUNDS, BoundMethod, replaced
from ..solvers.isolation import run_in_process
from ..solvers.linear_programs import LinearPrograms
from .recording import Recorder
from .search import BOUND_OVERTIME, Searched, search

AT_ONCE = 0
"""Order of the methods that are asked however little time is left: what a bound is at least must not hang on the clock."""

FIRST_SECONDS = 1.0
"""Most seconds of bounding before a search; never more than the budget for bounding."""

LARGEST = 500
"""Problems of a larger ``size`` have bounds that no answer reaches, and whose verification takes as long as finding them: what is there at
once is all that is looked for before the search."""

_TICK = 0.05


def find_bounds(
    problem: Problem,
    bound_time: float,
    *,
    target: float | None = None,
    answer: Any = None,
    known: Sequence[Evidence] = (),
    control: Control | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    unable: list[str] | None = None,
    linear: LinearPrograms | None = None,
    searching: bool = True,
    at_once: bool = False,
    compiling: Literal["never", "last", "first"] = "last",
    uncompiled: list[str] | None = None,
) -> list[Evidence]:
    """Evidence for bounds of ``problem``, to be verified by the checker.

    ``bound_time`` is the budget in seconds for all methods together, without what they prepare, compile or load; 0 turns bounding off.
    Evidence that reaches ``target``, the value of an answer, ends the search; the parts of ``answer`` help some methods, and ``known`` is
    evidence that is there already. ``control`` stops between and inside methods, and hears of the evidence and of the best answer that a
    method comes across; ``progress`` receives an event for each bound found, ``unable`` a line for each method that failed, after which the
    others are tried all the same.

    Methods that search (``BoundMethod.aims``) do so only if ``searching``, and take all the time that there is. ``at_once`` asks those
    alone that search nothing and have nothing to prepare; they come first in any case, before anything is compiled or loaded for the
    others. ``compiling`` says when methods whose loops were never compiled, of which ``uncompiled`` receives the names, have their turn:
    never; after all others, which are there then whatever becomes of these, and have half the budget; or before them, where the others had
    theirs already.
    """
    found: dict[str, Evidence] = {}
    failed: list[str] = [] if unable is None else unable
    if bound_time <= 0:
        return []
    control, linear = control or Control(), linear or LinearPrograms()
    methods = able_methods(problem, failed, searching=searching)
    stop = Stop(bound_time)  # from here on: listing imports them all
    control.on_stop(stop.ask)

    def settled(method: BoundMethod, within: Stop) -> bool:
        """Whether what the method finds leaves nothing to look for."""
        try:
            with off_the_clock():
                method.prepare()
            evidence = method.evidence(problem, within, linear, target, answer, control.publish)
        except UnsupportedError:
            return False
        except Exception as fault:  # whatever it is: a bound that cannot be computed is no bound, and costs neither answer nor other bounds
            failed.append(f"no bound by {method.name}: {in_words(fault)}")
            return False
        if evidence is None:
            return False
        found[method.name] = evidence
        control.publish(evidence=tuple(found.values()))
        if progress is not None:
            seconds = bound_time - stop.seconds_left
            progress({"phase": "bound", "seconds": seconds, "objective": target, "bound": evidence.value, "source": evidence.source})
        return evidence.kind in ENDLESS or reaches(evidence)

    def reaches(evidence: Evidence) -> bool:
        """Whether the bound that its checker derives, not only the one it states, reaches the target."""
        if target is None or not same(evidence.value, target):
            return False
        bound = proved_bound(problem, evidence)
        return bound is not None and same(bound, target)

    if not any(map(reaches, known)):
        for method, within in _turns(methods, stop, control, bound_time, at_once, compiling, failed, uncompiled):
            if settled(method, within):
                break
    return [found[method.name] for method in methods if method.name in found]


def _turns(
    methods: list[BoundMethod], stop: Stop, control: Control, bound_time: float, at_once: bool, compiling: str, failed: list[str],
    uncompiled: list[str] | None,
) -> Iterator[tuple[BoundMethod, Stop]]:  # fmt: skip
    """The methods in the order of their turns, each with the end of its time; the parameters are those of ``find_bounds``."""
    for method in (m for m in methods if m.order <= AT_ONCE):
        if control.stopped:
            return
        yield method, stop
    if at_once or stop.reached():
        return
    others = [m for m in methods if m.order > AT_ONCE]
    late = _late(others, failed)
    if uncompiled is not None:
        uncompiled.extend(method.name for method in late)
    others = [method for method in others if method not in late]
    share = stop.within(bound_time / 2.0) if compiling == "last" and late else stop
    for method in {"never": others, "last": others + late, "first": late + others}[compiling]:
        within = stop if method in late else share
        if stop.reached():
            return
        if within.reached() or (method in late and stop.seconds_left < min(1.0, 0.4 * bound_time)):  # not worth a compiler
            continue
        yield method, within


def _late(methods: list[BoundMethod], failed: list[str]) -> list[BoundMethod]:
    """The methods whose loops were never compiled; a method that raises an error here is removed from ``methods``."""
    late: list[BoundMethod] = []
    for method in tuple(methods):
        try:
            with off_the_clock():
                if not method.compiled():
                    late.append(method)
        except Exception as fault:
            methods.remove(method)
            failed.append(f"no bound by {method.name}: {in_words(fault)}")
    return late


def able_methods(problem: Problem, failed: list[str], *, searching: bool = True) -> list[BoundMethod]:
    """The methods that apply, cheapest first; ``failed`` receives a line for each that cannot say."""
    methods: list[BoundMethod] = []
    others = replaced(problem)
    for method in sorted(BOUNDS.values(), key=lambda method: method.order):
        try:
            if (searching or not method.aims) and method.name not in others and not method.missing(problem):
                methods.append(method)
        except Exception as fault:
            failed.append(f"no bound by {method.name}: {in_words(fault)}")
    return methods


def bounded(problem: Problem, seconds: float, **settings: Any) -> Searched:
    """``find_bounds`` as a search that Ctrl-C ends; its answer is the best that a method came across."""

    def find(control: Control) -> RawResult:
        evidence = tuple(find_bounds(problem, seconds, control=control, **settings))
        return RawResult("unknown", answer=control.answer, evidence=evidence)

    return search(find, Control(), seconds, overtime=BOUND_OVERTIME)


# -- before a search -----------------------------------------------------------------------------------------------------------


def first_evidence(
    problem: Problem, seconds: float, linear: LinearPrograms | None = None, most: float = 0.0, uncompiled: list[str] | None = None
) -> "tuple[list[Evidence], Goal | None]":
    """Evidence found within ``seconds``, and the goal that it sets for a search with the gap ``most``; large problems set none.

    Nothing is compiled for it: ``uncompiled`` receives the names of the methods that this leaves out.
    """
    large = problem.size > LARGEST
    try:
        searched = bounded(problem, seconds, linear=linear, searching=False, at_once=large, compiling="never", uncompiled=uncompiled)
        evidence = list(searched.result.evidence)
        if large:
            return evidence, None
        certificate = certify(problem, None, evidence)
        return evidence, Goal(problem, certificate, most)
    except (Exception, KeyboardInterrupt):  # whatever fails here will be told by the bounding that follows the search, and costs no answer
        return [], None


class Goal:
    """Ends a search, through its ``Control``, whose incumbent reaches a verified bound, or comes within the relative gap ``most`` of it.

    ``certificate`` is one without an answer; ``learn`` replaces it.
    """

    def __init__(self, problem: Problem, certificate: Certificate, most: float = 0.0) -> None:
        self.problem, self.certificate, self.most, self.limit, self.reached = problem, certificate, most, "none", False

    def learn(self, evidence: Sequence[Evidence]) -> None:
        """Take more evidence into account."""
        self.certificate = certify(self.problem, None, [*self.certificate.evidence, *evidence])

    @property
    def infeasible(self) -> bool:
        """Whether it is proved that there is no answer."""
        return self.certificate.infeasible

    def event(self) -> dict[str, Any]:
        """The event of the best bound that was checked so far."""
        worst = math.inf if self.problem.sense == "min" else -math.inf
        bound = worst if self.infeasible else self.certificate.bound
        return {"bound": bound, "kind": "verified", "source": str(self.certificate.bound_source)}

    def __call__(self, answer: Any, objective: float | None) -> bool:
        """Whether ``answer``, of this ``objective`` by its engine's count, leaves nothing to gain."""
        if len(self.problem.senses) == 1 and objective is not None and self._close(objective):
            judged = self.problem.evaluate(answer)
            if judged.feasible and self._close(judged.values[0]) and not self.reached:  # of several threads the first one decides
                self.limit, self.reached = "none" if self.met(judged.values[0]) else "gap", True
        return self.reached

    def met(self, value: float | None) -> bool:
        """Whether ``value`` meets the bound, or there is no answer at all."""
        known = self.certificate.bound
        return self.infeasible or (value is not None and known is not None and same(value, known))

    def _close(self, value: float) -> bool:
        bound = self.certificate.bound
        return bound is not None and (same(value, bound) or gap(value, bound) <= self.most)


# -- beside a search -----------------------------------------------------------------------------------------------------------


def free_core(threads: int) -> bool:
    """Whether the machine has a core that ``threads`` threads leave alone."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return cores > threads


@dataclass(frozen=True)
class BoundWork:
    """Bounding, picklable, and called with a ``Control``, to which the evidence found so far is published."""

    problem: Problem
    bound_time: float
    known: Sequence[Evidence]
    linear: LinearPrograms

    modules: ClassVar[tuple[str, ...]] = ("numba", "highspy")

    def __call__(self, control: Control) -> RawResult:
        control.publish()  # it has begun
        unable: list[str] = []
        find_bounds(self.problem, self.bound_time, known=self.known, control=control, unable=unable, linear=self.linear, compiling="first")
        return RawResult("unknown", statistics={"unable": unable})


class Bounding:
    """Bounds of a problem within one budget: the quick ones before its search, the others beside it where a core is free.

    ``budget`` is in seconds, and 0 once it is proved that there is no answer. ``first`` was found before the search, in ``seconds``;
    ``goal`` ends the search where it is set. ``beside`` says that bounding goes on beside the search, and ``line`` is the line to it, with
    the evidence and the best answer that a method came across. ``fault`` is what kept it from beginning, such as a problem that cannot be
    sent to another process; ``unable`` has a line for each method that failed.
    """

    def __init__(self, problem: Problem, budget: float, linear: LinearPrograms, record: Recorder) -> None:
        self.problem, self.budget, self.linear, self._record = problem, budget, linear, record
        self.first, self.seconds, self.beside, self.fault, self.unable = list[Evidence](), 0.0, False, "", list[str]()
        self.goal: Goal | None = None
        self.line = Control(self._heard)
        self._done, self._begun, self._told, self._lines = threading.Event(), False, 0, list[Control]()

    def begin(self, searched: Control, options: Options, competing: bool = False) -> None:
        """Find the quick bounds, and go on beside the search, whose line is ``searched``: it ends when nothing is left to gain.

        So it does where bounding comes across a best answer, if ``competing``.
        """
        began, most, uncompiled = time.perf_counter(), min(FIRST_SECONDS, self.budget), list[str]()
        if self.budget > 0:
            self._record.begin_phase("bound", most)
        self.first, self.goal = first_evidence(self.problem, most, self.linear, options.gap, uncompiled)
        searched.goal, self._lines = self.goal, [searched, self.line] if competing else [searched]
        if self.goal is not None and self.first:
            self._record.of_bounds(self.goal.event())
        if self.no_answer:
            self.budget = 0.0
        elif self.goal is not None and (self.budget > FIRST_SECONDS or (self.budget > 0 and uncompiled)) and free_core(options.threads):
            self.beside = True
            work = BoundWork(self.problem, self.budget, tuple(self.first), self.linear)
            threading.Thread(target=self._run, args=(work,), name="waybound-bounds", daemon=True).start()
        self.seconds = time.perf_counter() - began

    @property
    def no_answer(self) -> bool:
        """Whether it is proved that there is no answer."""
        return self.goal is not None and self.goal.infeasible

    def _run(self, work: BoundWork) -> None:
        try:
            result = run_in_process(work, Options(time_limit=work.bound_time), self.line, aside=True)
            self.fault, self.unable = "" if self._begun else result.message, result.statistics.get("unable", [])
        except Exception as fault:  # costs no answer; what was published stands
            self.fault = "" if self._begun else in_words(fault)
        finally:
            self._done.set()

    def _heard(self, event: dict[str, Any]) -> None:
        self._begun, evidence, goal = True, self.line.evidence, self.goal
        assert goal is not None
        if len(evidence) > self._told:
            self._record.of_bounds({"bound": evidence[-1].value, "source": evidence[-1].source})
        with suppress(Exception):  # a checker that fails is told when the certificate is made
            if len(evidence) > self._told:
                self._told = len(evidence)
                goal.learn(evidence)
            if goal.infeasible or any(line.answer is not None and goal(line.answer, line.objective) for line in self._lines):
                self._lines[0].stop()

    def found_beside(self, control: Control, best: float | None = None) -> tuple[Evidence, ...]:
        """All evidence, once the budget is spent, ``control`` asks for the end, or nothing is left to gain for an answer worth ``best``.

        With a verified bound it waits no longer than the budget, whatever is being compiled: the next run finds it compiled.
        """
        over, goal = time.perf_counter() + self.budget, self.goal
        assert goal is not None
        while not (self._done.wait(_TICK) or control.stopped or goal.met(best)):
            if goal.certificate.bound is not None and time.perf_counter() > over:
                break
        self.line.stop()
        return self.line.evidence
