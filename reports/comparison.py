"""``compare``: one problem by several methods, every answer checked, against the best verified bound of all runs."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ..formulations.problem import Problem
from ..formulations.rendering import as_html, as_text
from ..formulations.solution import Solution
from ..formulations.tolerance import EQUAL, gap, same
from ..formulations.verified_bounds import beats_bound, better_bound
from ..instances.errors import UsageError, WayboundError, in_words
from ..instances.printable import one_line
from ..instances.suggestions import did_you_mean

if TYPE_CHECKING:
    import pandas as pd

    from ..solving.search_log import Log, SearchLog


@dataclass(frozen=True)
class Compared:
    """One method's solution, or the error with which it ended."""

    name: str
    solution: Solution | None
    error: str = ""

    @property
    def objective(self) -> float | None:
        """Value of the first level of a checked answer."""
        evaluation = None if self.solution is None else self.solution.evaluation
        return None if evaluation is None else evaluation.values[0]

    @property
    def verified(self) -> float | None:
        """Verified bound of the first level from this run."""
        return None if self.solution is None else self.solution.certificate.bound

    @property
    def seconds(self) -> float | None:
        """Wall time of the search alone."""
        return None if self.solution is None else self.solution.seconds["solve"]

    @property
    def remark(self) -> str:
        """The error or faults of the run, or its claimed bound."""
        s = self.solution
        if s is None:
            return one_line(self.error)
        parts = [one_line(fault) for fault in s.faults]
        if s.bound_kind == "claimed" and isinstance(s.bound, float):
            parts.append(f"claims the bound {s.bound:.10g}")
        return "; ".join(parts)

    @property
    def status(self) -> str:
        """How the run ended, and on whose word."""
        s = self.solution
        if s is None:
            return "error"
        if s.status == "optimal":
            proved = s.bound_kind == "verified" and s.gap is not None and s.gap <= EQUAL
            return "optimal, verified" if proved else "optimal, by its own word"
        if s.status == "feasible":
            return "feasible" if s.limit == "none" else f"feasible, stopped by {s.limit}"
        if s.certificate.infeasible or s.certificate.unbounded:
            return f"{s.status}, verified"
        known = s.status in ("infeasible", "unbounded", "infeasible_or_unbounded")
        return f"{s.status.replace('_', ' ')}, by its own word" if known else "no answer"


