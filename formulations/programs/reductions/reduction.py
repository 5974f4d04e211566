"""Reductions of programs, and the chain that several of them make.

Flags compose along the chain (``Exactness.then``); points, objectives, bounds and duals travel back through it, starts forth.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any, ClassVar

from ..exactness import Exactness, Link

if TYPE_CHECKING:
    from ..program import Floats, Program


class Irreducible(ValueError):
    """A program that cannot be written so; the text is the feature of it that stands in the way."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """A program written otherwise, and the way back: identities, where a reduction says nothing else.

    Parameters
    ----------
    program : Program
        What it became; for solvers that count in integers alone an ``IntegerProgram``.
    exactness : Exactness
        How its optimum relates to that of the program it was made of.
    told : str
        What was done.
    """

    name: ClassVar[str]
    program: Any
    exactness: Exactness = Exactness.EXACT
    told: str = ""

    @property
    def link(self) -> Link:
        return Link(self.name, self.exactness, self.told)

    def vector(self, x: Any) -> Floats:
        """Point of the program as it was, for a point of what it became."""
        return x  # type: ignore[no-any-return]

    def encoded(self, x: Floats) -> Floats:
        """Point of what it became, for a start of the program as it was, whose NaN stay unknown."""
        return x

    def value(self, value: float) -> float:
        """Objective of the program as it was."""
        return value

    def bound(self, bound: float) -> float:
        """Bound of the program as it was, rounded outwards."""
        return self.value(bound)

    def duals(self, duals: Floats) -> Floats:
        """Row duals of the program as it was."""
        return duals


class Reduction(ABC):
    """Writes programs otherwise.

    Class attributes
    ----------------
    may_refuse : bool
        Whether there are programs that it cannot write.
    """

    may_refuse: bool = False

    def features(self, features: frozenset[str]) -> frozenset[str]:
        """Features of the program that it makes of one with these."""
        return features

    @abstractmethod
    def apply(self, program: Program) -> tuple[Step, ...]:
        """The steps that it takes, none where there is nothing to do; raises Irreducible."""


@dataclass(frozen=True, eq=False)
class Chain:
    """A program and the steps that led to what a solver is given."""

    source: Program
    steps: tuple[Step, ...] = ()

    @property
    def program(self) -> Any:
        """Program after the last step."""
        return self.steps[-1].program if self.steps else self.source

    @cached_property
    def exactness(self) -> Exactness:
        return reduce(Exactness.then, (step.exactness for step in self.steps), Exactness.EXACT)

    @property
    def links(self) -> tuple[Link, ...]:
        return tuple(step.link for step in self.steps)

    def then(self, reductions: Iterable[Reduction]) -> Chain:
        """The chain with more steps; raises Irreducible."""
        chain = self
        for reduction in reductions:
            chain = replace(chain, steps=(*chain.steps, *reduction.apply(chain.program)))
        return chain

    def vector(self, x: Any) -> Floats:
        for step in reversed(self.steps):
            x = step.vector(x)
        return x  # type: ignore[no-any-return]

    def encoded(self, x: Floats) -> Floats:
        for step in self.steps:
            x = step.encoded(x)
        return x

    def value(self, value: float) -> float:
        for step in reversed(self.steps):
            value = step.value(value)
        return value

    def bound(self, bound: float) -> float:
        for step in reversed(self.steps):
            bound = step.bound(bound)
        return bound

    def duals(self, duals: Floats) -> Floats:
        for step in reversed(self.steps):
            duals = step.duals(duals)
        return duals
