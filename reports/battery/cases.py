"""The cases of the battery: one program each, with what is true of it."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ...formulations.forms import FORMS
from ...formulations.problem import Problem
from ...formulations.programs.exactness import Exactness
from ...formulations.programs.program import Program
from ...instances.errors import UsageError
from ...instances.suggestions import did_you_mean
from .kinds import KINDS
from .truth import Truth, truth

FEW = 8
"""Problems of a kind that are looked at to tell whether a form can express any."""


@dataclass(frozen=True)
class Draw:
    """A choice of cases: the k-th of a seed is the same in every draw of the same kind and form.

    Without a kind or form, kinds take turns, and forms within each.
    """

    count: int
    seed: int = 1
    kind: str | None = None
    form: str | None = None

    def __post_init__(self) -> None:
        if self.kind is not None and self.kind not in KINDS:
            hint = did_you_mean(self.kind, KINDS)
            raise UsageError(f"the battery has no kind {self.kind!r}; it has {', '.join(KINDS)}{hint}", "unknown-name")
        if self.form is not None and FORMS[self.form] and not self.kinds:
            raise UsageError(f"no program of the battery has the form {self.form}" + (f" and the kind {self.kind}" if self.kind else ""))

    @property
    def kinds(self) -> list[str]:
        """Names of the kinds that take turns."""
        chosen = list(KINDS) if self.kind is None else [self.kind]
        return chosen if self.form is None else [k for k in chosen if any(self.form in _forms(_drawn(k, turn)) for turn in range(FEW))]


@dataclass(frozen=True)
class Case:
    """One program, and what is true of it."""

    number: int
    kind: str
    form: str
    problem: Problem
    program: Program
    truth: Truth


def cases(draw: Draw, numbers: range | None = None) -> Iterator[Case]:
    """The cases of a draw, or those of the given numbers."""
    kinds = draw.kinds
    for number in numbers or range(draw.count):
        turn, which = divmod(number, len(kinds))
        # A kind may hold problems that a form cannot express.
        tries = (_drawn(kinds[which], draw.seed, turn, again) for again in itertools.count())
        problem = next(p for p in tries if draw.form is None or draw.form in _forms(p))
        able = _forms(problem)
        form = draw.form or able[turn % len(able)]
        yield Case(number, kinds[which], form, problem, problem.compile(form).program, truth(problem))


def _drawn(kind: str, *seed: int) -> Problem:
    return KINDS[kind](np.random.default_rng([*seed, *kind.encode()]))


def _forms(problem: Problem) -> list[str]:
    """Names of exact forms, in which the problem itself is asked, and no more or less."""
    return [name for name in problem.forms() if FORMS[name].exactness is Exactness.EXACT]