@dataclass(frozen=True, eq=False)
class Comparison:
    """One problem, solved by several methods; one row each in the order asked for.

    Attributes
    ----------
    problem : Problem
        The one that all methods got.
    runs : tuple of Compared
        A name, a ``Solution`` or why there is none, and the seconds, a method.
    faults : tuple of str
        Where what one method claims, or what was verified for it, contradicts a checked answer of another. Empty as it should be.
    """

    problem: Problem
    runs: tuple[Compared, ...]
    faults: tuple[str, ...] = field(default=())

    @property
    def bound(self) -> float | None:
        """The best verified bound of the first level from any run: it holds for all of them."""
        return None if self._bounded_by is None else self._bounded_by.verified

    @property
    def bound_source(self) -> str | None:
        """The proof of that bound, and the run it comes from."""
        by = self._bounded_by
        return None if by is None or by.solution is None else f"{by.solution.certificate.bound_source}, from the run of {by.name}"

    @property
    def best(self) -> Solution | None:
        """The best checked answer; of equal ones the first."""
        best: Solution | None = None
        for run in self.runs:
            s = run.solution
            if s is not None and s.evaluation is not None and (best is None or _ahead(self.problem, s, best)):
                best = s
        return best

    @property
    def infeasible(self) -> bool:
        """Whether it is proved that there is no answer."""
        return any(run.solution is not None and run.solution.certificate.infeasible for run in self.runs)

    @property
    def _bounded_by(self) -> Compared | None:
        best: Compared | None = None
        for run in self.runs:
            known = None if best is None else best.verified
            if run.verified is not None and (known is None or better_bound(self.problem.sense, run.verified, known)):
                best = run
        return best

    def bounds(self, values: Sequence[float]) -> list[float]:
        """The best verified bound of each level for answers of these values.

        Bounds of further levels hold where the levels before are closed, by runs whose answers were worth as much there.
        """
        bounds: list[float] = []
        for level, sense in enumerate(self.problem.senses):
            known = [self.bound] if level == 0 else [self._level_bound(run, level, values) for run in self.runs]
            at_level = [bound for bound in known if bound is not None]
            if not at_level:
                break
            bounds.append(max(at_level) if sense == "min" else min(at_level))
            if not same(values[level], bounds[-1]):
                break
        return bounds

    @staticmethod
    def _level_bound(run: Compared, level: int, values: Sequence[float]) -> float | None:
        levels = () if run.solution is None else run.solution.certificate.levels
        if level > len(levels) or not all(same(a, b) for a, b in zip(levels[level - 1].given, values, strict=False)):
            return None
        return levels[level - 1].bound

    def gap(self, run: Compared) -> float | None:
        """Gap of a run's answer to the best verified bound of all, at the first level that is open; None without either."""
        evaluation = None if run.solution is None else run.solution.evaluation
        bounds = [] if evaluation is None else self.bounds(evaluation.values)
        if evaluation is None or not bounds:
            return None
        level = len(bounds) - 1
        if same(evaluation.values[level], bounds[-1]) and len(bounds) < len(evaluation.values):
            return None
        return gap(evaluation.values[level], bounds[-1], evaluation.sizes[level] if evaluation.sizes else 0.0, evaluation.precision)

    def to_frame(self) -> pd.DataFrame:
        """One row per method.

        Columns ``method, objective`` (of the first level, checked), ``verified_bound`` (that its own run led to), ``gap`` (to the best
        verified bound of all runs), ``seconds`` (search alone), ``status``, ``remark``.
        """
        import pandas as pd

        rows = [(r.name, r.objective, r.verified, self.gap(r), r.seconds, r.status, r.remark) for r in self.runs]
        names = ["method", "objective", "verified_bound", "gap", "seconds", "status", "remark"]
        return pd.DataFrame(rows, columns=names).astype(dict.fromkeys(names[1:5], float))

    def plot(self, *, ax: Any = None, title: str | None = None) -> Any:
        """Progress of all runs over time, on matplotlib axes; see ``plot_history``."""
        from .plots.history import plot_history

        return plot_history(self, ax=ax, title=title)

    def to_json(self) -> dict[str, Any]:
        """Plain data: a row each, and the solutions as in ``Solution.to_json``."""
        return {
            "schema": 1, "instance": self.problem.name, "problem": self.problem.problem, "sense": self.problem.sense, "bound": self.bound,
            "bound_source": self.bound_source, "faults": list(self.faults),
            "runs": [
                {
                    "method": r.name, "objective": r.objective, "verified_bound": r.verified, "gap": self.gap(r), "seconds": r.seconds,
                    "status": r.status, "remark": r.remark, "solution": None if r.solution is None else r.solution.to_json(),
                } for r in self.runs
            ],
        }  # fmt: skip

    def __len__(self) -> int:
        return len(self.runs)

    def __getitem__(self, name: str) -> Solution | None:
        """The solution by the method of this name, None where it ended with an error."""
        for run in self.runs:
            if run.name == name:
                return run.solution
        raise UsageError(f"nothing was compared under the name {name!r}; there are {', '.join(r.name for r in self.runs)}", "unknown-name")

    def __repr__(self) -> str:
        return f"<Comparison of {', '.join(r.name for r in self.runs)} on {self.problem.name}>"

    def __str__(self) -> str:
        from .tables.comparison import comparison_lines, comparison_table
        from .tables.table import table_plain

        return table_plain(comparison_table(self)) + "\n" + as_text("", comparison_lines(self)).lstrip("\n")

    def _repr_html_(self) -> str:
        from .tables.comparison import comparison_lines, comparison_table
        from .tables.table import table_html

        return table_html(comparison_table(self)) + as_html("", comparison_lines(self))


