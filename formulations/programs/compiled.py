"""A problem written down as a program, with the way back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from ...instances.errors import UsageError
from .exactness import Exactness
from .program import Floats, Program

if TYPE_CHECKING:
    from ..evidence import Evidence
    from ..problem import Problem


@dataclass(frozen=True, eq=False)
class Compiled:
    """A program, what it was made of, and what connects the two.

    Parameters
    ----------
    program : Program
        Arrays and nothing else; its name is that of the form.
    problem : Problem
        What it was compiled from.
    decode : callable
        From a vector of shape (variables,) to the problem's answer. Raises InputError where the vector stands for none.
    encode : callable, optional
        From an answer to a vector (warm starts). Raises InputError for an answer that is no point of the program.
    dual_evidence : callable, optional
        From row duals (d objective / d right side) of the linear relaxation to evidence that the checker can multiply out.
    exactness : Exactness
        How the program's optimum relates to that of the problem.
    """

    program: Program
    problem: Problem
    decode: Callable[[Floats], Any]
    encode: Callable[[Any], Floats] | None = None
    dual_evidence: Callable[[Floats], Evidence] | None = None
    exactness: Exactness = Exactness.EXACT

    @property
    def form(self) -> str:
        """Name of the form that made it."""
        return self.program.name

    def relaxed(self) -> Compiled:
        """The same without integrality: a relaxation.

        Raises
        ------
        UsageError
            If the program is not linear.
        """
        p = self.program
        if p.quadratic is not None or p.cones:
            raise UsageError(f"form {self.form} is not linear; only linear programs are relaxed")
        continuous = replace(p, variables=tuple(replace(b, integer=False) for b in p.variables))
        return replace(self, program=continuous, exactness=self.exactness.then(Exactness.RELAXATION))

    def write(self, path: str | PathLike[str]) -> None:
        """See ``Program.write``."""
        self.program.write(path)

    def to_highs(self) -> Any:
        """See ``Program.to_highs``."""
        return self.program.to_highs()

    def to_pulp(self) -> Any:
        """See ``Program.to_pulp``."""
        return self.program.to_pulp()

    def to_cvxpy(self) -> Any:
        """See ``Program.to_cvxpy``."""
        return self.program.to_cvxpy()

    def to_mathopt(self) -> Any:
        """See ``Program.to_mathopt``."""
        return self.program.to_mathopt()

    def __repr__(self) -> str:
        return f"<Compiled {self.problem.name}, {self.exactness.value}: {self.program!r}>"
