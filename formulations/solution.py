"""What ``solve`` returns: an answer with its evidence."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from .certificate import Certificate
from .evaluation import Evaluation
from .problem import Problem
from .tolerance import EQUAL, gap, same

if TYPE_CHECKING:
    import pandas as pd

Value = float | list[float] | list[float | None]

SCHEMA = 1
"""Version of the JSON written by ``Solution.to_json``."""

PLOTTERS: dict[str, Callable[..., Any]] = {}
"""Plot functions by problem family; filled by the floor above."""


def relative_gap(objective: Value | None, bound: Value | None, sizes: Sequence[float] = (), precision: float = EQUAL) -> float | None:
    """``tolerance.gap`` at the first level of the objective that is still open; None without a bound."""
    if objective is None or bound is None:
        return None
    values = list(objective) if isinstance(objective, list) else [objective]
    bounds = list(bound) if isinstance(bound, list) else [bound]
    found: float | None = None
    for value, limit, size in zip(values, bounds, sizes or [0.0] * len(values), strict=True):
        if value is None or limit is None:
            return None
        found = gap(value, limit, size, precision)
        if not same(value, limit, size):
            return found
    return found


@dataclass(frozen=True, eq=False)
class Solution:
    """An answer, what is known about it, and how it came about.

    Attributes
    ----------
    problem : Problem
    answer : object or None
        The problem's own answer, present only if it passed the check.
    status : str
        ``optimal, feasible, infeasible, unbounded, infeasible_or_unbounded, unknown, error``.
    limit : str
        ``none, time, iterations, gap, nodes, memory, interrupt``.
    objective, bound : float, list of float (objectives in order of priority) or None
    bound_kind : str or None
        ``verified`` (derived again by the checker from evidence) or ``claimed`` (a search's own figure).
    bound_source : str or None
    gap : float or None
    solver : str
    form : str or None
    seconds : dict
        ``compile, solve, bound, check``.
    seed : int
    versions : dict
    certificate : Certificate
        Verified facts only.
    statistics : dict
    message : str
    faults : tuple of str
        Claims of the solver, and bounds, that contradict the answer. It passed every check all the same; nothing that the solver claims
        is believed then, and a bound that contradicts it is withheld. Empty as it should be.
    """

    problem: Problem
    answer: Any
    status: str
    limit: str
    objective: Value | None
    bound: Value | None
    bound_kind: str | None
    bound_source: str | None
    gap: float | None
    solver: str
    form: str | None
    seconds: dict[str, float]
    seed: int
    versions: dict[str, str]
    certificate: Certificate
    evaluation: Evaluation | None = None
    statistics: dict[str, Any] = field(default_factory=dict)
    message: str = ""
    faults: tuple[str, ...] = ()

    def to_frame(self) -> pd.DataFrame:
        """The answer as a table (routing: one row a visit)."""
        self._need_answer()
        return self.problem.answer_to_frame(self.answer)

    def plot(self, **options: Any) -> Any:
        """Draw the answer; returns matplotlib axes."""
        self._need_answer()
        if self.problem.family not in PLOTTERS:
            import importlib

            importlib.import_module("waybound.reports.plots.routing")  # the floor above registers its plotters on import
        return PLOTTERS[self.problem.family](self.problem, self.answer, **{"solution": self, **options})

    def _need_answer(self) -> None:
        from ..instances.errors import NoAnswerError

        if self.answer is None:
            raise NoAnswerError(f"{self.solver} found no answer to {self.problem.name}: status {self.status}")

    def to_json(self) -> Mapping[str, Any]:
        """The keys that others may rely on, with a schema version."""
        return {
            "schema": SCHEMA,
            "instance": self.problem.name,
            "instance_hash": self.certificate.instance_hash or None,
            "problem": self.problem.problem,
            "sense": self.problem.sense,
            "convention": self.problem.convention,
            "solver": self.solver,
            "form": self.form,
            "status": self.status,
            "limit": self.limit,
            "objective": self.objective,
            "bound": self.bound,
            "bound_kind": self.bound_kind,
            "bound_source": self.bound_source,
            "gap": self.gap,
            "seconds": self.seconds,
            "seed": self.seed,
            "versions": self.versions,
            "statistics": self.statistics,
            "message": self.message,
            "faults": list(self.faults),
            "answer": None if self.answer is None else self.problem.answer_to_json(self.answer),
            "certificate": self.certificate.to_json(),
        }

    def __repr__(self) -> str:
        bound = "no bound" if self.bound is None else f"bound {self.bound} ({self.bound_kind})"
        faults = f", {len(self.faults)} faults: {'; '.join(self.faults)}" if self.faults else ""
        return f"<Solution of {self.problem.name} by {self.solver}: {self.status}, objective {self.objective}, {bound}{faults}>"

    def __str__(self) -> str:
        from .rendering import as_text, solution_lines, solution_title

        return as_text(solution_title(self), solution_lines(self))

    def _repr_html_(self) -> str:
        from .rendering import as_html, solution_lines, solution_title

        return as_html(solution_title(self), solution_lines(self))

    def __rich__(self) -> Any:
        from .rendering import as_rich, solution_lines, solution_title

        return as_rich(solution_title(self), solution_lines(self))
