"""Forms: ways to write a problem down as a program. Each registers itself in ``FORMS``."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from ..instances.errors import UnsupportedError, UsageError
from ..instances.registry import Registry
from .programs.compiled import Compiled
from .programs.exactness import Exactness
from .programs.program import INTEGERS
from .programs.size import ProgramSize


class Asked(Protocol):
    """The part of a problem that decides whether a form can write it down."""

    @property
    def family(self) -> str: ...
    @property
    def problem(self) -> str: ...

    def features(self) -> frozenset[str]: ...


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
        From the problem to its program, compiled. Its docstring is the mathematics.
    exactness : Exactness
    refuses : callable, optional
        Further reasons why it cannot take a problem, as feature names.
    size : callable, optional
        From the problem to a ``ProgramSize``, estimated without building anything: what the memory at hand does not hold is refused.
        None, the default, where nothing is known.
    makes : callable, optional
        Features of the program that it makes of a problem (see ``Program.features``); integers by default.
    order : int
        Forms of lower order come first; the first that can take a problem is its default, so this ranks by measured speed.
    """

    name: str
    family: str
    features: frozenset[str]
    build: Callable[[Any], Compiled]
    exactness: Exactness = Exactness.EXACT
    refuses: Callable[[Any], frozenset[str]] = lambda problem: frozenset()
    makes: Callable[[Any], frozenset[str]] = lambda problem: INTEGERS
    order: int = 0
    size: Callable[[Any], ProgramSize | None] = lambda problem: None

    def missing(self, problem: Asked) -> frozenset[str]:
        """Features of ``problem`` that the form lacks; empty if it can take it."""
        if problem.family != self.family:
            return frozenset({f"{problem.family} problems"})
        return (problem.features() - self.features) | self.refuses(problem)


FORMS: Registry[Form] = Registry("form", "waybound.formulations.*.forms", group="waybound.forms")


def usable_forms(problem: Asked) -> list[str]:
    """Names of the forms that can write ``problem`` down, the best one first."""
    return [form.name for form in sorted(FORMS.values(), key=lambda form: form.order) if not form.missing(problem)]


def nearest_form(problem: Asked) -> tuple[str, frozenset[str]]:
    """The form that lacks the fewest features of ``problem``, the best one of these, and what it lacks."""
    forms = sorted((form for form in FORMS.values() if form.family == problem.family), key=lambda form: form.order)
    lacking = {form.name: form.missing(problem) for form in forms}
    return min(lacking.items(), key=lambda item: len(item[1]), default=("", frozenset({f"a form for {problem.family} problems"})))


def default_form(problem: Asked) -> str:
    """The first exact form of ``problem``: others are taken where they are named, never by default.

    Raises UsageError if it has inexact forms alone. Raises UnsupportedError if it has none; names the nearest and what that one lacks.
    """
    usable = usable_forms(problem)
    exact = [name for name in usable if FORMS[name].exactness is Exactness.EXACT]
    if exact:
        return exact[0]
    if usable:
        raise UsageError(f"no form of {problem.problem} is exact; name one of {', '.join(usable)}", "missing")
    name, lacking = nearest_form(problem)
    raise UnsupportedError("no form" if name else "a program", lacking, nearest=name)


def compile_form(problem: Asked, form: str | None = None, *, relax: bool = False) -> Compiled:
    """See ``Problem.compile``."""
    chosen = FORMS[default_form(problem) if form is None else form]
    missing = chosen.missing(problem)
    if missing:
        raise UnsupportedError(f"form {form}", missing, usable_forms(problem))
    size = chosen.size(problem)
    if size is not None:
        size.refuse_beyond_memory(chosen.name)
    compiled = chosen.build(problem)
    exactness = chosen.exactness.then(compiled.exactness)
    compiled = replace(compiled, exactness=exactness, links=(replace(compiled.links[0], exactness=exactness), *compiled.links[1:]))
    return compiled.relaxed() if relax else compiled
