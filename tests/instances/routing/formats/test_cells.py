"""Cells of tables."""

from __future__ import annotations

import datetime
from typing import Any

import pytest

from waybound.instances.errors import InputError
from waybound.instances.routing.formats._cells import flag, kept, moment, span

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
    assert moment(cell, 3, "ready") == meant


@pytest.mark.parametrize(
    ("cell", "meant"),
    [
        ("", None), ("20", 20.0), ("20min", HOUR / 3), ("1h 30min", 1.5 * HOUR), ("90 Minutes", 1.5 * HOUR), ("0.5 h", HOUR / 2),
        ("00:20:00", HOUR / 3), ("0 days 00:20:00", HOUR / 3), ("1 day, 0:00:00.5", 24 * HOUR + datetime.timedelta(seconds=0.5)),
    ],
)  # fmt: skip
def test_lengths_of_time(cell: str, meant: Any) -> None:
    assert span(cell, 3, "service") == meant


@pytest.mark.parametrize("cell", ["noon", "25:00", "24:01", "08:60", "2026-13-04", "2026-05-04T25:00", "-08:00", "1_0"])
def test_what_is_no_moment_is_refused(cell: str) -> None:
    with pytest.raises(InputError, match="line 3: ready must be a number or a moment"):
        moment(cell, 3, "ready")


@pytest.mark.parametrize(
    "cell", ["00:20", "20 fortnights", "min", "1h and 5min", "2026-05-04", "-20min", "999999999999h", "9" * 400 + "min"]
)
def test_what_is_no_length_of_time_is_refused(cell: str) -> None:
    """Hours and minutes with a colon may be minutes and seconds as well."""
    with pytest.raises(InputError, match="line 3: service must be a number or a length of time"):
        span(cell, 3, "service")


def test_flags_and_what_is_only_kept() -> None:
    assert [flag(cell, 1, "depot") for cell in ("yes", "FALSE", "")] == [True, False, None]
    assert kept(["1", "", "-2.5"]) == [1, None, -2.5] and kept(["007", "8"]) == ["007", "8"] and kept(["1", "x"]) == ["1", "x"]
