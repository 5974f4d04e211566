"""Whatever is given as a start, of any family: an answer that is judged, or one line that says what is wrong with it."""

import copy
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hostile_instances import AT_RISK, FAMILIES, UNCERTAIN, Units
from orchard_cases import retrievals
from outside_family import Jobs, LeastWaiting

import waybound as wb
from waybound import Allocation, InputError, Problem, RiskAllocation, Route, Routes, Selection, UsageError
from waybound.solving.answers import start_given

LONGEST = 500
"""Characters of a message at most."""

SHRUG = "it fails as an answer"
"""What is told where a family says nothing itself: those of the tree have better words, unless the object itself fails."""


class Silent:
    """An object that cannot even be shown."""

    def __repr__(self) -> str:
        raise RuntimeError("not shown")


class Failing:
    """A list whose entries cannot be had."""

    def __len__(self) -> int:
        return 2

    def __getitem__(self, k: int) -> Any:
        raise RuntimeError("no entries")


def itself() -> list[Any]:
    """A list that is its own entry."""
    made: list[Any] = []
    made.append(made)
    return made


SHAPES: dict[str, Callable[[], Any]] = {
    "number": lambda: 7,
    "negative number": lambda: -1,
    "fraction": lambda: 1.5,
    "no number": lambda: float("nan"),
    "truth": lambda: True,
    "complex number": lambda: 1j,
    "huge number": lambda: 10**400,
    "text that is no file": lambda: "no-such-file",
    "empty text": lambda: "",
    "text with a zero": lambda: "a\0b",
    "long text": lambda: "x" * 5000,
    "folder": lambda: Path("/"),
    "bytes": lambda: b"abc",
    "set": lambda: {1, 2},
    "set of texts": lambda: frozenset({"?"}),
    "object": object,
    "class": lambda: dict,
    "function": lambda: print,
    "ellipsis": lambda: ...,
    "generator": lambda: (k for k in (1, 2)),
    "range": lambda: range(3),
    "empty list": list,
    "empty tuple": tuple,
    "empty mapping": dict,
    "list in itself": itself,
    "list of nothing": lambda: [None],
    "tuple of nothing": lambda: (None,),
    "tuple of texts": lambda: ("?", "!"),
    "list of numbers": lambda: [1, 2, 3],
    "tuple of numbers": lambda: (10**6, -5),
    "tuple of fractions": lambda: (1.5, 2.5),
    "tuple of truths": lambda: (True, False),
    "list of a huge number": lambda: [10**400],
    "tuple of huge numbers": lambda: (10**400, 2),
    "list of no number": lambda: [float("nan")],
    "mixed list": lambda: [1, "?", None],
    "lists": lambda: ([1], [2]),
    "nested lists": lambda: [[[[1]]]],
    "nested tuples": lambda: (((1,),),),
    "mappings": lambda: ({}, {}),
    "mapping of a number": lambda: {1: 2},
    "mapping of nothing": lambda: {None: [1]},
    "mapping of a tuple": lambda: {(1, 2): 3},
    "number as answer": lambda: {"answer": 7},
    "list as answer": lambda: {"answer": [1]},
    "mapping as answer": lambda: {"answer": {}},
    "nothing as answer": lambda: {"answer": None},
    "unknown kind": lambda: {"kind": "?"},
    "number as kind": lambda: {"kind": 7},
    "frame of other columns": lambda: pd.DataFrame({"x": [1, 2]}),
    "frame of numbered columns": lambda: pd.DataFrame([[1, 2]]),
    "empty frame": pd.DataFrame,
    "frame of objects": lambda: pd.DataFrame({"vehicle": [1], "site": [object()]}),
    "series": lambda: pd.Series([1, 2]),
    "array of no axis": lambda: np.array(3.0),
    "text of no axis": lambda: np.array("?"),
    "array of another length": lambda: np.ones(77),
    "matrix": lambda: np.ones((2, 3)),
    "cube": lambda: np.zeros((2, 2, 2)),
    "whole array": lambda: np.arange(77),
    "empty array": lambda: np.zeros(0),
    "array of objects": lambda: np.array([None, "?"], dtype=object),
    "array of texts": lambda: np.array(["?", "!"]),
    "array of days": lambda: np.array(["2020-01-01"], dtype="M8[D]"),
    "complex array": lambda: np.ones(3, dtype=complex),
    "array of fields": lambda: np.zeros(2, dtype=[("a", int)]),
    "masked array": lambda: np.ma.masked_array([1, 2], [1, 0]),
    "routes of unknown sites": lambda: Routes.of([[99, -3]]),
    "routes of texts": lambda: Routes((Route(("?",)),)),  # type: ignore[arg-type]
    "unknown elements": lambda: Selection.of([99]),
    "elements that are texts": lambda: Selection(("?",)),  # type: ignore[arg-type]
    "problem": lambda: wb.read("demo-tiny"),
    "solution of another problem": lambda: _solved(),
}

