"""Bounding beside a search: in a process of its own, where a core is free."""

from __future__ import annotations

import os
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, ClassVar

from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
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
        found = find_bounds(self.problem, self.bound_time, known=self.known, control=control, linear=self.linear)
        return RawResult("unknown", answer=found)


class Beside(Control):
    """Bounds a problem while ``searched`` is the line to the search for its answer, which ends when nothing is left to gain.

    Parameters
    ----------
    work : BoundWork
    goal : Goal
    searched : Control
    """

    def __init__(self, work: BoundWork, goal: Goal, searched: Control) -> None:
        super().__init__()
        self._goal, self._searched, self._done = goal, searched, threading.Event()
        threading.Thread(target=self._run, args=(work,), name="waybound-bounds", daemon=True).start()

    def _run(self, work: BoundWork) -> None:
        try:
            with suppress(Exception):  # what fails beside a search costs no answer; what was published stands
                result = run_in_process(work, Options(time_limit=work.bound_time), self)
                if result.answer is not None:
                    self.answer = result.answer
        finally:
            self._done.set()

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        super().publish(answer, objective, bound, evidence)
        with suppress(Exception):  # a checker that fails is told when the certificate is made
            self._goal.learn(answer)
            held = self._searched.answer
            if self._goal.infeasible or (held is not None and self._goal(held, self._searched.objective)):
                self._searched.stop()

    def found(self, control: Control) -> list[Evidence]:
        """All evidence, once the budget is spent or ``control`` asks for the end."""
        while not self._done.wait(_TICK):
            if control.stopped:
                self.stop()
        return list(self.answer or ())
