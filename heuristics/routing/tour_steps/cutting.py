"""From a tour with marks at its cuts to routes, and what to answer where there was no time for a tour."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Route, Routes

Sites = NDArray[np.int64]


def routes_of(sites: Sites, last: NDArray[np.bool_]) -> list[Route]:
    """The routes between cuts; ``last`` tells of each site whether a route ends there."""
    ends = np.nonzero(last)[0]
    return [Route(tuple(part.tolist())) for part in np.split(sites, ends + 1) if len(part)]


def in_turn(problem: RoutingProblem) -> Routes:
    """All customers in the order of the data, as many on a route as there is room for; each alone where other limits have a say."""
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


def closed_routes(problem: Any) -> frozenset[str]:
    """Why a problem with one vehicle type has no tour through its depot, as feature names."""
    return frozenset({"open-routes"}) if problem.fleet[0].start != problem.fleet[0].end else frozenset()


def too_many(problem: RoutingProblem, answer: Routes, name: str) -> str:
    """What to say of more routes than there are vehicles; empty where there are enough."""
    limit = problem.vehicle_limit
    return "" if limit is None or len(answer) <= limit else f"{name} found no way to serve all with a fleet of {limit}"
