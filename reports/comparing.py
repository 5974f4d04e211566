"""``compare``: one problem by several solvers and heuristics, every answer checked, against the best bound that any of them led to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..formulations.certificate import beats_bound
from ..formulations.problem import Problem
from ..heuristics.heuristic import HEURISTICS
from ..instances.errors import UsageError, WayboundError, in_words
from ..solvers import interrupts
from ..solvers.backend import BACKENDS
from ..solving.search_log import SearchLog
from ..solving.showing import Log, shown
from ..solving.solve import solve
from .comparison import Compared, Comparison

Methods = Sequence[str] | Mapping[str, Mapping[str, Any]]

CLAIMED = 1e-5
"""Relative difference up to which a search's bound agrees with an answer: solvers count no closer."""


def compare(
    problem: Problem,
    methods: Methods,
    *,
    time_limit: float = 60.0,
    log: Log = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    **common: Any,
) -> Comparison:
    """Solve one problem by several methods, one after the other, each with the same limits.

    Parameters
    ----------
    problem : Problem
    methods : sequence of str, or mapping
        Names of solvers and heuristics (``"pyvrp"``, ``"pulp:HiGHS"``, ``"savings"``). A mapping has a name of one's own for each and
        keywords for ``solve``: ``{"h = 3": {"heuristic": "local", "h": 3}}``.
    time_limit : float, seconds
        Of each search.
    log : bool, path or SearchLog, optional
        As for ``solve``: the logs of all runs, one after the other.
    progress : callable, optional
        As for ``solve``.
    **common
        Further keywords for ``solve``, the same for all: ``bound_time, seed, threads, gap, start, isolate, ...``

    Returns
    -------
    Comparison
        A method that fails or cannot take the problem is a row that says why. Ctrl-C ends the run that is under way and leaves out the
        rest.

    Raises
    ------
    UsageError
        For a name that is none, before anything is run.
    """
    asked = _asked(methods)
    runs: list[Compared] = []
    with shown(log) as written:
        for name, own in asked.items():
            if runs and (interrupts.received or _interrupted(runs[-1])):
                runs.append(Compared(name, None, "not run: interrupted"))
                continue
            runs.append(_run(problem, name, {"time_limit": time_limit, **common, **own}, written, progress))
    return Comparison(problem, tuple(runs), tuple(_contradictions(problem, runs)))


def _asked(methods: Methods) -> dict[str, dict[str, Any]]:
    """Keywords for ``solve`` by the name of each row."""
    if isinstance(methods, str):
        raise UsageError(f"compare takes a list of names, not {methods!r}: [{methods!r}, ...]")
    if isinstance(methods, Mapping):
        made = {str(name): dict(own) for name, own in methods.items()}
    else:
        made = {}
        for name in methods:
            if name in made:
                raise UsageError(f"{name} is to be compared with itself; a mapping gives runs of one method names of their own")
            made[name] = _method(name)
    for own in made.values():
        if own.get("solver") is not None:
            _ = BACKENDS[str(own["solver"]).partition(":")[0]]
        if own.get("heuristic") is not None:
            _ = HEURISTICS[own["heuristic"]]
    if not made:
        raise UsageError("there is nothing to compare: name some solvers and heuristics")
    return made


def _method(name: str) -> dict[str, Any]:
    if name in HEURISTICS:
        return {"heuristic": name}
    if name.partition(":")[0] in BACKENDS:
        return {"solver": name}
    raise UsageError(f"no solver and no heuristic is named {name!r}; there are {', '.join([*BACKENDS, *HEURISTICS])}")


def _run(problem: Problem, name: str, keywords: dict[str, Any], log: SearchLog | None, progress: Any) -> Compared:
    try:
        return Compared(name, solve(problem, log=log, progress=progress, **keywords))
    except WayboundError as fault:
        return Compared(name, None, str(fault))
    except Exception as fault:  # of whatever package: it costs this row, and no other
        return Compared(name, None, in_words(fault))


def _interrupted(run: Compared) -> bool:
    return run.solution is not None and run.solution.limit == "interrupt"


def _contradictions(problem: Problem, runs: Sequence[Compared]) -> list[str]:
    """Where the claims or verified bounds of one run contradict checked answers of the others."""
    found = []
    for one in runs:
        for other in runs:
            s, t = one.solution, other.solution
            if s is None or t is None or t.evaluation is None or one is other:
                continue
            value, size = t.evaluation.values[0], t.evaluation.size
            told = f"{other.name} has an answer of value {value!r}, which passed every check"
            if s.certificate.infeasible:
                found.append(
                    f"{told}; {s.certificate.bound_source} proves that there is none: one of the two checks is wrong, please report this"
                )
            elif s.status in ("infeasible", "infeasible_or_unbounded") and s.evaluation is None:
                found.append(f"{one.name} says {s.status.replace('_', ' ')}, but {told}")
            bound = s.bound[0] if isinstance(s.bound, list) else s.bound
            for kind, limit in (("verified", s.certificate.bound), ("claimed", bound if s.bound_kind == "claimed" else None)):
                if limit is not None and beats_bound(problem.sense, value, limit, size) and not t.evaluation.same_at(0, limit, CLAIMED):
                    found.append(f"the {kind} bound {limit!r} of {one.name} is refuted: {told}")
    return found
