import numpy as np
import pytest
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError, UsageError
from waybound.instances.routing.spreading_fire import Fire
from waybound.instances.routing.worlds.fire_monitoring import (
    FireWorld,
    HotspotRules,
    Hotspots,
    cluster_centres,
    number_of_clusters,
)
from waybound.instances.worlds import make_world


@pytest.mark.parametrize(("points", "clusters"), [(0, 0), (1, 1), (2, 1), (8, 2), (50, 5), (200, 10)])
def test_numbers_of_clusters(points, clusters):
    assert number_of_clusters(points) == clusters


def test_the_longest_waits_of_two_hotspots():
    """The first is visited at steps 3 and 7, the second at 5."""
    spots = Hotspots(np.arange(2), np.zeros((2, 2)), np.zeros(2), np.zeros(2))
    for time in range(1, 9):
        spots = spots.aged(np.array([time in (3, 7), time == 5]))
    assert (spots.worst.tolist(), spots.waits.tolist()) == ([4, 5], [1, 3])


def test_circling_and_shuttling_over_five_hotspots_on_an_arc():
    """A front of length 100 at speed 1, five hotspots within 20: circling ends with 500, shuttling with 200 at most."""
    places = np.arange(0, 21, 5)
    totals = []
    for at in (lambda time: time % 100, lambda time: abs((time + 20) % 40 - 20)):
        spots = Hotspots(np.arange(5), np.zeros((5, 2)), np.zeros(5), np.zeros(5))
        for time in range(1, 401):
            spots = spots.aged(places == at(time))
        totals.append(spots.worst.sum())
    assert totals[0] == 500
    assert totals[1] <= 200


@given(st.integers(0, 10**6), st.integers(1, 30), st.integers(1, 6), st.integers(0, 6))
def test_clusters_are_those_of_lloyd(seed, points, count, seeds):
    rng = np.random.default_rng(seed)
    at = rng.integers(0, 12, (points, 2)).astype(float)
    centres = cluster_centres(at, min(count, points), 12 * rng.random((seeds, 2)))
    assert 1 <= len(centres) <= min(count, points)
    nearest = ((at[:, None, :] - centres) ** 2).sum(axis=2).argmin(axis=1)
    assert set(nearest) == set(range(len(centres)))
    assert np.allclose(centres, [at[nearest == k].mean(axis=0) for k in range(len(centres))])


def test_identities_go_to_the_nearest_once_each_and_only_within_reach():
    old = Hotspots(np.array([4, 7]), np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([3.0, 5.0]), np.array([6.0, 8.0]))
    new = old.moved(np.array([[1.0, 0.0], [0.5, 0.0], [14.0, 0.0], [10.5, 0.0]]), 3.0, 9)
    assert new.ids.tolist() == [9, 4, 10, 7]
    assert (new.waits.tolist(), new.worst.tolist()) == ([0, 3, 0, 5], [0, 6, 0, 8])
    assert old.moved(np.array([[3.0, 0.0]]), 3.0, 9).ids.tolist() == [9]  # closer than, not at most
    assert len(old.moved(np.zeros((0, 2)), 3.0, 9)) == 0
    assert Hotspots().moved(np.ones((2, 2)), 3.0, 0).ids.tolist() == [0, 1]


def test_the_fire_takes_no_notice_of_the_aircraft():
    one, two = (make_world("fire-monitoring", 4, size=40) for _ in range(2))
    for _ in range(30):
        two.step({0: np.clip(two.place + 1.0, 0, 39)})
        one.step({})
        assert one.hotspots.ids.tolist() == two.hotspots.ids.tolist()
        assert one.hotspots.places.tolist() == two.hotspots.places.tolist()


def test_what_has_vanished_counts_if_it_is_kept():
    runs = []
    for keep in (False, True):
        world = make_world("fire-monitoring", 3, size=40, keep_dead=keep)
        for _ in range(150):
            world.step({})
        runs.append((world.worst_waits, float(world.hotspots.worst.sum()), world.dead))
    assert runs[0][1:] == runs[1][1:] and runs[0][2] > 0
    assert runs[0][0] == runs[0][1] and runs[1][0] == sum(runs[1][1:])


def test_a_lower_threshold_has_more_hot_points_and_a_still_front_stays():
    counts = [len(make_world("fire-monitoring", 2, threshold=beta).hot_points()) for beta in (0.0, 0.25, 0.35, 0.45)]
    assert counts == sorted(counts, reverse=True)
    world = make_world("fire-monitoring", 2, still=True, hotspots=5)
    before = world.hotspots.places.tolist()
    world.step({})
    assert world.hotspots.places.tolist() == before and len(before) == 5
    assert world.hotspots.waits.tolist() == [1.0] * 5


def test_a_fire_that_burns_all_is_over():
    world = make_world("fire-monitoring", 1, size=10, spread=1.0, begin=5)
    for _ in range(200):
        world.step({})
    assert world.over and world.metrics()["burnt"] == 1.0 and world.metrics()["worst_waits"] == 0.0


TEN = np.arange(100.0).reshape(10, 10)


@pytest.mark.parametrize(
    ("arrival", "intensity", "start", "more", "says"),
    [
        (TEN, np.ones((10, 9)), (0, 0), {}, "no two rasters alike"),
        (TEN * np.nan, np.ones((10, 10)), (0, 0), {}, "no time"),
        (TEN, -np.ones((10, 10)), (0, 0), {}, "no intensity"),
        (TEN, np.ones((10, 10)), (0, 9.5), {}, "starts off the map"),
        (TEN, np.ones((10, 10)), (0, 0), {"begin": 99}, "none is free"),
        (TEN + 5, np.ones((10, 10)), (0, 0), {"begin": 3}, "no cell burns"),
        (TEN, np.ones((10, 10)), (0, 0), {"speed": 0.0}, "does not move"),
    ],
)
def test_worlds_that_cannot_be(arrival, intensity, start, more, says):
    with pytest.raises(InputError, match=says):
        FireWorld(Fire(arrival, intensity), start, **{"begin": 50, **more})


@pytest.mark.parametrize(
    "rule", [{"threshold": np.nan}, {"normalised": "both"}, {"within": -1.0}, {"hotspots": 0}, {"seeding": "none"}, {"radius": np.nan}]
)
def test_rules_that_find_no_hotspots_are_refused(rule):
    with pytest.raises(UsageError, match=next(iter(rule))):
        HotspotRules(**rule)


@pytest.mark.parametrize(
    ("actions", "says"),
    [
        ({1: (0, 0)}, "no such aircraft"), ({0: (5, 5)}, "too far"), ({0: (-1, 0)}, "off the map"), ({0: 3.0}, "off the map"),
        ({0: "there"}, "off the map"),
    ],
)  # fmt: skip
def test_steps_that_are_refused_change_nothing(actions, says):
    world = FireWorld(Fire(TEN, np.ones((10, 10))), (0, 0), begin=50, rules=HotspotRules())
    before = world.metrics()
    with pytest.raises(InputError, match=says):
        world.step(actions)
    assert (world.metrics(), world.time) == (before, 0)
