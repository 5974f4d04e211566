"""Units of time: how timestamps and timedeltas become the numbers that a problem counts in, and back.

Nothing is converted without a unit that the user named: a timestamp is a number of nanoseconds to pandas and of microseconds to others.
"""

import contextlib
import datetime
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError, UsageError
from .number_arrays import Floats
from .suggestions import did_you_mean
from .text import is_number, shown

if TYPE_CHECKING:
    import pandas as pd


SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
"""Seconds of each unit."""

ALIASES = {
    "sec": "s", "second": "s", "seconds": "s", "minute": "min", "minutes": "min", "hour": "h", "hours": "h", "day": "d", "days": "d",
}  # fmt: skip


DAY = datetime.timedelta(days=1)

_DAY = re.compile(r"\d{4}-\d\d-\d\d")
_CLOCK = re.compile(r"(\d{1,2}):(\d\d)(?::(\d\d(?:\.\d{1,6})?))?\Z")
_SPAN = re.compile(r"(?:(\d{1,6}) days?,? )?(\d{1,6}):(\d\d):(\d\d(?:\.\d{1,9})?)\Z")
_PARTS = re.compile(r"(\d+(?:\.\d+)?)\s*([a-z]+)")


@dataclass(frozen=True)
class Clock:
    """The unit and the origin of a problem's times.

    ``unit``: ``s, min, h`` or ``d``. ``origin``: the moment that is time 0, as ISO 8601; "" where times are not those of a calendar.
    ``of_day``: whether time 0 is midnight of any day: times were told as times of day, such as 08:00.
    """

    unit: str
    origin: str = ""
    of_day: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "unit", unit_named(self.unit))
        if self.origin:
            try:
                datetime.datetime.fromisoformat(self.origin)
            except ValueError:
                raise InputError(
                    "the origin of time is no moment", expected="ISO 8601, as 2026-05-04T00:00:00", found=self.origin
                ) from None

    @property
    def seconds(self) -> float:
        """Seconds of one unit."""
        return SECONDS[self.unit]

    @property
    def midnight(self) -> "pd.Timestamp | None":
        """The origin."""
        import pandas as pd

        return pd.Timestamp(self.origin) if self.origin else None

    def moments(self, times: Iterable[float]) -> list[Any]:
        """Timestamps of times, whole milliseconds; texts of times of day, hours counted on behind midnight; else times themselves."""
        import pandas as pd

        if self.of_day:
            return [_hours(t * self.seconds) if math.isfinite(t) else None for t in times]
        start = self.midnight
        if start is None:
            return list(times)
        return [start + pd.Timedelta(round(1000.0 * t * self.seconds), unit="ms") if math.isfinite(t) else pd.NaT for t in times]

    def told(self, time: float, digits: int = 6) -> str:
        """A point in time as its data had it: a moment, a time of day with the day if it is a later one, else a number."""
        if not math.isfinite(time) or not (self.origin or self.of_day) or abs(time) * self.seconds > _CENTURIES:
            return f"{time:.{digits}g}"
        start = datetime.datetime.fromisoformat(self.origin) if self.origin else datetime.datetime(2000, 1, 1)
        moment = start + datetime.timedelta(milliseconds=round(time * self.seconds * 1000))
        parts = "milliseconds" if moment.microsecond else "seconds" if moment.second else "minutes"
        if self.origin:
            return moment.isoformat(" ", parts)
        day, clock = (moment - start).days, moment.time().isoformat(parts)
        return clock if day == 0 else "24:00" if moment == start + datetime.timedelta(days=1) else f"{clock} of day {day + 1}"

    def __str__(self) -> str:
        since = f" since {self.origin.replace('T', ' ')}" if self.origin else " since midnight" if self.of_day else ""
        return f"{self.unit}{since}"


def _hours(seconds: float) -> str:
    """``08:30:00``, with milliseconds where there are any."""
    minutes, milliseconds = divmod(round(1000.0 * abs(seconds)), 60_000)
    rest = f"{milliseconds // 1000:02d}.{milliseconds % 1000:03d}".removesuffix(".000")
    sign = "-" if seconds < 0 and minutes + milliseconds else ""
    return f"{sign}{minutes // 60:02d}:{minutes % 60:02d}:{rest}"


_CENTURIES = 200 * 366 * 86400
"""Seconds from time 0 on that a calendar is asked for."""


def moment_told(clock: Clock | None, time: float, digits: int = 6) -> str:
    """``Clock.told``; the number where there is no clock."""
    return f"{time:.{digits}g}" if clock is None else clock.told(time, digits)


def unit_named(name: object) -> str:
    """The short name of a unit of time; raises UsageError for what is none."""
    text = str(name)
    if text in SECONDS or text in ALIASES:
        return ALIASES.get(text, text)
    raise UsageError(f"unknown unit of time {text!r}; choose from {', '.join(SECONDS)}{did_you_mean(text, ALIASES)}", "unknown-name")


def moment_of(cell: str, line: int | None, what: str) -> Any:
    """Read a point in time from a text: a number, a time of day, or a timestamp; None if it is empty."""
    if not cell:
        return None
    if is_number(cell):
        return float(cell)
    try:
        if _DAY.match(cell):
            return datetime.datetime.fromisoformat(cell)
        if match := _CLOCK.match(cell):
            hours, minutes, seconds = int(match[1]), int(match[2]), float(match[3] or 0)
            whole = datetime.timedelta(hours=hours, minutes=minutes, seconds=seconds)
            if whole <= DAY and minutes < 60 and seconds < 60:
                return whole if whole == DAY else (datetime.datetime.min + whole).time()
    except ValueError:
        pass
    raise InputError(f"{what} must be a number or a moment", line=line, expected="480, 08:00 or 2026-05-04T08:00", found=shown(cell))


