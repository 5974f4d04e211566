"""``solve``: from a problem to an answer with its evidence, whichever solver does the search."""

from __future__ import annotations

import time
from dataclasses import replace
from functools import partial
from typing import Any

from ..formulations.arrays.problem import ArrayProblem
from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.programs.compiled import Compiled
from ..formulations.programs.exactness import Exactness
from ..formulations.programs.program import Program
from ..formulations.solution import Solution
from ..formulations.stop import hearing
from ..instances.errors import UsageError, WayboundError, in_words
from ..instances.limits import check_number, check_whole
from ..solvers import interrupts
from ..solvers.backend import Control, Options, RawResult
from ..solvers.linear_programs import LinearPrograms, linear_programs
from .answers import start_given
from .beside import Beside, BoundWork, free_core
from .choice import default_solver
from .concluding import conclude
from .goal import SECONDS, Goal, first_evidence
from .recording import SLOW_SET_UP, Progress, Recorder, pricing
from .runs import Run, continued, default_run, heuristic_run, solver_run
from .search import Searched, search
from .showing import Log, shown


def solve(
    problem: Problem | Compiled | Program,
    solver: str | None = None,
    *,
    heuristic: str | None = None,
    form: str | None = None,
    relax: bool = False,
    time_limit: float = 60.0,
    bound_time: float | None = None,
    iterations: int | None = None,
    gap: float = 0.0,
    seed: int = 1,
    threads: int = 1,
    start: Any = None,
    progress: Progress | None = None,
    log: Log = None,
    isolate: bool = False,
    memory_limit: float | None = None,
    no_improvement: int | None = None,
    lp_solver: str | None = None,
    options: dict[str, Any] | None = None,
    **parameters: Any,
) -> Solution:
    """Solve a problem with a solver or a heuristic, check the answer, and bound it.

    Parameters
    ----------
    problem : Problem, Compiled or Program
    solver : str, optional
        A name of ``solvers()``; ``pulp:HiGHS`` names a solver within a solver. Without solver and heuristic, the first
        installed one that can take the problem.
    heuristic : str, optional
        A name of ``heuristics()``; its parameters as keywords or in ``options``.
    form : str, optional
        For solvers that take programs; the problem's first form by default.
    relax : bool
        Drop integrality: the optimum is a bound.
    time_limit : float, seconds
        Wall time for the engine alone.
    bound_time : float, seconds, optional
        Budget for bounding after it, or beside it on a free core, and then for second opinions on what was claimed: a tenth of the limit,
        at least 1 s, by default; 0 turns it off.
    iterations, gap, seed, threads, memory_limit, no_improvement
        See ``Options``. What the solver or heuristic does not keep to is refused by name.
    start : answer, Solution, mapping or path, optional
        What to start from: an answer of the problem, or a list that says one (routing: routes as lists of site indices or ids); a
        ``Solution``; the JSON of either; a solution file.
    progress : callable, optional
        Receives ``{"phase", "seconds", "objective", "bound", "bound_kind", "found_by", "nodes"}`` from a worker thread, the best known of
        each, and the nodes of branch and bound where the solver tells them.
    log : bool, path or SearchLog, optional
        True shows a line per improvement and per few seconds, and at the end what was proved: in the cell of a notebook, else on standard
        error. A path writes it to a file. ``Solution.history`` has the figures in any case.
    lp_solver : str, optional
        Who solves the linear programs that bounds, engines and heuristics meet on their way: a name of ``solvers()``, by default HiGHS.
    isolate : bool
        Run the solver in a process of its own, with hard time and memory limits.
    options : dict, optional
        The solver's or heuristic's own options.

    Returns
    -------
    Solution
        Its answer, if any, passed every check. Ctrl-C returns the best one so far. Where a claim of the solver, or a bound, contradicts
        that answer, ``faults`` says so, and nothing that the solver claims is believed.

    Raises
    ------
    UsageError, UnsupportedError, MissingPackageError, InputError
        Before anything is run.
    CheckFailedError
        If a claim of the solver does not hold up, and there is no answer to hand over, nor a proof that there is none.
    SearchFailedError, NoAnswerError
        If the search fails, or runs out of memory, and there is no answer to hand over.
    """
    if not isinstance(problem, Problem | Compiled | Program):
        raise UsageError(f"solve takes a problem or a program, not {type(problem).__name__}; read(path) makes a problem of a file")
    check_number("time_limit", time_limit, above=0)
    check_number("gap", gap)
    check_whole("seed", seed)
    check_whole("threads", threads, least=1)
    if iterations is not None:
        check_whole("iterations", iterations, least=1)
    if no_improvement is not None:
        check_whole("no_improvement", no_improvement, least=1)
    if bound_time is not None:
        check_number("bound_time", bound_time)
    if memory_limit is not None:
        check_number("memory_limit", memory_limit, above=0)
    isolate = isolate or memory_limit is not None
    budget = max(1.0, time_limit / 10.0) if bound_time is None else bound_time
    given: Compiled | None = None
    if isinstance(problem, Program):
        problem = ArrayProblem(problem)
        given = problem.compile()
    elif isinstance(problem, Compiled):
        given, problem = problem, problem.problem
    start, told = start_given(problem, start)
    linear = linear_programs(lp_solver, seed, threads)
    chosen = Options(
        time_limit, iterations, gap, threads, seed, start, memory_limit, no_improvement, linear.solver, {**(options or {}), **parameters}
    )  # fmt: skip

    if heuristic is not None:
        if solver is not None or form is not None or relax:
            raise UsageError("a heuristic takes no solver, form or relaxation")
        run = heuristic_run(problem, heuristic, chosen, isolate)
    elif solver is None and form is None and not relax and given is None:
        run = default_run(problem, chosen, isolate)
    else:
        solver = solver or default_solver(problem, None if given is None else given.program, form, relax)
        run = solver_run(problem, given, solver, form, relax, chosen, isolate)

    run.notes.extend(told)
    listeners: list[Progress] = [] if progress is None else [progress]
    with shown(log) as written, hearing(lambda what, seconds: record.of_loops(what, seconds)):
        if written is not None:
            listeners.append(written)
            written.begin(problem, run.claimant, _limits_told(chosen, budget))
        record = Recorder(problem, listeners)
        made = _answered(problem, run, chosen, budget, linear, record, isolate)
        made = replace(made, events=record.end(made))
        if written is not None:
            written.end(made)
    return made


