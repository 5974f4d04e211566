import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import coded
from told_schedules import a_problem, an_answer, changed, faults_of, horizon_agrees, of_changed
from typer.testing import CliRunner

import waybound as wb
from waybound.cli.app import app
from waybound.formulations.routing.parse_routes import routes_given
from waybound.formulations.routing.routes import Route, Routes, Timetable, last_digit
from waybound.instances.errors import Code, InputError
from waybound.reports.benchmarks.routing_variants import TURNS


def test_vehicles_that_stay_at_home_have_no_route() -> None:
    made = Routes.of([[1, 2], [], Route((), 1), Route((3,), 1)])
    assert list(made) == [Route((1, 2)), Route((3,), 1)]
    assert len(made) == 2 and [len(r) for r in made] == [2, 1]


def test_sites_become_plain_numbers() -> None:
    (route,) = Routes.of([np.array([4, 2], dtype=np.int32)])
    assert route.visits == (4, 2) and {type(i) for i in route.visits} == {int}


def test_the_order_of_routes_does_not_matter_and_that_of_visits_does() -> None:
    one = Routes.of([Route((3, 1)), Route((2,), 1), Route((4,))])
    same = Routes.of([Route((4,)), Route((3, 1)), Route((2,), 1)])
    assert one != same and one.canonical() == same.canonical()
    assert [r.visits for r in one.canonical()] == [(3, 1), (4,), (2,)]
    assert Routes.of([[1, 3]]).canonical() != Routes.of([[3, 1]]).canonical()
    assert Routes.of([Route((1,), 0)]).canonical() != Routes.of([Route((1,), 1)]).canonical()


SITES = pd.DataFrame({"id": ["hub", "a", "b"], "x": [0, 10, 20], "y": 0, "ready": [0, 60, 180], "due": 720, "service": 10})
LONG = wb.RoutingProblem.from_frame(SITES, vehicles=1)
SHIFT = wb.RoutingProblem.from_frame(SITES, vehicles=1, max_duration=60)
EARLY = pd.DataFrame(
    {"vehicle": "vehicle 1", "site": ["a", "b"], "arrival": [10, 80], "begin": [60, 180], "departure": [70, 190]}
)  # of departing at 0, back at 210


def stated(problem: wb.RoutingProblem, table: pd.DataFrame) -> list[tuple[str, str | None]]:
    return [(v.check, v.site) for v in wb.judge(problem, table).violations]


@pytest.mark.share(6)
@pytest.mark.parametrize("number", range(2 * len(TURNS)))
def test_every_output_tells_one_schedule(number: int) -> None:
    problem, rng = a_problem(4, number), np.random.default_rng([4, number])
    answer = an_answer(problem, rng)
    assert not faults_of(problem, answer, picture=True, sheets=True)
    frame, _ = changed(problem, answer, rng)
    assert not of_changed(problem, frame, every=True)


def test_a_shift_of_an_hour_is_one_in_every_table(tmp_path: Path) -> None:
    solution = wb.solve(SHIFT, "highs", bound_time=1.0)
    visits, routes = solution.to_frame(), solution.to_frame("routes")
    assert visits["arrival"].tolist() == [160, 180] and visits["departure"].tolist() == [170, 190]
    assert (routes["departure"][0], routes["return"][0], routes["duration"][0]) == (150, 210, 60)
    for suffix in (".csv", ".xlsx", ".json"):
        solution.save(tmp_path / f"a{suffix}")
        verdict = wb.judge(SHIFT, tmp_path / f"a{suffix}")
        assert verdict.feasible and "timetable" not in {check.name for check in verdict.checks}, suffix
    read = pd.read_excel(tmp_path / "a.xlsx", sheet_name=None)
    assert read["visits"]["arrival"].tolist() == [160, 180] and read["routes"]["departure"].tolist() == [150]


def test_a_timetable_of_its_own_is_what_is_judged() -> None:
    assert stated(LONG, EARLY) == []
    assert stated(SHIFT, EARLY) == [("duration", None)]
    answer = routes_given(LONG, EARLY)
    verdict = LONG.evaluate(answer)
    assert verdict.quantities["waiting"] == 150 and LONG.answer_frames(answer)["routes"]["duration"].tolist() == [210]
    assert LONG.answer_to_frame(answer)[["arrival", "begin", "departure"]].to_numpy().tolist() == [[10, 60, 70], [80, 180, 190]]


@pytest.mark.parametrize(
    ("column", "values", "found"),
    [
        ("arrival", [10, 79], [("timetable", "b")]),
        ("begin", [59, 180], [("timetable", "a")]),
        ("departure", [69, 190], [("timetable", "a")]),
        ("departure", [75, 190], [("timetable", "b")]),  # then b is reached at 85
        ("arrival", [5, 80], [("timetable", "hub")]),  # leaves before the hub opens
        ("begin", [60, 730], [("time-windows", "b"), ("time-windows", "hub"), ("timetable", "b")]),  # and b is left at 740
        ("departure", [70, 715], [("time-windows", "hub")]),  # stays at b, and is late at the hub
    ],
)
def test_a_time_that_does_not_come_of_those_before_is_named(column: str, values: list[float], found: list[tuple[str, str]]) -> None:
    assert stated(LONG, EARLY.assign(**{column: values})) == found


