"""What ``solve`` is given to start from, as an answer of the problem."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

from ..formulations.answers import answer_in_json, read_answer
from ..formulations.problem import Problem
from ..formulations.solution import Solution
from ..instances.errors import InputError, UsageError


def answer_to_start_from(problem: Problem, start: Any) -> tuple[Any, tuple[str, ...]]:
    """The answer that ``start`` says, and what a user should be told about the reading.

    Parameters
    ----------
    problem : Problem
    start : object or None
        A ``Solution``; an answer of the problem, or what its ``answer_of`` takes for one (routing: a list of routes, each a list of site
        indices or ids); the JSON of either, as a mapping; or the path of a solution file.

    Raises
    ------
    UsageError
        If it is none of these.
    InputError
        If the file is no solution of the problem; with file and, where there is one, line.
    """
    if start is None:
        return None, ()
    if isinstance(start, Solution) and start.answer is None:
        return None, ("the start holds no answer",)
    if isinstance(start, str | PathLike):
        read = read_answer(problem, start)
        return read.answer, tuple(f"{start}: {note}" for note in read.notes)
    try:
        if isinstance(start, Solution):
            start = start.answer if start.problem is problem else start.to_json()  # which speaks of sites by name
        if isinstance(start, Mapping):
            read = answer_in_json(problem, start)
            return read.answer, tuple(f"the start: {note}" for note in read.notes)
        return problem.answer_of(start), ()
    except (InputError, UsageError) as error:
        raise UsageError(f"the start cannot be read: {error}") from None
