"""Times in tables of visits: numbers, moments, times of day, and their texts in files."""

from __future__ import annotations

import datetime
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.clock import Clock
from ...instances.errors import UsageError
from ...instances.printable import printable
from .timetable import COLUMNS, Moments, last_digit

if TYPE_CHECKING:
    import pandas as pd

_TIME_OF_DAY = re.compile(r"(-?)([0-9]{1,6}):([0-5][0-9])(?::([0-5][0-9](?:\.[0-9]+)?))?")

STEPS = (60_000_000_000, 1_000_000_000, 1_000_000)
FINEST = 1_000
"""Nanoseconds of what moments may be rounded to: minutes, seconds, milliseconds, else microseconds, for pandas makes spans of seconds that
are a nanosecond short."""


def stated_times(clock: Clock | None, columns: Mapping[str, Sequence[Any]]) -> tuple[list[Moments], float]:
    """Rows of arrival, begin and departure, in units of the data, and what their last digit counts; no rows where nothing is stated.

    Parameters
    ----------
    clock : Clock, optional
        What times count, without which there are numbers alone.
    columns : mapping
        By the titles ``arrival, begin, departure``, any of them: one value a visit; None, NaN, NaT or an empty text where nothing is
        stated.

    Raises
    ------
    UsageError
        For a value that is no time, or a moment where times have no origin.
    """
    numbers: list[float] = []
    spans: list[int] = []
    listed: dict[str, list[float | None]] = {}
    for title, values in columns.items():
        read: list[float | None] = []
        for value in values:
            found = _read(clock, value, title)
            if isinstance(found, float):
                numbers.append(found)
                read.append(found)
            else:
                spans += [] if found is None else [found]
                read.append(None if found is None or clock is None else found / 1e9 / clock.seconds)
        listed[title] = read
    if not numbers and not spans:
        return [], 0.0
    rows = max(map(len, listed.values()))
    digit = last_digit(numbers) if numbers else 0.0
    if spans and clock is not None:
        step = next((step for step in STEPS if all(span % step == 0 for span in spans)), FINEST)
        digit = max(digit, step / 1e9 / clock.seconds)
    return list(zip(*(listed.get(title, [None] * rows) for title in COLUMNS), strict=True)), digit


def _read(clock: Clock | None, value: Any, title: str) -> float | int | None:
    """A number, or whole nanoseconds since time 0; None where it is missing."""
    import pandas as pd

    if value is None or (isinstance(value, str) and not value.strip()) or (not isinstance(value, str) and pd.isna(value)):
        return None
    if isinstance(value, bool):
        raise _no_time(value, title)
    if isinstance(value, int | float | np.integer | np.floating):
        return _finite(float(value), value, title)
    if isinstance(value, datetime.timedelta | np.timedelta64):
        _need(clock, value, title)
        return int(pd.Timedelta(value).value)
    if isinstance(value, datetime.time):
        value = value.isoformat()
    if isinstance(value, str):
        text = value.strip()
        try:
            return _finite(float(text), value, title)
        except ValueError:
            pass
        if matched := _TIME_OF_DAY.fullmatch(text):
            _need(clock, value, title)
            sign, hours, minutes, seconds = matched.groups(default="0")
            since = (int(hours) * 3600 + int(minutes) * 60) * 1_000_000_000 + round(float(seconds) * 1e9)
            return -since if sign else since
    try:
        moment = pd.Timestamp(value)
    except (TypeError, ValueError):
        raise _no_time(value, title) from None
    return _since(clock, moment, title)


def _since(clock: Clock | None, moment: pd.Timestamp, title: str) -> int:
    """Of moments without a time zone it is that of the origin, which workbooks cannot hold."""
    _need(clock, moment, title)
    start = None if clock is None else clock.midnight
    if start is None:
        raise UsageError(f"column {title} of the visits holds moments ({moment}), and the problem does not know which moment is time 0")
    if start.tzinfo is not None and moment.tzinfo is None:
        moment = moment.tz_localize(start.tzinfo)
    elif start.tzinfo is None and moment.tzinfo is not None:
        raise UsageError(f"column {title} of the visits has a time zone ({moment}), and the times of the problem have none")
    return int((moment - start).value)


def _finite(number: float, value: Any, title: str) -> float:
    if not abs(number) < float("inf"):
        raise _no_time(value, title)
    return number


def _need(clock: Clock | None, value: Any, title: str) -> None:
    if clock is None:
        raise UsageError(
            f"column {title} of the visits holds {printable(str(value), 40)!r}, and the problem has no unit of time: give numbers"
        )


def _no_time(value: Any, title: str) -> UsageError:
    return UsageError(
        f"column {title} of the visits holds {printable(str(value), 40)!r}, which is no time; give numbers or moments, or leave it out"
    )
