import itertools
import math

import numpy as np
import pytest

from waybound.formulations.routing.checking.customer_set_kernels import set_values, with_route
from waybound.formulations.stop import Stop


def test_the_least_order_of_each_set_that_keeps_the_limit_is_found() -> None:
    rng = np.random.default_rng(1)
    n = 4
    cost, weight = rng.uniform(1, 9, (2, n + 1, n + 1))
    limit, before = 22.0, np.array([0, 1, 0, 0])  # the first customer comes before the second
    flat = np.zeros((1, n + 1))
    found = set_values(Stop(60.0).flag, cost[None], weight[None], np.zeros(1), flat, np.full((1, n + 1), limit), before)
    assert found[0, 0] == math.inf
    for size in range(1, n + 1):
        for members in itertools.combinations(range(n), size):
            orders = [p for p in itertools.permutations(members) if 1 not in p or (0 in p and p.index(0) < p.index(1))]
            ways = [list(itertools.pairwise((0, *(k + 1 for k in p), 0))) for p in orders]
            if not ways or min(sum(weight[a, b] for a, b in way) for way in ways) > limit:
                expected = math.inf
            else:  # no level rules out more than its own least order does
                expected = min(sum(cost[a, b] for a, b in way) for way in ways)
            value = found[0, sum(1 << k for k in members)]
            assert value == pytest.approx(expected) if expected == math.inf else value >= expected - 1e-12


def test_routes_are_added_to_disjoint_sets() -> None:
    best = np.full((2, 8), math.inf)
    best[0, 0] = 0.0
    once = with_route(Stop(60.0).flag, best, np.array([1, 6, 7]), np.array([2.0, 3.0, 9.0]))
    assert once[1, [1, 6, 7]].tolist() == [2.0, 3.0, 9.0] and once[0, 0] == 0.0
    assert with_route(Stop(60.0).flag, once, np.array([1, 6, 7]), np.array([2.0, 3.0, 9.0]))[1, 7] == 5.0


def test_they_end_when_asked_to() -> None:
    stop = Stop(60.0)
    stop.ask()
    assert math.isnan(with_route(stop.flag, np.zeros((1, 2)), np.array([1]), np.array([1.0]))[0, 0])
