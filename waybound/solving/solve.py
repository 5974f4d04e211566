"""``solve``: from a problem to an answer with its evidence, whichever method does the search."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial

from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.solution import Solution
from ..formulations.stop import hearing
from ..instances.errors import WayboundError, in_words
from ..solvers import interrupts
from ..solvers.backend import Control, Options, RawResult
from ..solvers.linear_programs import LinearPrograms
from .bounding import FIRST_SECONDS, Beside, BoundWork, Goal, first_evidence, free_core
from .concluding import conclude
from .method import Run, continued, requested_run
from .recording import SLOW_SET_UP, Progress, Recorder, pricing
from .request import Request
from .search import Searched, search
from .search_log import Log, shown


def solve(problem: Problem | Compiled, request: Request | None = None, *, progress: Progress | None = None, log: Log = None) -> Solution:
    """Solve a problem as it is asked for, check the answer, and bound it; ``waybound.solve`` documents what may be asked.

    Raises UsageError, UnsupportedError, MissingPackageError, InputError before anything is run; CheckFailedError, SearchFailedError,
    NoAnswerError if there is no answer to hand over.
    """
    request = request or Request()
    given, problem = (problem, problem.problem) if isinstance(problem, Compiled) else (None, problem)
    options, budget = request.search_options(), request.bound_budget
    run = requested_run(problem, given, request, options)
    run.notes.extend(request.notes)
    listeners: list[Progress] = [] if progress is None else [progress]
    with shown(log) as written, hearing(lambda what, seconds: record.of_loops(what, seconds)):
        if written is not None:
            listeners.append(written)
            written.begin(repr(problem).strip("<>"), problem.remarks(), run.claimant, _limits_in_words(options, budget))
        record = Recorder(problem.senses, listeners)
        solution = _answered(problem, run, options, budget, request.linear, record, request.isolated)
        solution = replace(solution, events=record.end(solution))
        if written is not None:
            written.end(solution)
    return solution


def _answered(
    problem: Problem, run: Run, options: Options, budget: float, linear: LinearPrograms, record: Recorder, isolate: bool
) -> Solution:
    """Search, with bounds before it and beside it where the search has none of its own, and conclude."""
    exactness = run.exactness
    hear = record.of_search(run.name, answers=exactness.answer_is_valid, bounds=exactness.bound_is_valid and not run.heuristic)
    control = Control(hear) if run.compiled is not None or len(problem.senses) == 1 else pricing(problem, hear)
    control.on_set_up = partial(record.engine_set_up, run.name)
    crash: Exception | None = None
    with interrupts.held():  # an answer that is found is judged, whatever signal comes then
        before = 0.0
        if run.opening is not None:
            run, options, before = continued(problem, run, options, isolate, record)
        go, began = run.go, time.perf_counter()
        first: list[Evidence] = []
        goal: Goal | None = None
        beside: Beside | None = None
        if not run.bounds and options.iterations is None:  # a clock decides when evidence is there, and work limits shall repeat to the bit
            if budget > 0:
                record.begin_phase("bound", min(FIRST_SECONDS, budget))
            uncompiled: list[str] = []
            first, goal = first_evidence(problem, min(FIRST_SECONDS, budget), linear, options.gap, uncompiled)
            if goal is not None and first:
                record.of_bounds(goal.told())
            control.goal = goal
            if goal is not None and goal.infeasible:
                go, budget = (lambda control: RawResult("unknown", message="proved before the search")), 0.0
            elif goal is not None and (budget > FIRST_SECONDS or (budget > 0 and uncompiled)) and free_core(options.threads):
                work = BoundWork(problem, budget, tuple(first), linear)
                beside = Beside(work, goal, control, record.of_bounds, competing=not run.heuristic)
        spent = time.perf_counter() - began
        if goal is None or not goal.infeasible:
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
        if goal is not None and (goal.reached or goal.infeasible) and not searched.interrupted:
            searched = replace(searched, result=replace(searched.result, limit=goal.limit))
        try:
            solution = conclude(problem, run, searched, control, options, budget, record, crash, first, beside)
        finally:
            if beside is not None:
                beside.line.stop()
        solution.seconds["bound"] += spent
        solution.seconds["solve"] += before
        return solution


def _limits_in_words(options: Options, budget: float) -> str:
    """The limits of a search in words."""
    asked = [f"{name.replace('_', ' ')} {value:g}" for name, value in options.asked().items()]
    parts = [f"time limit {options.time_limit:g} s", f"bound time {budget:g} s", *asked, f"seed {options.seed}"]
    return ", ".join([*parts, f"{options.threads} thread{'s' if options.threads != 1 else ''}"])
