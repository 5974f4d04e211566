"""Tours of robots that empty sensors."""

from __future__ import annotations

import numpy as np
import pytest

from waybound.instances.auctions.worlds.information_gathering import GatheringRules, GatheringWorld
from waybound.reports.missions.auctions import _gathering_tours as tours


def observation(places, rates, stores, robots=1, size=20):
    world = GatheringWorld(GatheringRules(size, size, len(places), robots), np.random.default_rng(1), places=places, rates=rates)
    world.stores[:] = stores
    return world._look()


def test_shares_of_the_reference():
    o = observation([[0, 4], [0, 7], [0, 10]], [2.0, 1.0, 5.0], [80.0, 40.0, 10.0])
    made = tours.tour(o, 0, [0, 1, 2])  # 20 steps out and back; what each will hold is capped at its store
    assert list(made.shares.values()) == pytest.approx([38.462, 23.077, 38.462], abs=1e-3)
    assert tours.times_to_full(o) == pytest.approx([10, 60, 18])


def test_lengths_and_orders_on_a_line():
    o = observation([[0, 2], [0, 5]], [1.0, 1.0], [50.0, 50.0])
    reached, back = tours.length(o, 0, [1, 0])
    assert (reached.tolist(), back) == ([5.0, 8.0], 10.0)
    assert tours.by_urgency(o, 0, [0, 1], 1, "shifted") == [0, 1]  # equally full: the nearer is the more urgent
    assert tours.by_urgency(o, 0, [], 3, "shifted") == []


def test_a_robot_changes_for_a_smaller_loss_alone():
    o = observation([[0, 3], [0, 4]], [5.0, 1.0], [100.0, 0.0])
    assert tours.switched(o, 0, [1], [0])
    assert not tours.switched(o, 0, [0], [1])
    assert not tours.switched(o, 0, [0], [0])


def test_tasks_go_to_the_end_of_the_shortest_path():
    o = observation([[0, 4], [0, 6], [0, 1], [0, 9]], [1.0] * 4, [0.0] * 4, robots=2, size=11)
    o.robots[:] = [[0, 0], [0, 10]]
    assert tours.appended(o, [0, 1], [0, 1, 2, 3]) == {0: [0, 2], 1: [1, 3]}
    assert tours.appended(o, [], [0]) == {}


def test_a_full_robot_goes_home():
    o = observation([[3, 3]], [1.0], [50.0])
    o.robots[:], o.loads[:] = [[2, 5]], 100.0
    own = tours.Tour([0], {0: 10.0})
    move = tours.drive(o, 0, own)
    assert (move.cell, move.amount, own.stops) == ((1, 4), 0.0, [])