def _ahead(problem: Problem, a: Solution, b: Solution) -> bool:
    """Whether the checked answer of ``a`` is better, level by level."""
    assert a.evaluation is not None and b.evaluation is not None
    for level, sense in enumerate(problem.senses):
        if not a.evaluation.same_at(level, b.evaluation.values[level]):
            return better_bound(sense, b.evaluation.values[level], a.evaluation.values[level])
    return False


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
        The one that all methods get.
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
    from ..solvers import interrupts
    from ..solving.search_log import shown

    names = _asked(methods)
    runs: list[Compared] = []
    with shown(log) as written:
        for name, own in names.items():
            last = runs[-1].solution if runs else None
            if runs and (interrupts.received or (last is not None and last.limit == "interrupt")):
                runs.append(Compared(name, None, "not run: interrupted"))
                continue
            runs.append(_run(problem, name, {"time_limit": time_limit, **common, **own}, written, progress))
    return Comparison(problem, tuple(runs), tuple(_contradictions(problem, runs)))


def _asked(methods: Methods) -> dict[str, dict[str, Any]]:
    """Keywords for ``solve`` by the name of each row."""
    from ..heuristics.heuristic import HEURISTICS
    from ..solvers.backend import BACKENDS

    if isinstance(methods, str):
        raise UsageError(f"compare takes a list of names, not {methods!r}: [{methods!r}, ...]", "malformed")
    if isinstance(methods, Mapping):
        keywords = {str(name): dict(own) for name, own in methods.items()}
    else:
        keywords = {}
        for name in methods:
            if name in keywords:
                raise UsageError(
                    f"{name} is to be compared with itself; a mapping gives runs of one method names of their own", "duplicate"
                )
            if name not in HEURISTICS and name.partition(":")[0] not in BACKENDS:
                known = [*BACKENDS, *HEURISTICS]
                there = f"there are {', '.join(known)}{did_you_mean(name, known)}"
                raise UsageError(f"no solver and no heuristic is named {name!r}; {there}", "unknown-name")
            keywords[name] = {"heuristic" if name in HEURISTICS else "solver": name}
    for own in keywords.values():
        if own.get("solver") is not None:
            _ = BACKENDS[str(own["solver"]).partition(":")[0]]
        if own.get("heuristic") is not None:
            _ = HEURISTICS[own["heuristic"]]
    if not keywords:
        raise UsageError("there is nothing to compare: name some solvers and heuristics", "missing")
    return keywords


def _run(problem: Problem, name: str, keywords: dict[str, Any], log: SearchLog | None, progress: Any) -> Compared:
    from ..solving.request import request_of, searchable
    from ..solving.solve import solve

    try:
        if {"log", "progress"} & keywords.keys():
            raise UsageError("log and progress are those of compare, for all runs")
        target = searchable(problem)
        return Compared(name, solve(target, request_of(target, **keywords), log=log, progress=progress))
    except WayboundError as fault:
        return Compared(name, None, str(fault))
    except Exception as fault:  # of whatever package: it costs this row, and no other
        return Compared(name, None, in_words(fault))


def _contradictions(problem: Problem, runs: Sequence[Compared]) -> list[str]:
    """Claims or verified bounds of one run that contradict checked answers of others."""
    faults = []
    for one, other in itertools.permutations(runs, 2):
        s, t = one.solution, other.solution
        if s is None or t is None or t.evaluation is None:
            continue
        value, size = t.evaluation.values[0], t.evaluation.size
        answered = f"{other.name} has an answer of value {value!r}, which passed every check"
        if s.certificate.infeasible:
            proof = f"{s.certificate.bound_source} proves that there is none"
            faults.append(f"{answered}; {proof}: one of the two checks is wrong, please report this")
        elif s.status in ("infeasible", "infeasible_or_unbounded") and s.evaluation is None:
            faults.append(f"{one.name} says {s.status.replace('_', ' ')}, but {answered}")
        bound = s.bound[0] if isinstance(s.bound, list) else s.bound
        for kind, limit in (("verified", s.certificate.bound), ("claimed", bound if s.bound_kind == "claimed" else None)):
            if limit is not None and beats_bound(problem.sense, value, limit, size) and not t.evaluation.same_at(0, limit, CLAIMED):
                faults.append(f"the {kind} bound {limit!r} of {one.name} is refuted: {answered}")
    return faults
