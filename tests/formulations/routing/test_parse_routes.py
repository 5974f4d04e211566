import datetime
import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import check_coded
from file_cases import check_refused
from hypothesis import given, strategies as st

import waybound as wb
from waybound.formulations.routing.parse_routes import routes_given, stated_times
from waybound.instances.clock import Clock
from waybound.instances.errors import UsageError

SITES = pd.DataFrame({"id": ["yard", "a", "b", "c", "d"], "x": [0, 1, 2, 3, 4], "y": 0.0})
ALIKE = wb.RoutingProblem.from_frame(SITES)
MIXED = wb.RoutingProblem.from_frame(SITES, fleet=[{"name": "van", "count": 2}, {"name": "big truck", "count": 1}])
WANTED = wb.Routes.of([[1, 3], [2, 4]])
TWO = wb.Routes.of([wb.Route((1, 3), 0), wb.Route((2, 4), 1)])


@pytest.mark.parametrize(
    "given",
    [
        [["a", "c"], ["b", "d"]], [[1, 3], [2, 4]], [np.array([1, 3]), np.array([2, 4])], [["yard", "a", "c", "yard"], [0, 2, 4, 0]],
        {"routes": [["a", "c"], ["b", "d"]]}, {"vehicle 1": ["a", "c"], "vehicle 2": ["b", "d"]}, {"vehicle": [["a", "c"], ["b", "d"]]},
        {1: ["a", "c"], 2: ["b", "d"]}, WANTED, [["a", "c"], [], ["b", "d"]],
        pd.DataFrame({"vehicle": [1, 2, 1, 2], "site": ["c", "b", "a", "d"], "position": [2, 1, 1, 2]}),
        pd.DataFrame({"Route": ["p", "q", "p", "q"], "Customer": ["a", "b", "c", "d"]}),
    ],
)  # fmt: skip
def test_every_way_to_say_it_is_the_same(given: Any) -> None:
    assert routes_given(ALIKE, given).canonical() == WANTED


@pytest.mark.parametrize(
    "given",
    [
        {"van 2": ["a", "c"], "big truck": ["b", "d"]}, {"van": [["a", "c"]], "big truck 1": ["b", "d"]},
        pd.DataFrame({"vehicle": ["van 1", "van 1", "big truck 1", "big truck 1"], "site": list("acbd")}),
    ],
)  # fmt: skip
def test_names_of_vehicles_are_those_of_types_with_a_number_or_without(given: Any) -> None:
    assert routes_given(MIXED, given).canonical() == TWO


@pytest.mark.parametrize(
    ("problem", "given", "message"),
    [
        (ALIKE, 5, "5 is no list of routes"),
        (ALIKE, "a b", "is no list of routes"),
        (ALIKE, [["a", "z"]], "there is no site 'z'"),
        (ALIKE, {"vehicle 1": "ab"}, "the route of vehicle 1 must be a list of sites, not 'ab'"),
        (ALIKE, {"vehicl": ["a"]}, "there is no vehicle 'vehicl'; did you mean 'vehicle'?"),
        (MIXED, [["a"]], "lists do not say which of the 2 vehicle types drives a route; give {'van 1': [...]}"),
        (MIXED, {"bus 1": ["a"]}, "there is no vehicle 'bus 1'; the types are van, big truck"),
        (ALIKE, pd.DataFrame({"vehicle": [1]}), "a table of visits needs the column 'site'"),
        (ALIKE, pd.DataFrame({"vehicles": [1], "site": ["a"]}), "needs the column 'vehicle'; did you mean 'vehicles'?"),
        (ALIKE, pd.DataFrame({"vehicle": [1, None], "site": ["a", "b"]}), "has a row without"),
    ],
)
def test_what_says_nothing_clearly_is_refused(problem: wb.RoutingProblem, given: Any, message: str) -> None:
    with pytest.raises(UsageError) as error:
        routes_given(problem, given)
    assert message in str(error.value) and "\n" not in str(error.value)


@given(st.permutations([1, 2, 3, 4]), st.integers(0, 4), st.booleans())
def test_tables_and_lists_of_an_answer_lead_back_to_it(order: list[int], cut: int, mixed: bool) -> None:
    problem = MIXED if mixed else ALIKE
    answer = wb.Routes.of([wb.Route(tuple(order[:cut]), 0), wb.Route(tuple(order[cut:]), int(mixed))])
    for given_back in (problem.answer_to_frame(answer), problem.answer_routes(answer)):
        assert routes_given(problem, given_back).canonical() == answer.canonical()


