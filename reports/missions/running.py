"""``run``: play a mission with any solver, heuristic or policy, and log it."""

import contextlib
import math
import signal
import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from time import perf_counter
from types import FrameType
from typing import TYPE_CHECKING, Any

import numpy as np

from ...formulations.problem import Problem
from ...formulations.solution import Solution, relative_gap
from ...heuristics.heuristic import HEURISTICS
from ...instances.errors import UnsupportedError, UsageError
from ...instances.suggestions import did_you_mean
from ...instances.worlds import World
from ...solvers import interrupts
from ...solvers.backend import BACKENDS, STATUSES
from ...solving.request import Request
from ...solving.solve import solve
from .mission import MISSIONS, Decision, Mission

if TYPE_CHECKING:
    import pandas as pd

Row = dict[str, Any]
Watch = Callable[[World, Row], None]

COLUMNS = ("problems", "objective", "bound", "bound_kind", "gap", "guarantee", "seconds", "status", "limit")
"""Columns of a log about the solving of each step, beside ``step``, the world's metrics and the mission's measures."""


def run(
    mission: str | Mission,
    *,
    solver: str | None = None,
    heuristic: str | None = None,
    policy: str | None = None,
    steps: int | None = None,
    seed: int = 1,
    time_limit: float = 60.0,
    bound_time: float = 0.0,
    options: dict[str, Any] | None = None,
    watch: Watch | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    **settings: Any,
) -> "pd.DataFrame":
    """Play a mission: observe, decide, act, step by step.

    Parameters
    ----------
    mission : str or Mission
        A name of ``MISSIONS``, or a mission of one's own.
    solver, heuristic, policy : str, optional
        What decides: a name for ``solve``, or a rule of the mission's own. Without any, the first installed solver that can take
        the mission's problems.
    steps : int, >= 1, optional
        By default until the world is over, and no more than the mission lasts: ``Mission.lasting``.
    seed : int
        The same seed gives the same world, whatever decides in it; and the same log (``seconds`` apart) if the solver is repeatable.
    time_limit, bound_time : float, seconds
        For each problem, as in ``solve``; no time is spent on bounds by default.
    options : dict, optional
        The solver's or heuristic's own.
    watch : callable, optional
        ``watch(world, row)`` is called at the start (with an empty row) and after each step.
    progress : callable, optional
        Receives ``{"phase", "seconds", "objective"}`` after each step.
    **settings
        The mission's own.

    Returns
    -------
    pandas.DataFrame
        One row per step: ``step``; the world's metrics after it; for what was solved in it ``problems`` (their number), ``objective``
        and ``bound`` (of all teams together), ``bound_kind``, ``gap``, ``guarantee`` (the worst stated ratio, if all have one),
        ``seconds`` (wall time of all solving, or of the policy), ``status`` (the worst; ``none`` without a problem) and ``limit``; and,
        but for policies, the mission's measures. ``attrs`` tells the mission, what decided, seed, settings, ``limit``: ``interrupt`` if
        Ctrl-C ended the run, which keeps the steps so far; and ``faults``: claims and bounds that contradict a verified answer, by step.

    Raises
    ------
    UsageError, UnsupportedError, MissingPackageError
        For a name, setting or combination that does not exist.
    CheckFailedError
        If a claim of the solver does not hold up, and there is no answer to go on with.
    """
    import pandas as pd

    played = MISSIONS[mission]() if isinstance(mission, str) else mission
    if not isinstance(played, Mission):
        raise UsageError(f"run takes a mission or its name, not {type(mission).__name__}", "malformed")
    deciders = {"solver": solver, "heuristic": heuristic, "policy": policy}
    most = played.lasting if steps is None else steps
    rules = played.policies()
    _check_asked(played.name, most, seed, options or {}, rules, **deciders)
    seeds = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, 2])))
    faults: list[str] = []

    def decide(problem: Problem) -> Solution:
        try:
            seed = int(seeds.random() * 2**31)
            request = Request(
                solver=solver, heuristic=heuristic, time_limit=time_limit, bound_time=bound_time, seed=seed, options=options or {}
            )
            solution = solve(problem, request)
        except UnsupportedError as fault:
            fault.args = (_with_policies(str(fault), played.name, rules, heuristic or solver),)
            raise
        faults.extend(f"step {len(rows) + 1}: {fault}" for fault in solution.faults)
        return solution

    world = played.world(int(seed), **settings)
    rows: list[Row] = []
    limit = "none"
    if watch is not None:
        watch(world, {})
    with _interrupts() as interrupted:
        try:
            while len(rows) < most and not (steps is None and world.over) and not interrupted():
                row = _step(played, world, None if policy is None else rules[policy], decide)
                rows.append(row)
                if watch is not None:
                    watch(world, row)
                if progress is not None:
                    phase = f"step {len(rows)} of {'at most ' * (steps is None)}{most}"
                    progress({"phase": phase, "seconds": row["seconds"], "objective": row["objective"]})
        except KeyboardInterrupt:
            pass
        if interrupted() and len(rows) < most:
            limit = "interrupt"
    frame = pd.DataFrame(rows, columns=None if rows else ["step", *world.metrics(), *COLUMNS])
    frame.attrs.update(mission=played.name, **deciders, seed=int(seed), settings=dict(settings), limit=limit, faults=faults)
    return frame


