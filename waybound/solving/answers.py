"""Answers as users give them, to start from or to be checked."""

from collections.abc import Mapping
from os import PathLike
from typing import Any

import numpy as np

from ..formulations.answers import answer_in_json, read_answer
from ..formulations.evaluation import Evaluation, input_errors
from ..formulations.problem import Problem
from ..formulations.programs.solved_models import solved_model
from ..formulations.solution import Solution
from ..formulations.solver_solutions import answer_of_solver
from ..instances.errors import InputError, UsageError


def answer_given(problem: Problem, given: Any, called: str, form: str | None = None) -> tuple[Any, tuple[str, ...]]:
    """Read ``given`` as an answer of ``problem``; returns the answer, if any, and notes on the reading for the user.

    It may be a ``Solution``; an answer of the problem, or what its ``answer_of`` takes for one (routing: a list of routes, each a list of
    site indices or ids, or of each vehicle by its name, or a frame of visits); the JSON of either, as a mapping; the path of a solution
    file; or a solved model of ``form`` (HiGHS, PuLP, CVXPY, PySCIPOpt, MathOpt's result), names as exported. Messages call it ``called``.

    Raises UsageError if it is none of these; InputError if the file or the model is no solution of the problem; with file and, where there
    is one, line.
    """
    if given is None:
        return None, ()
    if isinstance(given, Solution) and given.answer is None:
        return None, (f"{called} holds no answer",)
    if isinstance(given, str | PathLike):
        read = read_answer(problem, given, form)
        return read.answer, tuple(f"{given}: {note}" for note in read.notes)
    solved = solved_model(given)
    if solved is not None:
        try:
            answer, name = answer_of_solver(problem, solved, form)
        except InputError as error:
            raise InputError(f"{called} {error.message}", error.code, expected=error.expected, found=error.found) from None
        return answer, (f"{called}: a solution of {solved.solver} to the form {name}",)
    try:
        with input_errors(problem.problem):
            if isinstance(given, Solution):
                given = given.answer if given.problem is problem else given.to_json()  # which speaks of sites by name
            if isinstance(given, Mapping):
                foreign = None if given.keys() & {"answer", "kind"} else problem.foreign_answer(given)
                if foreign is not None:
                    return foreign, ()
                if given.keys() & {"answer", "kind"}:
                    read = answer_in_json(problem, given)
                    return read.answer, tuple(f"{called}: {note}" for note in read.notes)
            return problem.answer_of(given.item() if isinstance(given, np.ndarray) and given.ndim == 0 else given), ()
    except (InputError, UsageError) as error:
        raise UsageError(f"{called} cannot be read: {error}", error.code) from error.__cause__


def start_given(problem: Problem, given: Any) -> tuple[Any, tuple[str, ...]]:
    """``answer_given`` for what a search shall start from: an answer that the problem can judge, feasible or not.

    Raises UsageError for an answer that can only be one of another instance, too.
    """
    start, notes = answer_given(problem, given, "the start")
    if start is None:
        return None, notes
    foreign = True
    try:
        with input_errors(problem.problem):
            problem.check_start(start)
            foreign = False
            problem.evaluate(start)
            return problem.searched_from(start), notes
    except (InputError, UsageError) as error:
        fault = "is for another instance" if foreign else "cannot be read"
        raise UsageError(f"the start {fault}: {error}", "foreign" if foreign else error.code) from error.__cause__


def evaluated(problem: Problem, answer: Any) -> Evaluation:
    """The judge's verdict on an answer that a user gave; raises InputError where it cannot be judged."""
    with input_errors(problem.problem):
        return problem.evaluate(answer)
