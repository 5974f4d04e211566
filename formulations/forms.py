"""Forms: ways to write a problem down as a program. One module a form; it registers itself in ``FORMS``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from ..instances.errors import UnsupportedError, UsageError
from ..instances.registry import Registry
from .problem import Problem
from .programs.exactness import Exactness
from .programs.program import Program


@dataclass(frozen=True)
class Form:
    """A form and what it can express.

    Parameters
    ----------
    name : str
        Used with ``--form``.
    family : str
        Family of the problems it takes.
    features : frozenset of str
        Features of the problem that it can express.
    build : callable
        From the problem to its program. Its docstring is the mathematics.
    exactness : Exactness
    refuses : callable, optional
        Further reasons why it cannot take a problem, as feature names.
    kind : callable, optional
        Kind of the program that it makes of a problem (``LP, MILP, QP, MIQP``).
    order : int
        Forms of lower order come first; the first that can take a problem is its default, so this ranks by measured speed.
    """

    name: str
    family: str
    features: frozenset[str]
    build: Callable[[Any], Program]
    exactness: Exactness = Exactness.EXACT
    refuses: Callable[[Any], frozenset[str]] = lambda problem: frozenset()
    kind: Callable[[Any], str] = lambda problem: "MILP"
    order: int = 0

    def missing(self, problem: Problem) -> frozenset[str]:
        """Features of ``problem`` that the form lacks; empty if it can take it."""
        if problem.family != self.family:
            return frozenset({f"{problem.family} problems"})
        return (problem.features() - self.features) | self.refuses(problem)


FORMS: Registry[Form] = Registry("form", "waybound.formulations.*.forms")


def nearest_form(problem: Problem) -> tuple[str, frozenset[str]]:
    """The form that lacks the fewest features of ``problem``, the best one of these, and what it lacks."""
    forms = sorted((form for form in FORMS.values() if form.family == problem.family), key=lambda form: form.order)
    lacking = {form.name: form.missing(problem) for form in forms}
    return min(lacking.items(), key=lambda item: len(item[1]), default=("", frozenset({f"a form for {problem.family} problems"})))


def no_form(problem: Problem) -> UnsupportedError:
    """What to raise where no form can take ``problem``."""
    name, lacking = nearest_form(problem)
    return UnsupportedError("no form", lacking, nearest=name)


def compile_form(problem: Problem, form: str | None = None, *, relax: bool = False) -> Program:
    """See ``Problem.compile``."""
    usable = problem.forms()
    if form is None:
        if not usable:
            raise no_form(problem)
        form = usable[0]
    chosen = FORMS[form]
    missing = chosen.missing(problem)
    if missing:
        raise UnsupportedError(f"form {form}", missing, usable)
    program = chosen.build(problem)
    return relaxed(program) if relax else program


def relaxed(program: Program) -> Program:
    """The program without integrality: a relaxation."""
    if program.quadratic is not None or program.cones:
        raise UsageError(f"form {program.form} is not linear; only linear programs are relaxed")
    return replace(
        program,
        variables=tuple(replace(b, integer=False) for b in program.variables),
        exactness=program.exactness.then(Exactness.RELAXATION),
    )
