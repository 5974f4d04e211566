"""The base class of all problems."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from ..instances.errors import InputError, UsageError
from ..instances.instance import settings_of
from ..instances.registry import Registry
from ..instances.suggestions import did_you_mean
from ..instances.text import shown
from . import plotting
from .evaluation import Evaluation
from .evidence import Evidence, LeftOut, Reason
from .forms import compile_form, usable_forms
from .rendering import Line, as_html, as_rich

if TYPE_CHECKING:
    from os import PathLike

    import pandas as pd

    from ..instances.instance import Instance
    from .programs.compiled import Compiled
    from .rendering import Line

Decision = tuple[Any, bool]
"""A statement about an answer, in the problem's words, and whether it holds."""


class Problem(ABC):
    """Data, constraints and objective. A problem knows no solver, and can judge any answer.

    Attributes
    ----------
    family : str
        Class of answers, forms, plots and tables: ``routing``, ``max-min``, ``selection``, ``arrays``, or one of another package.
    answer_suffixes : tuple of str
        Of solution files that are no JSON.
    name : str
        Of the instance.
    problem : str
        Name used with ``--problem``.
    convention : str
        Distance convention, or ``exact`` where there are no distances.
    notes : tuple of str
        What a user should be told about the reading of the file.
    """

    family: ClassVar[str]
    answer_suffixes: ClassVar[tuple[str, ...]] = ()
    name: str
    problem: str
    notes: tuple[str, ...]

    @property
    @abstractmethod
    def senses(self) -> tuple[str, ...]:
        """``min`` or ``max`` for each level of the objective."""

    @property
    def sense(self) -> str:
        """Sense of the first level."""
        return self.senses[0]

    @property
    def convention(self) -> str:
        return "exact"

    @abstractmethod
    def digest(self) -> str:
        """Hash of all data that an answer's value and feasibility depend on."""

    def digest_later(self) -> Callable[[], str] | str:
        """The digest, or a function that computes it when it is asked for, where the data are large and cannot change meanwhile."""
        return self.digest()

    @abstractmethod
    def features(self) -> frozenset[str]:
        """Features that a solver must be able to express."""

    @abstractmethod
    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute objective and violations of ``answer`` from the data alone."""

    def concession(self, evidence: Evidence, evaluation: Evaluation) -> float:
        """Amount by which an answer may pass the bound that ``evidence`` proves, because its checks hold only up to their residuals.

        0 wherever the checker of the evidence widens all limits, or the judge prices answers within them.
        """
        return 0.0

    def facts(self) -> dict[str, Any]:
        """Facts about the data for ``waybound info``, as plain JSON values by name.

        ``objective``, a text, is shown beside the sense.
        """
        return {}

    def remarks(self) -> tuple[str, ...]:
        """Lines that every solution shows: the notes, and which parts of the data count for nothing."""
        return tuple(self.notes)

    def _repr_html_(self) -> str:
        description = plotting.tell(self)
        return as_html(description.title, [Line(*row) for row in description.rows])

    def __rich__(self) -> Any:
        description = plotting.tell(self)
        return as_rich(description.title, [Line(*row) for row in description.rows])

    @property
    def size(self) -> int:
        """How many things an answer decides on: sites, robots, elements, variables; 0 if it is not known."""
        return 0

    def linear_entries(self) -> int:
        """About the least number of coefficients of a linear form of the problem, for callers with a budget; 0 if it is not known."""
        return 0

    def infeasibility_reasons(self, stopped: Callable[[], bool] = lambda: False) -> Iterator[Reason]:
        """Reasons from the data alone why there is no answer, each with evidence that its checker confirmed.

        Parameters
        ----------
        stopped : callable
            Asked now and then whether to give up.
        """
        return iter(())

    def answer_at_hand(self) -> Any | None:
        """An answer that needs no search, where there may be one: what refutes a solver that claims there is none. It is judged first."""
        return None

    def left_out(self, answer: Any) -> Sequence[LeftOut]:
        """Optional things that ``answer`` leaves out, each with the reason."""
        return ()

    def check_statement(self, statement: Any) -> None:
        """Raise InputError unless ``statement``, plain JSON, is one that is true or false of each answer."""
        raise InputError(f"nothing can be stated of answers to {self.problem} problems", "unsupported", found=shown(str(statement)))

    def restricted(self, decisions: Sequence[Decision]) -> Problem:
        """The same problem, restricted to the answers for which each statement holds, or does not hold, as decided.

        What it allows besides weakens bounds, and breaks none. It shares the data of this one, and is made in little time.

        Raises
        ------
        InputError
            For a malformed statement, and in families that know none.
        """
        for statement, _ in decisions:
            self.check_statement(statement)
        return self

    def given(self, values: Sequence[float]) -> Problem | None:
        """The problem of the levels of priority after the first ``len(values)``; None in families without such problems.

        Its answers include all answers of this one that are no worse than ``values`` at the levels before, so that what bounds its first
        level bounds those.
        """
        return None

    def in_words(self, statement: Any, holds: bool) -> str:
        """A statement, or its opposite, as a sentence."""
        return f"{statement} {'holds' if holds else 'does not hold'}"

    def why_none(self, kind: str, data: Mapping[str, Any]) -> str:
        """A proof that there is no answer, in words; empty where the family has none for it."""
        return ""

    @abstractmethod
    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        """The answer with the file's own ids."""

    @abstractmethod
    def answer_from_json(self, data: Any) -> Any:
        """Inverse of ``answer_to_json``; raises InputError for anything else."""

    def answer_of(self, given: Any) -> Any:
        """The answer that ``given`` is or clearly describes; raises UsageError for anything else."""
        return given

    def check_start(self, answer: Any) -> None:
        """Raise UsageError if ``answer`` names things that this problem does not have, so that it belongs to another instance."""
        return

    def searched_from(self, answer: Any) -> Any:
        """``answer`` as a search starts from it: its decisions alone, without a stated timetable and the like."""
        return answer

    @abstractmethod
    def answer_to_frame(self, answer: Any) -> pd.DataFrame:
        """The answer as a table."""

    def answer_frames(self, answer: Any) -> dict[str, pd.DataFrame]:
        """All tables of an answer by name; ``answer`` is that of ``answer_to_frame``, unless the family has another name for it."""
        return {"answer": self.answer_to_frame(answer)}

    def answer_lines(self, answer: Any) -> list[Line]:
        """An answer in a few lines, for printing; none where a table shows it all."""
        return []

    def answer_routes(self, answer: Any) -> list[Any]:
        """The routes of an answer by the ids of sites; raises UsageError in families without routes."""
        raise UsageError(f"answers to {self.problem} problems have no routes; to_frame() tells what they have", "unsupported")

    def answer_to_networkx(self, answer: Any) -> Any:
        """An answer as a networkx graph; raises UsageError in families that have none."""
        raise UsageError(f"answers to {self.problem} problems are no graphs; to_frame() tells what they are", "unsupported")

    def to_instance(self) -> Instance:
        """The data of this problem as an instance that files can hold, and of which ``read`` makes the same problem.

        Raises
        ------
        UsageError
            If there is no file for what the problem holds.
        """
        raise UsageError(f"{type(self).__name__} problems have no file format, so that {self.name} cannot be saved", "unsupported")

    def save(self, path: str | PathLike[str], format: str | None = None) -> None:  # noqa: A002
        """Write the problem to a file, whole or not at all; ``wb.read(path)`` makes the same problem of it.

        Parameters
        ----------
        path : path-like
            ``.json`` holds everything; other suffixes (docs/formats.md) what their format has a place for.
        format : str, optional
            Name of the format, where the suffix does not say it.

        Raises
        ------
        UsageError
            For a suffix that is unknown, and for what the format cannot express, by name.
        InputError
            If the file cannot be written.
        """
        from ..instances.writing import write_instance

        write_instance(self.to_instance(), path, format)

    def check_answer_suffix(self, suffix: str) -> None:
        """Raise UsageError unless solution files of ``suffix`` can hold an answer to this problem."""
        known = (".json", *self.answer_suffixes, *(s for s in (".csv", ".xlsx") if s not in self.answer_suffixes))
        if suffix not in known:
            raise UsageError(
                f"answers to {self.problem} problems are written as {', '.join(known)}, not under the suffix {suffix!r}", "unknown-name"
            )

    def answer_from_frame(self, frame: pd.DataFrame) -> Any:
        """The answer in a table as ``answer_to_frame`` makes it; raises UsageError in families that do not read it back."""
        able = " or ".join((".json", *self.answer_suffixes))
        raise UsageError(f"answers to {self.problem} problems are not read from such tables; use {able}", "unsupported")

    def foreign_answer(self, data: Mapping[str, Any]) -> Any | None:
        """The answer in a JSON document of another tool, None where it is no such document; raises InputError where it is broken."""
        return None

    def answer_to_text(self, answer: Any, suffix: str, objective: float | None = None) -> str:
        """Text of a solution file of ``suffix``, one of ``answer_suffixes``; ``objective`` is for formats that state it."""
        raise NotImplementedError(f"{type(self).__name__} does not say how {suffix} files are written")

    def answer_from_text(self, text: str) -> tuple[Any, float | None]:
        """The answer in a solution file that is no JSON, and the objective that it states.

        Raises
        ------
        InputError
            For anything else, with the line.
        UsageError
            If the format cannot express answers to this problem.
        """
        found = shown(text.strip().split("\n")[0])
        raise InputError(f"is no solution file of {self.problem} problems", line=1, expected="JSON", found=found)

    def forms(self) -> list[str]:
        """Names of the forms that can write this problem down, the best one first."""
        return usable_forms(self)

    def compile(self, form: str | None = None, *, relax: bool = False) -> Compiled:
        """Write the problem down as arrays.

        Parameters
        ----------
        form : str, optional
            A name of ``forms()``; by default the first of them that is exact.
        relax : bool
            Drop integrality.

        Raises
        ------
        UnsupportedError
            If the form lacks a feature of the problem.
        """
        return compile_form(self, form, relax=relax)


def refuse_settings(name: str, settings: Mapping[str, Any], known: tuple[str, ...] = ()) -> None:
    """Raise UsageError for a setting that a problem without distances does not have; ``convention`` may be ``exact`` everywhere."""
    for key, value in settings.items():
        if key == "convention":
            if value not in (None, "exact"):
                raise UsageError(
                    f"{name} problems have no distances to round: the convention can only be exact, not {value!r}", "unsupported"
                )
        elif key not in known:
            takes = ", ".join(known) + did_you_mean(key, known) if known else "none"
            raise UsageError(f"{name} has no setting {key!r}; it takes {takes}", "unknown-name")


def problem_from_instance(instance: Instance, problem: str | None = None, **settings: Any) -> Problem:
    """The problem ``problem`` (by default the one the instance stands for) of an instance.

    Keyword arguments are the settings of ``--set`` and ``convention``.
    """
    name = problem or instance.problem
    kept = settings_of(instance) if name == instance.problem else {}
    return PROBLEMS[name](instance, name, {**kept, **settings})


PROBLEMS: Registry[Callable[[Any, str, dict[str, Any]], Problem]] = Registry(
    "problem", "waybound.formulations.*", group="waybound.problems"
)
