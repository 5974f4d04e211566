"""Where groups begin."""

from itertools import pairwise

import numpy as np

from waybound.instances.auctions.orchard_grid import OrchardGrid
from waybound.instances.auctions.orchard_rules import NONE, OrchardRules, draw_routes, draw_start
from waybound.instances.generators import Draw


def test_orders_by_chance_are_permutations():
    rules = OrchardRules(OrchardGrid(3, 6), 2, 4, relocation="random")
    start = draw_start(rules, Draw(np.random.default_rng(1)))
    assert all(sorted(order.tolist()) == rules.grid.harvested.tolist() for order in start.orders)
    assert len(set(start.cells.tolist())) == 4


def test_routes_are_runs_of_neighbours_that_share_no_cell():
    rules = OrchardRules(OrchardGrid(3, 7), 2, 4)
    start = draw_routes(rules, Draw(np.random.default_rng(1)))
    routes = [[c for c in order.tolist() if c != NONE] for order in start.orders]
    assert sorted(c for route in routes for c in route) == rules.grid.harvested.tolist()
    assert max(map(len, routes)) - min(map(len, routes)) <= 1
    assert start.cells.tolist() == [route[0] for route in routes]
    for route in routes:
        for a, b in pairwise(route):
            (r1, c1), (r2, c2) = divmod(a, 7), divmod(b, 7)
            assert abs(r1 - r2) + abs(c1 - c2) == 1
