"""``solve``: from a problem to an answer with its evidence, whichever method does the search."""

import math
import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.solution import Solution
from ..formulations.stop import hearing
from ..formulations.verdict import verdict_in_words
from ..instances.errors import WayboundError, in_words
from ..solvers import interrupts
from ..solvers.backend import Control, Options, RawResult
from ..solvers.linear_programs import LinearPrograms
from .bounding import Bounding
from .concluding import conclude
from .method import Run, continued, requested_run
from .recording import SLOW_SET_UP, Progress, Recorder
from .request import Request
from .search import Searched, search
from .search_log import Log, shown

PRICED_EVERY = 0.25
"""Least seconds between two incumbents of an objective with levels that are evaluated for listeners."""


def solve(problem: Problem | Compiled, request: Request | None = None, *, progress: Progress | None = None, log: Log = None) -> Solution:
    """Solve a problem as it is asked for, check the answer, and bound it; ``waybound.solve`` documents what may be asked.

    Raises UsageError, UnsupportedError, MissingPackageError, InputError before anything is run; CheckFailedError, SearchFailedError,
    NoAnswerError if there is no answer to hand over.
    """
    request = request or Request()
    compiled, problem = (problem, problem.problem) if isinstance(problem, Compiled) else (None, problem)
    options, budget = request.search_options(), request.bound_budget
    run = requested_run(problem, compiled, request, options)
    run.notes.extend(request.notes)
    listeners: list[Progress] = [] if progress is None else [progress]
    with shown(log) as written, hearing(lambda what, seconds: record.of_loops(what, seconds)):
        if written is not None:
            listeners.append(written)
            written.begin(repr(problem).strip("<>"), problem.remarks(), run.claimant, _limits_in_words(options, budget))
        record = Recorder(problem.senses, listeners)
        solution = _answered(problem, run, options, budget, request.linear, record, request.isolated)
        values = None if solution.evaluation is None else solution.evaluation.values
        solution = replace(solution, events=record.end(values, solution.bound, solution.bound_kind, solution.solver))
        if written is not None:
            result = {"objective": solution.objective, "bound": solution.bound, "gap": solution.gap}
            written.end(result, verdict_in_words(solution))
    return solution


def _answered(
    problem: Problem, run: Run, options: Options, budget: float, linear: LinearPrograms, record: Recorder, isolate: bool
) -> Solution:
    """Search, with bounds before it and beside it where the search has none of its own, and conclude."""
    bounding, exactness, priced_at, before = Bounding(problem, budget, linear, record), run.exactness, -math.inf, 0.0
    priced = run.compiled is None and len(problem.senses) > 1  # engines tell one value of an objective with levels, or none
    crash: Exception | None = None

    def heard(event: dict[str, Any]) -> None:
        nonlocal priced_at
        values = None
        if priced and control.answer is not None and time.perf_counter() - priced_at >= PRICED_EVERY:
            priced_at = time.perf_counter()
            with suppress(Exception):  # it will be judged, and told what is wrong, at the end
                judged = problem.evaluate(control.answer)
                values = list(judged.values) if judged.feasible else None
        hear({**event, "objective": values} if priced else event)

    hear = record.of_search(run.name, answers=exactness.answer_is_valid, bounds=exactness.bound_is_valid and not run.heuristic)
    control = Control(heard)
    control.on_set_up = partial(record.engine_set_up, run.name)
    with interrupts.held():  # an answer that is found is judged, whatever signal comes then
        if run.opening is not None:
            run, options, before = continued(problem, run, options, isolate, record)
        go = run.go
        if not run.bounds and options.iterations is None:  # a clock decides when evidence is there, and work limits shall repeat to the bit
            bounding.begin(control, options, competing=not run.heuristic)
        if bounding.no_answer:
            go = lambda control: RawResult("unknown", message="proved before the search")  # noqa: E731
        else:
            record.begin_phase("solve", round(options.time_limit, 1))
        try:
            searched = search(go, control, options.time_limit)
        except WayboundError:
            raise
        except Exception as fault:  # of the engine, before it published an answer; the start may be one
            crash = fault
            message = f"the engine failed: {in_words(fault)}"
            searched = Searched(RawResult("error", message=message), False, time.perf_counter() - control.started)
        if control.set_up is not None and control.set_up >= SLOW_SET_UP:
            run.notes.append(f"{run.name} took {control.set_up:.1f} s to set up")
        goal = bounding.goal
        if goal is not None and (goal.reached or goal.infeasible) and not searched.interrupted:
            searched = replace(searched, result=replace(searched.result, limit=goal.limit))
        try:
            solution = conclude(problem, run, searched, control, options, bounding, record, crash)
        finally:
            bounding.line.stop()
        solution.seconds["bound"] += bounding.seconds
        solution.seconds["solve"] += before
        return solution


def _limits_in_words(options: Options, budget: float) -> str:
    """The limits of a search in words."""
    asked = [f"{name.replace('_', ' ')} {value:g}" for name, value in options.asked().items()]
    parts = [f"time limit {options.time_limit:g} s", f"bound time {budget:g} s", *asked, f"seed {options.seed}"]
    return ", ".join([*parts, f"{options.threads} thread{'s' if options.threads != 1 else ''}"])
