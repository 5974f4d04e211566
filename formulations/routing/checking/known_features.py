"""Features of a problem for which the checkers of this family know that what they prove still holds.

Whatever is not named here proves nothing: a checker that ignores a feature may only ever be too modest. What each does to the checkers:
docs/formulations/routing.md#what-the-checkers-make-of-the-features. ``reloads`` and ``recharging`` are missing: loads and energy start anew
at depots on the way, and ways lead through them. Some checkers take the problem ``without_stops`` instead: it has every answer of the
problem, at no more cost.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ....instances.number_arrays import Flags as Flags, Floats as Floats, Integers as Integers
from ....instances.routing.travel import EXPLICIT, Travel
from ...evidence import checker

if TYPE_CHECKING:
    from ....instances.routing.vehicle_type import VehicleType
    from ..problem import RoutingProblem

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
        @checker(kind, "routing", subject or f"{kind} is")
        @functools.wraps(check)
        def checked(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
            return check(problem, data) * (1.0 if problem.sense == "min" else -1.0)

        return checked

    return register


def refuse_unknown_resources(names: Any, known: tuple[str, ...], shown: str) -> None:
    """Raise InputError for evidence that names a resource which is not known."""
    if not set(names) <= set(known):
        raise InputError("evidence names an unknown resource", "unknown-name", expected=", ".join(known), found=shown[:80])


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


def with_fleet(problem: RoutingProblem, fleet: Sequence[VehicleType], travel: Travel | None = None) -> RoutingProblem:
    """The same problem with other vehicles."""
    return problem.altered(fleet=tuple(fleet), travel=travel or problem.travel)


def explicit(distances: Floats, durations: Floats) -> Travel:
    """Travel along matrices as they are, whatever the convention of the problem."""
    return Travel(EXPLICIT, matrix=distances, duration_matrix=durations, convention="exact")


def without_stops(problem: RoutingProblem) -> RoutingProblem:
    """The problem without stops on the way; ``problem`` itself where no vehicle makes any."""
    if not any(v.reloads or v.stations for v in problem.fleet):
        return problem
    fleet = []
    for v in problem.fleet:
        stops = np.array(sorted({*v.reloads, *v.stations}), dtype=np.int64)
        distances, durations = (_over(matrix, stops) if len(stops) else matrix for matrix in own_moves(problem, v))
        loads = {"capacity": math.inf, "further_capacity": (), "reloads": (), "max_reloads": None} if v.reloads else {}
        store = {"energy": None} if v.stations else {}
        fleet.append(replace(v, travel=explicit(distances, durations), speed=1.0, **loads, **store))  # type: ignore[arg-type]
    travel = explicit(problem.travel.distances, problem.travel.durations)
    return with_fleet(problem, fleet, travel).altered(forbidden=None, needed=())  # these are moves without a stop between


def _over(matrix: Floats, stops: Integers) -> Floats:
    """Shortest ways over any of the stops (Floyd 1962)."""
    length = matrix.copy()
    for k in stops.tolist():
        np.minimum(length, length[:, k, None] + length[None, k], out=length)
    return length
