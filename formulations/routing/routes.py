"""The answer of every routing problem: a list of routes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from .timetable import Timetable


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
    """All routes that are driven; vehicles that stay at home have none."""

    routes: tuple[Route, ...]

    @classmethod
    def of(cls, routes: Iterable[Sequence[int] | Route]) -> Routes:
        """Routes from sequences of site indices; empty ones are dropped."""
        made = (r if isinstance(r, Route) else Route(tuple(int(i) for i in r)) for r in routes)
        return cls(tuple(r for r in made if r.visits))

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
