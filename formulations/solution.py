"""Solutions: answers with their evidence, as ``solve`` returns them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..instances.errors import UsageError
from ..instances.suggestions import did_you_mean
from . import plotting
from .certificate import Certificate, answer_lines, bound_line, gap_line, ratio_lines
from .evaluation import Evaluation
from .problem import Problem
from .programs.exactness import Link
from .rendering import Line, as_html, as_rich, as_text, number
from .search_history import Event, history_frame
from .tolerance import EQUAL, gap, same

if TYPE_CHECKING:
    from os import PathLike

    import pandas as pd

Value = float | list[float] | list[float | None]

SCHEMA = 1
"""Version of the JSON written by ``Solution.to_json``."""

_LIMIT_WORDS = {
    "time": "the time limit",
    "iterations": "the limit on iterations",
    "gap": "the gap asked for",
    "nodes": "the limit on nodes",
    "memory": "the memory limit",
    "interrupt": "an interrupt",
}


def relative_gap(objective: Value | None, bound: Value | None, sizes: Sequence[float] = (), precision: float = EQUAL) -> float | None:
    """``tolerance.gap`` at the first level of the objective that is still open; None without a bound."""
    if objective is None or bound is None:
        return None
    values = list(objective) if isinstance(objective, list) else [objective]
    bounds = list(bound) if isinstance(bound, list) else [bound]
    widest: float | None = None
    for value, limit, size in zip(values, bounds, sizes or [0.0] * len(values), strict=True):
        if value is None or limit is None:
            return None
        widest = gap(value, limit, size, precision)
        if not same(value, limit, size):
            return widest
    return widest


@dataclass(frozen=True)
class Opinion:
    """Another solver's result on a claim that has no evidence.

    ``status``: its own word. ``objective`` and ``bound``: its own claims, in the units of the program. ``verdict``: ``agrees``,
    ``undecided``, ``refutes`` (by an answer that passed every check), ``is refuted`` (by such an answer, or a verified bound), or
    ``contradicts``: nothing that was checked refutes either of the two.
    """

    solver: str
    status: str
    objective: float | None
    bound: float | None
    verdict: str


@dataclass(frozen=True, eq=False)
class Solution:
    """An answer, what is known about it, and how it came about.

    Attributes
    ----------
    problem : Problem
        The one that was solved.
    answer : object or None
        The problem's own answer, present only if it passed the check.
    status : str
        ``optimal, feasible, infeasible, unbounded, infeasible_or_unbounded, unknown, error``.
    limit : str
        ``none, time, iterations, gap, nodes, memory, interrupt``.
    objective, bound : float, list of float (objectives in order of priority) or None
        What the answer is worth, recomputed from the data, and what no answer can beat.
    bound_kind : str or None
        ``verified`` (derived again by the checker from evidence) or ``claimed`` (a search's own figure).
    bound_source : str or None
        By which method, or on whose word.
    gap : float or None
        Relative distance of objective and bound; 0 is optimal.
    solver : str
        Name of the solver or heuristic.
    form : str or None
        How the problem was written down, for solvers that take programs.
    seconds : dict
        ``compile, solve, bound, check``.
    seed : int
        The same one gives the same answer, where no time limit decides.
    versions : dict
        Of waybound, Python and the solver's package.
    certificate : Certificate
        Verified facts only.
    evaluation : Evaluation or None
        The judge's whole verdict on the answer.
    statistics : dict
        What the solver counts: nodes, iterations, ...
    message : str
        What else a user should read, such as why a search ended.
    chain : tuple of Link
        How the problem was written down and what was done to that on the way to the solver: form, reductions, each exact, a relaxation or
        a restriction.
    opinions : tuple of Opinion
        What other solvers say where the claim of an optimum, of infeasibility, or that nothing is best stands without evidence.
    faults : tuple of str
        Claims of the solver, and bounds, that contradict the answer or what is proved, and a failure of the solver beside the start. The
        answer passed every check all the same; nothing that the solver claims is believed then, and a bound that contradicts the answer is
        withheld. Empty as it should be.
    events : tuple of Event
        What was known at each moment of the search; ``history`` is a frame of them.
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
    chain: tuple[Link, ...] = ()
    opinions: tuple[Opinion, ...] = ()
    faults: tuple[str, ...] = ()
    events: tuple[Event, ...] = ()

    @property
    def history(self) -> pd.DataFrame:
        """The best answer and bound over time: one row whenever something better was found, and the checked figures as the last row.

        Columns ``seconds`` since the call of ``solve``, ``phase`` (``solve, bound, check``), ``objective`` and ``bound`` (the best known,
        by the search's own count before the last row), ``bound_kind`` (``claimed``, ``evidence``: to be checked, ``verified``), ``gap``,
        ``found_by``; of objectives in order of priority also ``objective_2``, ``bound_2``, ...
        """
        return history_frame(self.events, len(self.problem.senses))

    def to_frame(self, of: str | None = None) -> pd.DataFrame:
        """The answer as a table.

        Parameters
        ----------
        of : str, optional
            Of routing: ``visits``, one row per stop, the default; ``routes``, one row each; ``left-out``, as ``left_out()``.
        """
        self._need_answer()
        if of is None:
            return self.problem.answer_to_frame(self.answer)
        if of == "left-out":
            return self.left_out()
        frames = self.problem.answer_frames(self.answer)
        if of not in frames:
            names = (*frames, "left-out")
            raise UsageError(f"there is no table of {of!r}; choose from {', '.join(names)}{did_you_mean(of, names)}", "unknown-name")
        return frames[of]

    @property
    def routes(self) -> list[Any]:
        """The routes by ids of sites, without the depots at both ends; each knows its ``vehicle``.

        Raises
        ------
        NoAnswerError
            If there is no answer.
        UsageError
            If answers of this family have no routes.
        """
        self._need_answer()
        return self.problem.answer_routes(self.answer)

    def to_networkx(self) -> Any:
        """The answer as a networkx graph (routing: a ``MultiDiGraph`` of sites and moves)."""
        self._need_answer()
        return self.problem.answer_to_networkx(self.answer)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the answer to a file, whole or not at all, in the form that the suffix stands for.

        Parameters
        ----------
        path : path-like
            ``.json`` (all that is told of it; ``certificate.save`` writes the evidence), ``.csv`` and ``.xlsx`` (tables); of routes also
            ``.sol``, ``.tour``, ``.geojson`` and ``.vroom``. ``wb.judge(problem, path)`` reads any of them back.

        Raises
        ------
        NoAnswerError
            If there is no answer.
        UsageError, InputError
            If the suffix cannot hold the answer, or the file cannot be written.
        MissingPackageError
            If ``.xlsx`` lacks the package openpyxl.
        """
        from .answers import write_answer

        self._need_answer()
        write_answer(self, path)

    def left_out(self) -> pd.DataFrame:
        """Everything that the answer leaves out, one row each.

        Columns ``where`` (routing: the id of a site), ``reason``, and ``proved``: whether no answer can hold it, as a checker confirmed;
        all other reasons are of this answer.
        """
        import pandas as pd

        self._need_answer()
        rows = [(one.where, one.reason, one.proved) for one in self.problem.left_out(self.answer)]
        return pd.DataFrame(rows, columns=["where", "reason", "proved"])

    def plot(self, *, ax: Any = None, title: str | None = None, **options: Any) -> Any:
        """Draw the answer.

        Parameters
        ----------
        ax : matplotlib axes, optional
            New ones by default: of pyplot in a notebook or where pyplot is in use, else without any display.
        title : str, optional
            Instead of the one made.
        **options
            What else the plot of the problem's family takes.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        NoAnswerError
            If there is no answer.
        UsageError
            If answers of this family cannot be drawn.
        """
        self._need_answer()
        return plotting.draw(self, ax=ax, title=title, **options)

    def to_html(self, path: str | PathLike[str] | None = None) -> str:
        """The page of the answer: figures and facts, pictures (of routes a map that zooms), tables that sort, and the certificate.

        Without an answer it says why there is none. See ``docs/pages.md``.

        Parameters
        ----------
        path : path-like, optional
            Also write it to this file, whole or not at all.

        Returns
        -------
        str
            An HTML document that needs no network.

        Raises
        ------
        InputError
            If the file cannot be written.
        """
        return plotting.page(self, path)

    def to_folium(self) -> Any:
        """Routes on a map of streets, where sites have latitude and longitude; it loads tiles from the network when it is looked at.

        Returns
        -------
        folium.Map

        Raises
        ------
        NoAnswerError
            If there is no answer.
        UsageError
            If answers of this family have no routes, or sites no latitude and longitude.
        MissingPackageError
            Without the package folium (``pip install 'waybound[maps]'``).
        """
        self._need_answer()
        return plotting.streets(self)

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
            "chain": [{"step": link.name, "exactness": link.exactness.value, "told": link.told} for link in self.chain],
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
            "notes": list(self.problem.remarks()),
            "opinions": [asdict(opinion) for opinion in self.opinions],
            "faults": list(self.faults),
            "answer": None if self.answer is None else self.problem.answer_to_json(self.answer),
            "left_out": [] if self.answer is None else [one.to_json() for one in self.problem.left_out(self.answer)],
            "certificate": self.certificate.to_json(),
        }

    def __repr__(self) -> str:
        bound = "no bound" if self.bound is None else f"bound {self.bound} ({self.bound_kind})"
        faults = f", {len(self.faults)} faults: {'; '.join(self.faults)}" if self.faults else ""
        return f"<Solution of {self.problem.name} by {self.solver}: {self.status}, objective {self.objective}, {bound}{faults}>"

    def __str__(self) -> str:
        return as_text(solution_title(self), self._lines())

    def _repr_html_(self) -> str:
        return as_html(solution_title(self), self._lines())

    def __rich__(self) -> Any:
        return as_rich(solution_title(self), self._lines())

    def _lines(self) -> list[Line]:
        """The lines of the answer, then those of its evidence."""
        answer = [] if self.answer is None else self.problem.answer_lines(self.answer)
        return [*answer, *solution_lines(self)]


# -- for people ------------------------------------------------------------------------------------------------------------


def solution_title(solution: Solution) -> str:
    """Heading of a solution."""
    by = f"{solution.solver} ({solution.form})" if solution.form else solution.solver
    p = solution.problem
    return f"{p.name}: {p.problem}, {p.sense}, convention {p.convention}, by {by}"


def status_line(solution: Solution) -> Line:
    """How a run ended, and what that rests on: a verified bound, or a solver's claim."""
    s = solution
    stopped = "" if s.limit == "none" else f"; stopped by {_LIMIT_WORDS.get(s.limit, s.limit)}"
    if s.status == "optimal":
        precision = EQUAL if s.evaluation is None else s.evaluation.precision
        if s.bound_kind == "verified" and s.gap is not None and s.gap <= precision:
            return Line("status", "optimal: the verified bound meets the objective", "good")
        return Line("status", f"optimal according to {s.solver}{_seconded(s)}{stopped}", "good")
    if s.status == "feasible":
        return Line("status", f"feasible{stopped}")
    if s.status == "infeasible" and s.certificate.infeasible:
        return Line("status", f"infeasible, verified: {s.certificate.bound_source}", "bad")
    if s.status == "unbounded" and s.certificate.unbounded:
        return Line("status", f"unbounded, verified: {s.certificate.bound_source}", "bad")
    if s.status in ("infeasible", "unbounded", "infeasible_or_unbounded"):
        return Line("status", f"{s.status.replace('_', ' ')} according to {s.solver}{_seconded(s)}", "bad")
    return Line("status", f"no answer{stopped}" if s.status == "unknown" else f"{s.status}{stopped}", "bad")


def _seconded(solution: Solution) -> str:
    """The solvers that were asked for a second opinion and say the same; or what the others say instead."""

    def told(verdict: str) -> str:
        return ", ".join(o.solver for o in solution.opinions if o.verdict == verdict)

    agree = sum(o.verdict == "agrees" for o in solution.opinions)
    count = f" ({agree} of {len(solution.opinions)} asked agreed)" if solution.opinions else ""
    if agree:
        return f" and {told('agrees')}{count}"
    others = "; ".join(f"{names} {verdict}" for verdict in ("undecided", "is refuted") if (names := told(verdict)))
    return f" alone: {others}{count}" if others else ""


def solution_lines(solution: Solution) -> list[Line]:
    """How a run ended, what its certificate says, claimed and verified bound, and remarks on the problem."""
    s, c = solution, solution.certificate
    lines = [status_line(s), *(Line("fault", fault, "bad") for fault in s.faults), *answer_lines(c)]
    if s.bound_kind == "claimed":
        lines.append(Line("bound", f"{number(s.bound)}, claimed by {s.bound_source} (its own figure, no evidence)"))
        if c.bound is not None:
            lines.append(replace(bound_line(c), label=""))
    elif c.bound is not None:
        lines.append(bound_line(c))
    else:
        lines.append(Line("bound", "none", "quiet"))
    if s.gap is not None:
        against = f", against the {s.bound_kind} bound" if s.bound_kind else ""
        lines.append(gap_line(s.objective, s.bound, s.gap, against))
    lines += ratio_lines(c)
    lines.append(Line("seconds", ", ".join(f"{name} {spent:.2f}" for name, spent in s.seconds.items()), "quiet"))
    if s.message:
        lines.append(Line("message", s.message))
    return lines + [Line("note", note) for note in s.problem.remarks()]
