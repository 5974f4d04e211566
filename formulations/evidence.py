"""Evidence for a bound: data that a checker can verify without a solver."""

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from ..instances.errors import InputError
from ..instances.registry import Registry


@dataclass(frozen=True)
class Evidence:
    """A bound and what proves it.

    Parameters
    ----------
    kind : str
        Which checker reads it: a name in ``CHECKERS``.
    source : str
        Where it comes from, for people: "LP relaxation of two-index-time-flow".
    value : float
        The bound it is meant to prove, on the first level of the objective; infinite where it proves that there is no answer
        (``inf`` for ``min``, ``-inf`` for ``max``), or answers as good as one wants (the other way round). The checker derives its own.
    data : dict
        Plain JSON values.
    """

    kind: str
    source: str
    value: float
    data: dict[str, Any]

    def to_json(self) -> dict[str, Any]:
        value = self.value if math.isfinite(self.value) else str(self.value)  # "inf": JSON has no infinity
        return {"kind": self.kind, "source": self.source, "value": value, "data": self.data}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> "Evidence":
        return cls(str(data["kind"]), str(data["source"]), float(data["value"]), dict(data["data"]))


class EvidenceChecker(Protocol):
    """Derives the bound that ``data`` proves for ``problem``, from the problem's data alone.

    Returns the bound on the first level of the objective: minus infinity for ``min`` where nothing is proved, infinity where it is
    proved that there is no answer (the signs change places for ``max``). Raises InputError where ``data`` is not of the expected
    shape. The bound must hold for any ``data``, however wrong, and for every answer that ``problem.evaluate`` accepts.
    """

    def __call__(self, problem: Any, data: Mapping[str, Any]) -> float: ...


CHECKERS: Registry[EvidenceChecker] = Registry(
    "kind of evidence", "waybound.formulations.checking", "waybound.formulations.*.checking", group="waybound.checkers"
)


def checker(kind: str, family: str, subject: str, of: str = "", needs: str = "") -> Callable[[EvidenceChecker], EvidenceChecker]:
    """Register the checker of one family's evidence, which refuses problems without the attribute ``needs``, and those of other families:
    ``subject`` ("prices of bins are") evidence for ``of``, by default problems of the family."""

    def register(check: EvidenceChecker) -> EvidenceChecker:
        @functools.wraps(check)
        def checked(problem: Any, data: Mapping[str, Any]) -> float:
            if problem.family != family or (needs and getattr(problem, needs, None) is None):
                raise InputError(f"{subject} evidence for {of or f'{family} problems'}", "foreign", found=problem.problem)
            return check(problem, data)

        return CHECKERS.add(kind, checked)

    return register


ENDLESS: Registry[Callable[[Any, Mapping[str, Any]], bool]] = Registry(
    "kind of evidence", "waybound.formulations.*.checking", group="waybound.endless"
)
"""Checkers of evidence that answers are as good as one wants: from problem and data to whether that is proved. It bounds nothing."""


@dataclass(frozen=True)
class LeftOut:
    """A thing that an answer leaves out, with the reason.

    ``where`` is its name, ``reason`` is in the problem's words; ``proved`` says whether no answer can hold it, as a checker confirmed; else
    the reason is one of this answer.
    """

    where: str
    reason: str
    proved: bool

    def to_json(self) -> dict[str, Any]:
        return {"where": self.where, "reason": self.reason, "proved": self.proved}


@dataclass(frozen=True)
class Reason:
    """Why a problem has no answer, or one part of it.

    Parameters
    ----------
    kind : str
        What is to blame: ``site``, ``fleet``, ``row`` (of a form), or another word of the problem's.
    where : str
        Its name.
    message : str
        One line in the problem's words.
    evidence : Evidence, optional
        Proves by itself that there is no answer, as its checker confirmed; None for rows.
    """

    kind: str
    where: str
    message: str
    evidence: Evidence | None = None

    @property
    def name(self) -> str:
        """Kind and name, or one word where they are the same."""
        return self.kind if self.where == self.kind else f"{self.kind} {self.where}"

    def to_json(self) -> dict[str, Any]:
        evidence = None if self.evidence is None else self.evidence.to_json()
        return {"kind": self.kind, "where": self.where, "message": self.message, "evidence": evidence}


@dataclass(frozen=True)
class Guarantee:
    """A stated approximation ratio.

    Parameters
    ----------
    ratio : float
        >= 1: worse over better.
    statement : str
        The ratio in the paper's form.
    assumptions : tuple of str
        What was checked on the instance for it to hold.
    source : str
        Paper and theorem.
    """

    ratio: float
    statement: str
    assumptions: tuple[str, ...]
    source: str

    def to_json(self) -> dict[str, Any]:
        return {"ratio": self.ratio, "statement": self.statement, "assumptions": list(self.assumptions), "source": self.source}