def _check_asked(
    mission: str, steps: Any, seed: Any, options: dict[str, Any], rules: Collection[str], *, solver: str | None, heuristic: str | None,
    policy: str | None,
) -> None:  # fmt: skip
    """Refuse what cannot be played before it begins: there may be no problem to solve for many steps."""
    if sum(name is not None for name in (solver, heuristic, policy)) > 1:
        raise UsageError("give one of solver, heuristic and policy, not several")
    for name, value, least in (("steps", steps, 1), ("seed", seed, 0)):
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            raise UsageError(f"{name} must be a whole number of at least {least}, not {value!r}", "out-of-range")
    if solver is not None:
        _ = BACKENDS[solver.partition(":")[0]]
    if heuristic is not None:
        HEURISTICS[heuristic].check_parameters(options)
    if policy is not None and policy not in rules:
        hint = did_you_mean(policy, rules)
        raise UsageError(f"{mission} has no policy {policy!r}; choose from {', '.join(rules) or 'none'}{hint}", "unknown-name")
    if policy is not None and options:
        raise UsageError(f"policy {policy} takes no options")


def _with_policies(fault: str, mission: str, rules: Collection[str], asked: str | None) -> str:
    """The error and the policies of the mission, which somebody may have taken for heuristics."""
    meant = f"; {asked} is a policy: --policy {asked}" if asked in rules else ""
    return fault + (meant or f"; policies of {mission}: {', '.join(rules)}" if rules else "")


def _step(mission: Mission, world: World, rule: Callable[[Any], Any] | None, decide: Callable[[Problem], Solution]) -> Row:
    """Play one step, and return its row of the log."""
    observation = world.observe()
    decisions: list[Decision] = []
    actions: dict[int, Any] = {}
    begun = perf_counter()
    if rule is not None:
        actions.update(rule(observation))
    else:
        for view in mission.teams(observation):
            problem = mission.problem(view)
            decision = Decision(view, problem, None if problem is None else decide(problem))
            decisions.append(decision)
            actions.update(mission.actions(view, problem, decision.answer))
    ruled = {} if rule is None else {"seconds": perf_counter() - begun}
    world.step(actions)
    measures = {} if rule is not None else mission.measures(decisions, world)
    solutions = [d.solution for d in decisions if d.solution is not None]
    return {"step": world.time, **world.metrics(), **_solving_columns(mission, solutions), **ruled, **measures}


def _solving_columns(mission: Mission, solutions: Sequence[Solution]) -> Row:
    """Columns of the log about the solving of one step, all teams together."""
    objective = _together(mission, [_first(s.objective) for s in solutions])
    bound = _together(mission, [_first(s.bound) for s in solutions])
    stated = [s.certificate.guarantee for s in solutions]
    ratios = [g.ratio for g in stated if g is not None]
    gap = relative_gap(objective, bound)
    limits = [s.limit for s in solutions if s.limit != "none"]
    return {
        "problems": len(solutions),
        "objective": math.nan if objective is None else objective,
        "bound": math.nan if bound is None else bound,
        "bound_kind": None if bound is None else "verified" if all(s.bound_kind == "verified" for s in solutions) else "claimed",
        "gap": math.nan if gap is None else gap,
        "guarantee": max(ratios) if solutions and len(ratios) == len(solutions) else math.nan,
        "seconds": math.fsum(second for s in solutions for second in s.seconds.values()),
        "status": max((s.status for s in solutions), key=STATUSES.index, default="none"),
        "limit": limits[0] if limits else "none",
    }  # fmt: skip


def _together(mission: Mission, values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return mission.total(known) if known and len(known) == len(values) else None


def _first(value: Any) -> float | None:
    """The first level of an objective in order of priority."""
    first = value[0] if isinstance(value, list) else value
    return None if first is None else float(first)


@contextlib.contextmanager
def _interrupts() -> Iterator[Callable[[], bool]]:
    """Tells whether Ctrl-C was pressed, even where ``solve`` took it for the end of its own search alone."""
    seen: list[int] = []

    def interrupted() -> bool:
        return bool(seen or interrupts.received)

    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield interrupted
        return

    def note(number: int, frame: FrameType | None) -> None:
        seen.append(number)
        before(number, frame)

    signal.signal(signal.SIGINT, note)
    try:
        yield interrupted
    finally:
        signal.signal(signal.SIGINT, before)