BROKEN: dict[str, Callable[[], Any]] = {
    "object that cannot be shown": Silent,
    "list that cannot be read": Failing,
    "routes of nothing": lambda: Routes(None),  # type: ignore[arg-type]
    "selection of nothing": lambda: Selection(None),  # type: ignore[arg-type]
}
"""Objects that fail whoever looks at them."""

MEMBERS = (None, 7, -1, "?", [], [None], {}, {"?": None}, 10**400)
"""What stands in place of each part of an answer's JSON."""


@cache
def _solved() -> wb.Solution:
    return wb.solve(wb.read("demo-tiny"), "highs", bound_time=0)


DRAWN = {**FAMILIES, **AT_RISK, **UNCERTAIN}
NAMES = [*DRAWN, "orchard-day", "outside"]


@cache
def problem_of(name: str) -> Problem:
    if name == "outside":
        return LeastWaiting(Jobs({"a": 1.0, "b": 2.0}))
    return retrievals(((0, 2), (1, 2)), (0, 0)) if name == "orchard-day" else DRAWN[name](np.random.default_rng(3), Units())


def answer_of(problem: Problem) -> Any:
    """Some answer, where there is one to be had at once."""
    if isinstance(problem, LeastWaiting):
        return "a", "b"
    if isinstance(problem, RiskAllocation):
        return Allocation.of(np.zeros(len(problem.lower)), np.zeros(len(problem.names)))
    known = wb.solve(problem, "highs", time_limit=5.0, bound_time=0).answer if "highs" in able(problem) else None
    return problem.answer_at_hand() if known is None else known


def able(problem: Problem) -> list[str]:
    return [row.name for row in wb.solvers(problem) if row.installed and not row.missing]


def refusal(problem: Problem, given: Any) -> str | None:
    """The one line that refuses a start; None where it is taken, and the judge has a word on it."""
    try:
        start, _ = start_given(problem, given)
    except (InputError, UsageError) as error:
        told = str(error)
        assert told and "\n" not in told and len(told) <= LONGEST, told
        return told
    assert len(problem.evaluate(start).values) == len(problem.senses)
    return None


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", NAMES)
def test_a_start_of_any_shape_is_judged_or_refused_in_one_line(name: str) -> None:
    told = {shape: refusal(problem_of(name), make()) for shape, make in SHAPES.items()}
    assert sum(line is not None for line in told.values()) >= len(SHAPES) - 12
    if name != "outside":
        assert not [shape for shape, line in told.items() if line is not None and SHRUG in line]


@pytest.mark.parametrize("shape", BROKEN)
@pytest.mark.parametrize("name", NAMES)
def test_an_object_that_fails_whoever_looks_at_it_is_refused_in_one_line(name: str, shape: str) -> None:
    assert refusal(problem_of(name), BROKEN[shape]()) is not None


def mutants(data: Any) -> Iterator[Any]:
    """``data`` with one part replaced by each of ``MEMBERS``, left out, or twice."""
    for path in _paths(data):
        for member in MEMBERS:
            made = copy.deepcopy(data)
            _at(made, path[:-1])[path[-1]] = member
            yield made
        made = copy.deepcopy(data)
        held = _at(made, path[:-1])
        if isinstance(held, list):
            held.append(copy.deepcopy(held[path[-1]]))
        else:
            del held[path[-1]]
        yield made


def _paths(data: Any) -> Iterator[tuple[Any, ...]]:
    members = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, member in members:
        yield (key,)
        yield from ((key, *rest) for rest in _paths(member))


def _at(data: Any, path: tuple[Any, ...]) -> Any:
    for key in path:
        data = data[key]
    return data


@pytest.mark.parametrize("name", NAMES)
def test_the_json_of_an_answer_with_a_broken_part_is_judged_or_refused_in_one_line(name: str) -> None:
    problem = problem_of(name)
    told = [refusal(problem, given) for given in mutants(problem.answer_to_json(answer_of(problem)))]
    refused = [line for line in told if line is not None]
    assert len(refused) > 10
    assert name == "outside" or not [line for line in refused if SHRUG in line]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_search_goes_on_from_what_is_taken(name: str) -> None:
    problem = problem_of(name)
    for make in SHAPES.values():
        if name != "outside" and refusal(problem, make()) is None:
            wb.solve(problem, start=make(), time_limit=0.5, bound_time=0)