@pytest.mark.parametrize(
    "names",
    [
        ("van", "van 2"), ("van 2", "van"), ("van", "van 1"), ("van 1", "van 1 1"), ("1", "1 2"), ("1", "2"), ("vehicle", "vehicle 1"),
        ("vehicle 1", "vehicle 2"), ("vehicle 1 2", "vehicle 2 3"), ("007", "7"), ("1.0", "1"), ("a,b", 'q"x'), (" van", "van "),
        ("NA", "nan"), ("=1+1", "-2"), ("van;1", "van {2}"),
    ],
)  # fmt: skip
def test_what_is_written_reads_back_whatever_types_are_called(names: tuple[str, str], tmp_path: Path) -> None:
    sites = pd.DataFrame({"lat": [45, 45.1, 45.2, 45.3, 45.4, 45.5], "lon": [15.0] * 6, "demand": [0, 1, 1, 1, 1, 1]})
    fleet = [{"name": names[0], "count": 3, "capacity": 1}, {"name": names[1], "count": 1, "capacity": 2}]
    problem = wb.RoutingProblem.from_frame(sites, fleet=fleet)
    start = wb.Routes.of([wb.Route((1,)), wb.Route((2,)), wb.Route((3,)), wb.Route((4, 5), 1)])
    solution = wb.solve(problem, "highs", start=start, time_limit=5, bound_time=0)
    assert len({route.vehicle for route in solution.routes}) == 4
    told = [solution.to_frame(), solution.routes, {route.vehicle: list(route) for route in solution.routes}]
    for suffix in (".csv", ".xlsx", ".json", ".vroom", ".geojson"):
        solution.save(tmp_path / f"answer{suffix}")
        told.append(tmp_path / f"answer{suffix}")
    for each in told:
        again = wb.judge(problem, each)
        assert again.feasible and again.objective == solution.objective, each


def test_a_name_of_a_vehicle_that_is_suggested_is_none_of_another_type() -> None:
    sites = pd.DataFrame({"x": [0, 1], "y": [0, 1]})
    problem = wb.RoutingProblem.from_frame(sites, fleet=[{"name": "van", "count": 2}, {"name": "van 1"}])
    check_refused(wb.UsageError, r"give \{'van 2': \[\.\.\.\]\}", wb.judge, problem, [[1]])
    check_coded(wb.UsageError, "ambiguous", routes_given, problem, [[1]])


DAY = Clock("min", "2026-05-04T00:00:00")
ZONED = Clock("h", "2026-05-04T00:00:00+02:00")


@pytest.mark.parametrize(
    ("clock", "values", "read", "digit"),
    [
        (None, [1, 2.5, None], [1.0, 2.5, None], 0.1),
        (None, ["10", " 12.25", "", float("nan"), np.float64(3)], [10.0, 12.25, None, None, 3.0], 0.01),
        (None, [1000, 2000], [1000.0, 2000.0], 1.0),
        (DAY, [pd.Timestamp("2026-05-04 08:05"), pd.NaT], [485.0, None], 1.0),
        (DAY, ["2026-05-04 08:05:30", "09:00"], [485.5, 540.0], 1 / 60),
        (DAY, [datetime.time(6, 30), pd.Timedelta("7h"), datetime.timedelta(minutes=1)], [390.0, 420.0, 1.0], 1.0),
        (Clock("s", "2026-05-04"), [pd.Timestamp("2026-05-04 00:00:16.954999999")], [16.954999999], 1e-6),
        (ZONED, [pd.Timestamp("2026-05-04 08:00", tz="UTC"), "2026-05-04 08:00:00.500"], [10.0, 8.0 + 0.5 / 3600], 1e-3 / 3600),
    ],
)
def test_numbers_moments_and_their_texts_are_times(clock: Clock | None, values: Any, read: list[float | None], digit: float) -> None:
    rows, least = stated_times(clock, {"begin": values})
    assert [row[1] for row in rows] == pytest.approx(read) and all(row[0] is row[2] is None for row in rows)
    assert least == pytest.approx(digit)


def test_where_nothing_is_stated_there_are_no_rows() -> None:
    assert stated_times(None, {"arrival": [None, ""], "departure": [math.nan, pd.NA]}) == ([], 0.0)
    assert stated_times(None, {}) == ([], 0.0)


@pytest.mark.parametrize(
    ("clock", "value", "message"),
    [
        (None, "soon", "column arrival of the visits holds 'soon', which is no time"),
        (None, True, "holds 'True', which is no time"),
        (None, math.inf, "holds 'inf', which is no time"),
        (None, "08:00", "the problem has no unit of time"),
        (Clock("min"), pd.Timestamp("2026-05-04"), "the problem does not know which moment is time 0"),
        (DAY, pd.Timestamp("2026-05-04", tz="UTC"), "has a time zone"),
    ],
)
def test_what_is_no_time_is_refused_by_its_column(clock: Clock | None, value: Any, message: str) -> None:
    with pytest.raises(UsageError, match="column arrival") as error:
        stated_times(clock, {"arrival": [1.0 if clock is None else None, value]})
    assert message in str(error.value) and "\n" not in str(error.value)
