import datetime
import re
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from coded import coded
from file_cases import check_refused, refused

from waybound.instances.clock import moment_of, span_of
from waybound.instances.errors import Code, InputError, UsageError, WayboundError
from waybound.instances.routing.formats._frame_settings import KEYS, arguments, flag, in_file, kept, of_set


def test_every_key_is_an_argument(tmp_path: Path) -> None:
    (tmp_path / "fleet.csv").write_text("name\nvan\n")
    (tmp_path / "m.txt").write_text("0 1\n2 0\n")
    (tmp_path / "w.csv").write_text("site,ready,due\n007,08:00,\n")
    (tmp_path / "s.csv").write_text("delivery;pickup;load;load2\na;007;2;\n")
    (tmp_path / "g.csv").write_text("group,site,required\n1,a,no\n")
    texts = {
        "vehicles": "2", "min-vehicles": "1", "capacity": "5, 9", "max-duration": "2h", "max-distance": "80", "fixed-cost": "7",
        "unit-cost": "0.5", "fleet": "fleet.csv", "speed": "50", "time-unit": "minutes", "distance-unit": "m", "matrix": "m.txt",
        "durations": "m.txt", "variances": "m.txt", "closing": "m.txt",
        "windows": "w.csv", "shipments": "s.csv", "groups": "g.csv",
        "columns": "demand=crates, id = shop", "extra": "note, demands",
    }  # fmt: skip
    assert {*texts, "metric"} == set(KEYS)
    made = arguments({key: (1, text) for key, text in texts.items()}, tmp_path, 2)
    assert all(made.pop(key).tolist() == [[0, 1], [2, 0]] for key in ("travel", "durations", "variances", "closing"))
    assert made.pop("windows").to_dict("records") == [{"site": "007", "ready": datetime.time(8), "due": None}]
    assert made.pop("shipments").to_dict("records") == [{"delivery": "a", "pickup": "007", "load": 2.0, "load2": 0.0}]
    assert made.pop("groups").to_dict("records") == [{"group": "1", "site": "a", "required": False}]
    assert made.pop("fleet")["name"].tolist() == ["van"]
    assert made == {
        "vehicles": 2, "min_vehicles": 1, "capacity": [5, 9], "max_duration": pd.Timedelta("2h"), "max_distance": 80, "fixed_cost": 7,
        "unit_cost": 0.5, "speed": 50, "time_unit": "min", "distance_unit": "m", "columns": {"demand": "crates", "id": "shop"},
        "extra": ["note", "demands"],
    }  # fmt: skip
    assert arguments({"metric": (1, "manhattan"), "extra": (2, "TRUE")}, tmp_path, 2) == {"travel": "manhattan", "extra": True}


def test_what_comes_from_python_is_handed_on() -> None:
    frame = pd.DataFrame({"name": ["van"]})
    given = {"fleet": frame, "vehicles": None, "capacity": 5, "max-duration": pd.Timedelta("2h"), "extra": ["note"]}
    made = arguments(of_set(given), Path(), 2)
    assert made.pop("fleet") is frame and made == {"capacity": 5, "max_duration": pd.Timedelta("2h"), "extra": ["note"]}


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("speed", "nan", "line 4: speed must be a finite number"),
        ("max-duration", "-1", "line 4: max-duration is negative"),
        ("time-unit", "week", "line 4: unknown unit of time 'week'"),
        ("distance-unit", "league", "line 4: unknown unit of distance 'league'"),
        ("fleet", ".", "line 4: fleet '.' is no plain file"),
        ("columns", "a=b=c", "line 4: columns must pair titles"),
        ("variances", "no.csv", "line 4: variances 'no.csv' no such file"),
        ("windows", "no.csv", "line 4: windows 'no.csv' no such file"),
    ],
)
def test_a_setting_that_makes_no_sense_is_refused_with_its_line(key: str, text: str, message: str, tmp_path: Path) -> None:
    assert refused(arguments, {key: (4, text)}, tmp_path, 2).startswith(message)


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("windows", "site,redy\na,1\n", "1: column 'redy' is unknown; did you mean 'ready'?; expected site, ready, due"),
        ("windows", "site,ready\na,soon\n", "2: ready must be a number or a moment"),
        ("shipments", "pickup,delivery\na,b\na,\n", "3: delivery is empty"),
        ("shipments", "pickup,delivery,load\na,b,-1\n", "2: load is negative"),
        ("groups", "group,site,required\n1,a,perhaps\n", "2: required must be true or false"),
        ("groups", "group,site\n", "1: holds no groups"),
        ("variances", "0 -1\n1 0\n", "1: variance is negative"),
        ("variances", "0 inf\n1 0\n", "1: variances holds something that is no finite number; expected a number; found 'inf'"),
        ("closing", "0 x\n1 0\n", "1: closing holds something that is no finite number; expected a number, or inf for no limit; found 'x'"),
        ("durations", "0 1\n", "1: durations has a wrong number of rows"),
    ],
)
def test_what_a_file_beside_holds_is_refused_with_its_line(key: str, text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "beside.csv").write_text(text)
    with pytest.raises(InputError, match=f"^{re.escape(str(tmp_path / 'beside.csv'))}:{re.escape(message)}"):
        arguments({key: (4, "beside.csv")}, tmp_path, 2)


