"""Orders of waypoints by urgency and shares of a robot's room: the worked examples, and against plain enumeration."""

import itertools

import numpy as np
import pytest
from coded import check_coded, coded
from file_cases import check_refused

from waybound.heuristics.auctions._gathering import expected_contents, next_stop, receding_order, reward_split, urgencies, water_filled
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
    for given, code in (
        (([1, 2], [1], [1, 1]), "wrong-shape"), (([0], [1], [1]), "out-of-range"), (([1], [np.nan], [1]), "out-of-range"),
    ):  # fmt: skip
        with pytest.raises(InputError, check=coded(code)):
            urgencies(*given)
    check_refused(UsageError, "urgency must be shifted, literal, rate", urgencies, [1], [1], [1], "soon")
    check_coded(UsageError, "out-of-range", next_stop, np.ones(2), np.ones((2, 2)), 0)


def test_the_example_with_and_without_a_capacity():
    held = expected_contents([80, 40, 10], [2, 1, 5], 20)
    assert held.tolist() == [120, 60, 110]
    assert reward_split(held, 100).tolist() == pytest.approx([41.37931, 20.68966, 37.93103], abs=1e-5)
    capped = expected_contents([80, 40, 10], [2, 1, 5], 20, 100.0)
    assert capped.tolist() == [100, 60, 100]
    assert reward_split(capped, 100).tolist() == pytest.approx([38.46154, 23.07692, 38.46154], abs=1e-5)


def test_no_more_is_taken_than_there_is():
    held = expected_contents([5, 0, 0], [0.1, 0.1, 0.2], 20)
    assert (held / held.sum() * 100).tolist() == pytest.approx([53.84615, 15.38462, 30.76923], abs=1e-5)  # as (4.7) has it
    assert reward_split(held, 100).tolist() == [7, 2, 4]


def test_what_caps_cut_off_goes_to_the_others():
    rng = np.random.default_rng(1)
    for _ in range(100):
        weights, caps, total = rng.random(5) * (rng.random(5) < 0.8), rng.random(5), float(rng.random() * 4)
        made = water_filled(weights, caps, total)
        assert (made <= caps + 1e-12).all() and (made >= 0).all() and (made[weights == 0] == 0).all()
        assert made.sum() == pytest.approx(min(total, caps[weights > 0].sum()), abs=1e-12)
        level = np.divide(made, weights, out=np.full(5, np.inf), where=weights > 0)
        free = (weights > 0) & (made < caps - 1e-12)
        assert not free.any() or np.ptp(level[free]) < 1e-9


def test_an_empty_store_and_a_full_robot_take_nothing():
    assert reward_split([0, 0], 5).tolist() == [0, 0] and reward_split([3, 1], 0).tolist() == [0, 0]
    for given in (([-1], 1), ([np.nan], 1), ([1], -1), ([[1]], 1)):
        with pytest.raises(InputError, check=coded("out-of-range")):
            reward_split(*given)
