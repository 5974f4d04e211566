"""Times in tables of visits."""

from __future__ import annotations

import datetime
import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from waybound.formulations.routing.stated_times import stated_times
from waybound.instances.clock import Clock
from waybound.instances.errors import UsageError

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
