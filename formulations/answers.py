"""Answers in files: read as the problem's own, and written by suffix."""

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..instances.atomic import atomic_write
from ..instances.document import parse_json
from ..instances.errors import InputError, UsageError
from ..instances.printable import printable
from ..instances.text import decode, read_bytes
from .answer_tables import first_sheet, frame_of, is_table, workbook
from .evaluation import input_errors
from .json_text import json_text
from .problem import Problem
from .programs.solution_files import SolverFile, is_solver_json, solver_file, solver_json
from .references import is_number
from .solver_solutions import answer_of_solver

if TYPE_CHECKING:
    from .solution import Solution


@dataclass(frozen=True)
class ReadAnswer:
    """An answer from a file.

    ``answer`` is the problem's own, ``stated`` the objective that the file states, ``notes`` what a user should be told about the reading.
    """

    answer: Any
    stated: float | list[float] | None = None
    notes: tuple[str, ...] = ()


def read_answer(problem: Problem, path: str | PathLike[str], form: str | None = None) -> ReadAnswer:
    """The answer in a solution file, recognised by content: JSON, a table, what else the problem's answers are written as, or what a
    solver wrote of an exported form.

    ``form`` is the form that a solver's file is of, by default whichever fits. Raises InputError, with file and line, if the file is no
    solution of such a problem, UsageError if the file's format cannot express answers to this problem.
    """
    try:
        with input_errors(problem.problem):
            return _read_answer(problem, path, form)
    except InputError as error:
        raise error.at(file=path) from error.__cause__


def _read_answer(problem: Problem, path: str | PathLike[str], form: str | None) -> ReadAnswer:
    held = read_bytes(path)
    if held.startswith(b"PK\x03\x04"):
        return ReadAnswer(problem.answer_from_frame(first_sheet(path, held)))
    text = decode(held, path)
    try:
        if text.lstrip().startswith("{"):
            data = parse_json(text)
            if is_solver_json(data):
                return _of_solver(problem, solver_json(data), form)
            foreign = problem.foreign_answer(data) if isinstance(data, dict) else None
            if foreign is not None:
                return ReadAnswer(foreign)
            if not isinstance(data, dict) or not ({"answer", "kind"} & data.keys()) or "waybound" in data:
                raise InputError("is JSON, but no solution", expected='an object with the key "answer", or an answer itself')
            return answer_in_json(problem, data)
        solved = solver_file(text)
        if solved is not None:
            return _of_solver(problem, solved, form)
        if is_table(text) and ".csv" not in problem.answer_suffixes:
            return ReadAnswer(problem.answer_from_frame(frame_of(text)))
        return ReadAnswer(*problem.answer_from_text(text))
    except InputError as error:
        raise error.at(file=path) from None
    except UsageError as error:
        raise UsageError(f"{path}: {error}", error.code) from None


def _of_solver(problem: Problem, solved: SolverFile, form: str | None) -> ReadAnswer:
    answer, name = answer_of_solver(problem, solved, form)
    return ReadAnswer(answer, notes=(f"a solution of {solved.solver} to the form {name}",))


def answer_in_json(problem: Problem, data: Mapping[str, Any]) -> ReadAnswer:
    """Read an answer from JSON, as a whole solution is written or an answer alone; raises InputError for anything else."""
    if "answer" not in data:
        return ReadAnswer(problem.answer_from_json(data))
    if data["answer"] is None:
        raise InputError("the file holds no answer", "missing", expected='an "answer" that is not null')
    notes = tuple(
        f"made for another {what}: {printable(data[key], 80)}, here {own}"
        for key, what, own in (
            ("problem", "problem", problem.problem),
            ("convention", "convention", problem.convention),
            ("instance_hash", "instance, or other settings", problem.digest()),
        )
        if data.get(key) not in (None, own)
    )
    return ReadAnswer(problem.answer_from_json(data["answer"]), _values(data.get("objective")), notes)


def _values(stated: Any) -> float | list[float] | None:
    if is_number(stated):
        return float(stated)
    return [float(v) for v in stated] if isinstance(stated, list) and stated and all(map(is_number, stated)) else None


def check_answer_path(problem: Problem, path: str | PathLike[str]) -> None:
    """Raise UsageError unless an answer of ``problem`` can be written under the suffix of ``path``."""
    try:
        problem.check_answer_suffix(Path(path).suffix.lower())
    except UsageError as error:
        raise UsageError(f"{path}: {error}", error.code) from None


def write_answer(solution: "Solution", path: str | PathLike[str]) -> None:
    """Write the answer of ``solution`` by the suffix of ``path``, whole or not at all.

    ``.json`` holds all that ``Solution.to_json`` tells, ``.csv`` and ``.xlsx`` tables, other files what their format can express.

    Raises UsageError if the suffix cannot hold the answer, InputError if the file cannot be written.
    """
    check_answer_path(solution.problem, path)
    suffix = Path(path).suffix.lower()
    text: str | bytes
    if suffix == ".json":
        text = json_text(solution.to_json())
    elif suffix == ".xlsx":
        text = workbook({**solution.problem.answer_frames(solution.answer), "left out": solution.left_out()})
    elif suffix == ".csv" and suffix not in solution.problem.answer_suffixes:
        text = solution.to_frame().to_csv(index=False, lineterminator="\n")
    else:
        objective = solution.objective if isinstance(solution.objective, float) else None
        text = solution.problem.answer_to_text(solution.answer, suffix, objective)
    atomic_write(path, text)
