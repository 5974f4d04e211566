"""Reductions of programs, and chains of them.

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
    """A program that a reduction cannot rewrite; the text names the feature that stands in the way."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Step:
    """A rewritten program, and the way back: identities, where a reduction says nothing else.

    Parameters
    ----------
    program : Program
        The rewritten program; for solvers that count in integers alone an ``IntegerProgram``.
    exactness : Exactness
        How its optimum relates to that of the program before.
    told : str
        Description of the rewriting.
    """

    name: ClassVar[str]
    program: Any
    exactness: Exactness = Exactness.EXACT
    told: str = ""

    @property
    def link(self) -> Link:
        return Link(self.name, self.exactness, self.told)

    def vector(self, x: Any) -> Floats:
        """Point of the program before, for a point of the rewritten one."""
        return x  # type: ignore[no-any-return]

    def encoded(self, x: Floats) -> Floats:
        """Point of the rewritten program, for a start of the one before; NaN stay unknown."""
        return x

    def value(self, value: float) -> float:
        """Objective of the program before."""
        return value

    def bound(self, bound: float) -> float:
        """Bound of the program before, rounded outwards."""
        return self.value(bound)

    def duals(self, duals: Floats) -> Floats:
        """Row duals of the program before."""
        return duals


class Reduction(ABC):
    """Rewrites programs.

    Class attributes
    ----------------
    may_refuse : bool
        Whether there are programs that it cannot rewrite.
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
    """A program and the steps that led from it to the one that a solver is given."""

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
