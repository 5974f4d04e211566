import numpy as np
import pytest
from coded import coded

from waybound.instances.arrays.worlds.fleet_energy import DISPATCH, HOME, NEVER, FleetWorld, Job, ways
from waybound.instances.errors import InputError

JOBS = (Job(np.array([[2.0, 0.0]]), 0, NEVER), Job(np.array([[0.0, 1.0], [3.0, 0.0]]), 2, 5))


def world(**changes):
    values = {
        "pads": np.zeros((2, 2)), "endurance": np.array([6, 6]), "recharge": np.array([16, 16]), "jobs": JOBS, "reach": 1.0, "reserve": 2,
    } | changes  # fmt: skip
    return FleetWorld(**values)


def test_ways_are_whole_steps_and_one_at_least():
    assert ways(np.array([[0.0, 0.0], [3.0, 0.0]]), np.array([[0.0, 0.0], [3.0, 4.0]]), 2.0).tolist() == [[1, 3], [2, 2]]


def test_a_robot_flies_watches_returns_and_charges():
    w = world()
    w.step({DISPATCH: {0}, 0: (0, 0)})
    w.step({})
    assert w.watched() == {(0, 0)} and (w.demanded, w.covered) == (2, 0)
    w.step({})
    assert (w.demanded, w.covered, w.metrics()["airborne"]) == (3, 1, 1.0)
    w.step({0: HOME})
    assert w.watched() == set() and w.battery[0] == 4.0
    w.step({})
    o = w.observe()
    assert not o.aloft[0] and (o.since[0], w.battery[0]) == (5, 3.0)
    w.step({})
    assert w.battery[0] == 3.5  # sixteen steps from empty to full
    w.step({0: (0, 0)})
    assert w.hasty == (0,) and w.metrics()["takeoffs"] == 2.0


def test_low_voltage_is_told_once_and_an_empty_battery_is_lost():
    w = world()
    w.step({0: (0, 0)})
    crossings = []
    for _ in range(8):
        crossings.append(dict(w.observe().low))
        w.step({})
    assert [c for c in crossings if c] == [{0: 6}]
    assert w.lost == 1 and not w.aloft[0]


def test_jobs_are_asked_for_from_their_start_to_their_end():
    w = world()
    asked = []
    for _ in range(6):
        asked.append(sorted(w.observe().jobs))
        w.step({DISPATCH: {0, 1}})
    assert asked == [[0], [0], [0, 1], [0, 1], [0, 1], [0]]
    assert w.demanded == 6 + 3 * 2


@pytest.mark.parametrize(
    ("actions", "message", "code"),
    [
        ({DISPATCH: {7}}, "does not exist", "unknown-name"),
        ({5: HOME}, "no such robot", "unknown-name"),
        ({1: HOME}, "robot 1 is on its way home, or there", "contradiction"),
        ({1: (0, 3)}, "robot 1 is told no place", "unknown-name"),
        ({1: "away"}, "robot 1 is told no place", "unknown-name"),
        ({0: (0, 0)}, "robot 0 is in the air", "contradiction"),
    ],
)
def test_orders_that_cannot_be_followed_change_nothing(actions, message, code):
    w = world()
    w.step({0: (0, 0)})
    before = (w.metrics(), w.battery.tolist(), w.watches[:])
    with pytest.raises(InputError, match=message, check=coded(code)):
        w.step(actions)
    assert (w.metrics(), w.battery.tolist(), w.watches) == before


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pads": np.zeros((0, 2))}, "no robot"),
        ({"recharge": np.array([0, 5])}, "must be positive"),
        ({"reserve": -1}, "must be positive"),
        ({"reach": 0.0}, "must be positive"),
        ({"reach": 0.1}, "no robot reaches the places of any job"),
    ],
)
def test_fleets_that_reach_nothing_are_refused_at_once(changes, message):
    with pytest.raises(InputError, match=message):
        world(**changes)
