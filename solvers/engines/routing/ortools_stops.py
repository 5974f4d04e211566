"""Stops at depots on the way, for the OR-Tools routing library: nodes that may be left out, where loads and stores begin anew.

Loads on board, and what a store has given since it was full, are dimensions of the library. Slack at a stop sets them to whatever they
begin with there; elsewhere there is none.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....formulations.routing.problem import RoutingProblem
from .integer_scales import Integers


@dataclass(frozen=True)
class Stop:
    """One visit of a depot by a vehicle of any of ``kinds``, who all reload there, recharge, or both."""

    site: int
    kinds: frozenset[int]
    reloads: bool
    recharges: bool


def stops_on_the_way(problem: RoutingProblem, types: Sequence[int], most: int) -> list[Stop]:
    """Each depot as often as an answer may have to stop there, at most ``most`` times; ``types`` is the fleet's type of each vehicle."""
    fleet, stops = problem.fleet, []
    needed = len(problem.customers) + min(len(problem.customers), len(types))  # once before each site, and once before each return
    for depot in sorted({site for v in fleet for site in (*v.reloads, *v.stations)}):
        for role in ((True, False), (False, True), (True, True)):
            kinds = frozenset(k for k in types if (depot in fleet[k].reloads, depot in fleet[k].stations) == role)
            number = min(needed, most)
            if role[0]:
                limits = [fleet[k].max_reloads for k in types if k in kinds]
                number = min(number, sum(number if limit is None else limit for limit in limits))
            stops += [Stop(depot, kinds, *role)] * (number if kinds else 0)
    return stops


def count_routes(routing: Any, vehicles: int, customers: Sequence[int], least: int, stops: bool) -> None:
    """Have ``least`` routes at least; where there are ``stops``, whoever drives serves somebody. ``customers`` are indices, which are those
    of their nodes."""
    solver, drives = routing.solver(), [routing.ActiveVehicleVar(vehicle) for vehicle in range(vehicles)]
    if least:
        solver.Add(solver.Sum(drives) >= least)
    for vehicle, drive in enumerate(drives if stops else ()):
        served = [solver.IsEqualCstVar(routing.VehicleVar(index), vehicle) for index in customers]
        solver.Add(solver.Sum(served) >= drive)


def add_stores(routing: Any, evaluators: list[int], stores: Sequence[tuple[int, int]], stations: Sequence[int]) -> None:
    """The dimension of what each vehicle's store has given since it was full.

    ``evaluators`` are those of what moves draw, less the largest store from nodes of stations; ``stores`` what each vehicle's store holds,
    and what it lacks of that at departure; ``stations`` indices of stops.
    """
    reach = max(store for store, _ in stores)
    used = add_level(routing, evaluators, [store for store, _ in stores], "store", stations, reach)
    for vehicle, (_, lacking) in enumerate(stores):
        used.CumulVar(routing.Start(vehicle)).SetValue(lacking)
    for index in stations:  # nothing is stored beyond what the store holds
        routing.solver().Add(used.CumulVar(index) + used.SlackVar(index) >= reach)


def add_level(routing: Any, evaluators: list[int], limits: list[int], name: str, anew: Sequence[int], reach: int) -> Any:
    """A dimension that may begin anew at the indices ``anew``, whose transits there are less by ``reach`` than what is used."""
    routing.AddDimensionWithVehicleTransitAndCapacity(evaluators, 2 * reach, limits, False, name)
    level, free = routing.GetDimensionOrDie(name), set(anew)
    for index in range(routing.Size()):
        if index not in free:
            level.SlackVar(index).SetValue(0)
    return level


def add_loads(
    routing: Any, carried: tuple[Integers, Integers, Integers], limits: list[int], name: str, turns: Sequence[tuple[int, int]]
) -> None:
    """The dimensions of what is on board of vehicles that reload: what a trip delivers and has collected, and what shipments put there.

    A trip may begin with any load; where it ends, what was collected and has been shipped is still there at least, which is all that the
    first load has to be enough for. ``carried`` is what each node has delivered, collected and put on board of shipments; ``limits`` are
    the capacities of the vehicles; ``turns`` index and node of each stop where vehicles reload.
    """
    (delivered, collected, shipped), reach, vehicles = carried, max(limits), len(limits)
    stops, anew = [index for index, _ in turns], np.zeros(len(delivered), dtype=np.int64)
    anew[[node for _, node in turns]] = reach

    def level(change: Integers, called: str, free: Sequence[int]) -> Any:
        evaluator = routing.RegisterUnaryTransitVector(change.tolist())
        return add_level(routing, [evaluator] * vehicles, limits, f"{called} {name}", free, reach)

    board = level(collected + shipped - delivered - anew, "load", stops)
    kept = [
        level(change, called, free)
        for change, called, free in ((collected - anew, "collected", stops), (shipped, "shipped", ()))
        if (change + anew * (called == "collected")).any()
    ]
    for vehicle in range(vehicles):
        for dimension in kept:
            dimension.CumulVar(routing.Start(vehicle)).SetValue(0)
    if kept:
        for index in (*stops, *(routing.End(vehicle) for vehicle in range(vehicles))):
            routing.solver().Add(board.CumulVar(index) >= sum(dimension.CumulVar(index) for dimension in kept))
