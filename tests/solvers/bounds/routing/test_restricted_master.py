"""The pool of routes and the linear program over it."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.restricted_master import Master, Pool


def test_routes_are_kept_once_and_their_moves_are_counted() -> None:
    pool = Pool()
    pool.add([np.array([1, 2]), np.array([2, 1, 2])])
    assert [r.tolist() for r in pool.new([np.array([1, 2]), np.array([3])])] == [[3]]
    assert pool.sums(np.arange(9.0).reshape(3, 3)).tolist() == [1 + 5 + 6, 2 + 7 + 5 + 6]
    assert pool.flow(np.array([0.5]), 3).tolist() == [[0, 0.5, 0], [0, 0, 0.5], [0.5, 0, 0]]
    assert pool.twice.tolist() == [False, True]
    pool.keep(np.array([False, True]))
    assert [r.tolist() for r in pool.routes] == [[2, 1, 2]] and pool.sums(np.ones((3, 3))).tolist() == [4.0]


def test_the_cheapest_routes_are_chosen_within_their_number() -> None:
    pool = Pool()
    pool.add([np.array([1]), np.array([2]), np.array([1, 2])])
    master = Master(pool, np.array([[0.0, 3, 4], [3, 0, 5], [4, 5, 0]]), np.full(3, 100.0), 1)
    master.refresh()
    for shut, fewest, cost in (([0, 0, 0], 1, 12.0), ([0, 0, 0], 2, 14.0), ([0, 0, 1], 1, 14.0), ([1, 0, 1], 1, 108.0)):
        master.restrict(np.array(shut, dtype=bool), fewest, 2)
        assert master.solve(NEVER).value == pytest.approx(cost)
