"""A relaxation of a routing problem, for the checkers: one depot, one kind of vehicle, and arcs with costs and resources.

Depots are merged into one node, vehicle types into the best of all of them, which only adds routes and lowers costs: a bound for
the merged fleet is one for the fleet. All limits are widened by what ``evaluate`` lets pass (``tolerance``), so that a bound holds for
every answer that it accepts. Which levels and arcs are within reach is worked out here once more, apart from ``preparation`` and
``instances.routing.reach``: an arc that these drop by mistake is still priced here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...checking.granularity import Grain, grain, is_decimal
from ...tolerance import widening
from .known_features import (
    EPS,
    Flags,
    Floats,
    Integers,
    departure,
    earliest_levels,
    last_return,
    least_moves,
    unknown_features,
    without_stops,
)

if TYPE_CHECKING:
    from ....instances.routing.instance import VehicleType
    from ..problem import RoutingProblem


_ROUNDS = 10
_LEAST_STEP = 1e-4
"""Sums of multiples of 0.001 are compared exactly where the tolerance of a limit is smaller than this."""


@dataclass(frozen=True, eq=False)
class Resource:
    """Something that grows along a route; node 0 is the depot, the others are the customers in site order.

    ``weight`` is what each move adds at least, shape (nodes, nodes), ``start`` the level on leaving the depot, ``lower`` and ``upper``
    the levels at which a route of an accepted answer can stand at a node (``upper[0]`` on return); rounding may add ``slack``, and no
    level, limit or weight is larger than half of ``size``. The level is never below that of the resource ``above``.
    """

    weight: Floats
    start: float
    lower: Floats
    upper: Floats
    slack: float
    size: float
    above: Resource | None = None


@dataclass(frozen=True, eq=False)
class Relaxation:
    """Arcs that some route may use, their costs, and how many routes there are.

    ``customers`` are the sites of nodes 1, 2, ...; ``cost`` of shape (nodes, nodes) is the share of an arc in the first level of the
    objective, infinite for one that no feasible route can use; there is no answer if ``fewest > most``. ``resources`` are those that are
    limited, and ``time`` always; the objective of every answer is a multiple of ``grain``; ``first`` and ``last`` mark customers who can
    only be the first and the last of their route.
    """

    customers: Integers
    cost: Floats
    fewest: int
    most: int
    resources: dict[str, Resource]
    grain: Grain | None
    first: Flags
    last: Flags

    def cheapest_routes(self, depot: Floats, per_route: float, surely: Flags) -> float:
        """Least sum of ``k`` of ``depot``, those of ``surely`` among them, plus ``k per_route`` over all numbers k of routes; infinite
        if none fits."""
        least, rest = int(surely.sum()), np.sort(depot[~surely])
        fixed = depot[surely]
        return min(math.fsum([*fixed, *rest[: k - least]]) + per_route * k for k in range(self.fewest, self.most + 1))


def relax(problem: RoutingProblem) -> Relaxation | None:
    """The relaxation; None where the objective is no sum over arcs, where sites may be left out, or for unknown features."""
    problem = without_stops(problem)
    weights = None if unknown_features(problem) else _term_weights(problem)
    customers = problem.sites.customers
    if weights is None or len(customers) == 0 or not problem.sites.required[customers].all():
        return None
    per_cost, per_vehicle = weights
    between, _ = least_moves(problem)
    cost = per_cost * min(v.unit_cost for v in problem.fleet) * merged(problem, between)
    cost[0] = first_move(problem, lambda v: per_cost * (v.fixed_cost + v.unit_cost * between[v.start, customers]) + per_vehicle)
    cost[1:, 0] = per_cost * np.min([v.unit_cost * between[customers, v.end] for v in problem.fleet], axis=0)

    resources = limited_resources(problem)
    allowed = moves_left(problem)
    resources = narrowed(resources, allowed)
    cost[~allowed] = math.inf
    grains = [per_cost * v.unit_cost * between for v in problem.fleet]
    fixed = [per_cost * v.fixed_cost + per_vehicle for v in problem.fleet]
    # Costs of time, and moves of which each vehicle has its own, are no multiples of anything that is looked for.
    whole = not per_cost or not problem.features() & {"duration-cost", "overtime", "vehicle-travel", "committed-vehicles"}
    size = grain(np.concatenate([*(g.ravel() for g in grains), fixed])) if whole else None
    fewest, most = _fleet(problem)
    inner = allowed[1:, 1:]
    first, last = (np.logical_not(np.asarray(inner.any(axis=axis))) for axis in (0, 1))
    fewest = max(fewest, int(first.sum()), int(last.sum()))
    return Relaxation(customers, cost, fewest, most, resources, size, first, last)


def moves_left(problem: RoutingProblem) -> Flags:
    """Moves between the merged nodes that no statement forbids, shape (nodes, nodes)."""
    customers = problem.sites.customers
    allowed = ~np.eye(len(customers) + 1, dtype=bool)
    if problem.forbidden is not None:
        allowed[1:, 1:] &= ~problem.forbidden[np.ix_(customers, customers)]
        allowed[0, 1:] &= ~np.all([problem.forbidden[v.start, customers] for v in problem.fleet], axis=0)
        allowed[1:, 0] &= ~np.all([problem.forbidden[customers, v.end] for v in problem.fleet], axis=0)
    return allowed


def needed_moves(problem: RoutingProblem) -> list[Flags]:
    """Sets of moves between the merged nodes, shape (nodes, nodes), of each of which some route makes at least one."""
    problem = without_stops(problem)
    return smallest([merged_moves(problem, moves) for moves in customers_moves(problem)])


def customers_moves(problem: RoutingProblem) -> list[Flags]:
    """Sets of needed moves, shape (sites, sites), that someone makes who serves somebody: one with a move from depot to depot may be kept
    by a vehicle that does not."""
    depots = np.ix_(problem.sites.depots, problem.sites.depots)
    return [moves for moves in problem.needed if not moves[depots].any()]


def merged_moves(problem: RoutingProblem, moves: Flags) -> Flags:
    """A set of moves between the merged nodes."""
    customers = problem.sites.customers
    joined = np.zeros((len(customers) + 1,) * 2, dtype=bool)
    joined[1:, 1:] = moves[np.ix_(customers, customers)]
    joined[0, 1:] = np.any([moves[v.start, customers] for v in problem.fleet], axis=0)
    joined[1:, 0] = np.any([moves[customers, v.end] for v in problem.fleet], axis=0)
    return joined


def smallest(sets: Sequence[Flags]) -> list[Flags]:
    """The sets that contain no other set of the list: who makes a move of the smaller set makes one of the larger set, too."""
    minimal: list[Flags] = []
    for moves in sets:
        if not any((known <= moves).all() for known in minimal):
            minimal = [*(known for known in minimal if not (moves <= known).all()), moves]
    return minimal


def fewest_carriers(problem: RoutingProblem, groups: Sequence[Integers]) -> list[int]:
    """Least number of routes that visit all customers of each group, given as nodes from 1 on: what they bring, and what they collect,
    fits into as many vehicles. Where even all vehicles are too small, one more than there are."""
    problem = without_stops(problem)
    sites, at = problem.sites, problem.sites.customers
    least = [1] * len(groups)
    for k in range(sites.dimensions):
        name = "" if k == 0 else "further_"
        loads = [getattr(sites, f"{name}{what}")[at] for what in ("demand", "pickup")]
        room = _room(problem, [v.capacities[k] if k < len(v.capacities) else math.inf for v in problem.fleet])
        for load in loads:
            each = load if k == 0 else load[:, k - 1]
            totals = np.array([math.fsum(each[group - 1]) for group in groups]) * (1.0 - 4 * EPS)
            least = np.maximum(least, np.searchsorted(room, totals) + 1).tolist()
    return least


def _room(problem: RoutingProblem, capacities: Sequence[float]) -> Floats:
    """Upper bounds on what one, two, ... vehicles carry together, the largest first."""
    customers = len(problem.sites.customers)
    counts = [customers if v.count is None else min(v.count, customers) for v in problem.fleet]
    each = np.array(capacities)
    room = np.sort(np.repeat(each + widening(each), counts))[::-1]
    return np.cumsum(room) * (1.0 + 4 * len(room) * EPS)


def _term_weights(problem: RoutingProblem) -> tuple[float, float] | None:
    """Weights of total cost and of the number of vehicles in the first level; None if it holds anything else."""
    weights = {"total-cost": 0.0, "vehicles": 0.0}
    if problem.sense != "min":
        return None
    for weight, term in problem.objective.levels()[0].terms:
        if term.name not in weights or not 0 <= weight < math.inf:
            return None
        weights[term.name] += weight
    return weights["total-cost"], weights["vehicles"]


def _fleet(problem: RoutingProblem) -> tuple[int, int]:
    """Least and greatest number of routes: each visits someone, and together they carry all loads."""
    customers = problem.sites.customers
    counts = [len(customers) if v.count is None else min(v.count, len(customers)) for v in problem.fleet]
    most = min(len(customers), sum(counts))
    total = math.fsum(problem.sites.demand[customers]) * (1.0 - 4 * EPS)
    enough = np.nonzero(_room(problem, [v.capacity for v in problem.fleet]) >= total)[0]
    fewest = int(enough[0]) + 1 if len(enough) else most + 1
    return max(fewest, problem.min_vehicles), most


def merged(problem: RoutingProblem, matrix: Floats) -> Floats:
    """``matrix`` over the merged nodes: customers among themselves, row and column 0 left for the caller."""
    customers = problem.sites.customers
    joined = np.zeros((len(customers) + 1, len(customers) + 1))
    joined[1:, 1:] = matrix[np.ix_(customers, customers)]
    return joined


def first_move(problem: RoutingProblem, of: Callable[[VehicleType], Floats]) -> Floats:
    """Row 0 of a merged matrix: the smallest entry over all vehicle types; the depot itself gets 0."""
    return np.concatenate([[0.0], np.min([of(v) for v in problem.fleet], axis=0)])


def limited_resources(problem: RoutingProblem) -> dict[str, Resource]:
    """Resources that are limited: ``time`` always, the others where every vehicle has a limit on them."""
    sites, fleet = problem.sites, problem.fleet
    at = sites.customers
    zeros, free = np.zeros(len(at) + 1), np.full(len(at) + 1, math.inf)
    distances, durations = least_moves(problem)
    moving, driven = with_depot(problem, durations, zeros), with_depot(problem, distances, zeros)
    service = np.concatenate([[0.0], sites.service[at]])
    busy = with_depot(problem, durations, service)

    start = min(departure(problem, v) for v in fleet)
    ready, due = np.concatenate([[start], sites.ready[at]]), np.concatenate([[0.0], sites.due[at]])
    ends = []
    for v in fleet:
        end = last_return(problem, v)
        if v.energy is not None and v.energy.charge == "elapsed-fixed-start":
            store = v.energy.capacity + float(widening(v.energy.capacity))
            end = min(end, departure(problem, v) + store / v.energy.rate)
        ends.append(end)
    due[0] = max(ends)
    clock = max(abs(departure(problem, v)) for v in fleet)
    # Where vehicles or windows that are merged differ, levels need not be sums of what is looked at here.
    alike = not problem.features() & {"vehicle-travel", "vehicle-speeds", "shifts", "several-windows"}
    widened = partial(_widened_resource, alike=alike)
    resources = {"time": widened(busy, start, ready, due, clock, rounded=clock)}
    clock = resources["time"].size  # what the judge computes elapsed time from

    demand = np.concatenate([[0.0], sites.demand[at]])
    limits = {name: max(getattr(v, name) for v in fleet) for name in ("capacity", "max_distance", "max_duration")}
    if math.isfinite(limits["capacity"]):
        weight = np.tile(demand, (len(demand), 1))
        resources["load"] = widened(weight, 0.0, zeros, np.minimum(free, limits["capacity"]))
    if math.isfinite(limits["max_distance"]):
        resources["distance"] = widened(driven, 0.0, zeros, np.minimum(free, limits["max_distance"]))
    if math.isfinite(limits["max_duration"]):
        resources["duration"] = widened(busy, 0.0, zeros, np.minimum(free, limits["max_duration"]), rounded=clock)
    stores = [v.energy for v in fleet if v.energy is not None]
    if len(stores) == len(fleet):
        charges = {e.charge for e in stores}
        weight = moving
        if "travel" not in charges:
            weight = busy
        if charges == {"windows"}:
            weight = busy.copy()
            # From a depot the judge counts from that depot's own opening, so only a common opening can be used.
            first = 0 if len({departure(problem, v) for v in fleet}) == 1 else 1
            weight[first:, 1:] = np.maximum(busy[first:, 1:], ready[None, 1:] - ready[first:, None])
        rate, capacity = min(e.rate for e in stores), max(e.capacity for e in stores)
        resources["energy"] = widened(rate * weight, 0.0, zeros, np.minimum(free, capacity), rounded=max(e.rate for e in stores) * clock)
    return resources


def carried_loads(problem: RoutingProblem, usable: Flags) -> list[Resource]:
    """Loads that are limited, of each dimension what is delivered and what is collected; of the merged vehicles.

    Where there are both, the first is what was on board at the fullest so far, if nothing but what was delivered until then had been
    loaded: whoever is visited next adds his delivery to it, and it is no less than what has been collected.
    """
    problem = without_stops(problem)
    sites, at, resources = problem.sites, problem.sites.customers, list[Resource]()
    zeros = np.zeros(len(at) + 1)
    for k in range(sites.dimensions):
        capacity = max((v.capacities[k] if k < len(v.capacities) else math.inf) for v in problem.fleet)
        loads = (sites.demand, sites.pickup) if k == 0 else (sites.further_demand[:, k - 1], sites.further_pickup[:, k - 1])
        # Either level is a sum of both kinds of load, or may be, which the widening and the largest level have to know.
        alike = all(is_decimal(load[at]) for load in loads)
        made = {
            str(which): _widened_resource(
                np.tile(np.append(0.0, load[at]), (len(zeros), 1)), 0.0, zeros, zeros + capacity, alike=alike, top=math.inf
            )
            for which, load in enumerate(loads)
            if math.isfinite(capacity) and load[at].any()
        }
        tight = narrowed(made, usable.copy()) if made else {}
        collected = tight.get("1")
        resources += [replace(tight["0"], above=collected)] if "0" in tight else []
        resources += [collected] if collected is not None else []
    return resources


def order_resource(customers: int) -> Resource:
    """Number of moves so far: a route that visits each of its customers once makes one more at most."""
    n = customers + 1
    lower, upper = np.ones(n), np.full(n, float(customers))
    lower[0], upper[0] = 0.0, float(n)
    return Resource(np.ones((n, n)), 0.0, lower, upper, 0.0, 4.0 * n)


def with_depot(problem: RoutingProblem, matrix: Floats, before: Floats) -> Floats:
    """Merged matrix of ``before[i] + matrix[i, j]``; ``before`` has one entry per node."""
    at = problem.sites.customers
    joined = merged(problem, matrix)
    joined[0] = first_move(problem, lambda v: matrix[v.start, at])
    joined[1:, 0] = np.min([matrix[at, v.end] for v in problem.fleet], axis=0)
    joined += before[:, None]
    joined[0, 0] = 0.0
    return joined


def _widened_resource(
    weight: Floats, start: float, lower: Floats, upper: Floats, clock: float = 0.0, rounded: float = 0.0, *, alike: bool,
    top: float | None = None,
) -> Resource:  # fmt: skip
    """Limits widened by what a check lets pass; infinite ones are replaced by a level that no earliest schedule exceeds, or by ``top``.

    ``clock`` is the largest time at which a route starts, ``rounded`` the size of numbers from which the judge computes levels. Where all
    data are multiples of 0.001 (and all that counts is looked at: ``alike``), no level can exceed a limit by as little as what is let
    pass.
    """
    if top is None:
        top = max(start, float(lower.max())) + float(weight.max(axis=1).sum())
    wider = widening(upper, clock)
    if (
        alike
        and float(wider.max()) < _LEAST_STEP
        and all(is_decimal(values) for values in (weight, start, lower, upper[np.isfinite(upper)]))
    ):
        wider = np.zeros(len(upper))
    upper = np.minimum(upper + wider, max(top, start))
    size = max(rounded, abs(start), float(np.abs(lower).max()), float(np.abs(upper).max()), float(weight.max()))
    return Resource(weight, start, lower, upper, 16 * len(lower) * EPS * size, 4.0 * size)


def narrowed(resources: dict[str, Resource], allowed: Flags) -> dict[str, Resource]:
    """The reachable levels of every resource; removes from ``allowed`` the moves that no route can use, until nothing changes."""
    for _ in range(_ROUNDS):
        before = int(allowed.sum())
        reachable = {}
        for name, r in resources.items():
            earliest, latest = _earliest(r, allowed), _latest(r, allowed)
            reachable[name] = replace(r, lower=earliest, upper=latest)
            allowed &= earliest[:, None] + r.weight <= latest[None, :] + r.slack
        if int(allowed.sum()) == before:
            break
    return reachable


def _earliest(r: Resource, allowed: Flags) -> Floats:
    """Least level at each node over all walks from the depot, waiting included; infinite if none arrives."""
    steps, due = np.where(allowed, r.weight, math.inf), r.upper + r.slack
    due = np.where(r.lower > due, -math.inf, due)[1:]
    return np.append(r.start, earliest_levels(r.start + steps[0, 1:], steps[1:, 1:], r.lower[1:], due))


def _latest(r: Resource, allowed: Flags) -> Floats:
    """Greatest level at each node from which the depot is still reached in time: the least of the negated levels, backwards."""
    steps, due = np.where(allowed, r.weight, math.inf), r.slack - r.lower
    due = np.where(-r.upper > due, -math.inf, due)[1:]
    ways = earliest_levels(steps[1:, 0] - r.upper[0], steps[1:, 1:].T, -r.upper[1:], due)
    return 0.0 - np.append(-r.upper[0], ways)
