"""Reachability: shortest ways, least levels of whatever grows along a route, and what a route to given stops uses at least.

The reader of files, the preparation of forms, and the search for reasons why there is no answer share this arithmetic. The checkers of such
reasons have their own, so that no mistake made here is confirmed there.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..clock import moment_told
from ..errors import InputError
from ..number_arrays import Flags, Floats, Integers as Indices
from ..text import plain
from .instance import RoutingInstance, Sites, VehicleType
from .travel import Travel

Move = Callable[[ArrayLike, ArrayLike], Floats]
"""Lengths of direct moves between origins and destinations, which broadcast: ``Travel.distance``, ``Travel.duration``, ..."""

Legs = Callable[[str], Sequence[Floats]]
"""Shortest ways by ``time, travel`` or ``distance``: to the first stop, between stops, and from the last one to the end of a route."""

STRIP = 1 << 17
"""Number of moves that are computed at once."""


# -- ways --------------------------------------------------------------------------------------------------------------


def least_levels(level: Floats, moves: Callable[[Indices], Floats], lower: ArrayLike = -math.inf, upper: ArrayLike = math.inf) -> Floats:
    """Least level at each node over all ways, infinite where no way arrives; the triangle inequality is not assumed.

    Ways begin at ``level``, infinite where none does. ``moves`` gives, for k nodes, what a move from each of them to every node adds, shape
    (k, nodes): not negative, infinite for no move. On arrival a level is raised to ``lower`` (waiting); a way that is above ``upper`` then
    ends before. Label correcting: the lowest levels that have changed are followed first, as many at once as make ``STRIP`` moves.
    """
    level = level.copy()
    changed, most = np.isfinite(level), max(1, STRIP // len(level))
    while changed.any():
        nodes = np.nonzero(changed)[0]
        if len(nodes) > most:
            nodes = nodes[np.argpartition(level[nodes], most)[:most]]
        changed[nodes] = False
        reached = np.maximum(lower, (level[nodes, None] + moves(nodes)).min(axis=0))
        better = (reached < level) & (reached <= upper)
        level[better] = reached[better]
        changed |= better
    return level


def out_and_back(move: Move, vehicle: VehicleType, at: Indices, service: ArrayLike = 0.0, *, detours: bool = True) -> tuple[Floats, Floats]:
    """Lengths of the shortest ways from the start of a vehicle to each customer of ``at``, and from there to its end.

    Ways lead over any of these customers, each of which adds its ``service``; without ``detours`` they are the direct moves alone.
    """
    out, back = move(vehicle.start, at), move(at, vehicle.end)
    if not detours:
        return out, back
    busy = np.broadcast_to(np.asarray(service, dtype=np.float64), at.shape)
    return (
        least_levels(out, lambda nodes: busy[nodes, None] + move(at[nodes, None], at)),
        least_levels(back, lambda nodes: busy[nodes, None] + move(at, at[nodes, None])),
    )


def ways_alone(
    vehicle: VehicleType, at: Indices, duration: Move, distance: Move, service: ArrayLike = 0.0, *, detours: bool = True
) -> Legs:
    """Legs of a route to each of the customers ``at`` alone, for ``least_use``; ``service`` on the way counts for the time."""
    moves = {"time": duration, "travel": duration, "distance": distance}
    return lambda name: out_and_back(moves[name], vehicle, at, service if name == "time" else 0.0, detours=detours)


def shortest_ways(moves: Floats, through: Indices) -> Floats:
    """Lengths of the shortest ways between all sites over those of ``through`` (Floyd and Warshall); a move of length 0 is a move."""
    lengths = moves.copy()
    for k in through.tolist():
        np.minimum(lengths, lengths[:, k, None] + lengths[None, k, :], out=lengths)
    return lengths


# -- limits ------------------------------------------------------------------------------------------------------------


class Use(NamedTuple):
    """Least use of a limit by routes, and the most that they may use; arrays, or a number for all.

    ``limit`` is ``load, pickup, arrival, return, duration, distance`` or ``energy``.
    """

    limit: str
    least: Floats
    most: Floats | float


def least_use(sites: Sites, vehicle: VehicleType, stops: Sequence[Indices], legs: Legs) -> Iterator[Use]:
    """Least use of each limit by any route that makes the given stops in this order, whatever it does between them.

    ``stops`` are arrays of site indices, which broadcast against each other; ``legs`` of ``time`` may count services on the way. The uses
    are exact for routes that make these stops only and move directly. Elapsed time is that from the latest departure, which waiting
    prolongs where the depot closes too early to leave later. A charge of ``windows`` is no less than the time from the opening of the
    depot.
    """
    yield Use("load", _sum(sites.demand[k] for k in stops), vehicle.capacity)
    for k, capacity in enumerate(vehicle.further_capacity):
        yield Use("load", _sum(sites.further_demand[stop, k] for stop in stops), capacity)
        yield Use("pickup", _sum(sites.further_pickup[stop, k] for stop in stops), capacity)
    yield Use("pickup", _sum(sites.pickup[k] for k in stops), vehicle.capacity)
    *ways, home = legs("time")
    opens = max(float(sites.ready[vehicle.start]), vehicle.shift[0])
    clock: Floats = np.asarray(opens)
    for stop, way in zip(stops, ways, strict=True):
        arrival = clock + way
        yield Use("arrival", arrival, sites.due[stop])
        clock = np.maximum(arrival, sites.ready[stop]) + sites.service[stop]
    finish = clock + home
    yield Use("return", finish, min(float(sites.due[vehicle.end]), vehicle.shift[1]))
    busy = _sum(ways) + home + _sum(sites.service[k] for k in stops)
    elapsed = np.maximum(busy, finish - float(sites.due[vehicle.start]))
    yield Use("duration", elapsed, vehicle.max_duration)
    if math.isfinite(vehicle.max_distance):
        yield Use("distance", _sum(legs("distance")), vehicle.max_distance)
    if vehicle.energy is not None:
        charge = vehicle.energy.charge
        charged = _sum(legs("travel")) if charge == "travel" else elapsed if charge == "elapsed" else finish - opens
        yield Use("energy", vehicle.energy.rate * charged, vehicle.energy.at_departure)


def _sum(parts: Iterator[Floats] | Sequence[Floats]) -> Floats:
    first, *rest = parts
    return sum(rest, start=first)


# -- files -------------------------------------------------------------------------------------------------------------

WORDS = {
    "arrival": "earliest arrival",
    "return": "earliest return to the depot",
    "duration": "shortest duration of its route",
    "distance": "shortest length of its route",
}


def refuse_unreachable(instance: RoutingInstance, lines: Sequence[int] | None = None) -> None:
    """Raise InputError if a required customer lies beyond every vehicle, whatever the convention of distance.

    A customer is refused if even the shortest way from the start, through any customers and without service on the way, arrives after its
    window has closed; if the depot has closed when the shortest way back arrives; or if both ways and its service exceed the longest
    duration or distance of a route. Distances count rounded down to whole numbers, which no convention undercuts, so that a file that makes
    sense under any of them is read. ``lines`` has the line of each site, for the message.
    """
    sites = instance.sites
    if any(v.reloads or v.stations for v in instance.fleet):
        return  # ways through these depots are not looked at
    fleet = [replace(v, capacity=math.inf, further_capacity=(), energy=None) for v in instance.fleet]
    if not np.isfinite(sites.due).any() and all(
        math.isinf(v.max_duration) and math.isinf(v.max_distance) and math.isinf(v.shift[1]) for v in fleet
    ):
        return
    at, size = sites.customers, float(np.abs(sites.ready).max())
    for detours in (False, True):  # the direct way settles nearly all; only where it fails is another looked for
        uses_by_type = []
        for vehicle in fleet:
            travel = instance.travel if vehicle.travel is None else vehicle.travel
            legs = ways_alone(vehicle, at, _at_speed(travel, vehicle.speed), travel.least_distance, detours=detours)
            uses_by_type.append(list(least_use(sites, vehicle, [at], legs)))
        beyond = np.all([np.any([_exceeds(use, size) for use in uses], axis=0) for uses in uses_by_type], axis=0) & sites.required[at]
        if not beyond.any():
            return
    k = int(np.argmax(beyond))
    use = next(use for use in uses_by_type[0] if np.broadcast_to(_exceeds(use, size), len(at))[k])
    most = float(np.broadcast_to(use.most, len(at))[k])
    shown = partial(moment_told, instance.clock, digits=12) if use.limit in ("arrival", "return") else plain
    raise InputError(
        f"no vehicle can reach customer {sites.ids[at[k]]}: {WORDS[use.limit]}", "contradiction",
        line=None if lines is None else int(lines[at[k]]), expected=f"at most {shown(most)}",
        found=f"at least {shown(float(use.least[k]))}",
    )  # fmt: skip


def refuse_powerless(instance: RoutingInstance) -> None:
    """Raise InputError if sites are to be visited, and no vehicle has the energy for a first and a last move."""
    at = instance.sites.customers
    if not (instance.sites.required.any() or any(group.required for group in instance.sites.groups)):
        return
    for v in instance.fleet:
        if v.energy is None or v.stations:
            return
        moves = (v.travel or instance.travel).at_speed(v.speed)
        least = v.energy.rate * float(moves.duration(v.start, at).min() + moves.duration(at, v.end).min())
        if least <= v.energy.at_departure * (1.0 + 1e-9):
            return
    raise InputError("the energy of no vehicle lasts to any site and back", "contradiction", expected=f"at least {least:g}",
                     found=f"{max(v.energy.at_departure for v in instance.fleet if v.energy):g}")  # fmt: skip


def _at_speed(travel: Travel, speed: float) -> Move:
    return travel.least_duration if speed == 1.0 else lambda i, j: travel.least_duration(i, j) / speed


def _exceeds(use: Use, size: float) -> Flags:
    """Flags of the uses that exceed their limit by more than rounding: more than any judge of routes lets pass."""
    limit = np.asarray(use.most)
    return np.asarray(use.least > limit + 1e-9 * np.maximum(np.where(np.isfinite(limit), np.abs(limit), 0.0), size))
