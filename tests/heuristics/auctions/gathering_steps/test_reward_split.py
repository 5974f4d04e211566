"""Shares of a robot's room: the worked examples, and that they never exceed what there is."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.heuristics.auctions.gathering_steps.reward_split import expected_contents, reward_split, water_filled
from waybound.instances.errors import InputError


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
        with pytest.raises(InputError):
            reward_split(*given)
