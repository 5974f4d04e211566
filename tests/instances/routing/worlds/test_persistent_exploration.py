import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.routing.occupancy import Beams, RangeSensor
from waybound.instances.routing.occupancy_maps import MarkovMap
from waybound.instances.routing.terrain import Terrain
from waybound.instances.routing.worlds.persistent_exploration import SURE, PersistentWorld
from waybound.instances.worlds import make_world

KIND = "persistent-exploration"

SENSOR = RangeSensor(0.99, 0.01)


def street(robots=1, period=np.inf, base=(0, 0), **how):
    """A street of eight cells that stays free, and beside it a row of cells that are occupied, but one that may change."""
    known = np.array([[True] * 8, [False] * 8])
    periods = np.full((2, 8), np.inf)
    periods[1, 3] = period
    terrain = Terrain(~known & np.isinf(periods), known, periods, np.zeros((2, 8)))
    map_ = MarkovMap(np.where(known, SURE, 0.5).ravel(), SENSOR, seconds=10.0)
    return PersistentWorld(np.random.default_rng(1), terrain, base, robots, Beams.of(2.0, 360.0, 24), map_, **how)


OUT = tuple((0, k) for k in range(1, 8))
BACK = tuple((0, k) for k in range(6, -1, -1))


def test_robots_follow_ways_and_land():
    w = street(2, speed=2.0)
    w.step({0: (*OUT, *BACK)})
    state = w.observe().robots[0]
    assert (state.cell, state.after, state.flown, state.aloft) == ((0, 4), 0.0, 10.0, True) and w.metrics()["aloft"] == 1.0
    assert state.ahead == BACK[3:]
    w.step({})
    state = w.observe().robots[0]
    assert (state.cell, state.aloft, state.free, state.flown) == ((0, 0), False, True, 0.0)
    assert w.observe().robots[1].free and w.metrics()["lost"] == 0.0 and w.clock == 20.0


def test_a_robot_between_two_cells_comes_to_the_next_before_it_turns():
    w = street(speed=0.7)
    w.step({0: OUT})  # 7 m: three cells of 2 m, and a half
    state = w.observe().robots[0]
    assert state.cell == (0, 4) and state.after == pytest.approx(1.0 / 0.7) and state.flown == pytest.approx(10.0 + state.after)
    w.step({0: BACK[3:]})
    assert w.observe().robots[0].cell == (0, 1)


def test_batteries_are_charged_before_the_next_flight():
    w = street(charge=25.0)
    w.step({0: ((0, 1), (0, 0))})
    assert [w.observe().robots[0].free for _ in range(1)] == [False]
    with pytest.raises(InputError, match="battery is not full", check=coded("contradiction")):
        w.step({0: OUT})
    w.step({})
    w.step({})
    assert w.observe().robots[0].free


def test_a_robot_that_flies_too_long_is_lost():
    w = street(endurance=15.0)
    w.step({0: OUT})
    assert w.metrics()["lost"] == 0.0
    w.step({})
    assert w.metrics()["lost"] == 1.0 and not w.observe().robots[0].free


def test_cells_that_are_seen_become_known_and_others_do_not():
    w = street(speed=2.0)
    w.step({0: OUT[:2]})
    p = w.observe().p
    assert p[1, 1] > 0.9 and p[1, 7] == 0.5 and (p[0] == SURE).all()
    assert w.metrics()["unobserved"] == (~w.ever[1]).sum() > 0


def test_changes_that_nobody_sees_are_late():
    w = street(period=40.0)
    for expected in (0.0, 0.0, 25.0, 50.0):  # it is occupied from second 20 on, and free again from 40
        w.step({})
        assert w.metrics()["late"] == pytest.approx(expected if expected else 0.0, abs=3.0)
    assert w.metrics()["missed"] == 0.0
    w.step({0: OUT})
    assert w.metrics()["late"] == 0.0


def test_flights_above_occupied_cells_are_counted():
    w = street()
    w.step({0: ((1, 0), (1, 1), (0, 1))})
    assert w.metrics()["crossed"] == pytest.approx(2.0)


def test_readings_do_not_depend_on_what_robots_do():
    one, two = (make_world(KIND, 3) for _ in range(2))
    one.step({0: ((16, 17),)})
    two.step({})
    assert (one.truth == two.truth).all() and one._rng.random() == two._rng.random()


def test_observations_do_not_change_later():
    w = street()
    before = w.observe()
    w.step({0: OUT})
    assert (before.p[1] == 0.5).all() and before.robots[0].cell == (0, 0)
    with pytest.raises(ValueError, match="read-only"):
        before.p[0, 0] = 1.0


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ({1: OUT}, "no such robot"),
        ({0: ((0, 2),)}, "a way with a gap"),
        ({0: ((-1, 0),)}, "a way with a gap"),
        ({0: (3,)}, "a way with a gap"),
    ],
)
def test_orders_that_cannot_be_followed_change_nothing(actions, message):
    w = street()
    with pytest.raises(InputError, match=message):
        w.step(actions)
    assert w.time == 0 and w.clock == 0.0 and not w.robots[0].aloft


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"base": (9, 0)}, "base is outside the map"), ({"base": (1, 0)}, "in no free cell"), ({"robots": 0}, "robots reach no cell"),
        ({"endurance": 1.5}, "robots reach no cell"),
    ],
)  # fmt: skip
def test_what_cannot_be_flown_is_refused_at_once(how, message):
    with pytest.raises(InputError, match=message, check=coded("out-of-range")):
        street(**how)


def test_a_map_without_free_cells_is_refused():
    none = np.zeros((2, 2), dtype=bool)
    with pytest.raises(InputError, match="no cell that is known to be free", check=coded("missing")):
        PersistentWorld(
            np.random.default_rng(1), Terrain(~none, none, np.full((2, 2), np.inf), np.zeros((2, 2))), (0, 0), 1, Beams.of(2, 360, 4), None
        )


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"walls": 0.7, "dynamic": 0.7}, "more than all"), ({"shortest": 900.0, "longest": 800.0}, "shortest period"),
        ({"hit": 0.1, "false_hit": 0.2}, "more probable on occupied"), ({"model": "decay", "surest": 0.6}, "confidence would grow"),
        ({"rate": 0.0}, "rates of change"),
    ],
)  # fmt: skip
def test_contradictions_are_refused(settings, message):
    with pytest.raises(InputError, match=message):
        make_world(KIND, 1, **settings)
