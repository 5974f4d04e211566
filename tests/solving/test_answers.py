"""``solve(start=...)`` and ``check`` take whatever says clearly what it is, and refuse the rest in one line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from programs import program
from sata_cases import CASES

import waybound as wb
from waybound import InputError, Problem, Route, Routes, Selection, UsageError
from waybound.formulations.answers import write_answer
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.solving.answers import answer_given

XY = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)
PAIR = (wb.VehicleType(count=2, capacity=2),)
ANSWER = Routes.of([[1, 2], [3, 4]])


def square(ids: Any = "oabcd", fleet: Any = ()) -> wb.RoutingProblem:
    return wb.RoutingProblem(
        wb.Sites.of(list(ids), demand=[0, 1, 1, 1, 1]), wb.Travel("euclidean", coordinates=XY), fleet or PAIR, name="square"
    )


@pytest.fixture(scope="module")
def solution() -> wb.Solution:
    return wb.solve(square(), "highs", bound_time=0)


def told(problem: Problem, start: Any) -> Any:
    answer, notes = answer_given(problem, start, "the start")
    assert notes == ()
    return answer


@pytest.mark.parametrize(
    "start",
    [
        ANSWER, [[1, 2], [3, 4]], ((1, 2), (3, 4)), [["a", "b"], ["c", "d"]], [np.array([1, 2]), np.array([3, 4])],
        [Route((1, 2)), Route((3, 4))], {"kind": "routes", "routes": [{"visits": ["a", "b"]}, {"visits": ["c", "d"]}]},
        {"answer": {"kind": "routes", "routes": [{"visits": ["a", "b"]}, {"visits": ["c", "d"]}]}},
    ],
)  # fmt: skip
def test_routes_may_be_given_as_lists_and_json(start: Any) -> None:
    assert told(square(), start) == ANSWER


def test_a_solution_may_be_given_itself_as_json_and_as_a_file(solution: wb.Solution, tmp_path: Path) -> None:
    problem = solution.problem
    for suffix in ("json", "sol"):
        write_answer(solution, tmp_path / f"a.{suffix}")
    starts = [
        solution, solution.to_json(), solution.to_json()["answer"], json.loads(json.dumps(solution.to_json()["answer"])),
        tmp_path / "a.sol", str(tmp_path / "a.json"),
    ]  # fmt: skip
    for start in starts:
        assert told(problem, start).canonical() == solution.answer.canonical()


@pytest.mark.share(2)
@pytest.mark.parametrize("how", [{"solver": "pyvrp"}, {"solver": "ortools"}, {"solver": "highs"}])
def test_a_search_starts_from_what_is_given(how: dict[str, str]) -> None:
    for start in ([["a", "b"], ["c", "d"]], [[1, 2], [3, 4]]):
        found = wb.solve(square(), start=start, iterations=1, bound_time=0, **how)
        assert found.objective is not None
        assert found.objective <= square().evaluate(ANSWER).objective


def test_what_may_be_started_from_may_be_checked() -> None:
    given = [["a", "b"], ["c", "d"]]
    assert wb.check(square(), given).objective == wb.check(square(), ANSWER).objective
    assert wb.check(square(), {"kind": "routes", "routes": [{"visits": visits} for visits in given]}).feasible
    assert not wb.check(square(), [[1, 2]]).feasible
    assert not wb.check(square(), Routes.of([[9]])).feasible
    with pytest.raises(UsageError, match="the answer cannot be read: 7 is no list of routes"):
        wb.check(square(), 7)


def test_a_solution_of_other_data_is_read_by_names_and_said_to_be_one(solution: wb.Solution) -> None:
    other = wb.RoutingProblem(
        wb.Sites.of("oxdcba", demand=[0, 1, 1, 1, 1, 1]), wb.Travel("euclidean", coordinates=np.vstack([XY, XY[:1]])),
        (wb.VehicleType(count=3, capacity=2),),
    )  # fmt: skip
    answer, notes = answer_given(other, solution, "the start")
    ids = solution.problem.sites.ids
    assert [[other.sites.ids[k] for k in r.visits] for r in answer] == [[ids[k] for k in r.visits] for r in solution.answer]
    assert len(notes) == 1 and notes[0].startswith("the start: made for another instance, or other settings: ")
    assert "made for another instance" in wb.solve(other, "highs", start=solution, bound_time=0).message
    assert "made for another instance" not in wb.solve(solution.problem, "highs", start=solution, bound_time=0).message


def test_a_solution_without_an_answer_is_no_start_and_said_so(solution: wb.Solution) -> None:
    tight = square(fleet=(wb.VehicleType(count=1, capacity=2),))
    nothing = wb.solve(tight, "highs", bound_time=0)
    assert nothing.answer is None
    assert answer_given(tight, nothing, "the start") == (None, ("the start holds no answer",))
    assert "the start holds no answer" in wb.solve(square(), "highs", start=nothing, bound_time=0).message


NUMBERED = square("12345")
"""Where site 2 may be the one of index 2 or the one with the id 2."""

MIXED = square(fleet=(wb.VehicleType(name="small"), wb.VehicleType(name="large")))


@pytest.mark.parametrize(
    ("problem", "start", "says"),
    [
        (square(), 7, "the start cannot be read: 7 is no list of routes; "),
        (square(), [1, 2, 3], r"\[1, 2, 3\] is no list of routes"),
        (square(), ["ab", "cd"], "is no list of routes"),
        (square(), [["a", "z"]], "there is no site 'z'"),
        (square(), [[1, 9]], "there is no site"),
        (square(), [[1.5]], "a site is given by its name or its index, not by 1.5"),
        (square(), {"cart": [[1, 2]]}, "there is no vehicle 'cart'"),
        (square(), {"answer": None}, "holds no answer"),
        (square(), Selection.of([1]), "is no list of routes"),
        (NUMBERED, [[2, 3], [4]], "whole numbers could be names or indices of sites here"),
        (MIXED, [[1, 2], [3, 4]], "do not say which of the 2 vehicle types drives a route"),
        (wb.BottleneckSATA(CASES["S3"].graph), 5, "is no list of actions"),
        (wb.BottleneckSATA(CASES["S3"].graph, fractional=True), [1.0], "a vector of shares"),
        (ArrayProblem(program([1, 1], [[1, 1]], 1, 2, 0, 1)), [1.0], "one number a variable"),
        (wb.MaxMinLP(np.eye(2), np.eye(2)), "no.json", "no.json"),
        (wb.MaxMinLP(np.eye(2), np.eye(2)), [[1.0]], "a vector of 2 numbers"),
    ],
)
def test_what_says_nothing_clearly_is_refused_before_anything_runs(problem: Problem, start: Any, says: str) -> None:
    with pytest.raises((UsageError, InputError), match=says):
        wb.solve(problem, start=start)


def test_numbers_as_text_are_ids() -> None:
    assert told(NUMBERED, [["2", "3"], ["4", "5"]]) == ANSWER


def test_mixed_fleets_take_routes_that_name_their_type() -> None:
    routes = [Route((1, 2), 1), Route((3, 4))]
    assert told(MIXED, routes) == Routes.of(routes)


def test_selections_and_vectors_may_be_given_as_lists() -> None:
    graph = CASES["S3"].graph
    names = [graph.action_name(0), graph.action_name(2)]
    for problem in (wb.BottleneckSATA(graph), wb.WinnerTakesAllSATA(graph)):
        assert told(problem, names) == told(problem, Selection.of([0, 2])) == Selection.of([0, 2])
        assert told(problem, problem.answer_to_json(Selection.of([0, 2]))).elements == (0, 2)
    shares = [0.25] * graph.num_actions
    assert told(wb.BottleneckSATA(graph, fractional=True), shares).tolist() == shares
    assert told(wb.MaxMinLP(np.eye(2), np.eye(2)), (0.5, 1)).tolist() == [0.5, 1.0]


def test_a_program_starts_from_a_list_too() -> None:
    knapsack = program([5, 4], [[1, 1]], -np.inf, 1, 0, 1, integer=[0, 1], sense="max")
    assert wb.solve(knapsack, "highs", start=[0, 1], bound_time=0).objective == 5.0
