"""Exchanges of ends: where little else is changed, none betters what the search ends with."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
import pytest

import waybound as wb
from waybound.solvers.engines.routing.routing_integers import integer_routing
from waybound.solvers.engines.routing.ruin_recreate_steps import columns as k
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import arrays
from waybound.solvers.engines.routing.ruin_recreate_steps.search_kernels import anneal


def plane(customers: int, seed: int, due: float) -> wb.RoutingProblem:
    """Customers in a square with demands of 1 to 3, each to be reached by ``due``."""
    rng = np.random.default_rng(seed)
    xy = rng.integers(0, 100, (customers + 1, 2)).astype(float)
    demand = np.array([0, *rng.integers(1, 4, customers)])
    sites = wb.Sites.of(range(customers + 1), demand=demand, due=[math.inf, *[due] * customers], coordinates=xy)
    return wb.RoutingProblem(sites, wb.Travel("euclidean", xy, convention="round"), (wb.VehicleType(capacity=16.0),))


def exchanged(routes: list[tuple[int, ...]], turned: bool) -> Iterator[list[tuple[int, ...]]]:
    """All answers in which two routes have exchanged their ends, or a route has a part turned round."""
    for a, b in itertools.permutations(range(len(routes)), 2):
        others = [one for at, one in enumerate(routes) if at not in (a, b)]
        one, other = routes[a], routes[b]
        for i, j in itertools.product(range(len(one) + 1), range(len(other) + 1)):
            yield [*others, one[:i] + other[j:], other[:j] + one[i:]]
            if turned:
                yield [*others, one[:i] + other[:j][::-1], one[i:][::-1] + other[j:]]
    for a, one in enumerate(routes if turned else []):
        others = [other for at, other in enumerate(routes) if at != a]
        for i, j in itertools.combinations(range(len(one) + 1), 2):
            yield [*others, one[:i] + one[i:j][::-1] + one[j:]]


@pytest.mark.parametrize("due", [math.inf, 150.0])
@pytest.mark.parametrize("seed", range(4))
def test_no_exchange_of_ends_betters_the_last_answer(seed: int, due: float) -> None:
    """Nobody is removed but one at a time, so that nothing else would find most of them."""
    problem = plane(16, seed, due)
    held = arrays(problem, integer_routing(problem), 60, seed)
    best = np.full(1 + len(held.node), np.iinfo(np.int64).max)
    anneal(np.zeros(1, np.int64), *held.parts, best, np.array([1.0, 1.0, 0.0, 0.0]), 20_000, 0.0, held.flags)
    routes = [one.visits for one in held.routes(held.node[:, k.FOLLOWING])]
    cost = value(problem, routes)
    assert cost is not None
    found = [value(problem, others) for others in exchanged(routes, math.isinf(due))]
    assert all(other is None or other >= cost for other in found)
    assert sum(other is not None for other in found) > 10


def value(problem: wb.RoutingProblem, routes: list[tuple[int, ...]]) -> float | None:
    """The cost of routes, None if they break a limit."""
    judged = problem.evaluate(wb.Routes.of(wb.Route(visits, 0) for visits in routes if visits))
    return judged.values[0] if judged.feasible else None
