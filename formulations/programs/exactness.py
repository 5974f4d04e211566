"""Exactness of programs: how their optimum relates to that of the problem."""

from dataclasses import dataclass
from enum import Enum


class Exactness(Enum):
    """Flag of forms and reductions; flags compose with ``then`` and alone decide which bound may be shown.

    ``EXACT``
        Same optimum; answers carry over both ways.
    ``RELAXATION``
        Every answer of the problem is one of the program, at no worse value: its dual bound is a bound of the problem.
    ``RESTRICTION``
        Every point of the program is an answer of the problem: its answers count, its bound does not.
    ``NEITHER``
        A relaxation of a restriction, or the reverse: no bound, and answers only after the check.
    """

    EXACT = "exact"
    RELAXATION = "relaxation"
    RESTRICTION = "restriction"
    NEITHER = "neither"

    def then(self, other: "Exactness") -> "Exactness":
        """Flag of applying ``self`` and then ``other``."""
        if self is other or other is Exactness.EXACT:
            return self
        return other if self is Exactness.EXACT else Exactness.NEITHER

    @property
    def bound_is_valid(self) -> bool:
        """True if a dual bound of the program bounds the problem."""
        return self in (Exactness.EXACT, Exactness.RELAXATION)

    @property
    def infeasibility_is_valid(self) -> bool:
        """True if an infeasible program proves the problem infeasible."""
        return self.bound_is_valid

    @property
    def answer_is_valid(self) -> bool:
        """True if a feasible point of the program is promised to be an answer of the problem."""
        return self in (Exactness.EXACT, Exactness.RESTRICTION)


@dataclass(frozen=True)
class Link:
    """One step of the chain from the problem to the program that a solver was given.

    Parameters
    ----------
    name : str
        Of the form or reduction.
    exactness : Exactness
    told : str
        What it did, where there is something to tell.
    """

    name: str
    exactness: Exactness = Exactness.EXACT
    told: str = ""

    def __str__(self) -> str:
        return f"{self.name} ({self.exactness.value}){': ' if self.told else ''}{self.told}"