def span_of(cell: str, line: int | None, what: str) -> Any:
    """Read a length of time from a text: a number or a timedelta; None if it is empty."""
    if not cell:
        return None
    if is_number(cell):
        return float(cell)
    with contextlib.suppress(OverflowError):  # longer than any calendar
        if match := _SPAN.match(cell):
            days, hours, minutes, seconds = int(match[1] or 0), int(match[2]), int(match[3]), float(match[4])
            return datetime.timedelta(days=days, hours=hours, minutes=minutes, seconds=seconds)
        parts = _PARTS.findall(cell.lower())
        units = [ALIASES.get(unit, unit) for _, unit in parts]
        if parts and not _PARTS.sub("", cell.lower()).strip() and set(units) <= SECONDS.keys():
            return datetime.timedelta(seconds=sum(float(size) * SECONDS[unit] for (size, _), unit in zip(parts, units, strict=True)))
    raise InputError(
        f"{what} must be a number or a length of time", line=line, expected="20, 20min, 1h 30min or 00:20:00", found=shown(cell)
    )


class Times:
    """Reads columns, numbers and texts that may be moments or spans of time.

    ``unit``: in which the problem counts; moments and spans are refused without one.

    Time 0 is midnight of the first day that any moment falls on, in its own time zone: ``see`` all of them before the first is read.
    """

    def __init__(self, unit: str | None) -> None:
        self.unit = None if unit is None else unit_named(unit)
        self._first: Any = None
        self._of_day = False

    def see(self, values: Any) -> None:
        """Let moments among ``values`` (a column, a list, one value) count for the origin."""
        import pandas as pd

        for value in _flat(values):
            if isinstance(value, str):
                value = moment_of(value.strip(), None, "a time") if _DAY.match(value.strip()) else None
            if _is_moment(value) and value is not pd.NaT:
                moment = pd.Timestamp(value)
                if self._first is not None and (moment.tzinfo is None) != (self._first.tzinfo is None):
                    raise InputError("some timestamps have a time zone and others none", "contradiction",
                                     expected="all or none: tz_localize or tz_convert")  # fmt: skip
                self._first = moment if self._first is None or moment < self._first else self._first

    @property
    def origin(self) -> Any:
        """Time 0; None where no moment was seen."""
        return None if self._first is None else self._first.normalize()

    @property
    def clock(self) -> Clock | None:
        """The clock of all times read so far; None where no unit was named."""
        if self.unit is None:
            return None
        return Clock(self.unit, "" if self.origin is None else self.origin.isoformat(), self._of_day and self.origin is None)

    def moment(self, value: Any, what: str) -> float:
        """A point in time as a number; NaN where it is missing."""
        import pandas as pd

        if isinstance(value, str):
            value = moment_of(value.strip(), None, what)
        if value is None or value is pd.NaT:
            return math.nan
        if _is_moment(value):
            return float((pd.Timestamp(value) - self.origin).total_seconds()) / self._seconds(what, "timestamps")
        if isinstance(value, datetime.time):
            self._of_day = True
            return (value.hour * 3600 + value.minute * 60 + value.second + value.microsecond / 1e6) / self._seconds(what, "times of day")
        return self.span(value, what)

    def span(self, value: Any, what: str) -> float:
        """A length of time as a number; NaN where it is missing."""
        import pandas as pd

        if isinstance(value, str):
            value = span_of(value.strip(), None, what)
        if value is None or value is pd.NaT:
            return math.nan
        if isinstance(value, datetime.timedelta | np.timedelta64):
            return pd.Timedelta(value).total_seconds() / self._seconds(what, "timedeltas")
        if isinstance(value, bool) or _is_moment(value):
            raise InputError(
                f"{what} must be a length of time", expected=f"a number of {self.unit or 'units'} or a timedelta", found=str(value)
            )
        try:
            return float(value)
        except (TypeError, ValueError):
            raise InputError(f"{what} must hold numbers or times", found=repr(value)[:60]) from None

    def moments(self, values: Any, what: str) -> Floats:
        """Points in time, of any shape."""
        return self._all(values, what, self.moment)

    def spans(self, values: Any, what: str) -> Floats:
        """Lengths of time, of any shape."""
        return self._all(values, what, self.span)

    def _all(self, values: Any, what: str, read: Any) -> Floats:
        array = values.to_numpy() if hasattr(values, "to_numpy") else np.asarray(values)
        if array.dtype.kind in "iuf":
            return np.array(array, dtype=np.float64)
        if array.dtype.kind in "mM":  # numpy would hand over whole numbers of nanoseconds
            import pandas as pd

            flat = pd.Series(array.ravel())
            return np.array([read(v, what) for v in flat], dtype=np.float64).reshape(array.shape)
        return np.array([read(v, what) for v in array.ravel().tolist()], dtype=np.float64).reshape(array.shape)

    def _seconds(self, what: str, found: str) -> float:
        if self.unit is None:
            raise InputError(f"{what} holds {found}: say in which unit of time the problem counts", "missing",
                             expected="time_unit='min', or s, h, d", found="no time_unit")  # fmt: skip
        return SECONDS[self.unit]


def _is_moment(value: Any) -> bool:
    return isinstance(value, datetime.datetime | np.datetime64)


def _flat(values: Any) -> Iterator[Any]:
    """Single values of a column, a frame, nested lists or one value; columns of numbers have no moments."""
    if getattr(getattr(values, "dtype", None), "kind", "O") in "iufbm":
        return
    if isinstance(values, str) or not isinstance(values, Iterable):
        yield values
        return
    frame: Any = values
    for part in [frame[title] for title in frame.columns] if hasattr(frame, "columns") else values:
        yield from _flat(part)
