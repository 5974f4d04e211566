import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.worlds import make_world


def test_robots_go_through_doors_read_and_are_heard_in_the_base_and_beside_it():
    world = make_world("room-exploration", 1, rooms=9, robots=2)
    adjacent = world.building.adjacent
    first = int(np.nonzero(adjacent[0])[0][0])
    beyond = next(int(room) for room in np.nonzero(adjacent[first])[0] if room != 0 and not adjacent[0, room])
    world.step({0: (first, 0), 1: (0, 1)})
    assert world.robots.tolist() == [first, 0] and world.metrics()["entered"] == 2.0 and world.silent.tolist() == [0, 0]
    assert [(r.robot, r.room, r.action) for r in world.readings] == [(1, 0, 1)]
    world.step({0: (beyond, 0)})
    assert world.silent.tolist() == [1, 0] and world.observe().visits[[0, first, beyond]].tolist() == [1, 1, 1]
    world.step({0: (beyond, 2), 1: (first, 0)})  # who is beside the base passes on what others say
    assert world.silent.tolist() == [0, 0] and world.metrics()["searched"] == 1.0


def test_readings_come_as_often_as_the_sensors_say():
    world = make_world("room-exploration", 2, rooms=2, robots=1)
    for _ in range(3000):
        world.step({0: (0, 1 + world.time % 2)})
    for action, truth in ((1, int(world.types[0])), (2, int(not world.targets[0]))):
        odds = world.sensors[action - 1][truth]
        told = np.bincount([r.value for r in world.readings if r.action == action], minlength=len(odds)) / 1500
        assert (np.abs(told - odds) <= 5 * np.sqrt(odds * (1 - odds) / 1500)).all()


def test_the_building_and_its_truth_are_the_seeds_whatever_robots_do():
    still, busy = (make_world("room-exploration", 5) for _ in range(2))
    assert still.building.num_rooms == 22
    for _ in range(4):
        still.step({})
        busy.step({0: (0, 1)})
    still.step({1: (0, 1)})
    busy.step({1: (0, 1)})
    assert still.types.tolist() == busy.types.tolist() and still.readings[-1] == busy.readings[-1]


@pytest.mark.parametrize(
    ("actions", "code"),
    [
        ({7: (0, 0)}, "unknown-name"), ({0: (21, 0)}, "contradiction"), ({0: (0, 3)}, "malformed"), ({0: (99, 0)}, "malformed"),
        ({0: 1}, "malformed"), ({"a": (0, 0)}, "unknown-name"), ({0: (1, 1)}, "contradiction"),
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_refused_and_changes_nothing(actions, code):
    world = make_world("room-exploration", 1)
    with pytest.raises(InputError, check=coded(code)):
        world.step(actions)
    assert world.time == 0 and not world.readings