def test_times_are_as_exact_as_they_are_written() -> None:
    slanted = wb.RoutingProblem.from_frame(SITES.assign(y=[0, 3, 7]), vehicles=1, max_duration=63)
    answer = wb.Routes.of([[1, 2]])
    own = slanted.answer_to_frame(answer)
    assert slanted.evaluate(answer).feasible
    for digits in (0, 1, 2, 9):
        rounded = own.round({"arrival": digits, "begin": digits, "departure": digits})
        assert routes_given(slanted, rounded) == answer  # the judge's own schedule, rounded
        wrong = rounded.assign(arrival=[rounded["arrival"][0], rounded["arrival"][1] + 1.5 * 10.0**-digits])
        assert ("timetable", "b") in stated(slanted, wrong)
    # Another departure, rounded: each time is off by half a unit at most, and so is the one before it.
    early = pd.DataFrame({"vehicle": 1, "site": ["a", "b"], "arrival": [30.44, 81], "begin": [60, 180], "departure": [70, 190]})
    assert slanted.answer_to_frame(routes_given(slanted, early))["arrival"].tolist() == pytest.approx([30.44, 80.77032961])
    assert stated(slanted, early) == [("timetable", "b"), ("duration", None)]
    assert stated(slanted, early.assign(arrival=[30, 81])) == [("duration", None)]


def test_moments_are_read_as_they_are_written(tmp_path: Path) -> None:
    day = pd.Timestamp("2026-11-23", tz="Europe/Berlin")
    hours = [day + pd.Timedelta(hours=h) for h in (6, 7, 9)]
    dated = SITES.assign(ready=hours, due=day + pd.Timedelta("18h"), service=pd.Timedelta("10min"), y=[0, 3, 7])
    problem = wb.RoutingProblem.from_frame(dated, vehicles=1, time_unit="min", max_duration=63)
    solution = wb.solve(problem, "highs", bound_time=0.0)
    for suffix in (".csv", ".xlsx"):
        solution.save(tmp_path / f"a{suffix}")
        assert wb.judge(problem, tmp_path / f"a{suffix}").feasible, suffix
    early = solution.to_frame()
    early["arrival"] -= pd.Timedelta("30min")
    assert ("timetable", "b") in stated(problem, early)
    early.to_csv(tmp_path / "early.csv")
    dated.to_csv(tmp_path / "sites.csv", index=False)
    verdict = wb.judge(problem, tmp_path / "early.csv")
    assert not verdict.feasible and {v.site for v in verdict.violations if v.check == "timetable"} == {"b"}


def test_a_route_with_a_timetable_keeps_it_in_json_and_searches_begin_without() -> None:
    answer = routes_given(LONG, EARLY)
    data = json.loads(json.dumps(LONG.answer_to_json(answer)))
    assert LONG.answer_from_json(data) == answer != answer.untimed() == Routes.of([[1, 2]])
    assert wb.solve(LONG, "highs", start=EARLY, bound_time=0.0).answer.routes[0].timetable is None
    assert LONG.answer_to_json(answer.untimed()) == {"kind": "routes", "routes": [{"visits": ["a", "b"]}]}


@pytest.mark.parametrize(
    ("key", "value", "message", "code"),
    [
        ("arrival", [1.0], "routes[0].timetable.arrival must be a list with one time a visit", "wrong-shape"),
        ("begin", [1.0, "x"], "routes[0].timetable.begin[1] must be a finite number", "out-of-range"),
        ("digit", -1, "routes[0].timetable.digit must be at least 0", "out-of-range"),
        ("sleeps", 3, "routes[0].timetable must be an object with some of the keys", "malformed"),
    ],
)
def test_a_broken_timetable_in_json_is_refused_by_its_key(key: str, value: Any, message: str, code: Code) -> None:
    data = LONG.answer_to_json(routes_given(LONG, EARLY))
    data["routes"][0]["timetable"][key] = value
    with pytest.raises(InputError, check=coded(code)) as error:
        LONG.answer_from_json(data)
    assert message in str(error.value)


def test_stops_at_the_depots_tell_departure_and_return() -> None:
    ends = pd.DataFrame(
        {
            "vehicle": 1, "site": ["hub", "a", "b", "hub"], "arrival": [None, 110, 130, 210], "begin": [None, 110, 180, None],
            "departure": [100, 120, 190, None],
        }
    )  # fmt: skip
    assert stated(LONG, ends) == []
    assert stated(LONG, ends.assign(departure=[99, 120, 190, None])) == [("timetable", "a")]
    assert stated(LONG, ends.assign(arrival=[None, 110, 130, 211])) == [("timetable", "hub")]


def test_what_continues_a_plan_takes_the_schedule_that_is_shown() -> None:
    problem = wb.RoutingProblem.from_frame(SITES, windows={"a": [(0, 20), (100, 200)]}, vehicles=1)
    assert not horizon_agrees(problem, wb.Routes.of([[1, 2]]), 90.0)


def test_the_command_names_what_is_wrong(tmp_path: Path) -> None:
    SITES.to_csv(tmp_path / "sites.csv", index=False)
    EARLY.assign(arrival=[10, 79]).to_csv(tmp_path / "early.csv", index=False)
    shown = CliRunner().invoke(app, ["check", str(tmp_path / "sites.csv"), str(tmp_path / "early.csv")])
    assert shown.exit_code == 5 and "reaches b at 80, its timetable says 79" in " ".join(shown.output.split())


def test_the_last_digit_of_several_times_is_the_finest() -> None:
    assert (last_digit([10.0, 2000.0, None]), last_digit([1.5, 1.25]), last_digit([3e-7])) == (1.0, 0.01, 1e-7)
    assert Timetable((), (), ()).to_json() == {"digit": 0.0} and Route((1,)).timetable is None
