"""Routes and outcomes from tours with cuts, or from places on routes, and outcomes where there was no time."""

from typing import Any

import numpy as np

from ....formulations.evidence import Guarantee
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Route, Routes
from ....formulations.stop import Stop
from ...heuristic import CUT_SHORT, Outcome
from .distance_matrices import Flags, Sites


def routes_of(sites: Sites, last: Flags) -> list[Route]:
    """The routes between cuts; ``last`` tells of each site whether a route ends there."""
    ends = np.nonzero(last)[0]
    return [Route(tuple(part.tolist())) for part in np.split(sites, ends + 1) if len(part)]


def visits_by_route(route_of: Sites, place: Sites) -> list[Sites]:
    """Indices of those that are on a route (``route_of`` is not negative), route by route in the order of their places."""
    visited = np.nonzero(route_of >= 0)[0]
    visited = visited[np.lexsort((place[visited], route_of[visited]))]
    return np.split(visited, np.nonzero(np.diff(route_of[visited]))[0] + 1) if len(visited) else []


def in_turn(problem: RoutingProblem) -> Routes:
    """All customers in the order of the data, as many on a route as there is room for; each alone where there are windows or limits."""
    customers = problem.customers
    load, last = 0.0, np.ones(len(customers), dtype=bool)
    if not problem.features() & {"time-windows", "depot-windows", "max-duration", "max-distance"}:
        for k, demand in enumerate(problem.sites.demand[customers].tolist()):
            if k and load + demand <= problem.fleet[0].capacity:
                last[k - 1] = False
                load += demand
            else:
                load = demand
    return Routes(tuple(routes_of(customers, last)))


def no_time(answer: Routes, stop: Stop) -> Outcome:
    """The outcome of a heuristic that had no time to look at the moves: ``answer`` is its customers in the order of the data."""
    return Outcome(answer, message=f"customers in their order: {CUT_SHORT}", limit=stop.reached())


def ended(answer: Routes | None, cut: str, statistics: dict[str, Any], *messages: str, guarantee: Guarantee | None = None) -> Outcome:
    """The outcome of a heuristic at its end; ``cut`` says what cut it short, if anything did, and empty messages are left out."""
    message = "; ".join(words for words in (*messages, CUT_SHORT if cut else "") if words)
    return Outcome(answer, guarantee, (), statistics, message, cut or "none")


def too_many(problem: RoutingProblem, answer: Routes, name: str) -> str:
    """A message about more routes than there are vehicles; empty where there are enough."""
    limit = problem.vehicle_limit
    return "" if limit is None or len(answer) <= limit else f"{name} found no way to serve all with a fleet of {limit}"
