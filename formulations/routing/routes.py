"""The answer of every routing problem, a list of routes, and the timetables that somebody may state with them.

Part of the judge. A stated time counts as rounded to the last digit that any time of its table has. Where all times of a route are those
of the judge's own schedule, so rounded, that schedule is meant. Else the vehicle departs and goes on exactly when the table says, or as
soon as it can, and every time of the table that does not come of this is a violation.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

from ...instances.errors import InputError
from ...instances.number_arrays import Flags as Flags, Floats as Floats, Integers as Integers
from ...instances.printable import printable
from ..tolerance import ROUNDING

Moments = tuple[float | None, ...]


class Astray(NamedTuple):
    """A stated time that does not go with the data: at which stop, 0 being the start, and what happens there when."""

    stop: int
    what: str
    stated: float
    found: float


@dataclass(frozen=True)
class Timetable:
    """The stated times of one route; None where none are stated.

    ``arrival``, ``begin`` and ``ends`` have one entry per stop between start and end: when it is reached, when service begins there, and
    when the vehicle leaves it; ``departure`` is from the start, ``finish`` the return. Each time may be off by half of what its last
    ``digit`` counts.
    """

    arrival: Moments
    begin: Moments
    ends: Moments
    departure: float | None = None
    finish: float | None = None
    digit: float = 0.0

    def leaves(self, first: float, own: float) -> float:
        """Departure of the vehicle, whose first move lasts ``first``; ``own`` where nothing is stated."""
        if self.departure is not None:
            return self.departure
        return own if not self.arrival or self.arrival[0] is None else self.arrival[0] - first

    def tells(self, arrival: Floats, begin: Floats, ends: Floats) -> bool:
        """Whether it is this schedule, rounded; arrays have an entry for start and end too."""
        slack = 0.5 * self.digit * (1.0 + 1e-9) + self._noise(arrival)
        return all(abs(one.stated - one.found) <= slack for one in self._pairs(arrival, begin, ends))

    def astray(self, arrival: Floats, begin: Floats, ends: Floats) -> tuple[Astray, ...]:
        """Times that differ from those of a route driven by this timetable by a whole last digit.

        Half of one is the rounding of the time itself, and less than half that of the one before.
        """
        noise, most = self._noise(arrival), self.digit * (1.0 - 1e-9)
        return tuple(one for one in self._pairs(arrival, begin, ends) if not abs(one.stated - one.found) <= max(noise, most))

    def _pairs(self, arrival: Floats, begin: Floats, ends: Floats) -> Iterator[Astray]:
        last = len(arrival) - 1
        if self.departure is not None:
            yield Astray(0, "leaves", self.departure, float(begin[0]))
        for what, stated, times in (("reaches", self.arrival, arrival), ("begins at", self.begin, begin), ("leaves", self.ends, ends)):
            for k, moment in enumerate(stated, start=1):
                if moment is not None:
                    yield Astray(k, what, moment, float(times[k]))
        if self.finish is not None:
            yield Astray(last, "returns to", self.finish, float(arrival[last]))

    def _noise(self, arrival: Floats) -> float:
        return ROUNDING * (len(arrival) + 2) * float(np.abs(arrival).max())

    def to_json(self) -> dict[str, Any]:
        """The keys that something is stated for, in units of the data."""
        data = {key: list(getattr(self, key)) for key in COLUMNS.values()}
        columns = {key: moments for key, moments in data.items() if any(moment is not None for moment in moments)}
        ends = {key: moment for key in ("departure", "finish") if (moment := getattr(self, key)) is not None}
        return {**ends, **columns, "digit": self.digit}

    @classmethod
    def from_json(cls, data: Any, stops: int, path: str) -> Timetable:
        """Inverse of ``to_json``; raises InputError for anything else."""
        known = {"departure", "finish", "digit", *COLUMNS.values()}
        if not isinstance(data, dict) or not data.keys() <= known:
            raise InputError(f"{path} must be an object with some of the keys {', '.join(sorted(known))}", found=printable(str(data), 60))

        def real(value: Any, key: str) -> float | None:
            if value is None:
                return None
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise InputError(f"{path}.{key} must be a finite number", "out-of-range", found=printable(str(value), 40))
            return float(value)

        def listed(key: str) -> Moments:
            values = data.get(key, [None] * stops)
            if not isinstance(values, list) or len(values) != stops:
                found = printable(str(values), 60)
                raise InputError(f"{path}.{key} must be a list with one time a visit", "wrong-shape", expected=str(stops), found=found)
            return tuple(real(value, f"{key}[{k}]") for k, value in enumerate(values))

        digit = real(data.get("digit"), "digit") or 0.0
        if digit < 0.0:
            raise InputError(f"{path}.digit must be at least 0", "out-of-range", found=f"{digit:g}")
        return cls(
            listed("arrival"),
            listed("begin"),
            listed("ends"),
            real(data.get("departure"), "departure"),
            real(data.get("finish"), "finish"),
            digit,
        )


COLUMNS = {"arrival": "arrival", "begin": "begin", "departure": "ends"}
"""The field of a timetable that each column of a table of visits states."""


def last_digit(times: Iterable[float | None]) -> float:
    """Amount that the last digit of any of these numbers counts, 1 at most."""
    digits = [Decimal(repr(float(t))).normalize().as_tuple().exponent for t in times if t is not None]
    return 10.0 ** min([0, *(d for d in digits if isinstance(d, int))])


def table(rows: Sequence[Moments], digit: float, first: int, last: int) -> Timetable | None:
    """The timetable of one route; None where nothing is stated.

    Rows hold arrival, begin and departure, one a visit and perhaps one a depot at its ends, the visits being those from ``first`` up to
    ``last``.
    """
    if all(moment is None for row in rows for moment in row):
        return None
    arrival, begin, ends = zip(*rows[first:last], strict=True)
    before, after = rows[:first], rows[last:]
    return Timetable(arrival, begin, ends, before[-1][2] if before else None, after[0][0] if after else None, digit)


@dataclass(frozen=True)
class Route:
    """One vehicle's visits.

    Parameters
    ----------
    visits : tuple of int
        Site indices in order, without the depots at both ends. Depots between are stops to reload or to recharge: a route of several
        trips is one list, and of alternatives the list holds the one that is chosen.
    vehicle : int
        Index of the vehicle type in the fleet.
    timetable : Timetable, optional
        When it is driven, where somebody states that; else on the schedule of the judge.
    """

    visits: tuple[int, ...]
    vehicle: int = 0
    timetable: Timetable | None = None

    def __len__(self) -> int:
        return len(self.visits)


@dataclass(frozen=True)
class Routes:
    """All routes that are driven; vehicles that stay at home have none.

    Parameters
    ----------
    routes : tuple of Route
        Their order means nothing.
    """

    routes: tuple[Route, ...]

    @classmethod
    def of(cls, routes: Iterable[Sequence[int] | Route]) -> Routes:
        """Routes from sequences of site indices; empty ones are dropped.

        Parameters
        ----------
        routes : iterable of sequences of int, or of Route
            Site indices in the order of the visits, without the depots at both ends.
        """
        parts = (r if isinstance(r, Route) else Route(tuple(int(i) for i in r)) for r in routes)
        return cls(tuple(r for r in parts if r.visits))

    def __iter__(self) -> Iterator[Route]:
        return iter(self.routes)

    def __len__(self) -> int:
        return len(self.routes)

    def untimed(self) -> Routes:
        """The same routes without stated timetables."""
        return Routes(tuple(r if r.timetable is None else replace(r, timetable=None) for r in self.routes))

    def canonical(self) -> Routes:
        """The same routes in order of vehicle type and first visit, so that equal answers compare equal."""
        return Routes(tuple(sorted(self.routes, key=lambda r: (r.vehicle, r.visits))))
