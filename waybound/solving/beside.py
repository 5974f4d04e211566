"""Bounding beside a search: in a process of its own, where a core is free."""

from __future__ import annotations

import math
import os
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar

from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..instances.errors import in_words
from ..solvers.backend import Control, Options, RawResult
from ..solvers.isolation import run_in_process
from ..solvers.linear_programs import LinearPrograms
from .bounding import find_bounds
from .goal import Goal

_TICK = 0.05


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
        control.publish([])
        unable: list[str] = []
        found = find_bounds(
            self.problem, self.bound_time, known=self.known, control=control, unable=unable, linear=self.linear, compiling="first"
        )
        return RawResult("unknown", answer=found, statistics={"unable": unable})


class Beside(Control):
    """Bounds a problem while ``searched`` is the line to the search for its answer, which ends when nothing is left to gain.

    Parameters
    ----------
    work : BoundWork
    goal : Goal
    searched : Control
    progress : callable, optional
        Receives an event for each bound found.

    Attributes
    ----------
    fault : str
        What kept it from beginning, such as a problem that cannot be sent to another process; empty if nothing did.
    unable : list of str
        A line for each method that failed.
    """

    def __init__(self, work: BoundWork, goal: Goal, searched: Control, progress: Callable[[dict[str, Any]], None] | None = None) -> None:
        super().__init__()
        self._goal, self._searched, self._tell, self._done = goal, searched, progress, threading.Event()
        self.fault, self.unable = "", list[str]()
        threading.Thread(target=self._run, args=(work,), name="waybound-bounds", daemon=True).start()

    def _run(self, work: BoundWork) -> None:
        try:
            result = run_in_process(work, Options(time_limit=work.bound_time), self, aside=True)
            self.fault, self.unable = "" if self.answer is not None else result.message, result.statistics.get("unable", [])
            self.answer = self.answer if result.answer is None else result.answer
        except Exception as fault:  # costs no answer; what was published stands
            self.fault = "" if self.answer is not None else in_words(fault)
        finally:
            self._done.set()

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        super().publish(answer, objective, bound, evidence)
        if not answer:
            return
        if self._tell is not None:
            seconds = time.perf_counter() - self.started
            last: Evidence = answer[-1]
            known = {"phase": "bound", "seconds": seconds, "objective": self._searched.objective}
            self._tell({**known, "bound": last.value, "source": last.source})
        with suppress(Exception):  # a checker that fails is told when the certificate is made
            self._goal.learn(answer)
            held = self._searched.answer
            if self._goal.infeasible or (held is not None and self._goal(held, self._searched.objective)):
                self._searched.stop()

    def found(self, control: Control, best: float | None = None, patience: float = math.inf) -> list[Evidence]:
        """All evidence, once the budget is spent, ``control`` asks for the end, or nothing is left to gain for an answer worth ``best``.

        Who has a verified bound waits ``patience`` seconds at most, whatever is being compiled: the next run goes on where this one ended.
        """
        over = time.perf_counter() + patience
        while not (self._done.wait(_TICK) or control.stopped or self._goal.met(best)):
            if self._goal.first_level is not None and time.perf_counter() > over:
                break
        self.stop()
        return list(self.answer or ())
