"""Sites that no route can serve, with the proof, and the least number of routes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..tolerance import LIMIT, widening

if TYPE_CHECKING:
    from ...instances.routing.instance import VehicleType
    from .problem import RoutingProblem

Floats = NDArray[np.float64]
Sites = NDArray[np.int64]
Move = Callable[[ArrayLike, ArrayLike], Floats]
Ways = Callable[[Move, Sites, "VehicleType", Floats], tuple[Floats, Floats]]

MOST_DETOURS = 5_000
"""Customers up to which ways through others are looked at: each pass looks at all pairs."""

STRIP = 1 << 20
"""Moves that are looked at at once."""


def unreachable(problem: RoutingProblem) -> dict[int, str]:
    """Customers that no vehicle can serve, not even alone, and why.

    Parameters
    ----------
    problem : RoutingProblem

    Returns
    -------
    dict
        From site index to the reason, with its amounts; with several vehicle types, the reason of each. Ways are shortest ways
        through any other customers, services on the way included; only sites are named that the checker confirms to be out of reach.
        Beyond ``MOST_DETOURS`` customers, only those whose demand is too large are looked for.

    Notes
    -----
    The mathematics: docs/formulations/routing.md#proofs-that-there-is-no-answer.
    """
    with np.errstate(over="ignore", invalid="ignore"):  # sums that overflow are for the checker to judge
        verdicts = [_reasons(problem, kind) for kind in problem.fleet]
    customers = problem.customers
    found = {}
    for k, site in enumerate(customers.tolist()):
        reasons = [v[k] for v in verdicts]
        if all(r is not None for r in reasons):
            named = zip(problem.fleet, reasons, strict=True)
            found[site] = str(reasons[0]) if len(reasons) == 1 else "; ".join(f"{kind.name}: {r}" for kind, r in named)
    if not found:
        return {}
    from .checking.infeasible_site import out_of_reach

    confirmed = out_of_reach(problem)
    return {site: why for site, why in found.items() if confirmed[site]}


def minimum_vehicles(problem: RoutingProblem) -> int:
    """A lower bound on the number of routes of any feasible answer.

    The largest vehicles together must carry all required demands, rounding and the checker's tolerance granted; every answer
    has at least ``min_vehicles`` routes, and one if any customer is required.

    Returns
    -------
    int
        One more than the fleet has where it cannot carry the demands at all.
    """
    sites, customers = problem.sites, problem.customers
    must = customers[sites.required[customers]]
    if len(must) == 0:
        return problem.min_vehicles
    with np.errstate(over="ignore"):
        if not math.isfinite(float(sites.demand[must].sum())):
            return max(problem.min_vehicles, 1)
    total = math.fsum(sites.demand[must]) * (1.0 - 1e-12)
    room, routes = 0.0, 0
    for kind in sorted(problem.fleet, key=lambda v: -v.capacity):
        capacity = _allowed(kind.capacity)
        count = len(customers) if kind.count is None else kind.count
        lacking = max(0.0, total - room)
        if lacking <= 0.0 or math.isinf(capacity):
            needed = int(lacking > 0.0)
        else:
            needed = math.ceil(lacking / capacity) if lacking <= capacity * count else count + 1
        if needed <= count:
            return max(routes + needed, problem.min_vehicles, 1)
        room, routes = room + count * capacity, routes + count
    return max(routes + 1, problem.min_vehicles)


def _allowed(limit: Any) -> Any:
    return limit + widening(limit)


def _reasons(problem: RoutingProblem, kind: VehicleType) -> list[str | None]:
    """Why a vehicle of this type cannot serve each customer; None where nothing forbids it.

    No detour is longer than the direct way, so that shortest ways need not be known where the direct ones do.
    """
    reasons = _broken(problem, kind, _direct)
    too_large = problem.sites.demand[problem.customers] > _allowed(kind.capacity)
    if not any(reason is not None and not large for reason, large in zip(reasons, too_large, strict=True)):
        return reasons
    if len(reasons) > MOST_DETOURS:
        return [reason if large else None for reason, large in zip(reasons, too_large, strict=True)]
    return _broken(problem, kind, _shortest)


def _broken(problem: RoutingProblem, kind: VehicleType, ways: Ways) -> list[str | None]:
    sites, at = problem.sites, problem.customers
    duration, distance = problem.travel.duration, problem.travel.distance
    service = sites.service[at]
    out, back = ways(duration, at, kind, service)
    opens, due = float(sites.ready[kind.start]), sites.due[at]
    begin = np.maximum(opens + out, sites.ready[at])
    finish = begin + service + back
    shortest = out + service + back
    tests: list[tuple[Floats, Floats | float, str]] = [
        (sites.demand[at], kind.capacity, "its demand is {:g}, the capacity {:g}"),
        (opens + out, due, "it is reached at {:.6g} at the earliest, due {:g}"),
        (finish, float(sites.due[kind.end]), "the return from it is at {:.6g} at the earliest, due {:g}"),
        (shortest, kind.max_duration, "a route to it lasts {:.6g} at least, the longest duration is {:g}"),
    ]
    if math.isfinite(kind.max_distance):
        far, home = ways(distance, at, kind, np.zeros(len(at)))
        tests.append((far + home, kind.max_distance, "a route to it is {:.6g} long at least, the longest distance is {:g}"))
    if kind.energy is not None:
        rate, charge, store = kind.energy.rate, kind.energy.charge, kind.energy.capacity
        if charge == "travel":
            far, home = ways(duration, at, kind, np.zeros(len(at)))
            used = far + home
        elif charge == "elapsed":
            used = shortest
        else:  # from the opening of the depot, and no less where each move is charged at its window
            used = finish - opens
        tests.append((rate * used, store, f"a route to it draws {{:.6g}} of energy at least ({charge}), the store holds {{:g}}"))
    reasons: list[str | None] = [None] * len(at)
    for value, limit, text in tests:
        bounds = np.broadcast_to(np.asarray(limit, dtype=np.float64), len(at))
        for k in np.nonzero(value > _allowed(bounds) + LIMIT * np.abs(value))[0].tolist():
            reasons[k] = reasons[k] or text.format(value[k], bounds[k])
    return reasons


def _direct(move: Move, at: Sites, kind: VehicleType, service: Floats) -> tuple[Floats, Floats]:
    return move(kind.start, at), move(at, kind.end)


def _shortest(move: Move, at: Sites, kind: VehicleType, service: Floats) -> tuple[Floats, Floats]:
    """Shortest ways from the start to each customer, and from it to the end, services on the way included (Bellman-Ford)."""
    out, back = _direct(move, at, kind, service)
    for _ in range(len(at)):
        nearer, sooner = out.copy(), back.copy()
        for rows in np.array_split(np.arange(len(at)), 1 + len(at) ** 2 // STRIP):
            between = move(at[rows, None], at[None, :])
            np.minimum(nearer, ((out + service)[rows, None] + between).min(axis=0), out=nearer)
            sooner[rows] = np.minimum(back[rows], (between + (service + back)[None, :]).min(axis=1))
        if (nearer >= out).all() and (sooner >= back).all():
            break
        out, back = nearer, sooner
    return out, back
