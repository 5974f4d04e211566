"""What is asked of a search, and what is refused of it before anything runs."""

import inspect
from dataclasses import fields
from typing import Any

import pytest
from coded import coded

import waybound as wb
from waybound import Compiled, UsageError
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.solving.request import Request, request_of, searchable


def test_every_setting_of_solve_is_one_of_a_request_with_the_same_default() -> None:
    asked = {name: one.default for name, one in inspect.signature(wb.solve).parameters.items()}
    for one in fields(Request):
        if one.name not in ("notes", "options"):
            assert asked.pop(one.name) == one.default, one.name
    assert set(asked) == {"problem", "progress", "log", "options", "parameters"}


@pytest.mark.parametrize(
    "wrong",
    [
        {"time_limit": 0}, {"gap": -0.1}, {"seed": -1}, {"threads": 0}, {"iterations": 0}, {"no_improvement": 0}, {"bound_time": -1.0},
        {"memory_limit": 0.0}, {"heuristic": "savings", "solver": "highs"}, {"heuristic": "savings", "relax": True},
    ],
)  # fmt: skip
def test_a_limit_that_is_none_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError):
        Request(**wrong)


def test_a_tenth_of_the_limit_goes_into_bounding_and_a_second_at_least() -> None:
    assert [Request(time_limit=limit).bound_budget for limit in (5.0, 60.0)] == [1.0, 6.0]
    assert Request(bound_time=0.0).bound_budget == 0.0


def test_other_keywords_are_options_of_the_method(square: Any) -> None:
    request = request_of(square, heuristic="savings", shape=1.2, options={"more": 1}, start=[[1, 2], [3, 4]])
    assert request.options == {"more": 1, "shape": 1.2} == request.search_options().extra
    assert square.evaluate(request.start).feasible and request.notes == ()


def test_a_limit_of_memory_needs_a_process() -> None:
    assert Request(memory_limit=100.0).isolated and not Request().isolated


def test_a_bare_program_is_compiled(square: Any) -> None:
    program = square.compile().program
    compiled = searchable(program)
    assert isinstance(compiled, Compiled) and isinstance(compiled.problem, ArrayProblem)
    assert compiled.program.num_variables == program.num_variables
    with pytest.raises(UsageError, check=coded("malformed")):
        searchable([])
