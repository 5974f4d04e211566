"""What every problem can do, whatever its family."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

from ..instances.registry import Registry
from .evaluation import Evaluation

if TYPE_CHECKING:
    import pandas as pd

    from ..instances.instance import Instance
    from .evidence import Evidence
    from .programs.program import Program


class Problem(ABC):
    """Data, constraints and objective. A problem knows no solver, and can judge any answer.

    Attributes
    ----------
    family : str
        Class of answers and forms: ``routing``, later ``sensing``, ``risk``, ``auction``.
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
    @abstractmethod
    def convention(self) -> str: ...

    @abstractmethod
    def digest(self) -> str:
        """Hash of all data that an answer's value and feasibility depend on."""

    @abstractmethod
    def features(self) -> frozenset[str]:
        """What a solver must be able to express, in the problem's words."""

    @abstractmethod
    def evaluate(self, answer: Any) -> Evaluation:
        """Recompute objective and violations of ``answer`` from the data alone."""

    def concession(self, evidence: Evidence, evaluation: Evaluation) -> float:
        """By how much an answer may pass the bound that ``evidence`` proves: what the residuals of its checks are worth.

        0 wherever the checker of the evidence widens all limits, or the judge prices answers within them.
        """
        return 0.0

    @abstractmethod
    def answer_to_json(self, answer: Any) -> dict[str, Any]:
        """The answer with the file's own ids."""

    @abstractmethod
    def answer_from_json(self, data: Any) -> Any:
        """Inverse of ``answer_to_json``; raises InputError for anything else."""

    def answer_of(self, given: Any) -> Any:
        """The answer that ``given`` stands for: one already, or what says clearly which one; raises UsageError for anything else."""
        return given

    @abstractmethod
    def answer_to_frame(self, answer: Any) -> pd.DataFrame:
        """The answer as a table."""

    def forms(self) -> list[str]:
        """Names of the forms that can write this problem down, the best one first."""
        from .forms import FORMS

        return [form.name for form in sorted(FORMS.values(), key=lambda form: form.order) if not form.missing(self)]

    def compile(self, form: str | None = None, *, relax: bool = False) -> Program:
        """Write the problem down as arrays.

        Parameters
        ----------
        form : str, optional
            A name of ``forms()``; the first of them by default.
        relax : bool
            Drop integrality.

        Raises
        ------
        UnsupportedError
            If the form lacks a feature of the problem.
        """
        from .forms import compile_form

        return compile_form(self, form, relax=relax)


def problem_from_instance(instance: Instance, problem: str | None = None, **settings: Any) -> Problem:
    """The problem ``problem`` (by default the one the instance stands for) of an instance.

    Keyword arguments are the settings of ``--set`` and ``convention``.
    """
    name = problem or instance.problem
    return PROBLEMS[name](instance, name, settings)


PROBLEMS: Registry[Callable[[Any, str, dict[str, Any]], Problem]] = Registry("problem", "waybound.formulations.*")
