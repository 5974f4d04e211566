import math

import numpy as np
import pytest
from coded import coded

from waybound import InputError, UsageError
from waybound.instances.sata.phd_filter import PHDFilter
from waybound.instances.sata.tracks import TrackRules
from waybound.instances.sata.worlds.search_and_track import SearchRules, SearchWorld, read_places
from waybound.instances.worlds import make_world


def world(*, robots=1, targets=1, at=((50.0, 50.0),), goals=((55.0, 50.0),), seed=1, initial=0, target_step=0.0, **rules):
    sizes = SearchRules(robots, targets, 100.0, 100.0, robot_step=2.0, target_step=target_step, initial=initial)
    return SearchWorld(sizes, PHDFilter(**rules), TrackRules(), np.random.default_rng(seed), robots=at, targets=goals)


def test_a_target_in_sight_becomes_a_track_after_three_steps():
    w = world(detection=1.0, clutter=0.0)
    tracks = []
    for _ in range(5):
        w.step({})
        tracks.append(w.metrics()["tracks"])
    assert tracks == [0, 0, 1, 1, 1]
    assert w.metrics()["found"] == 1 and w.metrics()["missed"] == 0 and w.metrics()["ospa"] < 3
    assert np.linalg.norm(w.mixture.means[w.observe().tracks[0]] - [55, 50]) < 3


def test_a_target_out_of_sight_is_not_detected():
    w = world(goals=((80.0, 50.0),), clutter=0.0)
    for _ in range(20):
        w.step({})
    assert len(w.mixture.weights) == 0 and w.metrics()["ospa"] == 100.0


def test_detections_and_clutter_come_as_often_as_told():
    w = world(detection=0.7, clutter=0.3)
    counts = [len(w._detections()[0]) for _ in range(4000)]
    assert np.mean(counts) == pytest.approx(1.0, abs=0.04)
    ghosts = world(goals=((99.0, 99.0),), clutter=1.0)
    off = np.concatenate([ghosts._detections()[0] for _ in range(4000)]) - [50, 50]
    lengths = np.linalg.norm(off, axis=1)
    assert lengths.max() <= 25.0 and (lengths <= 12.5).mean() == pytest.approx(0.25, abs=0.03)
    assert np.abs(off.mean(axis=0)).max() < 1.0


def test_births_of_weight_one_overestimate_the_number_of_targets():
    w = world(detection=1.0, clutter=0.0)
    for _ in range(10):
        w.step({})
    assert w.metrics()["weight"] == pytest.approx(2.0, abs=0.05)


def test_components_begin_15_m_from_their_targets_on_average():
    off = []
    for seed in range(60):
        w = make_world("search-and-track", seed, width=2000, height=2000, initial=15)
        assert len(w.mixture.weights) == 15 and np.array_equal(w.mixture.covariances[3], 50 * np.eye(2))
        off += np.linalg.norm(w.mixture.means[:10] - w.targets, axis=1).tolist()
    assert np.mean(off) == pytest.approx(15.0, abs=1.0)
    assert len(make_world("search-and-track", 1, initial=5).mixture.weights) == 5


def test_targets_do_not_depend_on_what_robots_do_or_believe():
    one = make_world("search-and-track", 3, target_step=0.5, turn_every=5)
    other = make_world("search-and-track", 3, target_step=0.5, turn_every=5, repulsion="none", initial=2, merge=1)
    for k in range(30):
        one.step({0: np.array([0.0, 0.5 * k])})
        other.step({})
    assert np.array_equal(one.targets, other.targets)
    assert not np.array_equal(one.targets, make_world("search-and-track", 3).targets)
    assert ((one.targets >= 0) & (one.targets <= 150)).all()


def test_a_step_that_cannot_be_done_changes_nothing():
    w = world()
    before = w.robots.copy(), w.time
    for actions, message in (
        ({0: [53.0, 50.0]}, "cannot move 3 m"), ({1: [50.0, 50.0]}, "no robot number 1"), ({0: "there"}, "must be told a position"),
        ({0: [math.nan, 0.0]}, "must be told a position"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=message):
            w.step(actions)
    assert np.array_equal(w.robots, before[0]) and w.time == before[1]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"start": "151,0"}, r"robot 1 starts outside the area; expected within \[0, 150\] x \[0, 150\]"),
        ({"start": "1,1 2,2"}, "one position a robot"),
        ({"start": "1,nan"}, "robot 1 starts outside"),
    ],
)
def test_robots_outside_the_map_are_refused(settings, message):
    with pytest.raises(InputError, match=message):
        make_world("search-and-track", 1, **settings)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"target-step": 100}, "too long for an area"), ({"repulsion": "some"}, "repulsion must be one of all, undetected, none"),
        ({"start": "a,b"}, "start must be pairs of numbers"), ({"start": "1,2,3"}, "start must be pairs"),
    ],
)  # fmt: skip
def test_settings_that_make_no_sense_are_refused(settings, message):
    with pytest.raises(UsageError, match=message):
        make_world("search-and-track", 1, **settings)


def test_positions_are_read_from_text():
    assert read_places("1,2 3.5,4") == [[1.0, 2.0], [3.5, 4.0]] and read_places(None) is None
    assert make_world("search-and-track", 1, robots=2, start="1,2 3,4").robots.tolist() == [[1, 2], [3, 4]]


def test_an_unknown_repulsion_is_refused_in_python_too():
    with pytest.raises(InputError, match="repulsion", check=coded("unknown-name")):
        PHDFilter(repulsion="some")
