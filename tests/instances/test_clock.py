import datetime
import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from coded import check_coded, coded
from hypothesis import given, strategies as st

from waybound.instances.clock import SECONDS, Clock, Times, moment_told, unit_named
from waybound.instances.errors import InputError, UsageError

NINE = pd.Timestamp("2026-05-04 09:00")


def reading(unit: str | None, *seen: Any) -> Times:
    times = Times(unit)
    for values in seen:
        times.see(values)
    return times


@pytest.mark.parametrize(("unit", "value"), [("s", 32400.0), ("min", 540.0), ("h", 9.0), ("d", 0.375), ("minutes", 540.0)])
def test_a_timestamp_counts_from_midnight_in_the_unit(unit: str, value: float) -> None:
    column = pd.Series([NINE, NINE + pd.Timedelta("1D"), pd.NaT])
    made = reading(unit, column).moments(column, "column ready")
    assert made[0] == value and math.isnan(made[2])
    assert made[1] - made[0] == pytest.approx(86400.0 / SECONDS[unit_named(unit)])


@pytest.mark.parametrize(
    "values",
    [
        pd.Series([NINE]), pd.Series([NINE]).dt.tz_localize("Europe/Berlin"), np.array(["2026-05-04T09:00"], dtype="datetime64[s]"),
        [datetime.datetime(2026, 5, 4, 9)], pd.Series([NINE.to_pydatetime()], dtype=object), pd.DataFrame({"a": [NINE]}),
    ],
)  # fmt: skip
def test_moments_of_every_kind_are_the_same(values: Any) -> None:
    assert np.ravel(reading("min", values).moments(values, "ready")).tolist() == [540.0]


@pytest.mark.parametrize(
    "value", [pd.Timedelta("90min"), datetime.timedelta(minutes=90), np.timedelta64(5400, "s"), 90, 90.0, np.int64(90)]
)
def test_spans_of_every_kind_are_the_same(value: Any) -> None:
    assert Times("min").span(value, "service") == 90.0
    assert Times("min").spans(pd.Series([value]), "service").tolist() == [90.0]


def test_times_of_day_count_from_midnight() -> None:
    assert Times("h").moment(datetime.time(9, 30), "ready") == 9.5


@pytest.mark.parametrize(
    ("values", "kind"),
    [(pd.Series([NINE]), "timestamps"), (pd.Series([pd.Timedelta("1h")]), "timedeltas"), ([datetime.time(9)], "times of day")],
)
def test_nothing_is_converted_without_a_unit(values: Any, kind: str) -> None:
    with pytest.raises(
        InputError, match=f"column ready holds {kind}: say in which unit of time the problem counts; expected time_unit='min'"
    ):
        reading(None, values).moments(values, "column ready")


def test_texts_are_times_as_in_a_file() -> None:
    times = Times("min")
    texts = pd.Series(["2026-05-04T06:00", "07:30:00", "480", "", None])
    times.see(texts)
    assert times.origin == pd.Timestamp("2026-05-04")
    assert np.array_equal(times.moments(texts, "ready"), [360.0, 450.0, 480.0, np.nan, np.nan], equal_nan=True)
    spans = times.spans(pd.Series(["20min", "1h 5min", "00:20:00", ""]), "service")
    assert np.array_equal(spans, [20.0, 65.0, 20.0, np.nan], equal_nan=True)
    with pytest.raises(InputError, match="ready holds times of day: say in which unit of time"):
        Times(None).moment("06:00", "ready")


def test_what_is_no_time_says_what_is_one() -> None:
    with pytest.raises(InputError, match="column ready must be a number or a moment; expected 480, 08:00 or 2026-05-04T08:00"):
        Times("min").moments(pd.Series(["noon"]), "column ready")
    check_coded(InputError, "malformed", reading("min", [NINE]).span, NINE, "service")
    check_coded(InputError, "contradiction", reading, "min", [NINE], [NINE.tz_localize("UTC")])


@pytest.mark.parametrize("unit", ["minuts", "m", "ns", ""])
def test_a_unit_that_is_none_is_refused(unit: str) -> None:
    with pytest.raises(UsageError, check=coded("unknown-name")):
        Times(unit)


def test_a_clock_tells_moments_again() -> None:
    clock = reading("min", [NINE]).clock
    assert clock is not None and str(clock) == "min since 2026-05-04 00:00:00"
    assert clock.moments([540.0, math.inf])[0] == NINE and clock.moments([math.inf])[0] is pd.NaT
    assert Clock("h").moments([1.0, 2.0]) == [1.0, 2.0] and Times("h").clock == Clock("h") and Times(None).clock is None
    with pytest.raises(InputError, check=coded("malformed")):
        Clock("min", "noon")


@given(
    st.lists(st.datetimes(datetime.datetime(2000, 1, 1), datetime.datetime(2040, 1, 1)), min_size=1, max_size=6),
    st.sampled_from(sorted(SECONDS)),
)
def test_moments_come_back_to_the_second(moments: list[datetime.datetime], unit: str) -> None:
    whole = [m.replace(microsecond=0) for m in moments]
    times = reading(unit, whole)
    clock, numbers = times.clock, times.moments(pd.Series(whole, dtype="datetime64[ns]"), "ready")
    assert clock is not None and (numbers >= 0).all() and numbers.min() < 86400.0 / clock.seconds
    assert [m.to_pydatetime() for m in clock.moments(numbers.tolist())] == whole


@pytest.mark.parametrize(
    ("clock", "time", "told"),
    [
        (Clock("min"), 360.0, "360"),
        (Clock("min", of_day=True), 360.0, "06:00"),
        (Clock("min", of_day=True), 1080.5, "18:00:30"),
        (Clock("h", of_day=True), 24.0, "24:00"),
        (Clock("h", of_day=True), 25.5, "01:30 of day 2"),
        (Clock("s", of_day=True), 0.25, "00:00:00.250"),
        (Clock("min", of_day=True), math.inf, "inf"),
        (Clock("min", of_day=True), 1e12, "1e+12"),
        (Clock("min", "2026-05-04T00:00:00"), 390.0, "2026-05-04 06:30"),
        (Clock("min", "2026-05-04T00:00:00+02:00"), 390.0, "2026-05-04 06:30+02:00"),
    ],
)
def test_points_in_time_are_told_as_the_data_had_them(clock: Clock, time: float, told: str) -> None:
    assert clock.told(time) == moment_told(clock, time) == told


def test_times_of_day_make_a_clock_of_the_day_and_moments_one_of_the_calendar() -> None:
    times = Times("min")
    assert times.moment(datetime.time(6, 30), "ready") == 390.0
    assert times.clock == Clock("min", of_day=True) and str(times.clock) == "min since midnight"
    assert moment_told(None, 390.0) == "390"


@pytest.mark.parametrize(
    ("time", "text"),
    [(510.0, "08:30:00"), (510.61, "08:30:36.600"), (1590.0, "26:30:00"), (-30.0, "-00:30:00"), (0.0, "00:00:00"), (math.nan, None)],
)
def test_times_of_day_are_told_as_times_of_day_with_hours_counted_on_behind_midnight(time: float, text: str | None) -> None:
    assert Clock("min", of_day=True).moments([time]) == [text]