def _answered(
    problem: Problem, run: Run, options: Options, budget: float, linear: LinearPrograms, record: Recorder, isolate: bool
) -> Solution:
    """Search, with bounds before it and beside it where the search has none of its own, and conclude."""
    exactness = Exactness.EXACT if run.made is None else run.made.exactness
    hear = record.of_search(run.name, answers=exactness.answer_is_valid, bounds=exactness.bound_is_valid and not run.heuristic)
    control = Control(hear if run.made is not None or len(problem.senses) == 1 else lambda event: hear({**event, **priced()}))
    priced = pricing(problem, control)
    control.on_set_up = partial(record.engine_set_up, run.name)
    crash: Exception | None = None
    with interrupts.held():  # an answer that is found is judged, whatever signal comes then
        before = 0.0
        if run.opening is not None:
            run, options, before = continued(problem, run, options, isolate, record)
        began = time.perf_counter()
        first: list[Evidence] = []
        goal: Goal | None = None
        beside: Beside | None = None
        if not run.bounds and options.iterations is None:  # a clock decides when evidence is there, and work limits shall repeat to the bit
            if budget > 0:
                record.begin_phase("bound", min(SECONDS, budget))
            uncompiled: list[str] = []
            first, goal = first_evidence(problem, min(SECONDS, budget), linear, options.gap, uncompiled)
            if goal is not None and first:
                record.of_bounds(goal.told())
            control.goal = goal
            if goal is not None and goal.infeasible:
                run, budget = replace(run, go=lambda control: RawResult("unknown", message="proved before the search")), 0.0
            elif goal is not None and (budget > SECONDS or (budget > 0 and uncompiled)) and free_core(options.threads):
                beside = Beside(BoundWork(problem, budget, tuple(first), linear), goal, control, record.of_bounds)
        spent = time.perf_counter() - began
        if goal is None or not goal.infeasible:
            record.begin_phase("solve", round(options.time_limit, 1))
        try:
            searched = search(run.go, control, options.time_limit)
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
            made = conclude(problem, run, searched, control, options, budget, record, crash, first, beside)
        finally:
            if beside is not None:
                beside.stop()
        made.seconds["bound"] += spent
        made.seconds["solve"] += before
        return made


def _limits_told(options: Options, budget: float) -> str:
    """What a search was asked to keep to, for people."""
    asked = [f"{name.replace('_', ' ')} {value:g}" for name, value in options.asked().items()]
    parts = [f"time limit {options.time_limit:g} s", f"bound time {budget:g} s", *asked, f"seed {options.seed}"]
    return ", ".join([*parts, f"{options.threads} thread{'s' if options.threads != 1 else ''}"])
