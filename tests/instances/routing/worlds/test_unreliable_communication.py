"""The unknown floor: sight, radios, energy, what comes to the base, and what is refused before the first step."""

import math

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError
from waybound.instances.routing.worlds.unreliable_communication import CommunicationWorld
from waybound.instances.worlds import make_world

CORRIDOR = np.ones((1, 12), dtype=bool)


def corridor(robots=1, battery=20, **how):
    return CommunicationWorld(CORRIDOR, (0, 0), robots, battery, **{"sight": 0, "reach": 0, **how})


def test_flying_and_hovering_cost_a_step_and_the_ground_costs_none():
    w = corridor(3)
    w.step({0: w.base + 1, 1: w.base})
    assert (w.battery, w.robots, w.time, w.rested) == ([19, 19, 20], [w.base + 1, w.base, w.base], 1, 0)
    w.step({})
    assert (w.battery, w.rested, w.over) == ([19, 19, 20], 1, True)
    w.patience = 2
    assert not w.over


def test_only_what_is_at_the_base_counts():
    w = corridor(2, reach=2)
    for _ in range(3):
        w.step({1: w.robots[1] + 1})
    assert w.metrics()["explored"] == pytest.approx(100 * 4 / 12)
    assert w.metrics()["returned"] == pytest.approx(100 * 3 / 12)  # what was heard two cells away
    assert w.metrics()["groups"] == 2 and w.observe().groups == ((0,), (1,))
    w.step({1: w.robots[1] - 1})
    assert w.metrics()["returned"] == pytest.approx(100 * 4 / 12) and w.metrics()["groups"] == 1


def test_maps_pass_over_a_robot_between_two_others():
    w = corridor(3, reach=2)
    for _ in range(2):
        w.step({1: w.robots[1] + 1, 2: w.robots[2] + 1})
    for _ in range(2):
        w.step({2: w.robots[2] + 1})
    assert w.observe().groups == ((0, 1, 2),) and w.observe().seen[0].sum() == 5
    assert w.metrics()["returned"] == pytest.approx(100 * 5 / 12)


def test_walls_block_sight_and_radios():
    floor = np.ones((5, 7), dtype=bool)
    floor[:4, 3] = False
    w = CommunicationWorld(floor, (0, 0), 1, 9, sight=10, reach=10)
    view = {divmod(int(cell), w.width) for cell in w.visible(w.base)}
    assert (2, 3) in view and (2, 5) not in view
    left, right = w.base + 2, w.base + 4
    assert not w.linked(left, right) and not w.linked(right, left) and w.linked(w.base, left)
    assert CommunicationWorld(floor, (0, 0), 1, 9, reach=2, through=True).linked(left, right)
    assert not CommunicationWorld(floor, (0, 0), 1, 9, reach=1.9, through=True).linked(left, right)


@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 80), st.floats(0, 6))
def test_in_the_open_a_disc_is_seen(height, width, at, radius):
    base = (at // 9 % height, at % 9 % width)
    w = CommunicationWorld(np.ones((height, width), dtype=bool), base, 1, 9, sight=radius)
    near = {(r + 1, c + 1) for r in range(height) for c in range(width) if math.hypot(r - base[0], c - base[1]) <= radius}
    assert {divmod(int(cell), w.width) for cell in np.flatnonzero(w.observe().seen[0])} == near


@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(1, 12))
def test_links_are_mutual_and_open_cells_are_those_beside_seen_ones(seed, height, width):
    rng = np.random.default_rng(seed)
    floor = rng.random((height, width)) < 0.7
    floor[0, 0] = True
    w = CommunicationWorld(floor, (0, 0), 1, 9, sight=2.5, reach=4)
    cells = np.flatnonzero(w.free)
    a, b = rng.choice(cells, 2).tolist()
    assert w.linked(a, b) == w.linked(b, a) and w.linked(a, a)
    o = w.observe()
    beside = {int(c) + d for c in np.flatnonzero(o.seen[0]) for d in (0, 1, -1, w.width, -w.width)}
    assert set(np.flatnonzero(o.open[0]).tolist()) == {c for c in beside if w.free[c]}


def test_links_fail_at_random_whatever_robots_do():
    def heard(move):
        w = make_world("unreliable-communication", 4, map="corridor", width=30, robots=2, loss=0.5, reach=100)
        counts = []
        for _ in range(12):
            w.step({1: w.robots[1] + move})
            counts.append(len(w.observe().groups))
        return counts

    assert heard(0) == heard(1) and set(heard(1)) == {1, 2}


def test_observations_do_not_change_later_and_cannot_be_written():
    w = corridor()
    before = w.observe()
    w.step({0: w.base + 1})
    assert before.seen.sum() == 1 and before.robots == (w.base,)
    with pytest.raises(ValueError, match="read-only"):
        before.seen[0, 0] = True


@pytest.mark.parametrize(
    ("robot", "by", "message", "code"),
    [
        (2, 0, "no such robot", "unknown-name"),
        (0, 2, "robot 0 cannot fly there", "contradiction"),
        (0, -1, "robot 0 cannot fly there", "contradiction"),
        (0, 0.5, "robot 0 cannot fly there", "contradiction"),
        (1, 0, "battery of robot 1 is empty", "contradiction"),
    ],
)
def test_orders_that_cannot_be_followed_change_nothing(robot, by, message, code):
    w = corridor(2, battery=2)
    w.step({1: w.base + 1})
    w.step({1: w.base})
    before = (w.observe(), w.metrics(), list(w.battery))
    with pytest.raises(InputError, match=message, check=coded(code)):
        w.step({robot: w.base + by})
    assert (w.observe(), w.metrics(), w.battery) == before


@pytest.mark.parametrize(
    ("how", "message", "code"),
    [
        ((np.zeros((3, 3), dtype=bool), (0, 0), 1, 9), "no free cell", "missing"),
        ((CORRIDOR, (1, 0), 1, 9), "base is no free cell", "out-of-range"),
        ((CORRIDOR, (0, -1), 1, 9), "base is no free cell", "out-of-range"),
        ((CORRIDOR, (0, 0), 0, 9), "no robot can leave", "out-of-range"),
        ((CORRIDOR, (0, 0), 1, 1), "no robot can leave", "out-of-range"),
        ((CORRIDOR, (0, 0), 1, 9, -1.0), "see or hear", "out-of-range"),
        ((CORRIDOR, (0, 0), 1, 9, 1.0, math.nan), "see or hear", "out-of-range"),
        ((CORRIDOR, (0, 0), 1, 9, 1.0, 1.0, -0.1), "see or hear", "out-of-range"),
    ],
)
def test_what_cannot_be_explored_is_refused_at_once(how, message, code):
    with pytest.raises(InputError, match=message, check=coded(code)):
        CommunicationWorld(*how)
