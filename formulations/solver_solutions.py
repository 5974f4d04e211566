"""Answers out of what outside solvers write of an exported form of a problem."""

from typing import Any

from ..instances.errors import InputError, WayboundError
from .problem import Problem
from .programs.solution_files import SolverFile, vector_of


def answer_of_solver(problem: Problem, read: SolverFile, form: str | None = None) -> tuple[Any, str]:
    """The answer in a solver's solution, and the form whose solution it is.

    ``form``: the form that was exported; by default the first of the problem's forms that the file is a solution of. Raises InputError if
    it is a solution of none of them. Raises UsageError for a form that does not exist, and UnsupportedError for one
    that cannot write the problem down.
    """
    other: tuple[str, WayboundError] | None = None
    broken: tuple[str, WayboundError] | None = None
    for name in [form] if form is not None else problem.forms():
        model = problem.compile(name)
        try:
            x = vector_of(model.program, read)
        except WayboundError as fault:
            other = other or (f"another model than {problem.name}: as of its form {name} it ", fault)
            continue
        try:
            return model.decode(x), name
        except WayboundError as fault:
            broken = broken or (f"its form {name}, and no answer to {problem.name}: ", fault)
    told = broken or other
    if told is None:
        raise InputError(f"is a solution of {read.solver}, and no form writes {problem.name} down", "unsupported")
    start, worst = told
    why, expected, found = (worst.message, worst.expected, worst.found) if isinstance(worst, InputError) else (str(worst), None, None)
    raise InputError(f"is a solution of {start}{why}", worst.code if broken else "foreign", expected=expected, found=found)
