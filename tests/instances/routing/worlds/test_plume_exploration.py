import itertools
import math

import pytest
from coded import coded
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError
from waybound.instances.routing.worlds.plume_exploration import PlumeWorld, flight_time, neighbours, read_plume, serpentine
from waybound.instances.worlds import make_world

LINE = [(x, 0) for x in range(4)]


@pytest.mark.parametrize(("drift", "time"), [((1, 0), 2 / 3), ((-1, 0), 2 / 7), ((0, 1), 1 / math.sqrt(5.25)), ((0, 0), 0.4)])
def test_edges_with_against_and_across_the_drift(drift, time):
    assert flight_time((0, 0), (1, 0), 2.5, drift) == pytest.approx(time, rel=1e-12)


@given(*(st.integers(-20, 20) for _ in range(4)), st.floats(0, 1), st.floats(0, 2 * math.pi), st.floats(1.01, 9))
def test_the_velocity_of_a_flight_is_the_robots(a, b, c, d, wind, angle, speed):
    drift = (wind * math.cos(angle), wind * math.sin(angle))
    time = flight_time((a, b), (c, d), speed, drift)
    if (a, b) != (c, d):
        over_ground = math.hypot((c - a) / time + drift[0], (d - b) / time + drift[1])
        assert over_ground == pytest.approx(speed, rel=1e-9)
    assert flight_time((a, b), (a, b), speed, drift) == 0.0


def test_time_passes_to_the_next_arrival_and_flights_that_end_together_are_one_event():
    w = PlumeWorld(LINE, (0, 0), 3)
    w.step({0: (1, 0), 1: (3, 0), 2: (1, 0)})
    assert (w.clock, w.time) == (1.0, 1)
    assert w.observe().remaining == (0.0, 2.0, 0.0)
    assert w.places() == [(1.0, 0.0), (1.0, 0.0), (1.0, 0.0)]
    assert dict(w.observe().known) == {(0, 0): True, (1, 0): True, (2, 0): False}  # the third cell was flown over, not looked at
    w.step({})
    assert (w.clock, w.observe().unvisited) == (3.0, [(2, 0)])
    assert w.metrics() == {"clock": 3.0, "visited": 3.0, "flying": 0.0, "flown": 5.0, "finished": 0.0}


def test_it_is_over_once_all_is_visited_and_all_are_back():
    w = PlumeWorld([(0, 0), (1, 0)], (0, 0), 2)
    assert not w.over
    w.step({0: (1, 0)})
    assert not w.over
    w.step({0: (0, 0)})
    assert w.over and w.clock == 2.0
    w.step({})
    assert w.clock == 2.0
    assert PlumeWorld([(5, 5)], (5, 5), 1).over


def test_observations_do_not_change_later():
    w = PlumeWorld(LINE, (0, 0), 1)
    before = w.observe()
    w.step({0: (1, 0)})
    assert before.unvisited == [(1, 0)] and before.robots == ((0, 0),)


@pytest.mark.parametrize(
    ("actions", "message", "code"),
    [
        ({2: (0, 0)}, "no such robot", "unknown-name"),
        ({0: (1.5, 0)}, "robot 0 is told no cell", "malformed"),
        ({0: 3}, "robot 0 is told no cell", "malformed"),
        ({1: (0, 0)}, "robot 1 is under way", "contradiction"),
    ],
)
def test_orders_that_cannot_be_followed_change_nothing(actions, message, code):
    w = PlumeWorld(LINE, (0, 0), 2)
    w.step({0: (1, 0), 1: (3, 0)})
    before = (w.observe(), w.metrics())
    with pytest.raises(InputError, match=message, check=coded(code)):
        w.step(actions)
    assert (w.observe(), w.metrics()) == before


@pytest.mark.parametrize(
    ("how", "message", "code"),
    [
        (([], (0, 0), 1), "the plume has no cell", "missing"),
        ((LINE, (0, 1), 1), "start outside the plume", "out-of-range"),
        (([*LINE, (9, 9)], (0, 0), 1), "1 plume cells are not joined", "contradiction"),
        ((LINE, (0, 0), 0), "no robot", "out-of-range"),
        ((LINE, (0, 0), 1, 1.0, (0.0, 1.0)), "no faster than the plume", "out-of-range"),
        ((LINE, (0, 0), 1, math.nan), "no faster than the plume", "out-of-range"),
    ],
)
def test_what_cannot_be_explored_is_refused_at_once(how, message, code):
    with pytest.raises(InputError, match=message, check=coded(code)):
        PlumeWorld(*how)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("...\n...\n", "no single start; expected one S; found 0"),
        ("S#S", "found 2"),
        ("S#?", "line 1|1: an unknown sign"),
        ("S.#\n", "1 plume cells are not joined"),
    ],
)
def test_maps_that_make_no_plume_are_refused(tmp_path, text, message):
    path = tmp_path / "plume.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        make_world("plume-exploration", 1, file=str(path))


def test_a_map_is_read_north_first(tmp_path):
    path = tmp_path / "plume.txt"
    path.write_text(".##\n.S.\n")
    assert read_plume(str(path)) == ([(1, 0), (2, 0), (1, -1)], (1, -1))
    with pytest.raises(InputError, match="no such file"):
        read_plume(str(tmp_path / "none.txt"))


def test_a_wind_that_no_robot_outflies_is_refused():
    with pytest.raises(InputError, match="no faster than the plume"):
        make_world("plume-exploration", 1, wind=3)


@pytest.mark.parametrize(("shape", "cells"), [("grown", 30), ("line", 30), ("square", 25), ("serpentine", 29)])
def test_plumes_are_joined_and_of_about_the_size_asked_for(shape, cells):
    assert len(make_world("plume-exploration", 3, shape=shape, cells=30).cells) == cells


def test_the_same_seed_gives_the_same_plume_and_another_one_another():
    one, same, other = (make_world("plume-exploration", seed, cells=40) for seed in (5, 5, 6))
    assert (one.cells, one.start, one.drift) == (same.cells, same.start, same.drift)
    assert one.cells != other.cells


@pytest.mark.parametrize("width", range(1, 8))
def test_a_serpentine_is_a_path(width):
    path = serpentine(width)
    assert len(path) == len(set(path)) == width**2 + width - 1
    beside = [sum(near in set(path) for near in neighbours(cell)) for cell in path]
    assert all(b in neighbours(a) for a, b in itertools.pairwise(path))
    assert sum(beside) == 2 * (len(path) - 1)  # no other sides are shared
