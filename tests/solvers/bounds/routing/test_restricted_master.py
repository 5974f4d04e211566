import numpy as np
import pytest

from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.restricted_master import Master, Pool, Prices


def test_routes_are_kept_once_and_their_moves_are_counted() -> None:
    pool = Pool()
    pool.add([(0, np.array([1, 2])), (1, np.array([2, 1, 2]))])
    assert [(kind, r.tolist()) for kind, r in pool.new([(0, np.array([1, 2])), (1, np.array([1, 2])), (0, np.array([3]))])] == [
        (1, [1, 2]),
        (0, [3]),
    ]
    assert pool.sums(np.arange(9.0).reshape(3, 3)).tolist() == [1 + 5 + 6, 2 + 7 + 5 + 6]
    assert pool.sums(np.array([np.zeros((3, 3)), np.ones((3, 3))])).tolist() == [0.0, 4.0]
    flow = pool.flow(np.array([0.5]), (2, 3, 3))
    assert flow[0].tolist() == [[0, 0.5, 0], [0, 0, 0.5], [0.5, 0, 0]] and not flow[1].any()
    assert pool.twice.tolist() == [False, True]
    pool.keep(np.array([False, True]))
    assert [(kind, r.tolist()) for kind, r in pool.drives(np.array([0]))] == [(1, [2, 1, 2])]
    assert pool.sums(np.ones((3, 3))).tolist() == [4.0]


COST = np.array([[0.0, 3, 4], [3, 0, 5], [4, 5, 0]])
NOBODY = np.zeros(3, dtype=bool)


def test_the_cheapest_routes_are_chosen_within_their_number() -> None:
    pool = Pool()
    pool.add([(0, np.array([1])), (0, np.array([2])), (0, np.array([1, 2]))])
    master = Master(pool, COST[None], np.arange(3), np.full(3, 100.0), [2], 1)
    master.refresh()
    for shut, fewest, cost in (([0, 0, 0], 1, 12.0), ([0, 0, 0], 2, 14.0), ([0, 0, 1], 1, 14.0), ([1, 0, 1], 1, 108.0)):
        master.restrict(np.array(shut, dtype=bool), fewest, 2, NOBODY)
        assert master.solve(NEVER).value == pytest.approx(cost)


def test_of_each_type_there_are_so_many_routes_and_visits_may_be_left_out() -> None:
    pool = Pool()
    pool.add([(0, np.array([1])), (0, np.array([2])), (1, np.array([1])), (1, np.array([2]))])
    master = Master(pool, np.array([COST, 10.0 * COST]), np.arange(3), np.full(3, 1000.0), [1, 2], 1)
    open_to_all = np.zeros(4, dtype=bool)
    master.restrict(open_to_all, 0, 2, NOBODY)
    point = master.solve(NEVER)
    assert point.value == pytest.approx(min(6.0 + 80.0, 60.0 + 8.0)) and point.lacking == pytest.approx(0.0)
    assert point.prices is not None and 8.0 - 80.0 <= point.prices.routes[0] <= 6.0 - 60.0  # a second vehicle of the first type
    master.restrict(open_to_all, 0, 2, np.array([True, False, True]))
    assert master.solve(NEVER).value == pytest.approx(6.0)


def test_members_of_a_group_share_a_row() -> None:
    pool = Pool()
    pool.add([(0, np.array([1])), (0, np.array([2]))])
    master = Master(pool, COST[None], np.array([0, 1, 1]), np.full(2, 100.0), [2], 1)
    master.restrict(np.zeros(2, dtype=bool), 0, 2, np.zeros(2, dtype=bool))
    point = master.solve(NEVER)
    assert point.value == pytest.approx(6.0) and point.prices is not None and point.prices.visits[1] == point.prices.visits[2]


def test_prices_are_kept_within_a_box_and_what_it_makes_up_for_is_told() -> None:
    pool = Pool()
    pool.add([(0, np.array([1])), (0, np.array([2])), (0, np.array([1, 2]))])
    master = Master(pool, COST[None], np.arange(3), np.full(3, 100.0), [2], 1, boxed=True)
    every = np.zeros(3, dtype=bool)
    master.restrict(every, 1, 2, NOBODY)
    free = master.solve(NEVER)
    for middle, radius in ((2.0, 1.0), (50.0, 3.0), (6.0, 100.0)):
        master.box(Prices(np.zeros(1), np.array([0.0, middle, middle]), {}), radius)
        point = master.solve(NEVER)
        assert point.prices is not None and (abs(point.prices.visits[1:] - middle) <= radius + 1e-9).all()
        assert point.value <= free.value + 1e-9 and (point.held > 0.0) == (radius < 100.0)
    master.restrict(every, 1, 2, NOBODY)
    assert master.solve(NEVER).value == pytest.approx(free.value)
