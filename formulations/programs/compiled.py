"""A problem written down as a program, with the way back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike
from typing import TYPE_CHECKING, Any

from ...instances.errors import InputError, UsageError
from ..evaluation import input_errors
from .exactness import Exactness, Link
from .program import Floats, Program
from .reductions.continuous_relaxation import CONTINUOUS_RELAXATION
from .reductions.reduction import Irreducible

if TYPE_CHECKING:
    from ..evidence import Evidence
    from ..problem import Decision, Problem


@dataclass(frozen=True, eq=False)
class Compiled:
    """A program, the problem that it was made of, and the ways between the two.

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
        From row duals (d objective / d right side) of the linear relaxation to evidence that the checker can multiply out. Where there
        is ``at_most`` it takes a second argument: the problem restricted by decisions (``Problem.restricted``) whose duals they are.
    exactness : Exactness
        How the program's optimum relates to that of the problem.
    links : tuple of Link
        The form, and what was done to its program since.
    ray_evidence : callable, optional
        From a ray of the rows that proves the linear relaxation infeasible, of either sign, to evidence that there is no answer.
    at_most : callable, optional
        From an integer column and a whole number to the decision that says of an answer what ``column <= number`` says of its vector.
    """

    program: Program
    problem: Problem
    decode: Callable[[Floats], Any]
    encode: Callable[[Any], Floats] | None = None
    dual_evidence: Callable[..., Evidence] | None = None
    exactness: Exactness = Exactness.EXACT
    links: tuple[Link, ...] = ()
    ray_evidence: Callable[[Floats], Evidence] | None = None
    at_most: Callable[[int, int], Decision] | None = None

    def __post_init__(self) -> None:
        if not self.links:
            object.__setattr__(self, "links", (Link(self.program.name, self.exactness),))

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
        try:
            (step,) = CONTINUOUS_RELAXATION.apply(self.program)
        except Irreducible as fault:
            raise UsageError(str(fault), "unsupported") from None
        exactness, links = self.exactness.then(step.exactness), (*self.links, step.link)
        return replace(self, program=step.program, exactness=exactness, links=links)

    def start(self, answer: Any, notes: list[str]) -> Floats | None:
        """The vector of an answer that a search is to start from; None, with a line in ``notes``, if it is no point of the program."""
        try:
            with input_errors(self.problem.problem):
                return None if answer is None or self.encode is None else self.encode(answer)
        except InputError as fault:
            notes.append(f"the start was not used: {fault}")
            return None

    def write(self, path: str | PathLike[str]) -> None:
        """See ``Program.write``."""
        self.program.write(path)

    def answer(self, solution: Any) -> Any:
        """The problem's answer that a solver found of this model; the problem judges it (``wb.judge``).

        Parameters
        ----------
        solution : path, mapping, array or model
            A solver's solution file (HiGHS, SCIP, CBC, GLPK, Gurobi, MathOpt); values by name, names as exported; the vector of shape
            (variables,); or what ``to_highs``, ``to_pulp`` or ``to_cvxpy`` made, solved, a model of PySCIPOpt, or MathOpt's result.

        Raises
        ------
        InputError
            If it holds no solution, or one of another model.
        """
        from .solved_models import vector_from

        return self.decode(vector_from(self.program, solution))

    def to_highs(self, *, names: bool = True) -> Any:
        """See ``Program.to_highs``."""
        return self.program.to_highs(names=names)

    def to_pulp(self, *, names: bool = True) -> Any:
        """See ``Program.to_pulp``."""
        return self.program.to_pulp(names=names)

    def to_cvxpy(self) -> Any:
        """See ``Program.to_cvxpy``."""
        return self.program.to_cvxpy()

    def to_mathopt(self, *, names: bool = True) -> Any:
        """See ``Program.to_mathopt``."""
        return self.program.to_mathopt(names=names)

    def __repr__(self) -> str:
        return f"<Compiled {self.problem.name}, {self.exactness.value}: {self.program!r}>"