@pytest.mark.parametrize(
    "given",
    [
        {"speed": "fast"}, {"vehicles": 0}, {"capacity": -1}, {"columns": "crates"}, {"matrix": "no.csv"}, {"closing": "no.csv"},
        {"groups": "no.csv"}, {"shipments": True}, {"matrix": False}, {"columns": True},
    ],
)  # fmt: skip
def test_a_setting_of_the_command_line_has_no_line(given: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=f"^--set {next(iter(given))}") as caught:
        arguments(of_set(given), Path(), 2)
    assert caught.value.line is None


@pytest.mark.parametrize(
    ("key", "text", "code"), [("fleet", ".", "file"), ("max-duration", "-1", "out-of-range"), ("distance-unit", "league", "unknown-name")]
)
def test_a_code_is_kept_where_its_place_is_added(key: str, text: str, code: Code) -> None:
    for settings in ({key: (4, text)}, of_set({key: text})):
        with pytest.raises(WayboundError, check=coded(code)):
            arguments(settings, Path(), 2)


def test_a_unit_of_the_command_line_has_no_line() -> None:
    check_refused(UsageError, "unknown unit of time 'week'", arguments, of_set({"time-unit": "week"}), Path(), 2)


@pytest.mark.parametrize(
    ("python", "command"),
    [
        ("speed=50 (an hour), or durations=matrix", "--set speed=50 (an hour), or --set durations=FILE"),
        ("time_unit='min', or s, h, d", "--set time-unit=min, or s, h, d"),
        ("columns={'demand': 'dmand'} to use it, extra=['dmand']", "--set columns=demand=dmand to use it, --set extra=dmand"),
        ("columns x and y, lat and lon, or travel=matrix", "columns x and y, lat and lon, or --set matrix=FILE"),
        ("at least 1", "at least 1"),
    ],
)  # fmt: skip
def test_a_cure_is_told_as_the_command_line_writes_it(python: Any, command: str) -> None:
    told = in_file(InputError("wrong", "unknown-name", expected=python, line=3))
    assert (told.expected, told.code) == (command, "unknown-name")
    assert in_file(InputError("wrong")).expected is None


# -- cells ---------------------------------------------------------------------------------------------------------------


HOUR = datetime.timedelta(hours=1)


@pytest.mark.parametrize(
    ("cell", "meant"),
    [
        ("", None), ("480", 480.0), ("08:05", datetime.time(8, 5)), ("8:05:30", datetime.time(8, 5, 30)), ("24:00", 24 * HOUR),
        ("2026-05-04", datetime.datetime(2026, 5, 4)), ("2026-05-04 08:05", datetime.datetime(2026, 5, 4, 8, 5)),
        ("2026-05-04T08:05:00+02:00", datetime.datetime(2026, 5, 4, 8, 5, tzinfo=datetime.timezone(2 * HOUR))),
    ],
)  # fmt: skip
def test_moments(cell: str, meant: Any) -> None:
    assert moment_of(cell, 3, "ready") == meant


@pytest.mark.parametrize(
    ("cell", "meant"),
    [
        ("", None), ("20", 20.0), ("20min", HOUR / 3), ("1h 30min", 1.5 * HOUR), ("90 Minutes", 1.5 * HOUR), ("0.5 h", HOUR / 2),
        ("00:20:00", HOUR / 3), ("0 days 00:20:00", HOUR / 3), ("1 day, 0:00:00.5", 24 * HOUR + datetime.timedelta(seconds=0.5)),
    ],
)  # fmt: skip
def test_lengths_of_time(cell: str, meant: Any) -> None:
    assert span_of(cell, 3, "service") == meant


@pytest.mark.parametrize("cell", ["noon", "25:00", "24:01", "08:60", "2026-13-04", "2026-05-04T25:00", "-08:00", "1_0"])
def test_what_is_no_moment_is_refused(cell: str) -> None:
    check_refused(InputError, "line 3: ready must be a number or a moment", moment_of, cell, 3, "ready")


@pytest.mark.parametrize(
    "cell", ["00:20", "20 fortnights", "min", "1h and 5min", "2026-05-04", "-20min", "999999999999h", "9" * 400 + "min"]
)
def test_what_is_no_length_of_time_is_refused(cell: str) -> None:
    """Hours and minutes with a colon may be minutes and seconds as well."""
    check_refused(InputError, "line 3: service must be a number or a length of time", span_of, cell, 3, "service")


def test_flags_and_what_is_only_kept() -> None:
    assert [flag(cell, 1, "depot") for cell in ("yes", "FALSE", "")] == [True, False, None]
    assert kept(["1", "", "-2.5"]) == [1, None, -2.5] and kept(["007", "8"]) == ["007", "8"] and kept(["1", "x"]) == ["1", "x"]
