"""Features of a problem for which the checkers of this family know that what they prove still holds.

Whatever is not named here proves nothing: a checker that ignores a feature may only ever be too modest. Of those named:

``skills, several-windows, closing-moves, several-loads, pickups, shipments, initial-energy, forbidden-moves, route-risk, team-risk``
    Forbid routes that would be possible without them, and are left out. Several windows are one from the first opening to the last close;
    a vehicle leaves with all that it delivers, whatever it picks up, so that the demands on a route are within the capacity. Risks are 1/2
    at most, so that limits hold for the means of durations (``uncertain-durations``); ``route_limits`` takes them up.
``groups, penalties, rewards``
    Members of groups and sites with a penalty are optional: what is proved of required sites holds, sums over all sites prove nothing.
``duration-cost, overtime, committed-vehicles``
    Add costs that are not negative. Vehicles that serve no site are no routes and do not count.
``shifts``
    Taken up: the earliest departure and the latest return are those of vehicle and depot together.
``vehicle-speeds, vehicle-travel``
    Taken up where one vehicle is looked at; where vehicles are merged, a move is the shortest of any of them.

``reloads`` and ``recharging`` are missing: loads and energy start anew at depots on the way, and ways lead through them. Some checkers take
the problem ``without_stops`` instead (``stops_on_the_way``).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....instances.errors import InputError
from ...evidence import CHECKERS

if TYPE_CHECKING:
    from ....instances.routing.vehicle_type import VehicleType
    from ..problem import RoutingProblem

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Longs = NDArray[np.int64]
Check = Callable[["RoutingProblem", Mapping[str, Any]], float]

RESOURCES = ("time", "load", "distance", "duration", "energy")
"""Resources that evidence may name."""

EPS = float(np.finfo(np.float64).eps)

KNOWN = frozenset(
    {
        "capacity", "demands", "time-windows", "depot-windows", "service-times", "demand-or-service-of-depots", "rewards", "optional-sites",
        "limited-fleet", "min-vehicles", "heterogeneous-fleet", "multiple-depots", "open-routes", "max-duration", "max-distance",
        "energy:travel", "energy:elapsed", "energy:elapsed-fixed-start", "energy:windows", "fixed-cost", "unit-cost", "separate-durations",
        "duration-cost", "overtime", "shifts", "vehicle-speeds", "vehicle-travel", "several-loads", "pickups", "shipments", "groups",
        "several-windows", "skills", "penalties", "initial-energy", "closing-moves", "committed-vehicles", "forbidden-moves",
        "uncertain-durations", "route-risk", "team-risk",
    }
)  # fmt: skip


def routing_evidence(kind: str, subject: str = "") -> Callable[[Check], Check]:
    """Register a checker of routing problems; what it returns is the bound of a minimisation, -inf where nothing is proved."""

    def register(check: Check) -> Check:
        @functools.wraps(check)
        def checked(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
            if problem.family != "routing":
                raise InputError(f"{subject or f'{kind} is'} evidence for routing problems", found=problem.family)
            return check(problem, data) * (1.0 if problem.sense == "min" else -1.0)

        CHECKERS.add(kind, checked)
        return checked

    return register


def refuse_unknown_resources(names: Any, known: tuple[str, ...], shown: str) -> None:
    """Raise InputError for evidence that names a resource which is not known."""
    if not set(names) <= set(known):
        raise InputError("evidence names an unknown resource", expected=", ".join(known), found=shown[:80])


def unknown_features(problem: RoutingProblem) -> frozenset[str]:
    """Features of the data under which nothing is proved; those of the objective are for each checker to say."""
    return frozenset(name for name in problem.features() - KNOWN if not name.startswith("objective:"))


def own_moves(problem: RoutingProblem, vehicle: VehicleType) -> tuple[Floats, Floats]:
    """Distances and durations of all moves of a vehicle, shape (sites, sites)."""
    travel = problem.travel if vehicle.travel is None else vehicle.travel
    return travel.distances, travel.durations if vehicle.speed == 1.0 else travel.durations / vehicle.speed


def own_variances(problem: RoutingProblem, vehicle: VehicleType) -> Floats:
    """Variances of the durations of all moves of a vehicle, shape (sites, sites)."""
    travel = problem.travel if vehicle.travel is None else vehicle.travel
    return np.zeros((len(travel),) * 2) if travel.variances is None else travel.variances / vehicle.speed**2


def least_moves(problem: RoutingProblem) -> tuple[Floats, Floats]:
    """The shortest distance and duration of each move over all vehicles, shape (sites, sites)."""
    if all(v.travel is None and v.speed == 1.0 for v in problem.fleet):
        return problem.travel.distances, problem.travel.durations
    pairs = [own_moves(problem, v) for v in problem.fleet]
    return np.minimum.reduce([d for d, _ in pairs]), np.minimum.reduce([t for _, t in pairs])


def earliest_levels(first: Floats, between: Floats, ready: Floats | float = -math.inf, due: Floats | float = math.inf) -> Floats:
    """Least level at each node of all ways that begin with a move of ``first`` and meet every window on them (Bellman-Ford).

    A level is raised to ``ready``; infinite where no way arrives at ``due`` or below.
    """
    level = np.where(first > due, math.inf, np.maximum(first, ready))
    for _ in range(len(first)):
        arrival = (level[:, None] + between).min(axis=0)
        better = np.minimum(level, np.where(arrival > due, math.inf, np.maximum(arrival, ready)))
        if (better >= level).all():
            break
        level = better
    return level


def departure(problem: RoutingProblem, vehicle: VehicleType) -> float:
    """Earliest departure of a vehicle."""
    return max(float(problem.sites.ready[vehicle.start]), vehicle.shift[0])


def last_return(problem: RoutingProblem, vehicle: VehicleType) -> float:
    """Latest return of a vehicle."""
    return min(float(problem.sites.due[vehicle.end]), vehicle.shift[1])
