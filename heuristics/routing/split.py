"""Route first, cluster second: a tour through all customers, cut into routes in the best way."""

from dataclasses import replace
from typing import Any

import numpy as np

from ...formulations.routing.problem import RoutingProblem
from ...formulations.routing.routes import Routes
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from .insertion import insertion
from .savings import FEATURES
from .tour_partitioning import pieces_of, radial_guarantee
from .tour_steps.cutting import ended, in_turn, no_time, routes_of, too_many
from .tour_steps.distance_matrices import Flags, Sites
from .tour_steps.giant_tour import Costs, giant_tour, moving_costs

TIMED = frozenset({"time-windows", "depot-windows", "max-duration", "max-distance"})
FLEET_STATES = 50_000_000
"""Vehicles times customers up to which a limited fleet is part of the search."""


@heuristic(
    "split",
    "routing", FEATURES, "a tour through all customers, cut into routes in the best way; with windows and limits",
    stated="that of tour-partitioning, without windows and limits",
)  # fmt: skip
def split(problem: RoutingProblem, context: Context, *, tour: str = "christofides", improve: bool = True, starts: int = 50) -> Outcome:
    """Build one tour, and cut it into the routes that cost least of all that leave its order as it is.

    Takes one depot and one vehicle type, every site required. Where iterated tour partitioning has a guarantee for the same tour, so have
    these routes, which cost no more. May use more vehicles than the fleet has, where the order leaves no other way.

    A shortest path over positions in the tour, of which each move stands for a route; with a limited fleet, over positions and
    numbers of routes. Where loads are whole numbers and the only limit, in linear time for each number of routes. Source: Beasley (1983),
    Omega 11; Prins (2004), Computers and Operations Research 31; Vidal (2016), Split algorithm in O(n) for the capacitated vehicle routing
    problem, Computers and Operations Research 69; docs/formulations/routing.md#approximations.

    Parameters
    ----------
    tour : str
        ``christofides``, ``double-tree`` or ``nearest-neighbour``; with windows or limits also the routes of ``insertion`` in a row.
        The routes of a start, one after the other, take its place.
    improve : bool
        Shorten the tour by 2-opt and Or-opt.
    starts : int, >= 1
        Customers, evenly spread over the tour, at which it is opened to be cut; the first is that after the depot.
    """
    if not (isinstance(starts, int) and starts >= 1):
        raise UsageError(f"starts must be a whole number of at least 1, not {starts!r}", "out-of-range")
    stop = context.begin()
    costs = moving_costs(problem, stop)
    if costs is None:
        return no_time(in_turn(problem), stop)
    timed = bool(problem.features() & TIMED)
    node_of = np.zeros(len(problem.sites), dtype=np.int64)
    node_of[costs.nodes[1:]] = np.arange(1, len(costs.nodes))
    giant, orders, best, rank = None, [], in_turn(problem), (len(problem.customers) + 1, 0, np.inf)
    if context.start is not None:
        orders.append(_in_a_row(context.start, node_of, len(costs.nodes)))
    else:
        giant = giant_tour(costs, tour, bool(improve), stop)
        orders.append(giant.order)
        if not costs.symmetric or timed:
            orders.append(giant.order[::-1].copy())
        alone = pieces_of(problem).alone[giant.order - 1]
        if alone.any() and not timed:  # as tour partitioning does, for its guarantee
            orders.append(np.concatenate([giant.order[~alone], giant.order[alone]]))
        if timed:
            inserted = insertion(problem, replace(context, stop=stop, publish=lambda answer: None)).answer
            orders.insert(0, _in_a_row(inserted, node_of, len(costs.nodes)))
            if stop.reached():
                best = inserted  # of a route for each customer that was not inserted yet: they would take long to judge
            elif (judged := problem.evaluate(inserted)).feasible:
                best, rank = inserted, (0, 0, judged.values[0])
    if starts > 1:
        orders += [
            np.roll(orders[0], -int(k))
            for k in np.unique(np.linspace(0, len(orders[0]), min(starts, len(orders[0])), False, dtype=int))[1:]
        ]
    for order in orders:
        if stop.reached():
            break
        last, reached = _cut(problem, costs, order, stop)
        if last.any() and reached < rank:
            best, rank = Routes(tuple(routes_of(costs.nodes[order], last))).canonical(), reached
            context.publish(best)
    cut, guarantee = stop.reached(), None
    if giant is not None and not cut and (judged := problem.evaluate(best)).feasible:
        guarantee = radial_guarantee(problem, giant, judged.values[0], plain=not timed and problem.vehicle_limit is None)
    statistics: dict[str, Any] = {"routes": len(best)} | ({} if giant is None else {"tour": giant.length})
    message = "" if giant is None else giant.message
    return ended(best, cut, statistics, message, too_many(problem, best, "split"), guarantee=guarantee)


def _in_a_row(start: Routes, node_of: Sites, n: int) -> Sites:
    """The visits of an answer one after the other, each once; customers that it leaves out come last."""
    visits = [int(node_of[site]) for route in start for site in route.visits]
    kept = [node for node in dict.fromkeys(visits) if node > 0]
    return np.array([*kept, *sorted(set(range(1, n)) - set(kept))], dtype=np.int64)


def _cut(problem: RoutingProblem, costs: Costs, order: Sites, stop: Stop) -> tuple[Flags, tuple[int, int, float]]:
    """The best cut of an order: whether each customer is the last of its route; routes that break limits, routes too many, and the cost."""
    from .tour_steps.splitting_kernels import best_split, linear_split

    sites, vehicle, travel = problem.sites, problem.fleet[0], problem.travel
    visits, depot = costs.nodes[order], vehicle.start
    moves = ((depot, visits), (visits, np.roll(visits, -1)), (visits, depot))
    distance = np.stack([travel.distance(a, b) for a, b in moves])
    time = distance if not travel.own_durations else np.stack([travel.duration(a, b) for a, b in moves])
    limits = (float(sites.ready[depot]), float(sites.due[depot]), vehicle.max_duration, vehicle.max_distance)
    n, limit = len(order), problem.vehicle_limit
    data = (
        sites.demand[visits], sites.service[visits], sites.ready[visits], sites.due[visits], distance, time, vehicle.capacity, limits,
        vehicle.unit_cost, vehicle.fixed_cost,
    )  # fmt: skip
    whole = bool((data[0] == np.floor(data[0])).all()) and float(data[0].sum()) < 2.0**53
    loads_only = whole and not problem.features() & TIMED

    def cut(most: int) -> tuple[Flags, int, float]:
        if loads_only:
            return linear_split(stop.flag, data[0], distance, vehicle.capacity, vehicle.unit_cost, vehicle.fixed_cost, most)  # type: ignore[no-any-return]
        return best_split(stop.flag, *data, most)  # type: ignore[no-any-return]

    last, broken, value = cut(n)
    if limit is not None and last.sum() > limit and limit * n <= FLEET_STATES:
        fewer, worse, dearer = cut(limit)
        if fewer.any() and worse <= broken:
            last, broken, value = fewer, worse, dearer
    return last, (int(broken), 0 if limit is None else max(0, int(last.sum()) - limit), float(value))
