"""Orders by urgency: the worked examples, with the sign slip and without, and against plain enumeration."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from waybound.heuristics.auctions.gathering_steps.urgency import next_stop, receding_order, urgencies
from waybound.instances.errors import InputError, UsageError

RATES, TIMES, AWAY = [2, 1, 5], [10, 60, 18], [2, 10, 4]


def test_the_three_urgencies_of_the_example():
    assert urgencies(RATES, TIMES, AWAY, "literal").tolist() == [-4, -5.9, -3.25]
    assert urgencies(RATES, TIMES, AWAY).tolist() == [52 / 2, 1 / 10, 47 / 4]
    assert urgencies(RATES, TIMES, AWAY, "rate").tolist() == [2 / 12, 1 / 70, 5 / 22]


def test_the_literal_one_calls_far_waypoints_more_urgent():
    literal, shifted = (urgencies([2, 2], [10, 10], [1, 8], u) for u in ("literal", "shifted"))
    assert literal.tolist() == [-8, -1] and shifted[0] > shifted[1] > 0


@pytest.mark.parametrize(("horizon", "order", "length"), [(1, (0, 1, 2, 3), 10), (2, (1, 2, 3, 0), 14), (3, (1, 2, 3, 0), 14)])
def test_looking_ahead_need_not_shorten_the_tour(horizon, order, length):
    places, weights = np.array([2.0, -3.0, -4.0, -6.0]), np.array([10.0, 12.0, 12.0, 12.0])
    first, then = weights / np.abs(places), weights / np.maximum(1.0, np.abs(places[:, None] - places))
    assert receding_order(first, then, horizon) == order
    assert np.abs(np.diff([0, *places[list(order)]])).sum() == length
    if horizon == 3:
        assert first[1] + then[1, 2] + then[2, 3] == 22


@pytest.mark.parametrize("horizon", [1, 2, 3, 4])
def test_the_next_stop_is_the_first_of_the_best_order(horizon):
    rng = np.random.default_rng(horizon)
    for _ in range(20):
        n = int(rng.integers(1, 7))
        first, then = rng.normal(size=n), rng.normal(size=(n, n))
        orders = itertools.permutations(range(n), min(horizon, n))
        best = max(orders, key=lambda o: first[o[0]] + sum(then[a, b] for a, b in itertools.pairwise(o)))
        assert next_stop(first, then, horizon) == best[0]


def test_equal_orders_go_to_the_first_and_no_waypoint_is_left_out():
    assert receding_order(np.ones(4), np.ones((4, 4)), 3) == (0, 1, 2, 3)
    assert receding_order(np.zeros(0), np.zeros((0, 0)), 3) == ()


def test_what_makes_no_sense_is_refused():
    for given in (([1, 2], [1], [1, 1]), ([0], [1], [1]), ([1], [np.nan], [1])):
        with pytest.raises(InputError):
            urgencies(*given)
    with pytest.raises(UsageError, match="urgency must be shifted, literal, rate"):
        urgencies([1], [1], [1], "soon")
    with pytest.raises(UsageError, match="a look ahead of 0 stops"):
        next_stop(np.ones(2), np.ones((2, 2)), 0)
