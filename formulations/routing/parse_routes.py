"""Routes from what people write: lists of sites, one list per vehicle, or a table of visits with its times."""

from __future__ import annotations

import datetime
import itertools
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.clock import Clock
from ...instances.errors import UsageError
from ...instances.printable import printable
from ...instances.suggestions import did_you_mean
from ..references import indices_of
from .answers import Visits
from .routes import COLUMNS, Moments, Route, Routes, last_digit, table
from .schedule import schedule

if TYPE_CHECKING:
    import pandas as pd

    from .problem import RoutingProblem


_TIME_OF_DAY = re.compile(r"(-?)([0-9]{1,6}):([0-5][0-9])(?::([0-5][0-9](?:\.[0-9]+)?))?")

STEPS = (60_000_000_000, 1_000_000_000, 1_000_000)
FINEST = 1_000
"""Nanoseconds of what moments may be rounded to: minutes, seconds, milliseconds, else microseconds, for pandas makes spans of seconds that
are a nanosecond short."""


def stated_times(clock: Clock | None, columns: Mapping[str, Sequence[Any]]) -> tuple[list[Moments], float]:
    """Rows of arrival, begin and departure, in units of the data, and what their last digit counts; no rows where nothing is stated.

    ``columns`` has one value per visit by the titles ``arrival, begin, departure``; None, NaN, NaT or an empty text where nothing is
    stated. Raises UsageError for a value that is no time, or a moment where times have no origin.
    """
    numbers: list[float] = []
    spans: list[int] = []
    listed: dict[str, list[float | None]] = {}
    for title, values in columns.items():
        read: list[float | None] = []
        for value in values:
            moment = _read(clock, value, title)
            if isinstance(moment, float):
                numbers.append(moment)
                read.append(moment)
            else:
                spans += [] if moment is None else [moment]
                read.append(None if moment is None or clock is None else moment / 1e9 / clock.seconds)
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
    """Nanoseconds since time 0; a moment without a time zone, which workbooks cannot hold, is in that of the origin."""
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
        f"column {title} of the visits holds {printable(str(value), 40)!r}, which is no time; give numbers or moments, or leave it out",
        "malformed",
    )


_NUMBER = re.compile(r" [0-9]+\Z")

VEHICLE = ("vehicle", "route", "vehicle_id", "route_id")
SITE = ("site", "id", "customer", "node", "stop", "name")
ORDER = ("position", "order", "sequence", "stop_number", "arrival", "begin")
"""Titles of a table of visits, the best ones first."""


def routes_given(problem: RoutingProblem, given: Any) -> Routes:
    """``Routes``, or what says clearly which.

    A list of routes, each a ``Route`` or a list of site indices or ids, with or without the depot at its ends; such a list, or several,
    by the name of each vehicle or of its type; or a frame with the columns ``vehicle`` and ``site``, one row per visit, whose times
    ``arrival, begin, departure`` are stated with the routes (``timetable``) unless they are those of the judge. Raises UsageError for
    anything else, and for lists that do not say which of several vehicle types drives.
    """
    if isinstance(given, Routes):
        return given
    if hasattr(given, "columns") and hasattr(given, "groupby"):
        return _of_frame(problem, given)
    if isinstance(given, Mapping) and given.keys() == {"routes"} and _is_list(given["routes"]):
        given = given["routes"]
    if isinstance(given, Mapping):
        return _of_mapping(problem, given)
    listed: list[Any] = list(given) if isinstance(given, Iterable) and not isinstance(given, str | bytes) else [None]
    if all(isinstance(route, Route) for route in listed):
        return Routes.of(listed)
    if not all(_is_list(route) for route in listed):
        raise UsageError(f"{printable(repr(given), 80)} is no list of routes; Routes.of([[1, 2], [3]]) makes an answer", "malformed")
    if all(isinstance(route, Visits) for route in listed):
        return _routes_of(problem, [(_type(problem, route.vehicle), route) for route in listed])
    if len(problem.fleet) > 1:
        (name,) = problem.vehicle_names(Routes((Route(()),)))
        raise UsageError(
            f"lists do not say which of the {len(problem.fleet)} vehicle types drives a route; give {{{name!r}: [...]}}, one list a"
            " vehicle, or Route(visits, type)",
            "ambiguous",
        )
    return _routes_of(problem, [(0, route) for route in listed])


def _is_list(route: Any) -> bool:
    return isinstance(route, Sequence | np.ndarray) and not isinstance(route, str | bytes)


