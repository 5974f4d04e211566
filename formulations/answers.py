"""Answers in files: read as the problem's own, and written by suffix."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from ..instances.atomic import atomic_write
from ..instances.errors import InputError, UsageError
from ..instances.printable import printable
from ..instances.routing.instance import RoutingInstance
from ..instances.routing.solution_files import read_solution_file, write_solution_file
from .problem import Problem
from .routing.problem import RoutingProblem
from .routing.routes import Routes
from .solution import Solution

SUFFIXES = (".json", ".sol", ".tour")
"""Kinds of solution files."""


@dataclass(frozen=True)
class ReadAnswer:
    """An answer from a file.

    Attributes
    ----------
    answer : object
        The problem's own.
    stated : float, list of float or None
        The objective that the file states.
    notes : tuple of str
        What a user should be told about the reading.
    """

    answer: Any
    stated: float | list[float] | None = None
    notes: tuple[str, ...] = ()


def read_answer(problem: Problem, path: str | PathLike[str]) -> ReadAnswer:
    """The answer in a solution file (``.sol``, ``.tour`` or JSON, recognised by content).

    Raises
    ------
    InputError
        If the file is no solution of such a problem; with file and, where there is one, line.
    UsageError
        If the file's format cannot say which vehicle drives a route and the fleet has several types.
    """
    found = read_solution_file(path, _instance(problem) if isinstance(problem, RoutingProblem) else None)
    try:
        if isinstance(found, dict):
            return answer_in_json(problem, found)
    except InputError as error:
        raise error.at(file=path) from None
    _need_one_type(problem, path)
    return ReadAnswer(Routes.of(found.routes), found.cost)


def answer_in_json(problem: Problem, data: Mapping[str, Any]) -> ReadAnswer:
    """The answer in the JSON of a solution or of an answer; raises InputError for anything else."""
    if "answer" not in data:
        return ReadAnswer(problem.answer_from_json(data))
    if data["answer"] is None:
        raise InputError("the file holds no answer", expected='an "answer" that is not null')
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
    def real(value: Any) -> bool:
        return isinstance(value, int | float) and not isinstance(value, bool)

    if real(stated):
        return float(stated)
    return [float(v) for v in stated] if isinstance(stated, list) and stated and all(map(real, stated)) else None


def check_answer_path(problem: Problem, path: str | PathLike[str]) -> None:
    """Raise UsageError unless an answer of ``problem`` can be written under the suffix of ``path``."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise UsageError(f"{path}: the suffix stands for no kind of solution file; use one of {', '.join(SUFFIXES)}")
    if suffix == ".json":
        return
    if not isinstance(problem, RoutingProblem):
        raise UsageError(f"{path}: answers to {problem.problem} problems are written as .json")
    _need_one_type(problem, path)
    if suffix == ".tour" and problem.vehicle_limit != 1:
        raise UsageError(f"{path}: a .tour file holds one route, and this problem allows more; use .sol or .json, or set vehicles=1")


def write_answer(solution: Solution, path: str | PathLike[str]) -> None:
    """Write the answer of ``solution`` by the suffix of ``path``, whole or not at all.

    ``.json`` holds all that ``Solution.to_json`` tells, ``.sol`` and ``.tour`` the routes and their cost.

    Raises
    ------
    UsageError, InputError
        If the suffix cannot hold the answer, or the file cannot be written.
    """
    check_answer_path(solution.problem, path)
    if Path(path).suffix.lower() == ".json":
        atomic_write(path, json_text(solution.to_json()))
        return
    assert isinstance(solution.problem, RoutingProblem)
    objective = solution.objective
    cost = objective if isinstance(objective, float) else None
    write_solution_file(path, _instance(solution.problem), [route.visits for route in solution.answer], cost)


INDENTED = 1_000_000
"""Characters up to which JSON is laid out for people: doing so takes five times as long, which an interrupted command does not have."""


def json_text(data: Any) -> str:
    """Standard JSON, one key a line unless it is long; numbers that JSON does not know are null, characters that cannot be printed are
    escaped."""
    plain = finite(data)
    text = json.dumps(plain, ensure_ascii=False, allow_nan=False)
    if len(text) <= INDENTED:
        text = json.dumps(plain, indent=2, ensure_ascii=False, allow_nan=False)
    if not all(line.isprintable() for line in text.split("\n")):  # the standard lets DEL, C1 controls and overrides stand as they are
        text = "".join(c if c == "\n" or c.isprintable() else _escaped(c) for c in text)
    return text + "\n"


def _escaped(character: str) -> str:
    return json.dumps(character)[1:-1] if character != "\x7f" else "\\u007f"


def finite(data: Any) -> Any:
    """``data`` of plain JSON values, with null for infinities and NaN, and numpy's numbers as Python's."""
    if isinstance(data, dict):
        return {str(key): finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple | set | frozenset):
        return [finite(value) for value in data]
    if hasattr(data, "tolist"):
        return finite(data.tolist())
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data


def _need_one_type(problem: Problem, path: str | PathLike[str]) -> None:
    if isinstance(problem, RoutingProblem) and len(problem.fleet) > 1:
        raise UsageError(f"{path}: such a file cannot say which of the {len(problem.fleet)} vehicle types drives a route; use .json")


def _instance(problem: RoutingProblem) -> RoutingInstance:
    return RoutingInstance(
        problem.name, "problem", problem.sites, problem.travel, problem.fleet, problem.problem, min_vehicles=problem.min_vehicles
    )
