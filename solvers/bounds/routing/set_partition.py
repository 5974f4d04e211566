"""The set partitioning program of a problem: routes of each type of vehicle, and the rows by which customers are visited.

What routes cost is less what the visits on them are worth, so that a customer who may be left out costs nothing where he is.
docs/branch-price-cut.md
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....formulations.routing.checking.known_features import unknown_features
from ....formulations.routing.preparation import Preparation, offset, prepare
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.reachability import minimum_vehicles
from ....formulations.routing.routes import Route, Routes
from ....formulations.stop import NEVER, Stop
from ....instances.routing.vehicle_type import VehicleType
from .arcs import ARC_TERMS, Flags, Floats, Integers, too_many_arcs
from .route_levels import Level, levels_of

ROUNDED = 1e-12
"""Part of the largest number by which sums may differ by rounding."""


@dataclass(frozen=True, eq=False)
class RouteType:
    """Routes of vehicles that are alike: the ``cost`` of moves, shape (nodes, nodes), infinite for those that no route makes, the
    ``levels`` that limit them, and how many there are at ``most``; ``vehicles`` are positions in the fleet, with the number of each."""

    cost: Floats
    levels: tuple[Level, ...]
    most: int
    vehicles: tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class SetPartition:
    """Which routes there are to choose from, and what is asked of a choice; of a minimisation.

    Node 0 is the depot, the others are ``customers``, site indices. ``row``, shape (nodes,), has the row of each one's visits, from 1 on,
    that of all members of a group being the same; ``optional``, shape (1 + rows,), marks those that no route need visit. There are
    ``fewest`` to ``most`` routes, and ``constant`` is what an answer without any costs. ``merged``: one type of vehicle, and nobody is
    optional; ``symmetric``: one type, and each route can be driven the other way round at the same cost.
    """

    customers: Integers
    types: tuple[RouteType, ...]
    row: Integers
    optional: Flags
    fewest: int
    most: int
    constant: float
    merged: bool
    symmetric: bool

    @property
    def cost(self) -> Floats:
        """Costs of moves, shape (types, nodes, nodes)."""
        return np.array([one.cost for one in self.types])

    def routes(self, drives: Sequence[tuple[int, Integers]]) -> Routes:
        """The answer of some routes over nodes, each with the number of its type."""
        remaining = [[[vehicle, count] for vehicle, count in one.vehicles] for one in self.types]
        routes = []
        for kind, walk in drives:
            entry = next((entry for entry in remaining[kind] if entry[1] > 0), remaining[kind][0])
            entry[1] -= 1
            routes.append(Route(tuple(self.customers[walk - 1].tolist()), entry[0]))
        return Routes(tuple(routes))


def lacks_route_costs(problem: RoutingProblem) -> frozenset[str]:
    """Objectives that are not sums over moves and visits, and features that the checker does not know."""
    missing, sign = unknown_features(problem), 1.0 if problem.sense == "min" else -1.0
    for weight, term in problem.objective.levels()[0].terms:
        if term.name not in ("reward", "penalties") and (term.name not in ARC_TERMS or sign * weight < 0):
            missing = missing | {f"objective:{term.name}"}
    return missing


def set_partition(problem: RoutingProblem, stop: Stop = NEVER) -> SetPartition | None:
    """The program of a problem for which ``lacks_route_costs`` is empty; None where its moves are too many for the time."""
    alike: dict[object, list[int]] = {}
    for k, vehicle in enumerate(problem.fleet):
        alike.setdefault(replace(vehicle, count=1, name=""), []).append(k)
    if too_many_arcs(problem, stop.seconds_left / len(alike)):
        return None
    sites, customers = problem.sites, problem.customers
    n, sign = len(customers), 1.0 if problem.sense == "min" else -1.0
    types = []
    for listed in alike.values():
        counts = [n if (count := problem.fleet[k].count) is None else min(n, count) for k in listed]
        types.append(_route_type(problem, prepare(problem, listed[0]), sign, tuple(zip(listed, counts, strict=True))))
    node = {site: k for k, site in enumerate(customers.tolist(), start=1)}
    first = np.arange(n + 1)
    needs_no_visit = np.append(True, ~sites.required[customers])
    for group in sites.groups:
        members = [node[site] for site in group.sites]
        first[members], needs_no_visit[members] = min(members), not group.required
    rows, row = np.unique(first, return_inverse=True)
    most = min(n, sum(one.most for one in types))
    optional = needs_no_visit[rows]
    rewarded = {term.name for _, term in problem.objective.levels()[0].terms} & {"reward", "penalties"}
    merged = len(types) == 1 and sign > 0 and not rewarded and len(rows) == n + 1 and not optional[1:].any()
    return SetPartition(
        customers, tuple(types), row.astype(np.int64), optional, minimum_vehicles(problem), most, sign * offset(problem), merged,
        len(types) == 1 and _turns(problem, types[0]),
    )  # fmt: skip


def _turns(problem: RoutingProblem, one: RouteType) -> bool:
    """Whether each route can be driven the other way round at the same cost: it ends where it begins, and nobody waits or is due."""
    vehicle, usable = problem.fleet[one.vehicles[0][0]], np.isfinite(one.cost)
    waits = (problem.sites.ready[problem.customers] > problem.sites.ready[vehicle.start]).any() or problem.sites.windows
    mixed = any(level.above >= 0 for level in one.levels)
    if vehicle.start != vehicle.end or waits or mixed or _is_due(problem, vehicle) or (usable != usable.T).any():
        return False
    return all(_adds_up_both_ways(np.where(usable, values, 0.0), usable) for values in (one.cost, *(level.weight for level in one.levels)))


def _adds_up_both_ways(values: Floats, usable: Flags) -> bool:
    """Whether sums over round trips are the same in both directions, each customer having a part of his own in those of his moves."""
    own = values[0] - values[:, 0]
    apart = np.where(usable, values - values.T - own[None, :] + own[:, None], 0.0)
    return bool((np.abs(apart) <= ROUNDED * np.abs(values).max(initial=0.0)).all())


def _is_due(problem: RoutingProblem, kind: VehicleType) -> bool:
    """Whether anything has to be in time."""
    due = problem.sites.due[[*problem.customers, kind.end]]
    fixed = kind.energy is not None and kind.energy.charge == "elapsed-fixed-start"
    return bool(np.isfinite(due).any()) or math.isfinite(kind.shift[1]) or fixed


def _route_type(problem: RoutingProblem, prep: Preparation, sign: float, vehicles: tuple[tuple[int, int], ...]) -> RouteType:
    nodes, kind = prep.nodes - 1, problem.fleet[prep.vehicle]
    head = np.where(prep.head == prep.end, 0, prep.head)
    cost = np.full((nodes, nodes), math.inf)
    cost[prep.tail, head] = sign * prep.cost
    usable = np.isfinite(cost)
    timed = _is_due(problem, kind)

    limited = [name for name in prep.resources if timed or name != "time"] or ["time"]

    def level(name: str) -> Level:
        resource, weight = prep.resources[name], np.zeros((nodes, nodes))
        weight[prep.tail, head] = resource.weight
        lower, upper = resource.lower[:-1], np.append(resource.upper[-1], resource.upper[1:-1]) + resource.tolerance
        # What is on board at the fullest so far, if all that is delivered until then was, is no less than what has been collected.
        collected = name.replace("load", "pickup")
        above = limited.index(collected) if name != collected and collected in limited else -1
        return Level(weight, float(resource.lower[0]), lower, upper, above, timed and name == "time")

    most = min(nodes - 1, sum(count for _, count in vehicles))
    return RouteType(cost, tuple(levels_of([level(name) for name in limited], usable)), most, vehicles)
