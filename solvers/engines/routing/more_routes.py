"""Answers with as many routes as are asked for, made of those with fewer: customers, visited before or not, get vehicles of their own."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from ....formulations.routing.routes import Route, Routes

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem

MOST_TRIED = 50
"""Customers, and vehicle types for them, that are tried for one more route."""


def with_more_routes(problem: RoutingProblem, answer: Routes) -> Routes | None:
    """The answer with ``min_vehicles`` routes at least, each further one a customer to whom that is the least detour.

    Parameters
    ----------
    problem : RoutingProblem
    answer : Routes
        Feasible but for the number of its routes.

    Returns
    -------
    Routes or None
        None where it does not work out: what was not tried may.
    """
    lacking = problem.min_vehicles - sum(bool(route.visits) for route in answer)
    for _ in range(lacking):
        tried = (_alone(answer, *place) for _, *place in sorted(_places(problem, answer))[:MOST_TRIED])
        answer = next((one for one in tried if {v.check for v in problem.evaluate(one).violations} <= {"fleet"}), answer)
    return answer if problem.evaluate(answer).feasible else None


def _places(problem: RoutingProblem, answer: Routes) -> list[tuple[float, int, int, int]]:
    """By how much all routes get longer, and route, position and new vehicle type of a customer that leaves others behind.

    -1 and the site where it was left out before.
    """
    used, visited = Counter(route.vehicle for route in answer if route.visits), {site for route in answer for site in route.visits}
    found = []
    for kind, vehicle in enumerate(problem.fleet):
        if vehicle.count is not None and used[kind] >= vehicle.count:
            continue
        far = problem.travel_of(kind).distances
        for site in set(problem.customers.tolist()) - visited:
            found.append((float(far[vehicle.start, site] + far[site, vehicle.end]), -1, site, kind))
        for number, route in enumerate(answer.routes):
            served = [at for at, site in enumerate(route.visits) if not problem.sites.depot[site]]
            old, own = problem.fleet[route.vehicle], problem.travel_of(route.vehicle).distances
            stops = (old.start, *route.visits, old.end)
            for at in served if len(served) > 1 else ():
                before, site, after = stops[at : at + 3]
                longer = far[vehicle.start, site] + far[site, vehicle.end] + own[before, after] - own[before, site] - own[site, after]
                found.append((float(longer), number, at, kind))
    return found


def _alone(answer: Routes, number: int, at: int, kind: int) -> Routes:
    if number < 0:
        return Routes((*answer.routes, Route((at,), kind)))
    route = answer.routes[number]
    rest = Route(route.visits[:at] + route.visits[at + 1 :], route.vehicle)
    return Routes((*answer.routes[:number], rest, *answer.routes[number + 1 :], Route((route.visits[at],), kind)))
