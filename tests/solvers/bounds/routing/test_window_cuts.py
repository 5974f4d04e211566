"""Sets that no route serves are found where one route and a half enters them, once."""

import itertools

import numpy as np
import pytest
from draws import draws

from waybound.solvers.bounds.routing.route_levels import Level
from waybound.solvers.bounds.routing.window_cuts import WindowCuts


def drawn(seed: int, nodes: int = 6) -> tuple[Level, np.ndarray]:
    rng = np.random.default_rng(seed)
    weight = rng.integers(1, 20, (nodes, nodes)).astype(float)
    lower = np.append(0.0, rng.integers(0, 25, nodes - 1)).astype(float)
    upper = np.append(60.0, lower[1:] + rng.integers(0, 12, nodes - 1))
    return Level(weight, 0.0, lower, upper), ~np.eye(nodes, dtype=bool)


@pytest.mark.parametrize("seed", range(draws(20)))
def test_a_set_is_served_where_some_order_keeps_the_range(seed: int) -> None:
    level, usable = drawn(seed)
    cuts = WindowCuts(level, usable)
    for members in itertools.combinations(range(1, 6), 3):
        ends = []
        for order in itertools.permutations(members):
            at, last = 0.0, 0
            for node in (*order, 0):
                at, last = max(at + cuts.way[last, node], level.lower[node]), node
                at = at if at <= level.upper[node] else np.inf
            ends.append(at)
        assert cuts.served(members) == np.isfinite(min(ends))


def test_violated_sets_are_told_once() -> None:
    weight = np.full((4, 4), 10.0)
    level = Level(weight, 0.0, np.zeros(4), np.array([50.0, 12.0, 12.0, 50.0]))  # 1 and 2 are not on one route
    cuts, known = WindowCuts(level, ~np.eye(4, dtype=bool)), set[bytes]()
    flow = np.zeros((4, 4))
    for route, value in (((0, 1, 2, 0), 0.5), ((0, 2, 1, 0), 0.25), ((0, 3, 0), 1.0), ((0, 1, 0), 0.25), ((0, 2, 0), 0.25)):
        for i, j in itertools.pairwise(route):
            flow[i, j] += value
    found = cuts.violated(flow, known)
    assert [(np.flatnonzero(cut.inside).tolist(), cut.right) for cut in found] == [([1, 2], 2.0)]
    assert not cuts.violated(flow, known)
    assert (cuts.served((1, 3)), cuts.served((1, 2))) == (True, False)
