"""Answers out of what outside solvers write of an exported form of a problem."""

from __future__ import annotations

from typing import Any

from ..instances.errors import InputError, WayboundError
from .problem import Problem
from .programs.solution_files import SolverFile, vector_of


def answer_of_solver(problem: Problem, read: SolverFile, form: str | None = None) -> tuple[Any, str]:
    """The answer in a solver's solution, and the form whose solution it is.

    Parameters
    ----------
    problem : Problem
    read : SolverFile
    form : str, optional
        The form that was exported; by default the first of the problem's forms that the file is a solution of.

    Raises
    ------
    InputError
        If it is a solution of none of them.
    UsageError, UnsupportedError
        For a form that does not exist or cannot write the problem down.
    """
    names = [form] if form is not None else problem.forms()
    first: WayboundError | None = None
    for name in names:
        model = problem.compile(name)
        try:
            return model.decode(vector_of(model.program, read)), name
        except WayboundError as fault:
            first = first or fault
    if first is None:
        raise InputError(f"is a solution of {read.solver}, and no form writes {problem.name} down")
    why, expected, found = (first.message, first.expected, first.found) if isinstance(first, InputError) else (str(first), None, None)
    raise InputError(
        f"is a solution of another model than {problem.name}: as of its form {names[0]} it {why}", expected=expected, found=found
    )