def _of_mapping(problem: RoutingProblem, routes_by_name: Mapping[Any, Any]) -> Routes:
    routes: list[tuple[int, Any]] = []
    for name, listed in routes_by_name.items():
        if not _is_list(listed):
            raise UsageError(
                f"the route of {printable(str(name), 40)} must be a list of sites, not {printable(repr(listed), 60)}", "malformed"
            )
        several = len(listed) > 0 and all(_is_list(part) for part in listed)
        kind = _type(problem, name)
        routes += [(kind, part) for part in listed] if several else [(kind, listed)]
    return _routes_of(problem, routes)


def _of_frame(problem: RoutingProblem, frame: Any) -> Routes:
    """Visits of a table by vehicle, and its times."""
    titles = {str(title).casefold(): title for title in frame.columns}
    site = next((titles[t] for t in SITE if t in titles), None)
    vehicle = next((titles[t] for t in VEHICLE if t in titles), None)
    order = next((titles[t] for t in ORDER if t in titles and not frame[titles[t]].isna().any()), None)  # else rows are in order
    if site is None or vehicle is None:
        lacking = "site" if site is None else "vehicle"
        raise UsageError(
            f"a table of visits needs the column {lacking!r}{did_you_mean(lacking, titles)}; it has {', '.join(map(str, frame.columns))}",
            "missing",
        )
    if frame[[site, vehicle]].isna().to_numpy().any():
        raise UsageError(f"a table of visits has a row without {site} or {vehicle}", "missing")
    rows = frame if order is None else frame.sort_values([order], kind="stable")
    times, digit = stated_times(problem.clock, {title: rows[titles[title]].tolist() for title in COLUMNS if title in titles})
    by_vehicle: dict[Any, tuple[list[str], list[Moments]]] = {}
    for at, (name, visit) in enumerate(zip(rows[vehicle].tolist(), rows[site].tolist(), strict=True)):
        visits, stated = by_vehicle.setdefault(name, ([], []))
        visits.append(str(int(visit)) if isinstance(visit, float) and visit.is_integer() else str(visit))
        stated.append(times[at] if times else (None, None, None))
    alike = len(problem.fleet) == 1
    kinds = [0 if alike else _type(problem, name) for name in by_vehicle]
    return _routes_of(
        problem, list(zip(kinds, (v for v, _ in by_vehicle.values()), strict=True)), [s for _, s in by_vehicle.values()], digit
    )


def _type(problem: RoutingProblem, name: Any) -> int:
    """Type of a vehicle: the name of a type, with a number behind it or without, or its index."""
    names = {v.name: k for k, v in enumerate(problem.fleet)}
    text = str(name)
    if text in names:
        return names[text]
    short = _NUMBER.sub("", text)
    if short in names:
        return names[short]
    led = [k for name, k in names.items() if name.lstrip() == short]  # files lose the blanks before a name
    if len(led) == 1:
        return led[0]
    if len(names) == 1 and (isinstance(name, int) or text.isdigit()):
        return 0
    raise UsageError(
        f"there is no vehicle {printable(text, 60)!r}{did_you_mean(short, names)}; the types are {', '.join(names)}", "unknown-name"
    )


def _routes_of(
    problem: RoutingProblem, routes: Sequence[tuple[int, Any]], times: Sequence[Sequence[Moments]] = (), digit: float = 0.0
) -> Routes:
    named = [[str(v) if isinstance(v, np.str_) else v for v in route] for _, route in routes]
    sites = indices_of(itertools.chain.from_iterable(named), problem.sites.index(), "site")
    ends, parsed = itertools.accumulate(map(len, named), initial=0), []
    for number, ((kind, _), (first, last)) in enumerate(zip(routes, itertools.pairwise(ends), strict=True)):
        visits, vehicle = sites[first:last], problem.fleet[kind]
        begin, end = 0, len(visits)
        while begin < end and visits[begin] == vehicle.start:
            begin += 1
        while end > begin and visits[end - 1] == vehicle.end:
            end -= 1
        timetable = table(times[number], digit, begin, end) if times else None
        parsed.append(without_usual_times(problem, Route(tuple(visits[begin:end]), kind, timetable)))
    return Routes.of(parsed)


def without_usual_times(problem: RoutingProblem, route: Route) -> Route:
    """The route without its timetable where this states no more than the judge's own schedule."""
    if route.timetable is None:
        return route
    plain = Route(route.visits, route.vehicle)
    plan = schedule(problem, plain)
    arrival, begin, ends = ([plan.departure, *inner, plan.finish] for inner in (plan.arrival, plan.begin, plan.ends))
    return plain if route.timetable.tells(np.array(arrival), np.array(begin), np.array(ends)) else route
